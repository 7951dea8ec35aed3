//! The crate `ode_solvers`, with its defaults except for the limit on steps and the stiffness test, which would end a
//! solution, and without output between the steps.

use std::hint::black_box;

use ode_solvers::dop_shared::{IntegrationError, OutputType, Stats};
use ode_solvers::{Dop853, Dopri5, SVector, System};

use super::{MOST_STEPS, Solved, Task};
use crate::problems::FirstOrder;

struct Peer<'a, E>(&'a E);

impl<E: FirstOrder<N>, const N: usize> System<f64, SVector<f64, N>> for Peer<'_, E> {
    fn system(&self, _: f64, y: &SVector<f64, N>, dy: &mut SVector<f64, N>) {
        self.0.slope(&y.data.0[0], &mut dy.data.0[0]);
    }
}

pub(super) fn dopri5<E: FirstOrder<N>, const N: usize>(
    task: Task<'_, E, N>,
) -> Result<Solved<N>, String> {
    let start = SVector::from(black_box(task.start));
    let mut solver = Dopri5::from_param(
        Peer(task.equations),
        0.0,
        task.time,
        0.0,
        start,
        task.tolerance,
        task.tolerance,
        0.9,
        0.04,
        0.2,
        10.0,
        task.time,
        0.0,
        MOST_STEPS,
        u32::MAX,
        OutputType::Sparse,
    );
    let outcome = solver.integrate();
    solved(outcome, solver.y_out().last())
}

pub(super) fn dop853<E: FirstOrder<N>, const N: usize>(
    task: Task<'_, E, N>,
) -> Result<Solved<N>, String> {
    let start = SVector::from(black_box(task.start));
    let mut solver = Dop853::from_param(
        Peer(task.equations),
        0.0,
        task.time,
        0.0,
        start,
        task.tolerance,
        task.tolerance,
        0.9,
        0.0,
        0.333,
        6.0,
        task.time,
        0.0,
        MOST_STEPS,
        u32::MAX,
        OutputType::Sparse,
    );
    let outcome = solver.integrate();
    solved(outcome, solver.y_out().last())
}

fn solved<const N: usize>(
    outcome: Result<Stats, IntegrationError>,
    last: Option<&SVector<f64, N>>,
) -> Result<Solved<N>, String> {
    let stats = outcome.map_err(|error| error.to_string())?;
    let last = last.ok_or("it has no output")?;
    Ok(Solved {
        state: last.data.0[0],
        evaluations: u64::from(stats.num_eval),
        jacobians: 0,
    })
}
