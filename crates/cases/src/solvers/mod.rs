//! Solvers of `y' = f(y)` with error control: those of `sim_core` and their peers, with the same inlined right-hand
//! side and the same tolerance.

#[cfg(feature = "differential-equations")]
mod differential_equations;
#[cfg(feature = "ode_solvers")]
mod ode_solvers;
mod ours;

use crate::problems::FirstOrder;

/// A solver and its description.
#[derive(Debug)]
pub struct Solver {
    /// Name in tables.
    pub name: &'static str,
    /// Name in legends.
    pub title: &'static str,
    /// Its implementation.
    pub kind: Kind,
}

/// The implementations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Our implementation of Dormand and Prince's method of order 5.
    OurDopri5,
    /// Our implementation of their method of order 8.
    OurDop853,
    /// Dormand and Prince's method of order 5 in `ode_solvers`.
    #[cfg(feature = "ode_solvers")]
    OdeSolversDopri5,
    /// Their method of order 8 in `ode_solvers`.
    #[cfg(feature = "ode_solvers")]
    OdeSolversDop853,
    /// Dormand and Prince's method of order 5 in `differential-equations`.
    #[cfg(feature = "differential-equations")]
    DifferentialEquationsDopri5,
    /// Their method of order 8 in `differential-equations`.
    #[cfg(feature = "differential-equations")]
    DifferentialEquationsDop853,
    /// A method for stiff problems in `differential-equations`.
    #[cfg(feature = "differential-equations")]
    DifferentialEquationsRadau5,
}

/// Every solver that is compiled in, ours first.
pub static SOLVERS: &[Solver] = &[
    Solver {
        name: "sim_core::Dopri5",
        title: "Dopri5, sim-core",
        kind: Kind::OurDopri5,
    },
    Solver {
        name: "sim_core::Dop853",
        title: "Dop853, sim-core",
        kind: Kind::OurDop853,
    },
    #[cfg(feature = "ode_solvers")]
    Solver {
        name: "ode_solvers::Dopri5",
        title: "Dopri5, ode_solvers",
        kind: Kind::OdeSolversDopri5,
    },
    #[cfg(feature = "ode_solvers")]
    Solver {
        name: "ode_solvers::Dop853",
        title: "Dop853, ode_solvers",
        kind: Kind::OdeSolversDop853,
    },
    #[cfg(feature = "differential-equations")]
    Solver {
        name: "differential_equations::dopri5",
        title: "Dopri5, differential-eq.",
        kind: Kind::DifferentialEquationsDopri5,
    },
    #[cfg(feature = "differential-equations")]
    Solver {
        name: "differential_equations::dop853",
        title: "Dop853, differential-eq.",
        kind: Kind::DifferentialEquationsDop853,
    },
    #[cfg(feature = "differential-equations")]
    Solver {
        name: "differential_equations::radau5",
        title: "Radau5, differential-eq.",
        kind: Kind::DifferentialEquationsRadau5,
    },
];

/// The number of steps after which a solver is stopped.
const MOST_STEPS: u32 = 5_000_000;

/// A system to solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task<'a, E, const N: usize> {
    /// The equations.
    pub(crate) equations: &'a E,
    /// The initial state.
    pub(crate) start: [f64; N],
    /// The duration, from time 0.
    pub(crate) time: f64,
    /// Relative and absolute error tolerance of a step.
    pub(crate) tolerance: f64,
}

/// The result of a solver, and its cost by its own count.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solved<const N: usize> {
    /// The final state.
    pub(crate) state: [f64; N],
    /// Evaluations of the right-hand side.
    pub(crate) evaluations: u64,
    /// Evaluations of its Jacobian.
    pub(crate) jacobians: u64,
}

impl<E: FirstOrder<N>, const N: usize> Task<'_, E, N> {
    /// Solves the system.
    pub(crate) fn solve(self, solver: &Solver) -> Result<Solved<N>, String> {
        match solver.kind {
            Kind::OurDopri5 => ours::dopri5(self),
            Kind::OurDop853 => ours::dop853(self),
            #[cfg(feature = "ode_solvers")]
            Kind::OdeSolversDopri5 => ode_solvers::dopri5(self),
            #[cfg(feature = "ode_solvers")]
            Kind::OdeSolversDop853 => ode_solvers::dop853(self),
            #[cfg(feature = "differential-equations")]
            Kind::DifferentialEquationsDopri5 => differential_equations::dopri5(self),
            #[cfg(feature = "differential-equations")]
            Kind::DifferentialEquationsDop853 => differential_equations::dop853(self),
            #[cfg(feature = "differential-equations")]
            Kind::DifferentialEquationsRadau5 => differential_equations::radau5(self),
        }
    }
}
