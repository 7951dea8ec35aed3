//! Coulomb friction at the contacts of an island.
//!
//! The force across a contact's normal is at most the friction coefficient times the force along it. If the bodies
//! slide, it has this size and is opposite to their sliding. If they do not slide, it is the force that keeps them
//! from sliding, if that is no greater. Normal forces and friction are computed alternately, each with the last
//! result of the other (Kaufman, Sueda, James, Pai 2008, "Staggered projections for frictional contact in multibody
//! systems", sec. 4), until neither changes: immediately if all normals of a body are parallel.
//!
//! The direction of sliding is taken in the middle of the motion, which makes it correct to second order. If sliding
//! ends within the step, the friction force ends then (an event), and the contact is held afterwards. In a heap,
//! whose contacts are solved once a step, friction first stops sliding at the start of the step, by as much as it can
//! in the step. The rest of the friction then holds. Neither adds energy, at whatever time the step is cut.

use alloc::{vec, vec::Vec};
use glam::DVec3;

use super::{
    contact_set::ContactConstraint,
    island::{Island, Places},
    solver::Solution,
    view::View,
};
use crate::impulse::{ALL_SWEEPS, Joined, Known, drag, greatest, limit, project_with};

/// The greatest number of contacts for which a solution far from the starting point is searched too.
const FEW: usize = 4;

/// The greatest number of turns of normal forces and friction, and of sweeps of friction in each turn: for few
/// contacts; for more, which are solved as a heap if this does not suffice; and in a heap, in which each step
/// continues from the solution of the last one.
fn effort(contacts: usize, is_bundled: bool) -> (usize, usize) {
    match is_bundled {
        true => (3, 32),
        false if contacts <= FEW => (64, ALL_SWEEPS),
        false => (8, 200),
    }
}

/// Fraction of the greatest friction above which a contact counts as sliding.
const NEARLY_ALL: f64 = 1.0 - 1e-12;

/// The friction of an island, by its contacts; empty if all are frictionless.
#[derive(Clone, Debug, Default)]
pub(super) struct Friction {
    coefficient: Vec<f64>,
    /// The velocity of the second body relative to the first, across the normal, m/s; zero if they stick.
    sliding: Vec<DVec3>,
    /// The friction force on the second body, N.
    pub(super) force: Vec<DVec3>,
    /// The time at which sliding ends, s from the start of the trajectories; infinite if it does not end.
    pub(super) ends_after: Vec<f64>,
    /// The rest of the step, s.
    left: f64,
    /// The velocity stagger, s: the method keeps the velocity that the trajectory has this long before.
    stagger: f64,
    /// In a heap, the part of each contact's friction that was used to stop sliding, N; otherwise empty.
    spent: Vec<f64>,
}

impl Friction {
    pub(super) fn is_empty(&self) -> bool {
        self.coefficient.is_empty()
    }

    /// Whether a contact under the normal force `force` slides, or is about to.
    pub(super) fn slides(&self, k: usize, force: f64) -> bool {
        let Some(&coefficient) = self.coefficient.get(k) else {
            return false;
        };
        let most = limit(coefficient, force);
        most > 0.0 && self.force[k].length() + self.spent(k) >= NEARLY_ALL * most
    }

    fn spent(&self, k: usize) -> f64 {
        self.spent.get(k).copied().unwrap_or(0.0)
    }

    /// The greatest friction of a contact under a normal force, N.
    fn most(&self, k: usize, pressed: f64) -> f64 {
        (limit(self.coefficient[k], pressed) - self.spent(k)).max(0.0)
    }

    /// The acceleration against a contact's sliding that friction should reach as far as it can, m/s². It brings the
    /// contact to rest in the middle of its sliding, so that friction that cannot do so is opposite to the velocity
    /// in the middle of the motion. `yielding` is the sum of the inverse masses of the bodies, `most` the greatest
    /// friction, and `acceleration` the relative acceleration of the bodies.
    fn wanted(&self, k: usize, yielding: f64, most: f64, acceleration: DVec3) -> DVec3 {
        let sliding = self.sliding[k];
        let Some(direction) = sliding.try_normalize() else {
            return DVec3::ZERO;
        };
        // With the greatest friction, against the sliding at the start.
        let without = acceleration - yielding * self.force[k];
        let slowing = most * yielding - direction.dot(without);
        let stop = match slowing > 0.0 {
            true => sliding.length() / slowing - self.stagger,
            false => f64::INFINITY,
        };
        // A first-order method has already reversed the sliding.
        if stop <= 0.0 {
            return sliding / self.left;
        }
        let middle = 0.5 * stop.min(self.left) + self.stagger;
        sliding / middle.max(f64::EPSILON * self.left)
    }

