//! The forces of a world: adding, changing, removing them.

use alloc::vec::Vec;
use core::cmp::Ordering;
use glam::DVec3;

use super::{World, WorldError, error, order, plan::Plan};
use crate::{
    Force,
    force::{BodyMotion, PairMotion, Reach},
};

/// The forces of a world, except the constant resultants of its bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Forces {
    pub(super) list: Vec<Force>,
    /// The sum of all weights, as an acceleration, m/s².
    weight: DVec3,
    /// Which bodies are stepped together. It is valid only if `is_planned`.
    pub(super) plan: Plan,
    /// Whether the plan is valid: neither bodies nor forces have changed since it was made.
    is_planned: bool,
}

impl Forces {
    /// Invalidates the plan, because bodies or forces have changed.
    pub(super) fn forget_plan(&mut self) {
        self.is_planned = false;
    }
}

impl World {
    /// Adds a force to the constant resultants of the bodies, and returns its index in [`World::forces`].
    ///
    /// # Errors
    ///
    /// [`WorldError::Force`] if a number is out of range, [`WorldError::NoBody`] if the force names a body that does
    /// not exist.
    pub fn add_force(&mut self, force: Force) -> Result<usize, WorldError> {
        let index = self.forces.list.len();
        self.check_force(index, &force)?;
        let is_weight = force.reach() == Reach::Weight;
        self.forces.list.push(force);
        self.forces_changed(is_weight);
        Ok(index)
    }

    /// Replaces a force by another one.
    ///
    /// # Errors
    ///
    /// Those of [`World::add_force`], and [`WorldError::NoForce`].
    pub fn replace_force(&mut self, index: usize, force: Force) -> Result<(), WorldError> {
        self.check_force(index, &force)?;
        let forces = self.forces.list.len();
        let place = self.forces.list.get_mut(index);
        let place = place.ok_or(WorldError::NoForce { index, forces })?;
        let is_weight = [&*place, &force].map(Force::reach).contains(&Reach::Weight);
        *place = force;
        self.forces_changed(is_weight);
        Ok(())
    }

    /// Removes a force; the indices of the forces after it decrease by one.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoForce`].
    pub fn remove_force(&mut self, index: usize) -> Result<Force, WorldError> {
        let forces = self.forces.list.len();
        if index >= forces {
            return Err(WorldError::NoForce { index, forces });
        }
        let force = self.forces.list.remove(index);
        self.forces_changed(force.reach() == Reach::Weight);
        Ok(force)
    }

    /// The forces that were added to the constant resultants of the bodies.
    pub fn forces(&self) -> &[Force] {
        &self.forces.list
    }

    /// The potential energy of all forces that have one, J. It is 0 for a constant force or weight on a body at the
    /// origin, for a spring at its rest length, and for attraction from infinitely far away.
    pub fn potential_energy(&self) -> f64 {
        let bodies = self.movable();
        let constant: f64 = bodies
            .clone()
            .map(|i| -self.force(i).dot(self.position(i)))
            .sum();
        let of_body = |force: &Force, i| {
            let potential = force.body_potential(&self.body_motion(force, i));
            potential.unwrap_or(0.0)
        };
        let of_pair = |force: &Force, i, j| {
            let potential = force.pair_potential(&self.pair_motion(force, i, j));
            potential.unwrap_or(0.0)
        };
        // Without forces the sum is minus zero.
        let mut energy = constant + 0.0;
        for force in &self.forces.list {
            energy += match force.reach() {
                Reach::Weight | Reach::EachBody => {
                    bodies.clone().map(|i| of_body(force, i)).sum::<f64>()
                }
                Reach::Body(i) if !self.bodies.is_movable(i) => 0.0,
                Reach::Body(i) => of_body(force, i),
                Reach::Pair([i, j]) => of_pair(force, i, j),
                Reach::EachPair => bodies
                    .clone()
                    .flat_map(|j| {
                        self.movable()
                            .take_while(move |&i| i < j)
                            .map(move |i| (i, j))
                    })
                    .map(|(i, j)| of_pair(force, i, j))
                    .sum(),
            };
        }
        energy
    }

    /// The sum of all forces on a body at its current position and motion, without those of contacts, N; 0 on an
    /// immovable body. The time grows with the number of forces, and under gravitation with the number of bodies.
    pub fn applied_force(&self, body: usize) -> DVec3 {
        if !self.bodies.is_movable(body) {
            return DVec3::ZERO;
        }
        let constant = self.bodies.mass[body] * self.constant_acceleration(body);
        let forces = self.forces.list.iter();
        forces.fold(constant, |sum, force| sum + self.force_by(force, body))
    }

    /// The torque of all forces on a body about its centre of mass at its current position and motion, without that of
    /// contacts, N m; 0 on a body that cannot rotate or is immovable.
    pub fn applied_torque(&self, body: usize) -> DVec3 {
        let slot = self.bodies.turners.slot(body);
        let Some(slot) = slot.filter(|_| self.bodies.is_movable(body)) else {
            return DVec3::ZERO;
        };
        let constant = self.bodies.turners.torque[slot];
        let forces = self.forces.list.iter().filter(|force| force.has_points());
        forces.fold(constant, |sum, force| {
            let point = match (force.reach(), force.point(), force.points()) {
                (Reach::Body(i), Some(point), _) if i == body => point,
                (Reach::Pair([i, _]), _, Some([point, _])) if i == body => point,
                (Reach::Pair([_, j]), _, Some([_, point])) if j == body => point,
                _ => return sum,
            };
            sum + self.lever(body, point).0.cross(self.force_by(force, body))
        })
    }

