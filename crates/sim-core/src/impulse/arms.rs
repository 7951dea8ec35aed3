//! The response to several simultaneous contacts between turning bodies.
//!
//! As in [`super::together`], with velocities of six components: a contact at the arms `r1`, `r2` from the
//! centres of mass opens at `n·(v2 + ω2×r2 - v1 - ω1×r1)`. Contacts are few, so the Delassus operator
//! `N M⁻¹ Nᵀ` is a dense matrix.

use alloc::{vec, vec::Vec};
use glam::{DMat3, DVec3};

use crate::pieces::ties;

/// Two bodies in contact at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arms {
    /// The bodies, as indices in the list of motions.
    pub(crate) bodies: (usize, usize),
    /// A unit vector from the first to the second.
    pub(crate) normal: DVec3,
    /// From each centre of mass to the point, m.
    pub(crate) arms: (DVec3, DVec3),
}

/// The response of a body to impulses: inverse mass and inverse inertia; zero if it is immovable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Yielding {
    /// Inverse mass, 1/kg.
    pub(crate) mass: f64,
    /// Inverse inertia in the world, 1/(kg m²).
    pub(crate) inertia: DMat3,
}

/// The velocity and angular velocity of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Twist {
    /// Velocity of the centre of mass, m/s.
    pub(crate) velocity: DVec3,
    /// Angular velocity, rad/s.
    pub(crate) spin: DVec3,
}

impl Yielding {
    /// For an immovable body.
    pub(crate) const NOTHING: Yielding = Yielding {
        mass: 0.0,
        inertia: DMat3::ZERO,
    };
}

impl Twist {
    fn at(&self, arm: DVec3) -> DVec3 {
        self.velocity + self.spin.cross(arm)
    }
}

impl Arms {
    /// Opening speed of the contact, m/s.
    pub(crate) fn opening(&self, twists: &[Twist]) -> f64 {
        let (i, j) = self.bodies;
        let relative = twists[j].at(self.arms.1) - twists[i].at(self.arms.0);
        relative.dot(self.normal)
    }

    /// The change of each body's motion by an impulse of 1 N s.
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

