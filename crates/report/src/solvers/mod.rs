//! Solvers of `y' = f(y)` that choose their steps: the ones of `sim_core` and their peers, all
//! given the same right-hand side, inlined, and the same tolerance.

mod differential_equations;
mod ode_solvers;
mod ours;

use crate::problems::FirstOrder;

/// A solver and what it is.
#[derive(Debug)]
pub(crate) struct Solver {
    /// Name in tables.
    pub(crate) name: &'static str,
    /// Name in legends.
    pub(crate) title: &'static str,
    pub(crate) kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    OurDopri5,
    OurDop853,
    OdeSolversDopri5,
    OdeSolversDop853,
    DifferentialEquationsDopri5,
    DifferentialEquationsDop853,
    DifferentialEquationsRadau5,
}

/// Every solver, ours first.
pub(crate) static SOLVERS: [Solver; 7] = [
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
    Solver {
        name: "ode_solvers::Dopri5",
        title: "Dopri5, ode_solvers",
        kind: Kind::OdeSolversDopri5,
    },
    Solver {
        name: "ode_solvers::Dop853",
        title: "Dop853, ode_solvers",
        kind: Kind::OdeSolversDop853,
    },
    Solver {
        name: "differential_equations::dopri5",
        title: "Dopri5, differential-eq.",
        kind: Kind::DifferentialEquationsDopri5,
    },
    Solver {
        name: "differential_equations::dop853",
        title: "Dop853, differential-eq.",
        kind: Kind::DifferentialEquationsDop853,
    },
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
    pub(crate) equations: &'a E,
    pub(crate) start: [f64; N],
    /// Time to solve for, from 0.
    pub(crate) time: f64,
    /// Error allowed in a step, relative and absolute.
    pub(crate) tolerance: f64,
}

/// Where a solver has come to, at what cost by its own count.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solved<const N: usize> {
    pub(crate) state: [f64; N],
    pub(crate) evaluations: u64,
    pub(crate) jacobians: u64,
}

impl<E: FirstOrder<N>, const N: usize> Task<'_, E, N> {
    pub(crate) fn solve(self, solver: &Solver) -> Result<Solved<N>, String> {
        match solver.kind {
            Kind::OurDopri5 => ours::dopri5(self),
            Kind::OurDop853 => ours::dop853(self),
            Kind::OdeSolversDopri5 => ode_solvers::dopri5(self),
            Kind::OdeSolversDop853 => ode_solvers::dop853(self),
            Kind::DifferentialEquationsDopri5 => differential_equations::dopri5(self),
            Kind::DifferentialEquationsDop853 => differential_equations::dop853(self),
            Kind::DifferentialEquationsRadau5 => differential_equations::radau5(self),
        }
    }
}
