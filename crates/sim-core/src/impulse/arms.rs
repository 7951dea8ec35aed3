//! Several contacts at the same instant between bodies that turn.
//!
//! As in [`super::together`], with velocities of six components: a contact at the arms `r1`, `r2` from the
//! centres of mass opens at `n·(v2 + ω2×r2 - v1 - ω1×r1)`. Contacts are few, so that the matrix
//! `N M⁻¹ Nᵀ` is a dense one.

use alloc::{vec, vec::Vec};
use glam::{DMat3, DVec3};

/// Two bodies in contact at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arms {
    /// The bodies, as places in the list of motions.
    pub(crate) bodies: (usize, usize),
    /// A unit vector from the first to the second.
    pub(crate) normal: DVec3,
    /// From each centre of mass to the point, m.
    pub(crate) arms: (DVec3, DVec3),
}

/// What moves a body: inverse mass, 1/kg, and inverse inertia in the world, 1/(kg m²); zero where nothing does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Yielding {
    /// Inverse mass, 1/kg.
    pub(crate) mass: f64,
    /// Inverse inertia in the world, 1/(kg m²).
    pub(crate) inertia: DMat3,
}

/// How a body moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Twist {
    /// Velocity of the centre of mass, m/s.
    pub(crate) velocity: DVec3,
    /// Angular velocity, rad/s.
    pub(crate) spin: DVec3,
}

impl Twist {
    fn at(&self, arm: DVec3) -> DVec3 {
        self.velocity + self.spin.cross(arm)
    }
}

impl Arms {
    /// Speed at which the contact opens, m/s.
    pub(crate) fn opening(&self, twists: &[Twist]) -> f64 {
        let (i, j) = self.bodies;
        let relative = twists[j].at(self.arms.1) - twists[i].at(self.arms.0);
        relative.dot(self.normal)
    }

    /// What each body's motion changes by for an impulse of 1 N s.
    fn response(&self, yielding: &[Yielding]) -> [(usize, Twist); 2] {
        let (i, j) = self.bodies;
        let of = |body: usize, arm: DVec3, normal: DVec3| {
            let Yielding { mass, inertia } = yielding[body];
            let twist = Twist {
                velocity: mass * normal,
                spin: inertia * arm.cross(normal),
            };
            (body, twist)
        };
        [
            of(i, self.arms.0, -self.normal),
            of(j, self.arms.1, self.normal),
        ]
    }

    /// The speed at which it opens by the change of one body's motion.
    fn opened_by(&self, body: usize, change: &Twist) -> f64 {
        let mut sum = 0.0;
        if body == self.bodies.0 {
            sum -= change.at(self.arms.0).dot(self.normal);
        }
        if body == self.bodies.1 {
            sum += change.at(self.arms.1).dot(self.normal);
        }
        sum
    }
}

/// Adds impulses (N s) to motions.
pub(crate) fn push(
    contacts: &[Arms],
    yielding: &[Yielding],
    twists: &mut [Twist],
    impulse: &[f64],
) {
    for (contact, &given) in contacts.iter().zip(impulse) {
        if given != 0.0 {
            for (body, by) in contact.response(yielding) {
                twists[body].velocity += given * by.velocity;
                twists[body].spin += given * by.spin;
            }
        }
    }
}

/// The matrix that takes impulses to the speeds at which contacts open, row by row.
fn matrix(contacts: &[Arms], yielding: &[Yielding]) -> Vec<f64> {
    let count = contacts.len();
    let mut matrix = vec![0.0; count * count];
    for (l, other) in contacts.iter().enumerate() {
        let response = other.response(yielding);
        for (k, contact) in contacts.iter().enumerate() {
            matrix[k * count + l] = response
                .iter()
                .map(|(body, by)| contact.opened_by(*body, by))
                .sum();
        }
    }
    matrix
}

/// Part of a row's own number below which what is left of it depends on the others.
const DEPENDENT: f64 = 1e-10;

/// The impulses, none negative, after which each contact opens by at least as much more as is wanted (m/s),
/// and those that push by just that: of all motions that do, the nearest in the norm of kinetic energy. By
/// active sets (Lawson, Hanson 1974, "Solving least squares problems", ch. 23).
pub(crate) fn multipliers(contacts: &[Arms], yielding: &[Yielding], wanted: &[f64]) -> Vec<f64> {
    let count = contacts.len();
    let matrix = matrix(contacts, yielding);
    let scale: Vec<f64> = (0..count)
        .map(|k| 1.0 / libm::sqrt(matrix[k * count + k]))
        .collect();
    let mut given = vec![0.0; count];
    let mut pushes: Vec<usize> = Vec::new();
    // Those that have just been let go of, or depend on others that push.
    let mut barred = vec![false; count];
    let most = wanted
        .iter()
        .zip(&scale)
        .fold(0.0_f64, |most, (w, s)| most.max((w * s).abs()));
    let rounding = 64.0 * f64::EPSILON * most;
    for _ in 0..8 * count + 8 {
        let missing = |k: usize, given: &[f64]| {
            let row = &matrix[k * count..(k + 1) * count];
            wanted[k] - row.iter().zip(given).map(|(x, g)| x * g).sum::<f64>()
        };
        let next = (0..count)
            .filter(|&k| !barred[k] && scale[k].is_finite() && !pushes.contains(&k))
            .map(|k| (k, missing(k, &given) * scale[k]))
            .filter(|&(_, missing)| missing > rounding)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((next, _)) = next else { break };
        pushes.push(next);
        let mut is_changed = false;
        loop {
            let Some(solved) = solve(&matrix, count, &pushes, wanted, &scale) else {
                // The last one depends on the others.
                if let Some(last) = pushes.pop() {
                    barred[last] = true;
                }
                break;
            };
            let least = pushes
                .iter()
                .zip(&solved)
                .filter(|&(_, &solved)| solved <= 0.0)
                .map(|(&k, &solved)| given[k] / (given[k] - solved))
                .fold(1.0_f64, f64::min);
            if solved.iter().all(|&solved| solved > 0.0) {
                given.fill(0.0);
                for (&k, solved) in pushes.iter().zip(solved) {
                    given[k] = solved;
                }
                is_changed = true;
                break;
            }
            for (&k, solved) in pushes.iter().zip(&solved) {
                given[k] += least.max(0.0) * (solved - given[k]);
            }
            let before = pushes.len();
            let gone: Vec<usize> = pushes
                .iter()
                .zip(&solved)
                .filter(|&(&k, &solved)| solved <= 0.0 && given[k] <= f64::EPSILON * solved.abs())
                .map(|(&k, _)| k)
                .collect();
            for k in gone {
                given[k] = 0.0;
                barred[k] = k == next;
                pushes.retain(|&other| other != k);
            }
            if pushes.len() == before {
                break;
            }
        }
        if is_changed {
            barred.fill(false);
        }
    }
    given
}

