//! The accelerations of an island: the nearest to those by forces alone (Gauss' principle) with which no contact that
//! has reached its target is accelerated against its normal by more than its surface recedes.

use alloc::vec::Vec;
use glam::DVec3;

use super::{
    contact_motion::Course,
    friction::Friction,
    island::{Island, Places},
    solver::{ContactSolver, Solution},
    view::View,
};
use crate::impulse::{Joined, Known, apply, greatest, project_with};

/// An island is at rest if its bodies are slower than this fraction of the speed that forces give them in a step, and
/// if nothing accelerates it.
const AT_REST: f64 = 1e-6;

/// Fraction of the accelerations by forces that may remain in an island that counts as not accelerated.
const UNBALANCED: f64 = 1e-9;

/// The same fraction if friction holds with its greatest force: the effect of rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl ContactSolver<'_> {
    /// Gives the bodies of an island accelerations with which no contact that is kept closes.
    pub(super) fn solve_accelerations(
        &mut self,
        island: &Island,
        places: &Places,
        solution: &mut Solution,
        time: f64,
    ) {
        let Solution {
            free,
            acceleration,
            force,
            friction,
            ..
        } = &*solution;
        if self.balance(island, places, free, acceleration, (force, friction), time) {
            self.note_forces(island, places, solution, time);
            return;
        }
        // In a heap, surfaces count as flat for the rest of the step: nothing meets, and contacts that open close
        // again in the next step.
        if !solution.is_bundled && self.follow_surfaces(island, places, solution, time) {
            self.view().constrain(island, places, solution);
        }
        self.note_forces(island, places, solution, time);
        for (place, &body) in places.bodies.iter().enumerate() {
            if self.scene.bodies.is_movable(body) {
                let by = solution.acceleration[place] - solution.free[place];
                self.paths.acceleration[body] = self.paths.applied_acceleration[body] + by;
            }
        }
    }

    /// Searches where the surfaces of contacts turn or end along the motion that the contacts allow. Returns whether
    /// this changes the allowed accelerations.
    pub(super) fn follow_surfaces(
        &mut self,
        island: &Island,
        places: &Places,
        solution: &mut Solution,
        time: f64,
    ) -> bool {
        let mut turns = false;
        let length = self.scene.settings.dt - time;
        for k in 0..island.constraints.len() {
            let index = island.constraints[k];
            let constraint = self.contacts.all()[index];
            if solution.open[k] || constraint.is_overlap || length <= 0.0 {
                continue;
            }
            let (i, j) = constraint.bodies;
            let start = &self.paths.start;
            let (a, b) = places.joined[k].bodies;
            let stagger = match time == 0.0 {
                true => self.paths.velocity_stagger,
                false => 0.0,
            };
            let pushed = solution.acceleration[b] - solution.acceleration[a];
            let motion = (
                start.position[j] - start.position[i],
                start.velocity[j] - start.velocity[i] + stagger * pushed,
                pushed,
            );
            // The acceleration that would press the bodies together without this contact.
            let load = solution.force[k] * places.yielding(k);
            if load <= 0.0 {
                continue;
            }
            match self
                .view()
                .course_below(&constraint, motion, (length, time == 0.0), load)
            {
                Course::Flat(ahead) => self.contacts.get_mut(index).ahead = ahead,
                Course::Receding(recession) => {
                    solution.recession[k] += recession;
                    self.contacts.get_mut(index).is_turning = true;
                    turns = true;
                }
                Course::EndsAfter(after) => {
                    self.contacts.get_mut(index).ends_at = time + after;
                }
                Course::Ended => {
                    solution.open[k] = true;
                    turns = true;
                }
            }
        }
        turns
    }

    /// Stores for each contact the speed with which forces would close it in a step, its friction, and the time at
    /// which it stops sliding.
    pub(super) fn note_forces(
        &mut self,
        island: &Island,
        places: &Places,
        solution: &Solution,
        time: f64,
    ) {
        let dt = self.scene.settings.dt;
        let friction = &solution.friction;
        for (k, &index) in island.constraints.iter().enumerate() {
            let constraint = self.contacts.get_mut(index);
            constraint.load_speed = dt * solution.force[k] * places.yielding(k);
            if !friction.is_empty() {
                constraint.friction = friction.force[k];
                constraint.sticks = !friction.slides(k, solution.force[k]);
                constraint.ends_at = constraint.ends_at.min(time + friction.ends_after[k]);
            }
        }
    }

    /// Brings an island to rest that hardly moves and that nothing accelerates. Returns whether it has done so.
    pub(super) fn balance(
        &mut self,
        island: &Island,
        places: &Places,
        free: &[DVec3],
        acceleration: &[DVec3],
        (force, friction): (&[f64], &Friction),
        time: f64,
    ) -> bool {
        let push = greatest(free);
        let is_still = |v: DVec3| v.length() <= AT_REST * push * self.scene.settings.dt;
        // If friction almost holds a body, the body may have only a small acceleration: no more than the rounding of
        // the sum of all forces on it.
        let borne = (0..force.len()).map(|k| force[k] * places.yielding(k));
        let unbalanced = match (0..force.len()).any(|k| friction.slides(k, force[k])) {
            true => ROUNDING * borne.fold(push, f64::max),
            false => UNBALANCED * push,
        };
        let at_rest = time == 0.0
            && places.bodies.iter().enumerate().all(|(place, &body)| {
                match self.scene.bodies.is_movable(body) {
                    false => self.scene.before.velocity[body] == DVec3::ZERO,
                    true => {
                        is_still(self.paths.start.velocity[body])
                            && acceleration[place].length() <= unbalanced
                            && self.view().motion().coupled_group(body).is_none()
                            && self.paths.frozen.get(body) != Some(&true)
                    }
                }
            })
            && island
                .constraints
                .iter()
                .zip(force)
                .all(|(&index, &force)| {
                    let constraint = &self.contacts.all()[index];
                    constraint.target == 0.0 || force <= 0.0
                });
        if at_rest {
            for &body in &island.bodies {
                self.paths.start.velocity[body] = DVec3::ZERO;
                self.paths.acceleration[body] = DVec3::ZERO;
                self.fall_asleep(body);
            }
        }
        at_rest
    }
}

