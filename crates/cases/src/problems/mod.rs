//! What is solved: problems with known ends, each as a second-order motion for the methods of
//! `sim_core` and as a first-order system for solvers of those.
//!
//! A new problem is a file here and a line in [`all`].

mod ballistic;
mod counted;
mod drag;
pub mod kepler;
mod oscillator;
pub mod pleiades;
mod stiff_linear;
pub(crate) mod stiff_spring;

use sim_core::{DVec3, Method, Stepper, System};

use crate::solvers::{self, Solver};
use counted::Counted;

/// Every problem of the work-precision diagrams.
pub fn all() -> Vec<Box<dyn Solve>> {
    vec![
        Box::new(ballistic::problem()),
        Box::new(drag::problem()),
        Box::new(oscillator::problem()),
        Box::new(stiff_spring::problem()),
        Box::new(kepler::problem(0.6)),
        Box::new(kepler::problem(0.9)),
        Box::new(pleiades::problem()),
        Box::new(stiff_linear::problem()),
    ]
}

/// What to know of a problem before it is solved.
#[derive(Clone, Debug)]
pub struct Card {
    /// Name in tables and file names.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// Equation, start, exact end, and where it is from.
    pub about: &'static str,
    /// What the error is the greatest component of.
    pub error: &'static str,
    /// Time at the end, s.
    pub time: f64,
    /// Fewest and most steps that methods with a fixed step try.
    pub steps: [u64; 2],
    /// Into how many `dt` the time is cut for adaptive methods, as a program would that draws.
    pub frames: u64,
    /// Whether stability, not accuracy, limits the steps of explicit methods.
    pub is_stiff: bool,
}

/// The same equations for solvers of `y' = f(y)`.
pub trait FirstOrder<const N: usize> {
    /// Writes `f(y)`.
    fn slope(&self, y: &[f64; N], dy: &mut [f64; N]);

    /// Writes how `f` changes along a direction, `∂f/∂y · d`.
    fn slope_along(&self, y: &[f64; N], d: &[f64; N], out: &mut [f64; N]);

    /// The state that positions and velocities are.
    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; N];
}

/// A problem: equations, where they start, and where they end.
#[derive(Clone, Debug)]
pub(crate) struct Problem<E, const N: usize> {
    /// What to know of it.
    pub(crate) card: Card,
    /// Both forms of it.
    pub(crate) equations: E,
    /// Positions at the start.
    pub(crate) position: Vec<DVec3>,
    /// Velocities at the start.
    pub(crate) velocity: Vec<DVec3>,
    /// The first components of the state at the end.
    pub(crate) exact: Vec<f64>,
    /// What errors are divided by.
    pub(crate) scale: f64,
}

/// How much trouble to take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// Steps of equal length.
    Steps(u64),
    /// Error allowed in a step, relative and absolute.
    Tolerance(f64),
}

/// Where a solution has ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct End {
    /// The greatest error of a component that is known, by the problem's scale.
    pub error: f64,
    /// Calls of the right-hand side.
    pub evaluations: u64,
    /// Calls of its Jacobian, or of products with it.
    pub jacobians: u64,
}

/// A problem of any size, ready to be solved.
pub trait Solve {
    /// What to know of it.
    fn card(&self) -> &Card;

    /// By a method of `sim_core`. Evaluations are counted if asked for, at a cost in time.
    fn by_method(
        &self,
        method: &'static Method,
        effort: Effort,
        count: bool,
    ) -> Result<End, String>;

    /// By a solver of first-order systems.
    fn by_solver(&self, solver: &Solver, tolerance: f64) -> Result<End, String>;
}

impl<E: System + FirstOrder<N>, const N: usize> Solve for Problem<E, N> {
    fn card(&self) -> &Card {
        &self.card
    }

    fn by_method(
        &self,
        method: &'static Method,
        effort: Effort,
        count: bool,
    ) -> Result<End, String> {
        let mut stepper = Stepper::new(method, &self.position, &self.velocity);
        if !count {
            self.step(&mut stepper, &self.equations, effort)?;
            return Ok(self.end(&stepper));
        }
        let counted = Counted::new(&self.equations);
        self.step(&mut stepper, &counted, effort)?;
        Ok(End {
            evaluations: counted.evaluations(),
            jacobians: counted.jacobians(),
            ..self.end(&stepper)
        })
    }

