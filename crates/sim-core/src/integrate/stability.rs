//! The longest stable step of a method.
//!
//! A motion near equilibrium is a sum of oscillators `x'' = -k x - c x'`. On each of them a step of a fixed-step
//! method is a 2×2 matrix, found from its steps from (1, 0) and (0, 1). The method is stable as long as no eigenvalue
//! is outside the unit circle (Hairer, Wanner 1996, sec. IV.2).

use alloc::{vec, vec::Vec};
use core::slice;
use glam::DVec3;

use super::{Jacobians, Method, Scratch, Step, System};

impl Method {
    /// The largest `dt`, s, up to which the method is stable on `x'' = -k x - c x'`, with `k` in 1/s² and `c` in 1/s.
    /// It is 0 if the method is stable at no `dt`, or if `k` or `c` is not finite; infinite if the method is stable
    /// at every `dt`. Windows of instability below it that are narrower than 0.2 % may be missed.
    ///
    /// ```
    /// let rk4 = sim_core::Method::named("rk4").unwrap();
    /// assert!((rk4.stable_dt(1e6, 1e3) - 2.6225e-3).abs() < 1e-7);
    /// ```
    pub fn stable_dt(&self, k: f64, c: f64) -> f64 {
        let rate = libm::sqrt(k.max(0.0)).max(c.abs());
        let unstable = |dt: f64| self.growth(k, c, dt) > 1.0 + 1e-11;
        if self.adaptive || rate == 0.0 || k < 0.0 || c < 0.0 {
            // Either the method follows the motion at any step, or the motion itself grows.
            return f64::INFINITY;
        }
        if !(k.is_finite() && c.is_finite()) {
            return 0.0;
        }
        let (mut stable, factor) = (1e-2 / rate, 1.002);
        if unstable(stable) {
            return 0.0;
        }
        while !unstable(factor * stable) {
            stable *= factor;
            if stable * rate > 1e6 {
                return f64::INFINITY;
            }
        }
        let mut limit = factor * stable;
        for _ in 0..60 {
            let middle = 0.5 * (stable + limit);
            if unstable(middle) {
                limit = middle;
            } else {
                stable = middle;
            }
        }
        stable
    }

    /// The greatest absolute value of an eigenvalue of a step on that oscillator; infinite if the step fails.
    pub(super) fn growth(&self, k: f64, c: f64, dt: f64) -> f64 {
        let mut scratch = Scratch::default();
        let mut column = |x: f64, v: f64| {
            let (mut x1, mut v1) = (DVec3::ZERO, DVec3::ZERO);
            let step = Step {
                time: 0.0,
                dt,
                tolerance: 1e-9,
                position: &[x * DVec3::X],
                velocity: &[v * DVec3::X],
                new_position: slice::from_mut(&mut x1),
                new_velocity: slice::from_mut(&mut v1),
                scratch: &mut scratch,
                watch: None,
            };
            let done = (self.step)(&Oscillator { k, c }, step);
            done.map_or((f64::INFINITY, f64::INFINITY), |()| (x1.x, v1.x))
        };
        // The two axes have different units, which differ by the rate of the oscillator. Scaling them loses no digits
        // in the trace and the determinant.
        let ((xx, vx), (xv, vv)) = (column(1.0, 0.0), column(0.0, 1.0));
        let (half_trace, determinant) = (0.5 * (xx + vv), xx * vv - xv * vx);
        let discriminant = half_trace * half_trace - determinant;
        if discriminant > 0.0 {
            half_trace.abs() + libm::sqrt(discriminant)
        } else {
            libm::sqrt(determinant)
        }
    }
}

/// `x'' = -k x - c x'`.
struct Oscillator {
    k: f64,
    c: f64,
}

impl System for Oscillator {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn depends_on_velocity(&self) -> bool {
        self.c != 0.0
    }

