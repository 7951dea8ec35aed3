//! Rotations near a base rotation, represented by vectors, so that a method for `x'' = a(t, x, v)` can step them.
//!
//! A rotation is `base · exp(θ)`. The *rotation vector* `θ` is in the frame of the body, rad; its length is the angle.
//! With `s = |θ|²` the angular velocity in the body `Ω` and the rate `θ'` are related by
//!
//! ```text
//! Ω  = θ' - a θ×θ' + b θ×(θ×θ')      a = (1 - cos |θ|)/s,   b = (|θ| - sin |θ|)/(s |θ|)
//! θ' = Ω + ½ θ×Ω + c θ×(θ×Ω)         c = (1 - ½|θ| cot ½|θ|)/s
//! ```
//!
//! and `θ''` follows from `Ω'` by the derivative of the second equation (Iserles, Munthe-Kaas, Nørsett, Zanna 2000,
//! "Lie-group methods", Acta Numerica 9, p. 215, app. B; the signs are those of rotations that act from the right).
//! These equations hold for angles below a whole turn; a step ends within half a turn.

use glam::{DQuat, DVec3};

use super::flight::about;

/// The rotation of a rotation vector.
pub(crate) fn rotation(theta: DVec3) -> DQuat {
    about(theta, 1.0)
}

/// The rotation vector of a rotation, at most half a turn long.
pub(crate) fn vector(rotation: DQuat) -> DVec3 {
    // Both signs of a quaternion are the same rotation.
    let q = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    let part = DVec3::new(q.x, q.y, q.z);
    let sin = part.length();
    match sin > 0.0 {
        true => 2.0 * libm::atan2(sin, q.w) / sin * part,
        false => 2.0 * part,
    }
}

/// The angular velocity in the body, rad/s, for a rotation vector and its rate, rad/s.
pub(crate) fn spin(theta: DVec3, rate: DVec3) -> DVec3 {
    let s = theta.length_squared();
    let angle = libm::sqrt(s);
    // Without cancellation: 2 sin²(|θ|/2)/s.
    let half = libm::sin(0.5 * angle);
    let a = if s > 0.0 { 2.0 * half * half / s } else { 0.5 };
    let b = match s < NEAR {
        true => series(s, &SINE),
        false => (angle - libm::sin(angle)) / (s * angle),
    };
    let across = theta.cross(rate);
    rate - a * across + b * theta.cross(across)
}

/// The rate of the rotation vector for an angular velocity in the body, both rad/s.
pub(crate) fn rate(theta: DVec3, spin: DVec3) -> DVec3 {
    let (c, _) = cotangent(theta.length_squared());
    let across = theta.cross(spin);
    spin + 0.5 * across + c * theta.cross(across)
}

/// The second derivative of the rotation vector at constant angular velocity in the body, rad/s². An angular
/// acceleration adds its own [`rate`].
pub(crate) fn bend(theta: DVec3, rate: DVec3, spin: DVec3) -> DVec3 {
    let (c, slope) = cotangent(theta.length_squared());
    let across = theta.cross(spin);
    let turned = rate.cross(across) + theta.cross(rate.cross(spin));
    0.5 * rate.cross(spin) + 2.0 * slope * theta.dot(rate) * theta.cross(across) + c * turned
}

/// Below this the closed forms cancel, and the series are exact up to rounding.
const NEAR: f64 = 0.25;

/// `(|θ| - sin |θ|)/|θ|³` by powers of `s`.
const SINE: [f64; 8] = [
    1.0 / 6.0,
    -1.0 / 120.0,
    1.0 / 5_040.0,
    -1.0 / 362_880.0,
    1.0 / 39_916_800.0,
    -1.0 / 6_227_020_800.0,
    1.0 / 1_307_674_368_000.0,
    -1.0 / 355_687_428_096_000.0,
];

/// `(1 - ½|θ| cot ½|θ|)/s` by powers of `s`: Bernoulli numbers over factorials.
const COTANGENT: [f64; 8] = [
    1.0 / 12.0,
    1.0 / 720.0,
    1.0 / 30_240.0,
    1.0 / 1_209_600.0,
    1.0 / 47_900_160.0,
    691.0 / 1_307_674_368_000.0,
    1.0 / 74_724_249_600.0,
    3_617.0 / 10_670_622_842_880_000.0,
];

/// `c` and its derivative with respect to `s`.
fn cotangent(s: f64) -> (f64, f64) {
    if s < NEAR {
        let mut slopes = [0.0; COTANGENT.len() - 1];
        for (power, (slope, term)) in slopes.iter_mut().zip(&COTANGENT[1..]).enumerate() {
            *slope = (power + 1) as f64 * term;
        }
        return (series(s, &COTANGENT), series(s, &slopes));
    }
    let u = 0.5 * libm::sqrt(s);
    let (sin, cos) = libm::sincos(u);
    let part = 1.0 - u * cos / sin;
    let slope = (u / (sin * sin) - cos / sin) / (8.0 * u);
    let c = part / s;
    (c, (slope - c) / s)
}

fn series(s: f64, terms: &[f64]) -> f64 {
    terms.iter().rev().fold(0.0, |sum, term| sum * s + term)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of all lengths below a turn, with lengths on both sides of the change to closed forms.
    fn vectors() -> impl Iterator<Item = DVec3> {
        let lengths = [0.0, 1e-200, 1e-9, 0.1, 0.4999, 0.5001, 1.0, 2.0, 3.0];
        let axes = [DVec3::new(0.6, -0.48, 0.64), DVec3::Z];
        lengths
            .into_iter()
            .flat_map(move |length| axes.map(|axis| length * axis))
    }

    #[test]
    fn a_rotation_has_the_vector_that_it_is_made_of() {
        for theta in vectors() {
            let back = vector(rotation(theta));
            assert!(
                (back - theta).length() <= 4e-16 * (1.0 + theta.length()),
                "{theta}"
            );
            let back = vector(-rotation(theta));
            assert!(
                (back - theta).length() <= 4e-16 * (1.0 + theta.length()),
                "{theta}"
            );
        }
    }

    #[test]
    fn rates_and_spins_are_each_others_inverse() {
        let turning = DVec3::new(0.3, 1.1, -0.7);
        for theta in vectors() {
            let back = spin(theta, rate(theta, turning));
            assert!((back - turning).length() < 3e-15, "{theta}: {back}");
        }
    }

    /// Compares with finite differences of a vector on a curve.
    #[test]
    fn spins_and_bends_are_those_of_a_curve() {
        let (first, second) = (DVec3::new(0.3, 1.1, -0.7), DVec3::new(-0.9, 0.2, 0.5));
        for theta in vectors() {
            let at = |t: f64| theta + t * (first + 0.5 * t * second);
            let h = 1e-4;
            let turned = rotation(at(-h)).inverse() * rotation(at(h));
            let measured = vector(turned) / (2.0 * h);
            let now = spin(theta, first);
            assert!(
                (measured - now).length() < 1e-7,
                "{theta}: {measured} {now}"
            );
            let spin_at = |t: f64| spin(at(t), first + t * second);
            let turning = (spin_at(h) - spin_at(-h)) / (2.0 * h);
            let told = rate(theta, turning) + bend(theta, first, now);
            assert!((told - second).length() < 1e-7, "{theta}: {told}");
        }
    }
}
