//! The system that a method integrates: accelerations, and their derivatives by the motion.

use alloc::vec;
use glam::{DMat3, DVec3};

/// How a vector of one body changes with a position and a velocity: two 3×3 matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobians {
    /// Derivative with respect to position.
    pub position: DMat3,
    /// Derivative with respect to velocity.
    pub velocity: DMat3,
}

impl Jacobians {
    /// Of what depends on neither.
    pub const ZERO: Jacobians = Jacobians {
        position: DMat3::ZERO,
        velocity: DMat3::ZERO,
    };
}

/// The equations of motion `x'' = a(t, x, v)` of some bodies, in columns of equal length.
///
/// [`World`](crate::World) brings its forces in this form; so can anybody, to integrate a problem
/// of their own with a [`Stepper`](crate::Stepper). Only `len` and `accelerations` must be given.
pub trait System {
    /// How many bodies there are.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the acceleration of each body, m/s², at time `t`.
    fn accelerations(&self, t: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]);

    /// Whether the acceleration of a body depends on the motion of another one. `true` is always
    /// right; with `false` implicit methods solve for each body alone.
    fn is_coupled(&self) -> bool {
        true
    }

    /// Whether accelerations depend on velocities. `true` is always right; with `false` symplectic
    /// methods are explicit.
    fn depends_on_velocity(&self) -> bool {
        true
    }

    /// What a method made of drifts and kicks lets go on by itself for a time `h`, s, which may be negative:
    /// `x += h v`. A system whose motion without forces is another one has that here, and tells by
    /// [`System::kicks`] what is left.
    fn drift(&self, h: f64, x: &mut [DVec3], v: &mut [DVec3]) {
        for (x, v) in x.iter_mut().zip(v) {
            *x += h * *v;
        }
    }

    /// The accelerations that [`System::drift`] leaves out, as a system of as many bodies; `None`: all.
    fn kicks(&self) -> Option<&dyn System> {
        None
    }

    /// Writes `∂a/∂x · dx + ∂a/∂v · dv`, what implicit methods of coupled systems need. Unless it
    /// is given, a forward difference, right to about half of the digits.
    fn apply_jacobian(
        &self,
        t: f64,
        (x, v): (&[DVec3], &[DVec3]),
        (dx, dv): (&[DVec3], &[DVec3]),
        da: &mut [DVec3],
    ) {
        let scale = |s: &[DVec3]| {
            s.iter()
                .fold(0.0, |m, x| f64::max(m, x.abs().max_element()))
        };
        let largest = scale(dx).max(scale(dv));
        if largest == 0.0 {
            return da.fill(DVec3::ZERO);
        }
        let h = DIFFERENCE * (1.0 + scale(x).max(scale(v))) / largest;
        let moved = |s: &[DVec3], d: &[DVec3]| -> vec::Vec<DVec3> {
            s.iter().zip(d).map(|(s, d)| *s + h * *d).collect()
        };
        let mut base = vec![DVec3::ZERO; self.len()];
        self.accelerations(t, x, v, &mut base);
        self.accelerations(t, &moved(x, dx), &moved(v, dv), da);
        for (da, base) in da.iter_mut().zip(base) {
            *da = (*da - base) / h;
        }
    }

    /// Writes how each body's acceleration changes with its own motion, what implicit methods of
    /// uncoupled systems need. Unless it is given, forward differences.
    fn jacobians(&self, t: f64, x: &[DVec3], v: &[DVec3], out: &mut [Jacobians]) {
        let n = self.len();
        let mut base = vec![DVec3::ZERO; n];
        let mut moved = vec![DVec3::ZERO; n];
        self.accelerations(t, x, v, &mut base);
        // Uncoupled bodies may all be moved at once; coupled ones one after the other.
        let groups = if self.is_coupled() { n } else { 1 };
        for group in 0..groups {
            let bodies = if groups == 1 { 0..n } else { group..group + 1 };
            for axis in 0..3 {
                for of_velocity in [false, true] {
                    let mut at = (x.to_vec(), v.to_vec());
                    let column = if of_velocity { &mut at.1 } else { &mut at.0 };
                    for body in bodies.clone() {
                        column[body][axis] += difference(column[body]);
                    }
                    self.accelerations(t, &at.0, &at.1, &mut moved);
                    let start = if of_velocity { v } else { x };
                    for body in bodies.clone() {
                        let slope = (moved[body] - base[body]) / difference(start[body]);
                        let jacobians = &mut out[body];
                        let matrix = if of_velocity {
                            &mut jacobians.velocity
                        } else {
                            &mut jacobians.position
                        };
                        *matrix.col_mut(axis) = slope;
                    }
                }
            }
        }
    }
}

/// About the square root of the rounding unit: where rounding and curvature weigh the same.
const DIFFERENCE: f64 = 1.5e-8;

/// How far to move a vector for a forward difference.
fn difference(at: DVec3) -> f64 {
    DIFFERENCE * (1.0 + at.abs().max_element())
}