    fn accelerations(&self, _: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        a[0] = -self.k * x[0] - self.c * v[0];
    }

    fn jacobians(&self, _: f64, _: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        out[0] = Jacobians {
            position: glam::DMat3::from_diagonal(DVec3::splat(-self.k)),
            velocity: glam::DMat3::from_diagonal(DVec3::splat(-self.c)),
        };
    }
}

/// The largest stable `dt` of a method on a system near a motion: that of its stiffest and most damped oscillators, by
/// power iteration. `None` if no force is restoring.
pub(crate) fn largest_stable_step(
    method: &Method,
    system: &dyn System,
    t: f64,
    x: &[DVec3],
    v: &[DVec3],
) -> Option<f64> {
    let zero = vec![DVec3::ZERO; x.len()];
    let pull = |d: &[DVec3], out: &mut [DVec3]| {
        system.apply_jacobian(t, (x, v), (d, &zero), out);
    };
    let drag = |d: &[DVec3], out: &mut [DVec3]| {
        system.apply_jacobian(t, (x, v), (&zero, d), out);
    };
    let (k, shape) = dominant(x.len(), pull);
    let (c, drag_shape) = dominant(x.len(), drag);
    let stiffest = (k, -quotient(&shape, drag));
    let most_damped = (-quotient(&drag_shape, pull), c);
    [stiffest, most_damped]
        .into_iter()
        .filter(|&(k, c)| k > 0.0 || c > 0.0)
        .map(|(k, c)| method.stable_dt(k.max(0.0), c.max(0.0)))
        .reduce(f64::min)
}

/// The eigenvalue of `-apply` of the greatest absolute value, with its vector.
fn dominant(n: usize, apply: impl Fn(&[DVec3], &mut [DVec3])) -> (f64, Vec<DVec3>) {
    // Not symmetric, so that it has a component along every eigenvector.
    let mut shape: Vec<DVec3> = (0..n)
        .map(|i| {
            let i = 3.0 * i as f64;
            DVec3::new(
                libm::cos(i + 1.0),
                libm::cos(1.7 * i),
                libm::sin(2.3 * i + 0.4),
            )
        })
        .collect();
    let mut image = vec![DVec3::ZERO; n];
    for _ in 0..200 {
        apply(&shape, &mut image);
        let largest = image
            .iter()
            .fold(0.0, |m: f64, x| m.max(x.abs().max_element()));
        if !(largest > 0.0 && largest.is_finite()) {
            return (0.0, shape);
        }
        for (shape, image) in shape.iter_mut().zip(&image) {
            *shape = *image / largest;
        }
    }
    (-quotient(&shape, apply), shape)
}

/// Rayleigh's quotient `d·A d / d·d`.
fn quotient(d: &[DVec3], apply: impl Fn(&[DVec3], &mut [DVec3])) -> f64 {
    let mut image = vec![DVec3::ZERO; d.len()];
    apply(d, &mut image);
    let along: f64 = d.iter().zip(&image).map(|(d, i)| d.dot(*i)).sum();
    let squared: f64 = d.iter().map(|d| d.dot(*d)).sum();
    along / squared
}

#[cfg(test)]
mod tests {
    use crate::METHODS;

    /// The search ends for all of them.
    #[test]
    fn no_step_is_stable_where_the_rate_is_no_number() {
        for method in METHODS {
            for (k, c) in [
                (1.0, f64::INFINITY),
                (f64::INFINITY, 0.0),
                (f64::INFINITY, 1.0),
                (f64::NAN, 1.0),
                (1.0, f64::NAN),
            ] {
                let dt = method.stable_dt(k, c);
                assert_eq!(dt, if method.adaptive { f64::INFINITY } else { 0.0 });
            }
            for huge in [1e300, f64::MAX] {
                assert!(method.stable_dt(huge, 0.0) >= 0.0 && method.stable_dt(1.0, huge) >= 0.0);
            }
        }
    }
}
