//! The crate `differential-equations`, with its defaults except for the limit on steps.

use std::hint::black_box;

use differential_equations::linalg::Matrix;
use differential_equations::prelude::{
    Error, ExplicitRungeKutta, IVP, ImplicitRungeKutta, ODE, Solution,
};

use super::{MOST_STEPS, Solved, Task};
use crate::problems::FirstOrder;

struct Peer<'a, E>(&'a E);

impl<E: FirstOrder<N>, const N: usize> ODE<f64, [f64; N]> for Peer<'_, E> {
    fn diff(&self, _: f64, y: &[f64; N], dy: &mut [f64; N]) {
        self.0.slope(y, dy);
    }

    fn jacobian(&self, _: f64, y: &[f64; N], matrix: &mut Matrix<f64>) {
        for j in 0..N {
            let mut along = [0.0; N];
            let mut column = [0.0; N];
            along[j] = 1.0;
            self.0.slope_along(y, &along, &mut column);
            for (i, entry) in column.into_iter().enumerate() {
                matrix[(i, j)] = entry;
            }
        }
    }
}

pub(super) fn dopri5<E: FirstOrder<N>, const N: usize>(
    task: Task<'_, E, N>,
) -> Result<Solved<N>, String> {
    let method = ExplicitRungeKutta::dopri5().max_steps(MOST_STEPS as usize);
    let peer = Peer(task.equations);
    let problem = IVP::ode(&peer, 0.0, task.time, black_box(task.start)).method(method);
    let solution = problem.rtol(task.tolerance).atol(task.tolerance).solve();
    solved(solution)
}

pub(super) fn dop853<E: FirstOrder<N>, const N: usize>(
    task: Task<'_, E, N>,
) -> Result<Solved<N>, String> {
    let method = ExplicitRungeKutta::dop853().max_steps(MOST_STEPS as usize);
    let peer = Peer(task.equations);
    let problem = IVP::ode(&peer, 0.0, task.time, black_box(task.start)).method(method);
    let solution = problem.rtol(task.tolerance).atol(task.tolerance).solve();
    solved(solution)
}

pub(super) fn radau5<E: FirstOrder<N>, const N: usize>(
    task: Task<'_, E, N>,
) -> Result<Solved<N>, String> {
    let method = ImplicitRungeKutta::radau5().max_steps(MOST_STEPS as usize);
    let method = method.rtol(task.tolerance).atol(task.tolerance);
    let peer = Peer(task.equations);
    let problem = IVP::ode(&peer, 0.0, task.time, black_box(task.start));
    solved(problem.method(method).solve())
}

fn solved<const N: usize>(
    outcome: Result<Solution<f64, [f64; N]>, Error<f64, [f64; N]>>,
) -> Result<Solved<N>, String> {
    // Its errors implement `Display` only for some types of state, not for arrays.
    let solution = outcome.map_err(|error| match error {
        Error::MaxSteps { t, .. } => format!("at t = {t} after {MOST_STEPS} steps"),
        Error::StepSize { t, .. } => format!("at t = {t} the step became too small"),
        Error::Stiffness { t, .. } => format!("at t = {t} it found the problem stiff"),
        Error::LinearAlgebra { t, msg, .. } => format!("at t = {t}: {msg}"),
        other => format!("{other:?}"),
    })?;
    let (_, state) = solution.last().map_err(|error| format!("{error:?}"))?;
    Ok(Solved {
        state: *state,
        evaluations: solution.evals.function as u64,
        jacobians: solution.evals.jacobian as u64,
    })
}