    /// One force on a movable body, N; zero for weight, which is part of the constant acceleration.
    fn force_by(&self, force: &Force, body: usize) -> DVec3 {
        let on_first = |force: &Force, i, j| force.on_pair(&self.pair_motion(force, i, j));
        match force.reach() {
            Reach::Weight => DVec3::ZERO,
            Reach::EachBody => force.on_body(&self.body_motion(force, body)),
            Reach::Body(i) if i == body => force.on_body(&self.body_motion(force, body)),
            Reach::Body(_) => DVec3::ZERO,
            Reach::Pair([i, j]) if i == body => on_first(force, i, j),
            Reach::Pair([i, j]) if j == body => -on_first(force, i, j),
            Reach::Pair(_) => DVec3::ZERO,
            Reach::EachPair => {
                let others = self.movable().filter(|&other| other != body);
                others.map(|other| on_first(force, body, other)).sum()
            }
        }
    }

    /// The position of a point of a body in the world, m; the point is given in the frame of its shape, m.
    pub fn point_of(&self, body: usize, point: DVec3) -> DVec3 {
        self.position(body) + self.lever(body, point).0
    }

    /// A point of a body relative to the body's position, m, and its velocity relative to the body's, m/s.
    fn lever(&self, body: usize, point: DVec3) -> (DVec3, DVec3) {
        self.bodies.lever_in(&self.current.turned, body, point)
    }

    /// The acceleration of a body by constant forces and weight, m/s²; zero for an immovable body.
    pub(super) fn constant_acceleration(&self, body: usize) -> DVec3 {
        if !self.bodies.is_movable(body) {
            return DVec3::ZERO;
        }
        self.bodies.force[body] / self.bodies.mass[body] + self.forces.weight
    }

    /// Updates the world after a change of forces. `is_weight` says whether one of them is a weight: forces are
    /// often added one by one, and only a weight changes the acceleration of all bodies.
    fn forces_changed(&mut self, is_weight: bool) {
        self.forces.forget_plan();
        self.continuous.wake_all();
        self.integrator.forget_growth();
        if !is_weight {
            return;
        }
        let weights = self.forces.list.iter().filter_map(|force| match force {
            Force::Gravity { acceleration } => Some(*acceleration),
            _ => None,
        });
        let weight = weights.sum();
        if weight != self.forces.weight {
            self.forces.weight = weight;
            for body in 0..self.bodies.len() {
                self.bodies.acceleration[body] = self.constant_acceleration(body);
            }
        }
    }

    /// Makes the plan of bodies that are stepped together, unless it is valid.
    #[inline(always)]
    pub(super) fn make_plan(&mut self) {
        if !self.forces.is_planned {
            self.make_new_plan();
        }
    }

    #[cold]
    fn make_new_plan(&mut self) {
        let (bodies, motion) = (&self.bodies, &self.current);
        let key = |body: usize| order::key(bodies, motion, body);
        self.forces.plan = Plan::new(&self.forces.list, bodies.len(), key);
        self.forces.is_planned = true;
    }

    /// The order in which bodies that forces couple are stepped, if a plan exists whose order depends on their
    /// motion. The order stays the same until bodies or forces are added.
    pub(super) fn planned_order(&self) -> Option<Vec<usize>> {
        let plan = self.forces.is_planned.then_some(&self.forces.plan)?;
        if plan.each_pair.is_empty() {
            return None;
        }
        let groups = plan.sections.iter().flat_map(|section| &section.groups);
        Some(groups.flat_map(|group| &group.bodies).copied().collect())
    }

    /// Makes a plan with the bodies in an earlier order; bodies that are not in that order come last.
    pub(super) fn plan_in_order(&mut self, order: &[usize]) {
        let mut places = alloc::vec![i64::MAX; self.len()];
        for (place, &body) in (0..).zip(order) {
            places[body] = place;
        }
        let key = |body: usize| [places[body], 0, 0, 0, 0, 0, 0, 0, 0, 0];
        self.forces.plan = Plan::new(&self.forces.list, self.len(), key);
        self.forces.is_planned = true;
    }

    /// Removes the forces that name a removed body. Forces on bodies after it get the new indices of these bodies.
    pub(super) fn remove_forces_of(&mut self, gone: usize) {
        let renumber = |body: usize| match body.cmp(&gone) {
            Ordering::Less => Some(body),
            Ordering::Equal => None,
            Ordering::Greater => Some(body - 1),
        };
        let forces = self.forces.list.drain(..);
        self.forces.list = forces
            .filter_map(|force| force.renumbered(renumber))
            .collect();
        self.forces_changed(false);
    }

    fn check_force(&self, index: usize, force: &Force) -> Result<(), WorldError> {
        error::check_force(index, force)?;
        for body in force.bodies() {
            self.check_body(body)?;
        }
        Ok(())
    }

    /// The motion of a body, or of the point of it on which a force acts.
    fn body_motion(&self, force: &Force, i: usize) -> BodyMotion {
        let lever = force.point().map(|point| self.lever(i, point));
        let (arm, turning) = lever.unwrap_or_default();
        BodyMotion {
            time: self.time(),
            mass: self.bodies.mass[i],
            position: self.position(i) + arm,
            velocity: self.velocity(i) + turning,
        }
    }

    /// The same for two bodies.
    fn pair_motion(&self, force: &Force, i: usize, j: usize) -> PairMotion {
        let levers = force.points();
        let levers = levers.map(|[p, q]| (self.lever(i, p), self.lever(j, q)));
        let (first, second) = levers.unwrap_or_default();
        PairMotion {
            time: self.time(),
            mass: [self.bodies.mass[i], self.bodies.mass[j]],
            position: (self.position(j) - self.position(i)) + (second.0 - first.0),
            velocity: (self.velocity(j) - self.velocity(i)) + (second.1 - first.1),
        }
    }
}
