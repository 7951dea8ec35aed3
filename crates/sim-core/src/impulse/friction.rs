//! Friction: impulses of contacts perpendicular to their normals.

use alloc::{vec, vec::Vec};
use glam::DVec3;

use super::Joined;

/// The number of sweeps that is enough for any contacts. One or two are enough for a body on others; a row of bodies
/// needs about the square of its length.
pub const ALL_SWEEPS: usize = 2000;

/// Brings the sliding velocities of contacts as near to zero as friction can. Among the impulses that are no longer
/// than each contact's `limit` (N s), it finds those that leave the least energy (Moreau 1988, "Unilateral contact
/// and dry friction in finite freedom dynamics": the principle of most dissipation), and writes them to `given` (N
/// s). Velocities (m/s) include the impulses given so far. They end within `enough` of the answer, in which case the
/// result says so, or after the given number of sweeps. Each contact slides by `more` (m/s) in addition to the
/// velocities. The same holds for accelerations and forces.
///
/// The impulses of contacts are optimised one by one, each within its disc (Gauss, Seidel), accelerated by conjugate
/// directions (Silcowitz, Niebe, Erleben 2010, "A nonsmooth nonlinear conjugate gradient method for interactive contact
/// force problems").
pub fn drag(
    contacts: &[Joined],
    inverse_mass: &[f64],
    velocity: &mut [DVec3],
    limit: &[f64],
    more: &[DVec3],
    given: &mut [DVec3],
    (enough, sweeps): (f64, usize),
) -> bool {
    let rubs = |k: &usize| limit[*k] > 0.0 || given[*k] != DVec3::ZERO;
    let rubbing: Vec<usize> = (0..contacts.len()).filter(rubs).collect();
    let yielding = |&k: &usize| contacts[k].shared(&contacts[k], inverse_mass);
    let yielding: Vec<f64> = rubbing.iter().map(yielding).collect();
    let mut direction = vec![DVec3::ZERO; rubbing.len()];
    let mut before: Vec<DVec3> = rubbing.iter().map(|&k| given[k]).collect();
    let mut last = f64::INFINITY;
    for _ in 0..sweeps {
        let (mut worst, mut size) = (0.0_f64, 0.0);
        for ((&k, &yielding), before) in rubbing.iter().zip(&yielding).zip(&before) {
            let contact = &contacts[k];
            let best = given[k] - (contact.sliding(velocity) + more[k]) / yielding;
            let next = within(best, limit[k]);
            worst = worst.max(yielding * (next - given[k]).length());
            apply(contact, inverse_mass, velocity, next - given[k]);
            given[k] = next;
            size += (next - *before).length_squared();
        }
        if worst <= enough {
            return true;
        }
        let turn = if size < last { size / last } else { 0.0 };
        last = size;
        for ((&k, before), direction) in rubbing.iter().zip(&mut before).zip(&mut direction) {
            let along = turn * *direction;
            let next = within(given[k] + along, limit[k]);
            apply(&contacts[k], inverse_mass, velocity, next - given[k]);
            *direction = along + (given[k] - *before);
            (given[k], *before) = (next, next);
        }
    }
    false
}

/// The greatest friction of a contact: the coefficient, which may be infinite, times the normal force or impulse if
/// this is positive.
pub fn limit(coefficient: f64, pressed: f64) -> f64 {
    match coefficient > 0.0 && pressed > 0.0 {
        true => coefficient * pressed,
        false => 0.0,
    }
}

/// The velocities (m/s) of two bodies after friction in an impact with an impulse along a unit normal (N s); one body
/// may have infinite mass (kg). The friction impulse is at most the coefficient times that impulse, and ends the
/// sliding if it can.
pub fn rub(
    (m1, m2): (f64, f64),
    velocity: (DVec3, DVec3),
    normal: DVec3,
    friction: f64,
    impulse: f64,
) -> (DVec3, DVec3) {
    let mut both = [velocity.0, velocity.1];
    let contact = Joined {
        bodies: (0, 1),
        normal,
    };
    let inverse_mass = [1.0 / m1, 1.0 / m2];
    let best = -contact.sliding(&both) / (inverse_mass[0] + inverse_mass[1]);
    let dragged = within(best, limit(friction, impulse));
    apply(&contact, &inverse_mass, &mut both, dragged);
    (both[0], both[1])
}