/// The impulses of those that push, by Cholesky's decomposition; `None` where they depend on each other.
fn solve(
    matrix: &[f64],
    count: usize,
    pushes: &[usize],
    wanted: &[f64],
    scale: &[f64],
) -> Option<Vec<f64>> {
    let n = pushes.len();
    let entry = |k: usize, l: usize| {
        let (k, l) = (pushes[k], pushes[l]);
        matrix[k * count + l] * scale[k] * scale[l]
    };
    let mut lower = vec![0.0; n * n];
    for k in 0..n {
        for l in 0..=k {
            let known: f64 = (0..l).map(|m| lower[k * n + m] * lower[l * n + m]).sum();
            let left = entry(k, l) - known;
            if k == l {
                if left <= DEPENDENT {
                    return None;
                }
                lower[k * n + k] = libm::sqrt(left);
            } else {
                lower[k * n + l] = left / lower[l * n + l];
            }
        }
    }
    let solve_with = |right: &[f64]| {
        let mut x = right.to_vec();
        for k in 0..n {
            let known: f64 = (0..k).map(|m| lower[k * n + m] * x[m]).sum();
            x[k] = (x[k] - known) / lower[k * n + k];
        }
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|m| lower[m * n + k] * x[m]).sum();
            x[k] = (x[k] - known) / lower[k * n + k];
        }
        x
    };
    let right: Vec<f64> = pushes.iter().map(|&k| wanted[k] * scale[k]).collect();
    let mut x = solve_with(&right);
    // Once more with what is left.
    let left: Vec<f64> = (0..n)
        .map(|k| right[k] - (0..n).map(|l| entry(k, l) * x[l]).sum::<f64>())
        .collect();
    for (x, more) in x.iter_mut().zip(solve_with(&left)) {
        *x += more;
    }
    Some(x.iter().zip(pushes).map(|(x, &k)| x * scale[k]).collect())
}

/// Most rounds of reflection, as in [`super::reflect`].
const ROUNDS: usize = 1000;

/// Lets contacts bounce all at once with a restitution, and returns the impulse of each, N s. Motions go as
/// far beyond those that close nothing as they are away from them, which keeps the energy where it is 1
/// ([`super::reflect`]).
pub(crate) fn reflect(
    contacts: &[Arms],
    yielding: &[Yielding],
    twists: &mut [Twist],
    restitution: f64,
) -> Vec<f64> {
    let mut impulse = vec![0.0; contacts.len()];
    let speed = |contact: &Arms| {
        let (i, j) = contact.bodies;
        let of = |body: usize, arm: DVec3| {
            twists[body].velocity.length() + twists[body].spin.length() * arm.length()
        };
        of(i, contact.arms.0) + of(j, contact.arms.1)
    };
    let rounding: Vec<f64> = contacts
        .iter()
        .map(|contact| 16.0 * f64::EPSILON * speed(contact))
        .collect();
    for round in 0..ROUNDS {
        let closing: Vec<usize> = (0..contacts.len())
            .filter(|&k| contacts[k].opening(twists) < -rounding[k])
            .collect();
        if closing.is_empty() {
            break;
        }
        let part: Vec<Arms> = closing.iter().map(|&k| contacts[k]).collect();
        let wanted: Vec<f64> = part.iter().map(|c| -c.opening(twists)).collect();
        let mut given = multipliers(&part, yielding, &wanted);
        // As in `reflect` without arms: of an exact projection the contacts give up all that they give.
        let mut change = vec![Twist::default(); twists.len()];
        push(&part, yielding, &mut change, &given);
        let pairs = || part.iter().zip(&given);
        let given_up: f64 = pairs()
            .map(|(contact, given)| -given * contact.opening(twists))
            .sum();
        let opened: f64 = pairs()
            .map(|(contact, given)| given * contact.opening(&change))
            .sum();
        if opened <= 0.0 || opened.is_nan() {
            break;
        }
        let factor = match round + 1 == ROUNDS {
            true => 1.0,
            false => (1.0 + restitution) * given_up / opened,
        };
        for given in &mut given {
            *given *= factor;
        }
        push(&part, yielding, twists, &given);
        for (k, given) in closing.into_iter().zip(given) {
            impulse[k] += given;
        }
    }
    impulse
}
