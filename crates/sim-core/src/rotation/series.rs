//! Taylor polynomials of a rotation.
//!
//! Let `δ` be the rotation since the start of a piece, in the frame of the body at that start. Let `Ω` be the angular
//! velocity and `g` the torque, both in the frame of the body. Then the equations
//!
//! ```text
//! δ' = ½ δ Ω,   Ω' = I⁻¹(IΩ × Ω + g),   g' = g × Ω
//! ```
//!
//! have products on their right-hand sides, so each coefficient is a sum over the ones before it.

use glam::{DQuat, DVec3};

/// The highest order of a polynomial.
pub(super) const MOST: usize = 24;

/// The least order whose remainder is a ten-thousandth of rounding, for a piece that covers the part `reach` of the
/// radius of convergence: the terms after order `n` are at most `reach^(n+1) / (1 - reach)`. The remainder has the same
/// sign in every step, so that a larger one would add up.
pub(super) fn order(reach: f64) -> usize {
    let mut rest = reach / (1.0 - reach);
    let mut order = 0;
    while rest > 1e-4 * f64::EPSILON && order < MOST {
        rest *= reach;
        order += 1;
    }
    order
}

/// The greatest reach of a piece; order [`MOST`] is enough for it.
pub(super) const FARTHEST: f64 = 0.16;

/// The reach of a rotation per second, as a part of the radius of convergence. `spin` is the angular speed at the start
/// (rad/s), and `a` a bound on the effect of the torque, rad/s².
///
/// For a real body `|I_j - I_k| <= I_i`. So without torque `y' = y²/√3` majorises the speed; it has its pole at
/// `√3/|Ω|`. With a torque, `y' = y²/√3 + a z, z' = z y` majorises it, where `z` majorises the torque in the frame of
/// the body. With time in units of `1/(|Ω| + √a)`, all terms of that are at most those of
/// `y' = y²/√3 + z, z' = z y, y(0) = z(0) = 1`, which has its pole at 1.02126.
pub(super) fn rate(spin: f64, a: f64) -> f64 {
    match a > 0.0 {
        true => (spin + libm::sqrt(a)) / 1.0212,
        false => spin / ROOT_3,
    }
}

/// The greatest exponent of units whose squares are in the range of f64.
const MOST_UNITS: i32 = 500;

pub(super) const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// The rotation since the start of a piece, as a polynomial.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Series {
    order: usize,
    /// Units of time in a second, a power of two. The body rotates by about a radian in a unit, because powers of its
    /// speed in seconds may be out of range. The unit changes no digit.
    units: f64,
    /// Coefficients of `x, y, z, w`.
    turn: [[f64; 4]; MOST + 1],
}

impl Series {
    /// The series for a body with principal moments, an angular velocity and a torque in its frame.
    pub(super) fn new(moments: DVec3, spin: DVec3, torque: Option<DVec3>, order: usize) -> Series {
        let inverse = moments.recip();
        let pull = torque.map_or(0.0, |torque| (inverse * torque).abs().max_element());
        let speed = spin.abs().max_element().max(libm::sqrt(pull));
        let exponent = libm::frexp(speed).1.clamp(-MOST_UNITS, MOST_UNITS);
        let units = libm::ldexp(1.0, exponent);
        let spin = spin / units;
        let torque = torque.map(|torque| torque / (units * units));
        let factor = DVec3::new(
            moments.y - moments.z,
            moments.z - moments.x,
            moments.x - moments.y,
        ) * inverse;
        let mut omega = [[0.0; 3]; MOST + 1];
        let mut load = [[0.0; 3]; MOST + 1];
        let mut turn = [[0.0; 4]; MOST + 1];
        omega[0] = spin.to_array();
        load[0] = torque.unwrap_or(DVec3::ZERO).to_array();
        turn[0] = [0.0, 0.0, 0.0, 1.0];
        for n in 0..order {
            let (mut w, mut g, mut d) = ([0.0; 3], [0.0; 3], [0.0; 4]);
            for k in 0..=n {
                let [x, y, z] = omega[n - k];
                let [a, b, c] = omega[k];
                w[0] += b * z;
                w[1] += c * x;
                w[2] += a * y;
                let [p, q, r, s] = turn[k];
                d[0] += s * x + (q * z - r * y);
                d[1] += s * y + (r * x - p * z);
                d[2] += s * z + (p * y - q * x);
                d[3] -= p * x + q * y + r * z;
            }
            if torque.is_some() {
                for k in 0..=n {
                    let ([a, b, c], [x, y, z]) = (load[k], omega[n - k]);
                    g[0] += b * z - c * y;
                    g[1] += c * x - a * z;
                    g[2] += a * y - b * x;
                }
            }
            let part = 1.0 / (n as f64 + 1.0);
            for axis in 0..3 {
                let pull = inverse[axis] * load[n][axis];
                omega[n + 1][axis] = part * (factor[axis] * w[axis] + pull);
                load[n + 1][axis] = part * g[axis];
            }
            turn[n + 1] = d.map(|d| 0.5 * part * d);
        }
        Series { order, units, turn }
    }

    /// The rotation since the start of the piece, after a time, s.
    pub(super) fn at(&self, t: f64) -> DQuat {
        let t = t * self.units;
        let mut sum = [0.0; 4];
        for term in self.turn[1..=self.order].iter().rev() {
            for (sum, term) in sum.iter_mut().zip(term) {
                *sum = *sum * t + term;
            }
        }
        let [x, y, z, w] = sum.map(|sum| sum * t);
        DQuat::from_xyzw(x, y, z, 1.0 + w)
    }
}