impl View<'_> {
    /// Computes the accelerations nearest to those by forces alone with which no kept contact closes by more than its
    /// surface recedes, and the force of each contact. Returns whether they have been found.
    pub(super) fn constrain(
        &self,
        island: &Island,
        places: &Places,
        solution: &mut Solution,
    ) -> bool {
        if !solution.friction.is_empty() {
            return self.press_and_drag(island, places, solution);
        }
        self.press(island, places, solution);
        true
    }

    /// The same with given friction forces.
    pub(super) fn press(&self, island: &Island, places: &Places, solution: &mut Solution) {
        let Solution {
            open,
            recession,
            free,
            ..
        } = solution;
        let mut acceleration = free.clone();
        let friction = &solution.friction;
        for (joined, &dragged) in places.joined.iter().zip(&friction.force) {
            apply(joined, &places.inverse_mass, &mut acceleration, dragged);
        }
        let free = acceleration.clone();
        let kept: Vec<usize> = (0..open.len()).filter(|&k| !open[k]).collect();
        let joined: Vec<Joined> = kept.iter().map(|&k| places.joined[k]).collect();
        let missing = |&k: &usize| -recession[k] - places.joined[k].opening(&free);
        let missing: Vec<f64> = kept.iter().map(missing).collect();
        // The last forces are a good start.
        let before = |&k: &usize| {
            let load =
                self.contacts.all()[island.constraints[k]].load_speed / self.scene.settings.dt;
            let known = solution.force.get(k).copied();
            known.unwrap_or(load.max(0.0) / places.yielding(k))
        };
        let warm: Vec<f64> = kept.iter().map(before).collect();
        let inverse_mass = &places.inverse_mass;
        let known = Known {
            held: &[],
            warm: &warm,
            enough: self.unseen_speed(island) / self.scene.settings.dt,
            prepared: (kept.len() == open.len()).then_some(&places.prepared),
        };
        let given = project_with(&joined, inverse_mass, &mut acceleration, &missing, known);
        let mut force = alloc::vec![0.0; open.len()];
        for (k, given) in kept.into_iter().zip(given) {
            force[k] = given;
        }
        (solution.acceleration, solution.force) = (acceleration, force);
    }
}
