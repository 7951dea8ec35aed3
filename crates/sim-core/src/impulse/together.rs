//! The response to several simultaneous contacts.
//!
//! Velocities are allowed if no contact closes: `N v >= 0`, with a row for each contact that gives
//! the speed at which it opens. The *projection* is the allowed velocity nearest to the given one in the norm
//! of kinetic energy (Gauss' principle); its contacts neither give nor take energy.
//! The *reflection*, of elastic contacts, lies as far beyond the projection as the given velocity lies before it. It
//! keeps the energy and treats equal contacts equally; contacts that close after that are reflected again
//! (Smith, Kaufman, Vouga, Tamstorf, Grinspun 2012, "Reflections on simultaneous impact", sec. 5,
//! generalized reflections).
//!
//! The projection is `v + M⁻¹ Nᵀ λ` with `0 <= λ`, `0 <= N (v + M⁻¹ Nᵀ λ)`, and each `λ` times its
//! speed zero. The order of sums depends only on their terms, so that bodies in
//! another order, and mirror images, give the same bits, except for heaps of more than 8 contacts.

use alloc::{vec, vec::Vec};
use core::cell::OnceCell;
use glam::DVec3;

use super::complementarity::{self, FEW, Network, sum};

/// Two bodies in contact, and the unit normal from the first to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joined {
    /// The bodies, as indices in the list of velocities.
    pub bodies: (usize, usize),
    /// From the first to the second.
    pub normal: DVec3,
}

impl Joined {
    /// Opening speed of the contact, m/s.
    pub(crate) fn opening(&self, velocity: &[DVec3]) -> f64 {
        (velocity[self.bodies.1] - velocity[self.bodies.0]).dot(self.normal)
    }

    /// Velocity of the second body relative to the first, perpendicular to the normal, m/s.
    pub(crate) fn sliding(&self, velocity: &[DVec3]) -> DVec3 {
        let relative = velocity[self.bodies.1] - velocity[self.bodies.0];
        relative - relative.dot(self.normal) * self.normal
    }

    /// The entry of the Delassus operator for this contact and another one: the change of the opening speed here for
    /// an impulse there.
    pub(super) fn shared(&self, other: &Joined, inverse_mass: &[f64]) -> f64 {
        let signs = |contact: &Joined| [(contact.bodies.0, -1.0), (contact.bodies.1, 1.0)];
        let mut sum = 0.0;
        for (body, sign) in signs(self) {
            for (of_other, other_sign) in signs(other) {
                if body == of_other {
                    sum += sign * other_sign * inverse_mass[body];
                }
            }
        }
        sum * self.normal.dot(other.normal)
    }
}

/// The most rounds of reflection. A few are enough if the bodies can part at all. Wedged bodies cannot; they are left
/// without closing speed.
const ROUNDS: usize = 1000;

/// Velocities (m/s) after an impact of all contacts at once, with inverse masses (1/kg, 0 for an
/// immovable body), and the impulse of each contact (N s).
pub fn reflect(
    contacts: &[Joined],
    inverse_mass: &[f64],
    velocity: &mut [DVec3],
    restitution: f64,
) -> Vec<f64> {
    let mut impulse = vec![0.0; contacts.len()];
    let fastest = greatest(velocity);
    let rounding = 16.0 * f64::EPSILON * fastest;
    let closing_by = |least: f64, velocity: &[DVec3]| -> Vec<usize> {
        let all = 0..contacts.len();
        all.filter(|&k| contacts[k].opening(velocity) < -least)
            .collect()
    };
    for round in 0..ROUNDS {
        let mut closing = closing_by(rounding, velocity);
        if closing.is_empty() && round == 0 {
            // A grazing contact is an impact all the same; otherwise it would be found again.
            closing = closing_by(0.0, velocity);
        }
        if closing.is_empty() {
            break;
        }
        if round + 1 == ROUNDS {
            let missing = missing_speeds(contacts, velocity);
            let given = project(contacts, inverse_mass, velocity, &missing);
            for (impulse, given) in impulse.iter_mut().zip(given) {
                *impulse += given;
            }
            break;
        }
        let part: Vec<Joined> = closing.iter().map(|&k| contacts[k]).collect();
        let missing = missing_speeds(&part, velocity);
        let mut given = multipliers(&part, inverse_mass, &missing, Known::default());
        // In an exact projection `given_up` equals `opened`. The ratio compensates for rounding, so that energy is
        // conserved even if the equations are solved badly.
        let mut change = vec![DVec3::ZERO; velocity.len()];
        push(&part, inverse_mass, &mut change, &given);
        let pairs = || part.iter().zip(&given);
        let given_up = sum(pairs().map(|(contact, given)| -given * contact.opening(velocity)));
        let opened = sum(pairs().map(|(contact, given)| given * contact.opening(&change)));
        if opened <= 0.0 || opened.is_nan() {
            break;
        }
        let factor = (1.0 + restitution) * given_up / opened;
        for given in &mut given {
            *given *= factor;
        }
        push(&part, inverse_mass, velocity, &given);
        for (k, given) in closing.into_iter().zip(given) {
            impulse[k] += given;
        }
    }
    impulse
}

