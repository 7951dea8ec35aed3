//! The system that a method integrates: accelerations, and their derivatives with respect to the motion.

use alloc::vec;
use glam::{DMat3, DVec3};

/// The derivatives of a vector of one body with respect to position and velocity: two 3×3 matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobians {
    /// Derivative with respect to position.
    pub position: DMat3,
    /// Derivative with respect to velocity.
    pub velocity: DMat3,
}

impl Jacobians {
    /// For a vector that depends on neither.
    pub const ZERO: Jacobians = Jacobians {
        position: DMat3::ZERO,
        velocity: DMat3::ZERO,
    };
}

/// The equations of motion `x'' = a(t, x, v)` of some bodies, in columns of equal length.
///
/// [`World`](crate::World) provides its forces in this form. You can implement it to integrate a problem of your own
/// with a [`Stepper`](crate::Stepper). Only `len` and `accelerations` are required.
pub trait System {
    /// The number of bodies.
    fn len(&self) -> usize;

    /// Whether there are no bodies.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the acceleration of each body, m/s², at time `t`.
    fn accelerations(&self, t: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]);

    /// Whether the acceleration of a body depends on the motion of another one. `true` is always correct; with `false`,
    /// implicit methods solve for each body separately.
    fn is_coupled(&self) -> bool {
        true
    }

    /// Whether accelerations depend on velocities. `true` is always correct; with `false`, symplectic methods are
    /// explicit.
    fn depends_on_velocity(&self) -> bool {
        true
    }

    /// The drift of a method made of drifts and kicks: the motion without kicks over a time `h`, s, which may be
    /// negative. The default is `x += h v`. A system with another motion without forces implements it here, and
    /// returns the other accelerations from [`System::kicks`].
    fn drift(&self, h: f64, x: &mut [DVec3], v: &mut [DVec3]) {
        for (x, v) in x.iter_mut().zip(v) {
            *x += h * *v;
        }
    }

    /// The accelerations that [`System::drift`] leaves out, as a system of the same number of bodies; `None` for all.
    fn kicks(&self) -> Option<&dyn System> {
        None
    }

    /// Writes `∂a/∂x · dx + ∂a/∂v · dv`, which implicit methods need for coupled systems. The default is a forward
    /// difference, correct to about half of the digits.
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

    /// Writes the derivatives of each body's acceleration with respect to its own motion, which implicit methods need
    /// for uncoupled systems. The default uses forward differences.
    fn jacobians(&self, t: f64, x: &[DVec3], v: &[DVec3], out: &mut [Jacobians]) {
        let n = self.len();
        let mut base = vec![DVec3::ZERO; n];
        let mut moved = vec![DVec3::ZERO; n];
        self.accelerations(t, x, v, &mut base);
        // Uncoupled bodies may be moved together; coupled ones only one after the other.
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

/// About the square root of the rounding unit, at which the errors of rounding and of curvature are equal.
const DIFFERENCE: f64 = 1.5e-8;

/// The length by which a vector is moved for a forward difference.
fn difference(at: DVec3) -> f64 {
    DIFFERENCE * (1.0 + at.abs().max_element())
}