    /// The change of the opening speed by the change of one body's motion.
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

/// Adds the effects of impulses (N s) to motions.
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

/// The Delassus operator, row by row.
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

/// A contact depends on others if the rest of its diagonal entry, after these are eliminated, is below this part of the
/// entry. It is the square root of rounding, because the rounding of the others is divided by the rest.
const DEPENDENT: f64 = 1.0 / (1_u64 << 24) as f64;

/// The impulses, none negative, after which each contact opens by at least `wanted` (m/s) more; those that push open
/// by exactly that. Of all motions for which this holds it is the nearest in the norm of kinetic energy. Components
/// that no movable body connects are solved separately.
pub(crate) fn multipliers(contacts: &[Arms], yielding: &[Yielding], wanted: &[f64]) -> Vec<f64> {
    let moves = |body: usize| yielding[body].mass > 0.0 || yielding[body].inertia != DMat3::ZERO;
    let pairs = contacts.iter().map(|contact| contact.bodies);
    let ties = ties(pairs, yielding.len(), moves);
    let mut ties: Vec<(usize, usize)> = ties.into_iter().zip(0..).collect();
    ties.sort_unstable();
    let mut given = vec![0.0; contacts.len()];
    for tied in ties.chunk_by(|a, b| a.0 == b.0) {
        let part: Vec<Arms> = tied.iter().map(|&(_, k)| contacts[k]).collect();
        let wanted: Vec<f64> = tied.iter().map(|&(_, k)| wanted[k]).collect();
        let found = tied_multipliers(&part, yielding, &wanted);
        for (&(_, k), found) in tied.iter().zip(found) {
            given[k] = found;
        }
    }
    given
}

/// The same for connected contacts, by active sets: each contact whose residual is positive pushes as far as the
/// contacts allow that push already; those that would pull cease to push (Goldfarb, Idnani 1983, "A numerically
/// stable dual method for solving strictly convex quadratic programs", section 3). A contact that depends on others
/// that push takes the place of one of them.
fn tied_multipliers(contacts: &[Arms], yielding: &[Yielding], wanted: &[f64]) -> Vec<f64> {
    let count = contacts.len();
    let matrix = matrix(contacts, yielding);
    let scale: Vec<f64> = (0..count)
        .map(|k| 1.0 / libm::sqrt(matrix[k * count + k]))
        .collect();
    let entry = |k: usize, l: usize| matrix[k * count + l] * scale[k] * scale[l];
    // Scaled so that each diagonal entry is 1.
    let wanted: Vec<f64> = wanted.iter().zip(&scale).map(|(w, s)| w * s).collect();
    let mut given = vec![0.0; count];
    let mut pushes: Vec<usize> = Vec::new();
    let mut factor = Factor::default();
    // Contacts for which the others leave no room.
    let mut barred = vec![false; count];
    let most = wanted.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
    let rounding = 64.0 * f64::EPSILON * most;
    for _ in 0..8 * count + 8 {
        let missing = |k: usize| {
            let opened = pushes.iter().map(|&l| entry(k, l) * given[l]);
            wanted[k] - opened.sum::<f64>()
        };
        let next = (0..count)
            .filter(|&k| !barred[k] && scale[k].is_finite() && !pushes.contains(&k))
            .map(|k| (k, missing(k)))
            .filter(|&(_, missing)| missing > rounding)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((next, mut missing)) = next else {
            break;
        };
        let before = (given.clone(), pushes.clone());
        loop {
            let (own, by_others) = factor.reach(&pushes, next, entry);
            let to_find = if own > DEPENDENT {
                missing / own
            } else {
                f64::INFINITY
            };
            let first = (0..pushes.len())
                .filter(|&place| by_others[place] > 0.0)
                .map(|place| (given[pushes[place]] / by_others[place], place))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let step = first.map_or(to_find, |(step, _)| step.min(to_find));
            if step.is_infinite() {
                (given, pushes) = before;
                factor.rows.clear();
                factor.grow(&pushes, entry);
                barred[next] = true;
                break;
            }
            for (&k, by) in pushes.iter().zip(&by_others) {
                given[k] = (given[k] - step * by).max(0.0);
            }
            given[next] += step;
            if step == to_find {
                pushes.push(next);
                factor.grow(&pushes, entry);
                barred.fill(false);
                break;
            }
            missing -= step * own;
            if let Some((_, place)) = first {
                given[pushes.remove(place)] = 0.0;
                factor.rows.truncate(place);
                factor.grow(&pushes, entry);
            }
        }
        let right = pushes.iter().map(|&k| wanted[k]).collect();
        let solved = factor.solve(&pushes, entry, right);
        if solved.iter().all(|&solved| solved > 0.0) {
            for (&k, solved) in pushes.iter().zip(solved) {
                given[k] = solved;
            }
        }
    }
    for (given, scale) in given.iter_mut().zip(&scale) {
        if *given != 0.0 {
            *given *= scale;
        }
    }
    given
}

/// Cholesky's decomposition of the rows and columns of the contacts that push, in their order.
#[derive(Default)]
struct Factor {
    /// Rows of the lower triangle.
    rows: Vec<Vec<f64>>,
}

impl Factor {
    /// Adds the missing rows.
    fn grow(&mut self, pushes: &[usize], entry: impl Fn(usize, usize) -> f64) {
        for k in self.rows.len()..pushes.len() {
            let mut row = self.forward(pushes[..k].iter().map(|&l| entry(pushes[k], l)));
            let known: f64 = row.iter().map(|x| x * x).sum();
            row.push(libm::sqrt(
                (entry(pushes[k], pushes[k]) - known).max(DEPENDENT),
            ));
            self.rows.push(row);
        }
    }