/// The greatest length of some vectors.
pub fn greatest(vectors: &[DVec3]) -> f64 {
    vectors.iter().fold(0.0, |most, v| v.length().max(most))
}

/// The nearest velocities, or accelerations, with which each contact opens by at least its residual `missing` more
/// (m/s, or m/s²), and the impulse (or force) of each contact.
pub fn project(
    contacts: &[Joined],
    inverse_mass: &[f64],
    velocity: &mut [DVec3],
    missing: &[f64],
) -> Vec<f64> {
    project_with(contacts, inverse_mass, velocity, missing, Known::default())
}

/// Data about a projection that is known before it is computed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known<'a> {
    /// Contacts that open by exactly the residual, and may pull for this; none if empty.
    pub held: &'a [bool],
    /// Initial guess of the impulses, N s; none if empty.
    pub warm: &'a [f64],
    /// The residual at which the iteration may stop, m/s; little more than rounding if 0.
    pub enough: f64,
    /// Prepared data of the same contacts and masses.
    pub prepared: Option<&'a Prepared>,
}

/// Data for solving heaps, for contacts that are solved more than once; computed the first time.
#[derive(Clone, Debug, Default)]
pub struct Prepared(OnceCell<Network>);

impl Prepared {
    pub(super) fn network(&self, contacts: &[Joined], inverse_mass: &[f64]) -> &Network {
        self.0.get_or_init(|| Network::of(contacts, inverse_mass))
    }
}

/// The same with data known beforehand.
pub fn project_with(
    contacts: &[Joined],
    inverse_mass: &[f64],
    velocity: &mut [DVec3],
    missing: &[f64],
    known: Known,
) -> Vec<f64> {
    let given = multipliers(contacts, inverse_mass, missing, known);
    push(contacts, inverse_mass, velocity, &given);
    given
}

/// The residuals of contacts that must not close.
fn missing_speeds(contacts: &[Joined], velocity: &[DVec3]) -> Vec<f64> {
    contacts.iter().map(|c| -c.opening(velocity)).collect()
}

/// Adds the impulses of contacts to the velocities.
fn push(contacts: &[Joined], inverse_mass: &[f64], velocity: &mut [DVec3], impulse: &[f64]) {
    if contacts.len() > FEW {
        for (contact, &impulse) in contacts.iter().zip(impulse) {
            let (i, j) = contact.bodies;
            velocity[i] -= impulse * inverse_mass[i] * contact.normal;
            velocity[j] += impulse * inverse_mass[j] * contact.normal;
        }
        return;
    }
    // The terms of each body side by side: first their start, then the index of the next one.
    let mut next = vec![0; velocity.len() + 1];
    for contact in contacts {
        next[contact.bodies.0 + 1] += 1;
        next[contact.bodies.1 + 1] += 1;
    }
    for body in 0..velocity.len() {
        next[body + 1] += next[body];
    }
    let mut terms = vec![DVec3::ZERO; 2 * contacts.len()];
    for (contact, &impulse) in contacts.iter().zip(impulse) {
        let (i, j) = contact.bodies;
        for (body, impulse) in [(i, -impulse), (j, impulse)] {
            terms[next[body]] = impulse * inverse_mass[body] * contact.normal;
            next[body] += 1;
        }
    }
    let mut begin = 0;
    for (velocity, &end) in velocity.iter_mut().zip(&next) {
        let of_body = &terms[begin..end];
        begin = end;
        if !of_body.is_empty() {
            let along = |axis: usize| sum(of_body.iter().map(|term| term[axis]));
            *velocity += DVec3::new(along(0), along(1), along(2));
        }
    }
}

/// The lambdas of a projection.
fn multipliers(
    contacts: &[Joined],
    inverse_mass: &[f64],
    wanted: &[f64],
    known: Known,
) -> Vec<f64> {
    let is_held = known.held.contains(&true);
    let own = |k: usize| contacts[k].shared(&contacts[k], inverse_mass);
    match contacts.len() {
        0 => Vec::new(),
        1 if is_held => vec![wanted[0] / own(0)],
        1 => vec![wanted[0].max(0.0) / own(0)],
        2 if !is_held => {
            let shared = contacts[0].shared(&contacts[1], inverse_mass);
            two(wanted, [own(0), own(1)], shared)
        }
        _ => complementarity::multipliers(contacts, inverse_mass, wanted, known),
    }
}

