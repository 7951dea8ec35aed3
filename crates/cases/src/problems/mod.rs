//! Problems with a known final state, each as a second-order motion for the methods of `sim_core` and as a first-order
//! system for solvers of such systems.
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

/// The description of a problem.
#[derive(Clone, Debug)]
pub struct Card {
    /// Name in tables and file names.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// Equation, initial state, exact final state, and its source.
    pub about: &'static str,
    /// The quantities over whose components the error is the maximum.
    pub error: &'static str,
    /// Final time, s.
    pub time: f64,
    /// The fewest and the most steps for methods with a fixed step.
    pub steps: [u64; 2],
    /// The number of `dt` into which the time is divided for adaptive methods, as by a program that draws frames.
    pub frames: u64,
    /// Whether stability, not accuracy, limits the steps of explicit methods.
    pub is_stiff: bool,
}

/// The same equations for solvers of `y' = f(y)`.
pub trait FirstOrder<const N: usize> {
    /// Writes `f(y)`.
    fn slope(&self, y: &[f64; N], dy: &mut [f64; N]);

    /// Writes the derivative of `f` along a direction, `∂f/∂y · d`.
    fn slope_along(&self, y: &[f64; N], d: &[f64; N], out: &mut [f64; N]);

    /// The state that corresponds to positions and velocities.
    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; N];
}

/// A problem: equations, initial state and final state.
#[derive(Clone, Debug)]
pub(crate) struct Problem<E, const N: usize> {
    /// The description.
    pub(crate) card: Card,
    /// Both forms of the equations.
    pub(crate) equations: E,
    /// Initial positions.
    pub(crate) position: Vec<DVec3>,
    /// Initial velocities.
    pub(crate) velocity: Vec<DVec3>,
    /// The first components of the final state.
    pub(crate) exact: Vec<f64>,
    /// The scale by which errors are divided.
    pub(crate) scale: f64,
}

/// The accuracy of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// Steps of equal length.
    Steps(u64),
    /// Relative and absolute error tolerance of a step.
    Tolerance(f64),
}

/// The result of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct End {
    /// The greatest error of the known components, divided by the problem's scale.
    pub error: f64,
    /// Evaluations of the right-hand side.
    pub evaluations: u64,
    /// Evaluations of its Jacobian, or of products with it.
    pub jacobians: u64,
}

/// A problem of any size, ready to be solved.
pub trait Solve {
    /// The description.
    fn card(&self) -> &Card;

    /// Solves it with a method of `sim_core`. Evaluations are counted if requested, which takes time.
    fn by_method(
        &self,
        method: &'static Method,
        effort: Effort,
        count: bool,
    ) -> Result<End, String>;

    /// Solves it with a solver of first-order systems.
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
            // The check is rare, because its cost would count as the method's time.
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

    /// The greatest error of the known components.
    fn error(&self, state: &[f64; N]) -> f64 {
        let pairs = self.exact.iter().zip(state);
        // `max` would ignore NaN.
        let worst = pairs
            .map(|(exact, y)| (exact - y).abs())
            .fold(0.0, |m, e| if e <= m { m } else { e });
        worst / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two forms of every problem match its exact final state: the most accurate solutions of both reach it.
    #[test]
    fn both_forms_reach_the_end_that_is_known() {
        for problem in all() {
            let card = problem.card();
            let dop853 = Method::named("dop853").expect("it is in the table");
            let by_method = problem.by_method(dop853, Effort::Tolerance(1e-13), false);
            let by_solver = problem.by_solver(&solvers::SOLVERS[1], 1e-13);
            // A hundred orbits of eccentricity 0.9 turn a tolerance of 1e-13 into an error of 2e-6; other problems have
            // less.
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
