//! The solvers of `sim_core`.

use std::hint::black_box;

use sim_core::{Dop853, Dopri5, Tolerance};

use super::{MOST_STEPS, Solved, Task};
use crate::problems::FirstOrder;

pub(super) fn dopri5<E: FirstOrder<N>, const N: usize>(
    task: Task<'_, E, N>,
) -> Result<Solved<N>, String> {
    let f = |_: f64, y: &[f64; N], dy: &mut [f64; N]| task.equations.slope(y, dy);
    let tolerance = Tolerance::of(task.tolerance);
    let mut solver = Dopri5::new(f, 0.0, black_box(task.start), tolerance);
    solver.most_steps = u64::from(MOST_STEPS);
    solver.advance(task.time).map_err(|e| e.to_string())?;
    Ok(Solved {
        state: *solver.state(),
        evaluations: solver.evaluations(),
        jacobians: 0,
    })
}

pub(super) fn dop853<E: FirstOrder<N>, const N: usize>(
    task: Task<'_, E, N>,
) -> Result<Solved<N>, String> {
    let f = |_: f64, y: &[f64; N], dy: &mut [f64; N]| task.equations.slope(y, dy);
    let tolerance = Tolerance::of(task.tolerance);
    let mut solver = Dop853::new(f, 0.0, black_box(task.start), tolerance);
    solver.most_steps = u64::from(MOST_STEPS);
    solver.advance(task.time).map_err(|e| e.to_string())?;
    Ok(Solved {
        state: *solver.state(),
        evaluations: solver.evaluations(),
        jacobians: 0,
    })
}