    fn by_solver(&self, solver: &Solver, tolerance: f64) -> Result<End, String> {
        let start = E::state(&self.position, &self.velocity);
        let task = solvers::Task {
            equations: &self.equations,
            start,
            time: self.card.time,
            tolerance,
        };
        let solved = task.solve(solver)?;
        Ok(End {
            error: self.error(&solved.state),
            evaluations: solved.evaluations,
            jacobians: solved.jacobians,
        })
    }
}

impl<E: FirstOrder<N>, const N: usize> Problem<E, N> {
    fn step<S: System>(
        &self,
        stepper: &mut Stepper,
        system: &S,
        effort: Effort,
    ) -> Result<(), String> {
        let steps = match effort {
            Effort::Steps(steps) => steps,
            Effort::Tolerance(tolerance) => {
                stepper.tolerance = tolerance;
                self.card.frames
            }
        };
        let dt = self.card.time / steps as f64;
        for step in 0..steps {
            let done = stepper.step(system, dt);
            done.map_err(|failure| format!("step {}: {failure}", step + 1))?;
            let is_lost = || !stepper.velocity()[0].is_finite();
            // Looked at now and then: a check at each step would count as the method's time.
            if step % 4096 == 4095 && is_lost() {
                return Err(format!("beyond all numbers by step {}", step + 1));
            }
        }
        Ok(())
    }

    fn end(&self, stepper: &Stepper) -> End {
        End {
            error: self.error(&E::state(stepper.position(), stepper.velocity())),
            ..End::default()
        }
    }

    /// The greatest error of a component that is known.
    fn error(&self, state: &[f64; N]) -> f64 {
        let pairs = self.exact.iter().zip(state);
        // `max` would drop a NaN.
        let worst = pairs
            .map(|(exact, y)| (exact - y).abs())
            .fold(0.0, |m, e| if e <= m { m } else { e });
        worst / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every problem's two forms and its exact end belong together: the tightest solves of both
    /// forms meet it.
    #[test]
    fn both_forms_reach_the_end_that_is_known() {
        for problem in all() {
            let card = problem.card();
            let dop853 = Method::named("dop853").expect("it is in the table");
            let by_method = problem.by_method(dop853, Effort::Tolerance(1e-13), false);
            let by_solver = problem.by_solver(&solvers::SOLVERS[1], 1e-13);
            // A hundred orbits of eccentricity 0.9 make 2e-6 of a tolerance of 1e-13, others less.
            let allowed = 1e-5;
            for end in [by_method, by_solver] {
                let end = end.unwrap_or_else(|error| panic!("{}: {error}", card.name));
                assert!(end.error < allowed, "{}: {}", card.name, end.error);
            }
        }
    }

    #[test]
    fn jacobians_are_slopes_of_the_right_hand_sides() {
        fn check<E: FirstOrder<N>, const N: usize>(problem: &Problem<E, N>) {
            let y = E::state(&problem.position, &problem.velocity);
            let d: [f64; N] = std::array::from_fn(|i| (1.3 * i as f64 + 0.4).sin());
            let moved = |h: f64| {
                let at: [f64; N] = std::array::from_fn(|i| y[i] + h * d[i]);
                let mut slope = [0.0; N];
                problem.equations.slope(&at, &mut slope);
                slope
            };
            let (ahead, behind) = (moved(1e-5), moved(-1e-5));
            let mut along = [0.0; N];
            problem.equations.slope_along(&y, &d, &mut along);
            let scale = along.iter().fold(1.0, |m: f64, a| m.max(a.abs()));
            for i in 0..N {
                let difference = (ahead[i] - behind[i]) / 2e-5;
                let error = (difference - along[i]).abs() / scale;
                assert!(error < 1e-7, "{} {i}: {error}", problem.card.name);
            }
        }
        check(&ballistic::problem());
        check(&drag::problem());
        check(&oscillator::problem());
        check(&stiff_spring::problem());
        check(&kepler::problem(0.6));
        check(&pleiades::problem());
        check(&stiff_linear::problem());
    }
}
