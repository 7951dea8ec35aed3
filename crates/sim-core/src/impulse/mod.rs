//! The collision response.
//!
//! Two bodies exchange an impulse `j` along the contact normal `n`, which points from the first
//! to the second:
//!
//! ```text
//! v1' = v1 - (j/m1) n        v2' = v2 + (j/m2) n        (v2' - v1')·n = -e (v2 - v1)·n
//! ```
//!
//! so `j = -(1 + e) (v2 - v1)·n / ((1/m1 + 1/m2) n·n)` (Baraff 1997, "An introduction to
//! physically based modeling: rigid body simulation II", eq. 8-18, without rotation).

pub(crate) mod arms;
mod complementarity;
mod friction;
mod together;

use glam::DVec3;

use crate::expansion::two_sum;
pub use friction::{ALL_SWEEPS, apply, drag, limit, rub};
pub use together::{Joined, Known, Prepared, greatest, project, project_with, reflect};

/// The impulse between two bodies, and its effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// Impulse on the second body along the normal, and on the first against it, N s per length of the normal.
    pub impulse: f64,
    /// Velocities of the first body and of the second afterwards, m/s.
    pub after: (DVec3, DVec3),
}

/// The impulse between two bodies of masses `m1`, `m2` (kg; one may be infinite) and velocities `v1`, `v2` (m/s).
/// After it they part along `normal` at `restitution` (0 to 1) times the closing speed. `None` if they do not
/// approach, or if both are immovable.
///
/// Along an axis, velocities are rounded once. Rounding errors of differences are kept: bodies that meet millions of
/// times would lose the same digits again and again.
pub fn between(
    (m1, v1): (f64, DVec3),
    (m2, v2): (f64, DVec3),
    normal: DVec3,
    restitution: f64,
) -> Option<Exchange> {
    let (relative, lost) = two_sums(v2, -v1);
    let parting = relative.dot(normal);
    if parting >= 0.0 || parting.is_nan() {
        return None;
    }
    // Divided by n·n, so that an elastic exchange conserves energy for any rounding of `normal`.
    let factor = -(1.0 + restitution) / normal.length_squared();
    let (both, lost) = (factor * parting, factor * lost.dot(normal));
    // The small share of the heavier body first, and the rest to the other: if masses differ by orders of magnitude and
    // the bodies meet again and again, no rounding of a share near one adds up.
    let (light, heavy) = (m1.min(m2), m1.max(m2));
    if light.is_infinite() {
        return None;
    }
    let share = light / (light + heavy);
    let of_heavy = (both * share, lost * share);
    let (of_light, rest) = two_sum(both, -of_heavy.0);
    let of_light = (of_light, rest + (lost - of_heavy.1));
    let (first, second) = match m1 <= m2 {
        true => (of_light, of_heavy),
        false => (of_heavy, of_light),
    };
    Some(Exchange {
        impulse: light * of_light.0,
        after: (changed(v1, first, -normal), changed(v2, second, normal)),
    })
}

/// `v + by normal`, where `by` is a sum of two numbers.
fn changed(v: DVec3, by: (f64, f64), normal: DVec3) -> DVec3 {
    let (sum, lost) = two_sums(v, by.0 * normal);
    sum + (lost + by.1 * normal)
}

/// A sum by components, and its rounding errors.
fn two_sums(u: DVec3, v: DVec3) -> (DVec3, DVec3) {
    let [x, y, z] = [0, 1, 2].map(|axis| two_sum(u[axis], v[axis]));
    (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn head_on_pairs_meet_the_two_body_formula() {
        for (m1, m2) in [(1.0, 1.0), (1.0, 3.0), (2.0, 1e3), (1.0, 1e12), (1e6, 1e-6)] {
            let (u1, u2) = (10.0, -4.0);
            let n = DVec3::X;
            let after = between((m1, u1 * n), (m2, u2 * n), n, 1.0).unwrap().after;
            let (w1, w2) = (after.0.x, after.1.x);
            let exact1 = ((m1 - m2) * u1 + 2.0 * m2 * u2) / (m1 + m2);
            let exact2 = ((m2 - m1) * u2 + 2.0 * m1 * u1) / (m1 + m2);
            assert!(
                (w1 - exact1).abs() <= 1e-12 * exact1.abs().max(1.0),
                "{m1} {m2}"
            );
            assert!(
                (w2 - exact2).abs() <= 1e-12 * exact2.abs().max(1.0),
                "{m1} {m2}"
            );
        }
    }

    #[test]
    fn a_normal_of_any_length_conserves_energy() {
        let (m1, v1) = (2.0, DVec3::new(1.0, 2.0, -0.5));
        let (m2, v2) = (0.7, DVec3::new(-3.0, 0.25, 1.0));
        for n in [DVec3::new(1.0, 0.3, 0.1), DVec3::new(2e3, -1e2, 7.0)] {
            let (w1, w2) = between((m1, v1), (m2, v2), n, 1.0).unwrap().after;
            let energy = |a: DVec3, b: DVec3| m1 * a.length_squared() + m2 * b.length_squared();
            assert!((energy(w1, w2) / energy(v1, v2) - 1.0).abs() < 1e-15);
            assert!((m1 * w1 + m2 * w2 - m1 * v1 - m2 * v2).length() < 1e-14);
        }
    }

    #[test]
    fn parting_and_resting_pairs_are_left_alone() {
        for (first, second, normal) in [
            (DVec3::ZERO, DVec3::X, DVec3::X),
            (DVec3::X, DVec3::X, DVec3::X),
            (DVec3::X, DVec3::X, DVec3::ZERO),
        ] {
            assert_eq!(between((1.0, first), (1.0, second), normal, 1.0), None);
        }
    }

    #[test]
    fn walls_turn_bodies_back_by_their_restitution() {
        let wall = (f64::INFINITY, DVec3::new(-3.0, 0.0, 0.0));
        for e in [0.0, 0.25, 1.0] {
            let given = between((2.0, DVec3::X), wall, DVec3::X, e).unwrap();
            assert_eq!(given.after, (DVec3::NEG_X * (3.0 + e * 4.0), wall.1));
            assert_eq!(given.impulse, 8.0 + e * 8.0);
        }
    }
}