/// The lambdas of two contacts: both together if both push, otherwise that of the one that does.
fn two(wanted: &[f64], [a, b]: [f64; 2], shared: f64) -> Vec<f64> {
    let det = a * b - shared * shared;
    let first = (wanted[0] * b - wanted[1] * shared) / det;
    let second = (wanted[1] * a - wanted[0] * shared) / det;
    // Parallel contacts of the same bodies share the impulse.
    if det <= 4.0 * f64::EPSILON * a * b {
        let half = 0.5 * (wanted[0].max(wanted[1])).max(0.0);
        return vec![half / a, half / b];
    }
    if first >= 0.0 && second >= 0.0 {
        return vec![first, second];
    }
    let alone = [wanted[0].max(0.0) / a, wanted[1].max(0.0) / b];
    if first < 0.0 && shared * alone[1] >= wanted[0] {
        vec![0.0, alone[1]]
    } else {
        vec![alone[0], 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_random::Random;

    /// Random bodies, most of them near the first few, so that contacts share bodies.
    fn scene(seed: u64, bodies: usize, count: usize) -> (Vec<Joined>, Vec<f64>, Vec<DVec3>) {
        let mut random = Random(seed);
        let mut contacts = Vec::new();
        while contacts.len() < count {
            let (i, j) = (random.below(bodies), random.below(bodies));
            if i != j {
                let normal = random.in_cube().normalize();
                contacts.push(Joined {
                    bodies: (i, j),
                    normal,
                });
            }
        }
        let inverse: Vec<f64> = (0..bodies)
            .map(|i| {
                if i == 0 {
                    0.0
                } else {
                    libm::exp(random.signed())
                }
            })
            .collect();
        let velocity = (0..bodies)
            .map(|i| {
                if i == 0 {
                    DVec3::ZERO
                } else {
                    random.in_cube()
                }
            })
            .collect();
        (contacts, inverse, velocity)
    }

    fn energy(inverse: &[f64], velocity: &[DVec3]) -> f64 {
        let movable = inverse.iter().zip(velocity).filter(|&(&w, _)| w > 0.0);
        movable.map(|(w, v)| 0.5 * v.length_squared() / w).sum()
    }

    #[test]
    fn of_parallel_contacts_the_one_that_wants_most_counts() {
        for count in 1..6_usize {
            for most in 0..count {
                let contacts: Vec<Joined> = (0..count)
                    .map(|k| Joined {
                        bodies: (0, k % 3 + 1),
                        normal: DVec3::NEG_Y,
                    })
                    .collect();
                let missing: Vec<f64> = (0..count)
                    .map(|k| {
                        if k == most {
                            2.0
                        } else {
                            1.0 - 0.25 * k as f64
                        }
                    })
                    .collect();
                let mut velocity = vec![DVec3::ZERO; 4];
                let inverse_mass = [1.0, 0.0, 0.0, 0.0];
                project(&contacts, &inverse_mass, &mut velocity, &missing);
                let error = (velocity[0] - 2.0 * DVec3::Y).length();
                assert!(error < 1e-12, "{most} of {count}: {error:e}");
            }
        }
    }

    #[test]
    fn projections_close_nothing_and_only_push_what_stays_together() {
        for seed in 0..300 {
            let count = 1 + seed as usize % 9;
            let (contacts, inverse, start) = scene(seed, 5, count);
            let mut velocity = start.clone();
            let missing = missing_speeds(&contacts, &velocity);
            let given = project(&contacts, &inverse, &mut velocity, &missing);
            for (contact, &given) in contacts.iter().zip(&given) {
                let opening = contact.opening(&velocity);
                assert!(given >= 0.0 && opening > -1e-12, "{seed}: {opening:e}");
                assert!(
                    given * opening < 1e-11 * (1.0 + given),
                    "{seed}: {given:e} {opening:e}"
                );
            }
            assert!(energy(&inverse, &velocity) <= energy(&inverse, &start) * (1.0 + 1e-14));
        }
    }

    #[test]
    fn heaps_are_projected_as_well() {
        for seed in 0..80 {
            let (contacts, mut inverse, start) = scene(seed, 25, 10 + seed as usize);
            // In every other scene, masses differ by a factor of up to a million.
            let is_uneven = seed % 2 == 1;
            if is_uneven {
                inverse.iter_mut().for_each(|w| *w = libm::pow(*w, 7.0));
            }
            let rounding = if is_uneven { 1e-10 } else { 1e-13 };
            let mut velocity = start.clone();
            let missing = missing_speeds(&contacts, &velocity);
            let given = project(&contacts, &inverse, &mut velocity, &missing);
            let most = given.iter().fold(1.0_f64, |most, &given| most.max(given));
            for (contact, &given) in contacts.iter().zip(&given) {
                let opening = contact.opening(&velocity);
                assert!(given >= 0.0 && opening > -rounding, "{seed}: {opening:e}");
                assert!(
                    given * opening < 10.0 * rounding * most,
                    "{seed}: {given:e} {opening:e}"
                );
            }
            assert!(energy(&inverse, &velocity) <= energy(&inverse, &start) * (1.0 + 1e-14));
        }
    }

    /// A body that grazes two bodies in one place closes by less than the rounding of its speed, and moves away from
    /// them all the same.
    #[test]
    fn grazes_part() {
        let contacts = [1, 2].map(|other| Joined {
            bodies: (0, other),
            normal: DVec3::NEG_X,
        });
        let start = vec![DVec3::new(-8e-12, 1.8e4, 0.0), DVec3::ZERO, DVec3::ZERO];
        assert!(contacts.iter().all(|c| c.opening(&start) < 0.0));
        let mut velocity = start;
        let given = reflect(&contacts, &[1.0; 3], &mut velocity, 1.0);
        assert!(given.iter().all(|&given| given > 0.0), "{given:?}");
        assert!(contacts.iter().all(|c| c.opening(&velocity) > 0.0));
    }

    #[test]
    fn reflections_keep_energy_and_momentum_and_end() {
        for seed in 0..300 {
            let count = 1 + seed as usize % 9;
            let (mut contacts, mut inverse, start) = scene(seed, 6, count);
            inverse[0] = 0.5;
            // Some motion opens all contacts: no body is wedged.
            let (.., parting) = scene(seed + 1000, 6, 1);
            for contact in &mut contacts {
                contact.normal *= contact.opening(&parting).signum();
            }
            let mut velocity = start.clone();
            let given = reflect(&contacts, &inverse, &mut velocity, 1.0);
            let change = energy(&inverse, &velocity) / energy(&inverse, &start) - 1.0;
            assert!(change.abs() < 1e-13, "{seed}: {change:e}");
            let momentum =
                |v: &[DVec3]| v.iter().zip(&inverse).map(|(v, w)| *v / *w).sum::<DVec3>();
            assert!((momentum(&velocity) - momentum(&start)).length() < 1e-12);
            for (contact, given) in contacts.iter().zip(given) {
                let opening = contact.opening(&velocity);
                assert!(
                    given >= 0.0 && opening > -1e-14,
                    "{seed} {given:e} {opening:e}"
                );
            }
        }
    }

    #[test]
    fn the_order_of_contacts_and_a_mirror_change_no_bit() {
        for seed in 0..100 {
            let (contacts, inverse, start) = scene(seed, 5, 2 + seed as usize % 7);
            let mut velocity = start.clone();
            reflect(&contacts, &inverse, &mut velocity, 1.0);
            let mut reversed = contacts.clone();
            reversed.reverse();
            for contact in &mut reversed {
                contact.bodies = (contact.bodies.1, contact.bodies.0);
                contact.normal = -contact.normal;
            }
            let mut other = start.clone();
            reflect(&reversed, &inverse, &mut other, 1.0);
            assert_eq!(velocity, other, "{seed}: order");
            let mirror = DVec3::new(-1.0, 1.0, 1.0);
            for contact in &mut reversed {
                contact.normal *= mirror;
            }
            let mut image: Vec<DVec3> = start.iter().map(|v| *v * mirror).collect();
            reflect(&reversed, &inverse, &mut image, 1.0);
            let back: Vec<DVec3> = image.iter().map(|v| *v * mirror).collect();
            assert_eq!(velocity, back, "{seed}: mirror");
        }
    }

    #[test]
    fn a_ball_that_hits_two_sends_them_off_alike() {
        let along = |y: f64| DVec3::new(libm::sqrt(0.75), y, 0.0);
        let contacts = [0.5, -0.5].map(along).into_iter().zip(1..);
        let contacts: Vec<Joined> = contacts
            .map(|(normal, ball)| Joined {
                bodies: (0, ball),
                normal,
            })
            .collect();
        let mut velocity = vec![DVec3::X, DVec3::ZERO, DVec3::ZERO];
        reflect(&contacts, &[1.0; 3], &mut velocity, 1.0);
        assert_eq!(velocity[1] * DVec3::new(1.0, -1.0, 1.0), velocity[2]);
        assert!((velocity[0].x + 0.2).abs() < 1e-15 && velocity[0].y == 0.0);
        assert!((velocity[1].x - 0.6).abs() < 1e-15);
    }
}