    /// The time after which a contact stops sliding, s.
    fn stops_after(&self, k: usize, acceleration: DVec3) -> f64 {
        let against = -self.force[k].normalize_or_zero();
        let sliding = self.sliding[k] + self.stagger * acceleration;
        let (speed, slowing) = (against.dot(sliding), -against.dot(acceleration));
        match speed > 0.0 && slowing * self.left > speed {
            true => speed / slowing,
            false => f64::INFINITY,
        }
    }
}

impl View<'_> {
    /// The friction coefficients of the contacts of an island; `None` if all are frictionless.
    fn coefficients(&self, island: &Island) -> Option<Vec<f64>> {
        let all = self.contacts.all();
        let of = |&index: &usize| {
            let (i, j) = all[index].bodies;
            self.scene.bodies.pair_friction(i, j)
        };
        let coefficients: Vec<f64> = island.constraints.iter().map(of).collect();
        coefficients
            .iter()
            .any(|&c| c > 0.0)
            .then_some(coefficients)
    }

    /// Whether a sticking contact still sticks: it slides in a step by no more than a small part of its gap.
    fn sticks(&self, contact: &ContactConstraint, sliding: DVec3) -> bool {
        let (i, j) = contact.bodies;
        contact.sticks
            && sliding.length() <= 0.0625 * self.layout().hover_gap(i, j) / self.scene.settings.dt
    }

    /// Applies friction to the impulses of an island's contacts (`given`, N s), and stops the contacts that close
    /// because of it; speeds below `rounding` count as zero. Contacts that hardly slide and that forces press
    /// together are brought to rest. In a heap this holds for all contacts that forces press together, up to the
    /// friction of these forces in the rest of the step (`left`, s). Returns how much of this each contact has used,
    /// N s; `None` if an island that is no heap would need too many sweeps.
    pub(super) fn rub(
        &self,
        island: &Island,
        places: &Places,
        velocity: &mut [DVec3],
        given: &mut [f64],
        (rounding, target): (f64, &[f64]),
        left: Option<f64>,
    ) -> Option<Vec<f64>> {
        let Some(coefficient) = self.coefficients(island) else {
            return Some(Vec::new());
        };
        let constraint = |k: usize| &self.contacts.all()[island.constraints[k]];
        let count = given.len();
        let Places {
            joined,
            inverse_mass,
            ..
        } = places;
        let sticks = |k: usize, velocity: &[DVec3]| {
            let constraint = constraint(k);
            constraint.load_speed > 0.0 && self.sticks(constraint, joined[k].sliding(velocity))
        };
        let of_load = |k: usize| match left {
            Some(left) => {
                let load = constraint(k).load_speed / self.scene.settings.dt / places.yielding(k);
                limit(coefficient[k], left * load)
            }
            None => 0.0,
        };
        let of_load: Vec<f64> = (0..count).map(of_load).collect();
        let mut dragged = vec![DVec3::ZERO; count];
        let (turns, sweeps) = effort(count, left.is_some());
        let enough = (4.0 * rounding).max(self.unseen_speed(island) / 64.0);
        for _ in 0..turns {
            let most =
                |k: usize| match left.is_none() && coefficient[k] > 0.0 && sticks(k, velocity) {
                    true => f64::INFINITY,
                    false => limit(coefficient[k], given[k]) + of_load[k],
                };
            let most: Vec<f64> = (0..count).map(most).collect();
            if most.iter().all(|&most| most == 0.0) {
                break;
            }
            let none = vec![DVec3::ZERO; count];
            let is_found = drag(
                joined,
                inverse_mass,
                velocity,
                &most,
                &none,
                &mut dragged,
                (enough, sweeps),
            );
            if !is_found && left.is_none() {
                return None;
            }
            let missing = |k: usize| target[k] - joined[k].opening(velocity);
            let missing: Vec<f64> = (0..count).map(missing).collect();
            if missing.iter().all(|&missing| missing <= rounding) {
                break;
            }
            let known = Known {
                prepared: Some(&places.prepared),
                enough,
                ..Known::default()
            };
            let more = project_with(joined, inverse_mass, velocity, &missing, known);
            for (given, more) in given.iter_mut().zip(more) {
                *given += more;
            }
        }
        let beyond = |k: usize| dragged[k].length() - limit(coefficient[k], given[k]);
        let beyond = (0..count).map(|k| beyond(k).clamp(0.0, of_load[k]));
        Some(beyond.collect())
    }

    /// The data of an island's friction before its forces are computed.
    pub(super) fn friction_of(
        &self,
        island: &Island,
        places: &Places,
        velocity: &[DVec3],
        spent: Option<Vec<f64>>,
        time: f64,
    ) -> Friction {
        let Some(coefficient) = self.coefficients(island) else {
            return Friction::default();
        };
        let all = self.contacts.all();
        let sliding = |(joined, &index): (&Joined, &usize)| {
            let sliding = joined.sliding(velocity);
            match spent.is_some() || self.sticks(&all[index], sliding) {
                true => DVec3::ZERO,
                false => sliding,
            }
        };
        let contacts = places.joined.iter().zip(&island.constraints);
        Friction {
            sliding: contacts.map(sliding).collect(),
            force: island
                .constraints
                .iter()
                .map(|&index| all[index].friction)
                .collect(),
            ends_after: vec![f64::INFINITY; coefficient.len()],
            left: self.scene.settings.dt - time,
            stagger: if time == 0.0 {
                self.paths.velocity_stagger
            } else {
                0.0
            },
            coefficient,
            spent: spent.unwrap_or_default(),
        }
    }

    /// Computes the forces along the normals of an island's contacts and across them, and the resulting
    /// accelerations. Returns whether these are the solution and not only near it.
    pub(super) fn press_and_drag(
        &self,
        island: &Island,
        places: &Places,
        solution: &mut Solution,
    ) -> bool {
        let Places {
            joined,
            inverse_mass,
            ..
        } = places;
        let (turns, sweeps) = effort(joined.len(), solution.is_bundled);
        let mut is_answer = false;
        for turn in 0..=turns {
            self.press(island, places, solution);
            let friction = &solution.friction;
            let mut acceleration = solution.acceleration.clone();
            let mut force = friction.force.clone();
            let count = force.len();
            let pressed = |k: usize| match solution.open[k] {
                true => 0.0,
                false => solution.force[k],
            };
            let most = |k: usize| friction.most(k, pressed(k));
            let most: Vec<f64> = (0..count).map(most).collect();
            let given = |k: usize| pressed(k) * places.yielding(k);
            let largest = (0..count)
                .map(given)
                .fold(greatest(&solution.free), f64::max);
            let enough = 8.0 * f64::EPSILON * largest;
            let wanted = |k: usize| match most[k] > 0.0 {
                true => {
                    let pushed = joined[k].sliding(&solution.acceleration);
                    friction.wanted(k, places.yielding(k), most[k], pushed)
                }
                false => DVec3::ZERO,
            };
            let wanted: Vec<DVec3> = (0..count).map(wanted).collect();
            let is_found = drag(
                joined,
                inverse_mass,
                &mut acceleration,
                &most,
                &wanted,
                &mut force,
                (enough, sweeps),
            );
            if !is_found && !solution.is_bundled {
                return false;
            }
            let change = |k: usize| (force[k] - friction.force[k]).length() * places.yielding(k);
            let change = (0..count).map(change).fold(0.0, f64::max);
            is_answer = change <= enough;
            if is_answer || turn == turns {
                break;
            }
            solution.friction.force = force;
        }
        let friction = &solution.friction;
        if !solution.is_bundled {
            let ends = |k: usize| match friction.sliding[k] == DVec3::ZERO {
                true => f64::INFINITY,
                false => friction.stops_after(k, joined[k].sliding(&solution.acceleration)),
            };
            solution.friction.ends_after = (0..joined.len()).map(ends).collect();
        }
        is_answer
    }
}