    /// The rest of a contact's diagonal entry while the contacts that push open no further, and the decrease of
    /// their impulses for its impulse.
    fn reach(
        &self,
        pushes: &[usize],
        next: usize,
        entry: impl Fn(usize, usize) -> f64,
    ) -> (f64, Vec<f64>) {
        let row = self.forward(pushes.iter().map(|&l| entry(next, l)));
        let known: f64 = row.iter().map(|x| x * x).sum();
        (entry(next, next) - known, self.backward(row))
    }

    /// The solution for a right-hand side, refined once by its residual.
    fn solve(
        &self,
        pushes: &[usize],
        entry: impl Fn(usize, usize) -> f64,
        right: Vec<f64>,
    ) -> Vec<f64> {
        let n = pushes.len();
        let mut x = self.back(right.clone());
        let product = |k: usize, x: &[f64]| {
            let others = pushes.iter().zip(x);
            others.map(|(&l, x)| entry(pushes[k], l) * x).sum::<f64>()
        };
        let left = (0..n).map(|k| right[k] - product(k, &x)).collect();
        for (x, more) in x.iter_mut().zip(self.back(left)) {
            *x += more;
        }
        x
    }

    fn back(&self, right: Vec<f64>) -> Vec<f64> {
        self.backward(self.forward(right.into_iter()))
    }

    fn forward(&self, right: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut x: Vec<f64> = Vec::with_capacity(self.rows.len());
        for (row, right) in self.rows.iter().zip(right) {
            let known: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
            x.push((right - known) / row[x.len()]);
        }
        x
    }

    fn backward(&self, mut x: Vec<f64>) -> Vec<f64> {
        let n = x.len();
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|m| self.rows[m][k] * x[m]).sum();
            x[k] = (x[k] - known) / self.rows[k][k];
        }
        x
    }
}

/// The most rounds of reflection, as in [`super::reflect`].
const ROUNDS: usize = 1000;

