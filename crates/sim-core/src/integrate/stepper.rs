//! Steps a system by a method, without a world.

use alloc::{vec, vec::Vec};
use core::mem::swap;
use glam::DVec3;

use super::{Failure, Method, Scratch, Step, System};

/// Steps the motion of a [`System`] by a [`Method`].
///
/// ```
/// use sim_core::{DVec3, Method, Stepper, System};
///
/// struct Oscillator;
///
/// impl System for Oscillator {
///     fn len(&self) -> usize {
///         1
///     }
///     fn accelerations(&self, _: f64, x: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
///         a[0] = -x[0];
///     }
/// }
///
/// let method = Method::named("rk4").unwrap();
/// let mut oscillator = Stepper::new(method, &[DVec3::X], &[DVec3::ZERO]);
/// for _ in 0..100 {
///     oscillator.step(&Oscillator, 0.01)?;
/// }
/// assert!((oscillator.position()[0].x - 1f64.cos()).abs() < 1e-10);
/// # Ok::<(), sim_core::Failure>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stepper {
    method: &'static Method,
    /// Error that adaptive methods may make in a step, relative and absolute; initially 1e-9.
    pub tolerance: f64,
    time: f64,
    position: Vec<DVec3>,
    velocity: Vec<DVec3>,
    new_position: Vec<DVec3>,
    new_velocity: Vec<DVec3>,
    scratch: Scratch,
}

impl Stepper {
    /// A motion at time 0: positions in m, and the same number of velocities in m/s.
    pub fn new(method: &'static Method, position: &[DVec3], velocity: &[DVec3]) -> Stepper {
        assert_eq!(
            position.len(),
            velocity.len(),
            "a velocity for each position"
        );
        Stepper {
            method,
            tolerance: 1e-9,
            time: 0.0,
            position: position.to_vec(),
            velocity: velocity.to_vec(),
            new_position: vec![DVec3::ZERO; position.len()],
            new_velocity: vec![DVec3::ZERO; position.len()],
            scratch: Scratch::default(),
        }
    }

    /// Steps by `dt` seconds, not 0; negative goes backwards. On a failure nothing changes.
    pub fn step<S: System>(&mut self, system: &S, dt: f64) -> Result<(), Failure> {
        let step = Step {
            time: self.time,
            dt,
            tolerance: self.tolerance,
            position: &self.position,
            velocity: &self.velocity,
            new_position: &mut self.new_position,
            new_velocity: &mut self.new_velocity,
            scratch: &mut self.scratch,
            watch: None,
        };
        (self.method.step)(system, step)?;
        swap(&mut self.position, &mut self.new_position);
        swap(&mut self.velocity, &mut self.new_velocity);
        self.time += dt;
        Ok(())
    }

    /// Time, s: the sum of all steps.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Positions, m.
    pub fn position(&self) -> &[DVec3] {
        &self.position
    }

    /// Velocities, m/s.
    pub fn velocity(&self) -> &[DVec3] {
        &self.velocity
    }
}