/// The vector of at most the length `limit` that is nearest to a given one.
fn within(vector: DVec3, limit: f64) -> DVec3 {
    let length = vector.length();
    match length > limit {
        true => limit / length * vector,
        false => vector,
    }
}

/// Applies an impulse to the second body of a contact, and its opposite to the first.
pub fn apply(contact: &Joined, inverse_mass: &[f64], velocity: &mut [DVec3], impulse: DVec3) {
    let (i, j) = contact.bodies;
    velocity[i] -= inverse_mass[i] * impulse;
    velocity[j] += inverse_mass[j] * impulse;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tower(bodies: usize) -> (Vec<Joined>, Vec<f64>) {
        let joined = |k: usize| Joined {
            bodies: (k, k + 1),
            normal: DVec3::Y,
        };
        let contacts = (0..bodies).map(joined).collect();
        let inverse = (0..=bodies).map(|k| if k == 0 { 0.0 } else { 1.0 });
        (contacts, inverse.collect())
    }

    #[test]
    fn what_friction_can_hold_stands() {
        let (contacts, inverse) = tower(12);
        let mut velocity = vec![DVec3::X; 13];
        velocity[0] = DVec3::ZERO;
        let mut given = vec![DVec3::ZERO; 12];
        drag(
            &contacts,
            &inverse,
            &mut velocity,
            &[f64::INFINITY; 12],
            &[DVec3::ZERO; 12],
            &mut given,
            (1e-14, ALL_SWEEPS),
        );
        for (k, v) in velocity.iter().enumerate() {
            assert!(v.length() < 1e-12, "{k}: {v}");
        }
        // The lowest contact stops the whole stack.
        assert!((given[0].x + 12.0).abs() < 1e-11, "{}", given[0]);
    }

    #[test]
    fn what_friction_cannot_hold_is_slowed_against_its_motion() {
        let (contacts, inverse) = tower(1);
        for angle in 0..12 {
            let (sin, cos) = libm::sincos(f64::from(angle) * 0.5);
            let along = DVec3::new(cos, 0.0, sin);
            let mut velocity = vec![DVec3::ZERO, 3.0 * along + DVec3::Y];
            let mut given = vec![DVec3::ZERO];
            drag(
                &contacts,
                &inverse,
                &mut velocity,
                &[0.5],
                &[DVec3::ZERO],
                &mut given,
                (0.0, ALL_SWEEPS),
            );
            let wanted = 2.5 * along + DVec3::Y;
            assert!((velocity[1] - wanted).length() < 1e-15);
            assert!((given[0] + 0.5 * along).length() < 1e-15);
        }
    }

    #[test]
    fn energy_falls_and_no_impulse_is_beyond_its_limit() {
        let (contacts, inverse) = tower(6);
        let mut velocity: Vec<DVec3> = (0..7)
            .map(|k| {
                DVec3::new(
                    libm::sin(f64::from(k) * 7.0),
                    0.0,
                    libm::cos(f64::from(k) * 3.0),
                )
            })
            .collect();
        velocity[0] = DVec3::ZERO;
        let energy = |v: &[DVec3]| v[1..].iter().map(|v| v.length_squared()).sum::<f64>();
        let before = energy(&velocity);
        let limit = [0.3, 0.0, 0.1, 0.7, f64::INFINITY, 0.2];
        let mut given = vec![DVec3::ZERO; 6];
        drag(
            &contacts,
            &inverse,
            &mut velocity,
            &limit,
            &[DVec3::ZERO; 6],
            &mut given,
            (1e-15, ALL_SWEEPS),
        );
        assert!(energy(&velocity) < before);
        for ((contact, given), limit) in contacts.iter().zip(&given).zip(limit) {
            assert!(given.length() <= limit * (1.0 + 1e-15));
            let sliding = contact.sliding(&velocity);
            // A contact that still slides has the full friction against its motion.
            if sliding.length() > 1e-12 {
                assert!((given.length() - limit).abs() < 1e-14);
                assert!(given.dot(sliding) <= -0.999_999 * limit * sliding.length());
            }
        }
    }
}
