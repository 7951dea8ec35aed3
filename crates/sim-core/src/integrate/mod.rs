//! Time integration: one step from a state to the next.
//!
//! A [`Method`] is a value in the table [`METHODS`]. A new method is a file in this module and a line in the
//! table; tests, benchmarks, scene files and the control panel read the table. A method from outside the crate is
//! the same kind of value, given to [`Settings`](crate::Settings) without an entry.

pub(crate) mod adaptive;
mod backward_euler;
pub(crate) mod ballistic;
#[cfg(feature = "serde")]
pub(crate) mod by_name;
mod dop853;
mod dopri5;
mod forward_euler;
mod implicit;
mod implicit_midpoint;
mod krylov;
mod radau5;
mod rk4;
mod scratch;
mod splitting;
pub(crate) mod stability;
mod stepper;
mod symplectic4;
mod symplectic8;
mod symplectic_euler;
mod system;
mod velocity_verlet;

use glam::DVec3;

pub use scratch::Scratch;
pub use stepper::Stepper;
pub use system::{Jacobians, System};

/// A way to step `x'' = a(t, x, v)` forward by `dt`.
#[derive(Debug)]
pub struct Method {
    /// Name in scene files and on the command line.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// Order of convergence: the error at a fixed time shrinks as `dt` to this power. For a
    /// method that controls its error, the order of its steps.
    pub order: u32,
    /// Stability on `x'' = -ω² x`, in a few words.
    pub stability: &'static str,
    /// The publication that describes it.
    pub source: &'static str,
    /// Whether it keeps the symplectic form of forces that have a potential: energy does not
    /// drift.
    pub symplectic: bool,
    /// Whether a step with `-dt` undoes a step with `dt`, up to rounding.
    pub reversible: bool,
    /// Whether it divides `dt` into as many steps as [`Step::tolerance`] requires.
    pub adaptive: bool,
    /// The coefficient of a constant acceleration `a`, if a step is `x + dt v + fall dt² a`, `v + dt a`. Bodies under
    /// no other force are moved by this formula, without [`Method::step`]. With `None`, [`Method::step`] is always
    /// called.
    pub fall: Option<f64>,
    /// Writes the motion at the end of a step.
    pub step: fn(&dyn System, Step<'_>) -> Result<(), Failure>,
}

/// All methods, the course's four first.
///
/// All methods keep their order for forces that depend on velocities. Symplectic Euler evaluates such a force at the
/// old velocity. The other splitting methods evaluate a part of it at the new velocity, for which they solve an
/// equation. No method is symplectic for such forces; the implicit midpoint rule and the methods made of drifts and
/// kicks, except symplectic Euler, stay reversible.
pub static METHODS: [&Method; 11] = [
    &forward_euler::METHOD,
    &backward_euler::METHOD,
    &symplectic_euler::METHOD,
    &rk4::METHOD,
    &velocity_verlet::METHOD,
    &implicit_midpoint::METHOD,
    &symplectic4::METHOD,
    &symplectic8::METHOD,
    &radau5::METHOD,
    &dopri5::METHOD,
    &dop853::METHOD,
];

impl Method {
    /// Whether this is the implicit midpoint rule, which has its own coordinates for rotations.
    pub(crate) fn is_midpoint(&self) -> bool {
        self.name == implicit_midpoint::METHOD.name
    }

    /// The method of that name.
    pub fn named(name: &str) -> Option<&'static Method> {
        METHODS.into_iter().find(|m| m.name == name)
    }
}

impl PartialEq for Method {
    fn eq(&self, other: &Method) -> bool {
        self.name == other.name
    }
}

/// One step of a system: columns to read and columns to write, all of the length of the system.
#[derive(Debug)]
pub struct Step<'a> {
    /// Time at the start, s.
    pub time: f64,
    /// Length of the step, s; not 0. Negative goes backwards.
    pub dt: f64,
    /// Error that adaptive methods may make: relative, and absolute in m and m/s.
    pub tolerance: f64,
    /// Positions at the start, m.
    pub position: &'a [DVec3],
    /// Velocities at the start, m/s.
    pub velocity: &'a [DVec3],
    /// Positions at the end, m, to be written.
    pub new_position: &'a mut [DVec3],
    /// Velocities at the end, m/s, to be written.
    pub new_velocity: &'a mut [DVec3],
    /// Memory for intermediate results, kept from step to step.
    pub scratch: &'a mut Scratch,
    /// Receives the steps that an adaptive method takes.
    pub watch: Option<Watch<'a>>,
}

/// Receives each step that an adaptive method takes within `dt`, and may stop it there.
pub struct Watch<'a>(&'a mut Ask<'a>);

/// A function that is called after each step.
pub type Ask<'a> = dyn FnMut(f64, &[DVec3], &[DVec3]) -> bool + 'a;

impl<'a> Watch<'a> {
    /// Calls a function after each step, with the time, s from the start of `dt`, and all positions before and after
    /// the step, m.
    pub fn new(ask: &'a mut Ask<'a>) -> Watch<'a> {
        Watch(ask)
    }

    /// Whether to stop after a step. The motion there is then that at the end.
    pub fn stops(&mut self, time: f64, before: &[DVec3], after: &[DVec3]) -> bool {
        (self.0)(time, before, after)
    }
}

impl core::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Watch")
    }
}

/// The reason why a method failed in a step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The equations of an implicit method were not solved.
    #[error("its equations were not solved in {iterations} iterations")]
    NotConverged {
        /// The body farthest from a solution, as an index of the system.
        body: usize,
        /// Iterations of Newton's method.
        iterations: u32,
    },
    /// An adaptive method would need more steps than are allowed.
    #[error("the tolerance asks for more than {steps} steps in one")]
    TooManySteps {
        /// The body whose error is largest, as an index of the system.
        body: usize,
        /// Steps taken.
        steps: u32,
    },
}

#[cfg(test)]
mod tests;
