//! Solvers of `y' = f(y)` that choose their steps: the ones of `sim_core` and their peers, all
//! given the same right-hand side, inlined, and the same tolerance.

#[cfg(feature = "differential-equations")]
mod differential_equations;
#[cfg(feature = "ode_solvers")]
mod ode_solvers;
mod ours;

use crate::problems::FirstOrder;

/// A solver and what it is.
#[derive(Debug)]
pub struct Solver {
    /// Name in tables.
    pub name: &'static str,
    /// Name in legends.
    pub title: &'static str,
    /// Whose it is.
    pub kind: Kind,
}

/// Whose method it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Dormand and Prince's method of order 5, ours.
    OurDopri5,
    /// Theirs of order 8, ours.
    OurDop853,
    /// Of `ode_solvers`.
    #[cfg(feature = "ode_solvers")]
    OdeSolversDopri5,
    /// Of `ode_solvers`.
    #[cfg(feature = "ode_solvers")]
    OdeSolversDop853,
    /// Of `differential-equations`.
    #[cfg(feature = "differential-equations")]
    DifferentialEquationsDopri5,
    /// Of `differential-equations`.
    #[cfg(feature = "differential-equations")]
    DifferentialEquationsDop853,
    /// Of `differential-equations`, for stiff problems.
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

/// Steps after which a solver is stopped.
const MOST_STEPS: u32 = 5_000_000;

/// A system to solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task<'a, E, const N: usize> {
    /// What is solved.
    pub(crate) equations: &'a E,
    /// The state at time 0.
    pub(crate) start: [f64; N],
    /// Time to solve for, from 0.
    pub(crate) time: f64,
    /// Error allowed in a step, relative and absolute.
    pub(crate) tolerance: f64,
}

/// Where a solver has come to, at what cost by its own count.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solved<const N: usize> {
    /// The state at the end.
    pub(crate) state: [f64; N],
    /// Calls of the right-hand side.
    pub(crate) evaluations: u64,
    /// Calls of its Jacobian.
    pub(crate) jacobians: u64,
}

impl<E: FirstOrder<N>, const N: usize> Task<'_, E, N> {
    /// Solves it.
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