/// Resolves all contacts at once with a restitution, and returns the impulse of each, N s. The motions go as far
/// beyond the nearest motions without closing contacts as they were before them, times the restitution; for a
/// restitution of 1 this conserves the energy ([`super::reflect`]).
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
        // As in `reflect` without arms: in an exact projection `given_up` equals `opened`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_random::Random;

    /// Columns of bodies that stand on one floor, with a contact at each corner.
    fn columns(count: usize) -> (Vec<Arms>, Vec<Yielding>) {
        let mut yielding = vec![Yielding::NOTHING];
        let mut contacts = Vec::new();
        for column in 0..count {
            let mut below = 0;
            for _ in 0..2 {
                let mass = 1.0 + 0.25 * column as f64;
                let body = yielding.len();
                yielding.push(Yielding {
                    mass,
                    inertia: 6.0 * mass * DMat3::IDENTITY,
                });
                for (x, z) in [(-0.5, -0.5), (0.5, -0.5), (0.25, 0.5)] {
                    let height = if below == 0 { 0.0 } else { 0.5 };
                    contacts.push(Arms {
                        bodies: (below, body),
                        normal: DVec3::Y,
                        arms: (DVec3::new(x, height, z), DVec3::new(x, -0.5, z)),
                    });
                }
                below = body;
            }
        }
        (contacts, yielding)
    }

    #[test]
    fn what_only_a_floor_ties_is_found_as_if_alone() {
        let (alone, of_alone) = columns(1);
        let (all, of_all) = columns(3);
        let wanted: Vec<f64> = (0..all.len()).map(|k| 1.0 + 0.1 * (k % 6) as f64).collect();
        let first = multipliers(&alone, &of_alone, &wanted[..6]);
        let given = multipliers(&all, &of_all, &wanted);
        assert_eq!(given[..6], first);
        let mut twists = vec![Twist::default(); of_all.len()];
        push(&all, &of_all, &mut twists, &given);
        for ((contact, wanted), given) in all.iter().zip(&wanted).zip(&given) {
            let missing = wanted - contact.opening(&twists);
            assert!(missing < 1e-13 && *given >= 0.0);
            assert!(*given == 0.0 || missing > -1e-13, "{missing}");
        }
    }

    /// A plate on many points, each of which requires it to be higher than the last. At most three of them are
    /// independent, so points that push must give way to others.
    #[test]
    fn of_points_that_depend_on_each_other_the_right_ones_push() {
        let plate = Yielding {
            mass: 0.5,
            inertia: DMat3::from_diagonal(DVec3::new(3.0, 2.0, 5.0)),
        };
        let mut random = Random(5);
        let mut number = || random.signed();
        for round in 0..2000 {
            let count = 3 + round % 10;
            let contacts: Vec<Arms> = (0..count)
                .map(|_| Arms {
                    bodies: (0, 1),
                    normal: DVec3::Y,
                    arms: (DVec3::ZERO, DVec3::new(number(), -0.1, number())),
                })
                .collect();
            let wanted: Vec<f64> = (0..count).map(|_| number()).collect();
            let given = multipliers(&contacts, &[Yielding::NOTHING, plate], &wanted);
            let mut twists = [Twist::default(); 2];
            push(&contacts, &[Yielding::NOTHING, plate], &mut twists, &given);
            for ((contact, wanted), given) in contacts.iter().zip(&wanted).zip(&given) {
                let missing = wanted - contact.opening(&twists);
                assert!(
                    missing < 1e-9 && *given >= 0.0,
                    "round {round}: {missing:e}"
                );
                assert!(
                    *given == 0.0 || missing > -1e-9,
                    "round {round}: {missing:e}"
                );
            }
        }
    }

    /// A body between two walls that both push it away, mostly without a solution. A contact that pushes still opens
    /// by what is wanted, and rounding does not count as room.
    #[test]
    fn what_has_no_room_is_pushed_no_farther_than_wanted() {
        let body = Yielding {
            mass: 0.5,
            inertia: DMat3::from_diagonal(DVec3::new(3.0, 2.0, 5.0)),
        };
        let yielding = [Yielding::NOTHING, body, Yielding::NOTHING];
        let mut random = Random(3);
        let mut without_answer = 0;
        for round in 0..5000 {
            let tilt = [0.0, 1e-9][round % 2];
            let contacts: Vec<Arms> = (0..4 + round % 9)
                .map(|k| {
                    let mut sides = || random.in_unit_cube() - DVec3::splat(0.5);
                    let normal = (DVec3::Y + tilt * sides()).normalize();
                    let (below, place) = (k % 2 == 0, sides());
                    let height = if below { -0.1 } else { 0.1 };
                    let arm = DVec3::new(place.x, height, place.z);
                    Arms {
                        bodies: if below { (0, 1) } else { (1, 2) },
                        normal,
                        arms: if below {
                            (DVec3::ZERO, arm)
                        } else {
                            (arm, DVec3::ZERO)
                        },
                    }
                })
                .collect();
            let wanted: Vec<f64> = contacts.iter().map(|_| random.unit()).collect();
            let given = multipliers(&contacts, &yielding, &wanted);
            let mut twists = [Twist::default(); 3];
            push(&contacts, &yielding, &mut twists, &given);
            let mut most_missing: f64 = 0.0;
            for ((contact, wanted), given) in contacts.iter().zip(&wanted).zip(&given) {
                let missing = wanted - contact.opening(&twists);
                most_missing = most_missing.max(missing);
                let is_right = *given == 0.0 || *given > 0.0 && missing.abs() < 1e-6;
                assert!(is_right, "round {round}: {given:e} {missing:e}");
            }
            without_answer += u32::from(most_missing > 1e-6);
        }
        assert!(without_answer > 1000, "{without_answer}");
    }
}
