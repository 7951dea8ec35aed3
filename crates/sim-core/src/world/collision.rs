//! Whether bodies meet, and what they exchange.

use alloc::vec::Vec;
use glam::DVec3;

use super::{Collision, World};
use crate::{
    Feature,
    collide::{self, Contact, naive, snap},
    impulse,
};

/// An exchange of an impulse between two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// The step in which it happened, from 1.
    pub step: u64,
    /// When it happened, s; in the discrete modes, that of the first contact on the straight way from
    /// the start of the step to its end.
    pub time: f64,
    /// The bodies.
    pub bodies: (usize, usize),
    /// Point of contact in the world, m.
    pub point: DVec3,
    /// Where the bodies were then, m; in the discrete modes too, though they go back from there.
    pub positions: (DVec3, DVec3),
    /// Unit normal, from the first body to the second.
    pub normal: DVec3,
    /// Impulse on the second body along the normal, and on the first against it, N s.
    pub impulse: f64,
    /// Speeds along the normal at which they approached and at which they part, m/s.
    pub speeds: (f64, f64),
    /// What touched, where both are meshes and it is known.
    pub feature: Option<Feature>,
}

impl World {
    /// Whether two bodies with shapes can have an impact: not if nothing moves either, nor if they
    /// began in overlap and have not parted since.
    pub(super) fn may_collide(&self, i: usize, j: usize) -> bool {
        let is_movable = self.mass[i].is_finite() || self.mass[j].is_finite();
        let pair = (i.min(j), i.max(j));
        is_movable && self.overlapping.binary_search(&pair).is_err()
    }

    /// Pairs of bodies that meet now, though they were not put into the world so, by the exact test and in
    /// order: after a step there is none. For checks; it takes a box test for each pair that is near.
    pub fn meeting(&self) -> Vec<(usize, usize)> {
        let mut near = self.near_pairs(&self.current.position, |_, _| 0.0);
        let known = self.overlapping();
        near.retain(|&(i, j)| {
            let offset = self.current.position[j] - self.current.position[i];
            known.binary_search(&(i, j)).is_err() && self.meet_at(i, j, offset)
        });
        near
    }

    /// Whether two bodies meet where they are now, as the mode has it.
    pub(super) fn meet(&self, i: usize, j: usize) -> bool {
        let offset = self.current.position[j] - self.current.position[i];
        let meshes = match self.settings.collision {
            Collision::Naive => self.mesh(i).zip(self.mesh(j)),
            Collision::Bvh | Collision::Continuous => None,
        };
        let Some((first, second)) = meshes else {
            return self.meet_at(i, j, offset);
        };
        if !first.bounds().meets(&second.bounds(), snap(offset)) {
            return false;
        }
        match collide::is_turned(offset) {
            true => naive::intersect(second, first, -offset),
            false => naive::intersect(first, second, offset),
        }
    }

    /// Whether two bodies meet, through trees, with the second one at `offset` from the first.
    pub(super) fn meet_at(&self, i: usize, j: usize, offset: DVec3) -> bool {
        if let Some((first, second)) = self.mesh(i).zip(self.mesh(j))
            && !first.bounds().meets(&second.bounds(), snap(offset))
        {
            return false;
        }
        self.need_bvh(i);
        self.need_bvh(j);
        self.meet_built(i, j, offset)
    }

    /// The same with the trees there.
    pub(super) fn meet_built(&self, i: usize, j: usize, offset: DVec3) -> bool {
        let offset = snap(offset);
        let forms = self.form(i).zip(self.form(j));
        forms.is_some_and(|(first, second)| collide::meet(first, second, offset))
    }

    /// Exchanges an impulse along the normal of the feature that touched first.
    pub(super) fn bounce(&mut self, i: usize, j: usize) {
        if let Some(contact) = self.contact_on_way(i, j) {
            let time = self.time() + contact.time * self.settings.dt;
            self.exchange_now((i, j), &contact, time);
        }
    }

    /// Where two bodies that meet have touched first on the straight way of the step, in the world;
    /// `None` if nothing moves them against each other.
    pub(super) fn contact_on_way(&self, i: usize, j: usize) -> Option<Contact> {
        self.need_bvh(i);
        self.need_bvh(j);
        let (start, end) = (&self.previous.position, &self.current.position);
        let offset = start[j] - start[i];
        let motion = (end[j] - end[i]) - offset;
        let forms = self.form(i).zip(self.form(j));
        let contact = forms.and_then(|(a, b)| collide::first_contact(a, b, offset, motion));
        // Bodies that meet after a motion have touched on the way. Should rounding hide where,
        // the motion itself is turned back.
        let turned_back = || {
            Some(Contact {
                time: 1.0,
                point: offset + motion,
                normal: -motion.try_normalize()?,
                feature: None,
                face: None,
            })
        };
        let contact = contact.or_else(turned_back)?;
        let point = start[i].lerp(end[i], contact.time) + contact.point;
        Some(Contact { point, ..contact })
    }

    /// Lets two bodies that approach part by their restitution, now.
    pub(super) fn exchange_now(&mut self, (i, j): (usize, usize), contact: &Contact, time: f64) {
        let before = (self.current.velocity[i], self.current.velocity[j]);
        let restitution = self.pair_restitution(i, j);
        let masses = (self.mass[i], self.mass[j]);
        let after = self.exchange((i, j), contact, (masses, before), restitution, time);
        (self.current.velocity[i], self.current.velocity[j]) = after;
    }

    /// The velocities of two bodies after they have parted by a restitution, if they approach, from
    /// their masses and velocities before. The contact's point is in the world.
    pub(super) fn exchange(
        &mut self,
        bodies: (usize, usize),
        contact: &Contact,
        ((m1, m2), (v1, v2)): ((f64, f64), (DVec3, DVec3)),
        restitution: f64,
        time: f64,
    ) -> (DVec3, DVec3) {
        let normal = contact.normal;
        let Some(given) = impulse::between((m1, v1), (m2, v2), normal, restitution) else {
            return (v1, v2);
        };
        let mut after = given.after;
        let speeds = ((v1 - v2).dot(normal), (after.1 - after.0).dot(normal));
        if !self.friction.is_empty() {
            let friction = self.pair_friction(bodies.0, bodies.1);
            after = impulse::rub((m1, m2), after, normal, friction, given.impulse);
        }
        self.note_impact(bodies, contact, given.impulse, speeds, time);
        after
    }

    pub(super) fn note_impact(
        &mut self,
        bodies: (usize, usize),
        contact: &Contact,
        impulse: f64,
        speeds: (f64, f64),
        time: f64,
    ) {
        self.impacts += 1;
        let masses = (self.mass[bodies.0], self.mass[bodies.1]);
        self.continuous
            .progress
            .note_impulse(impulse, speeds.0, masses);
        let part = ((time - self.time()) / self.settings.dt).clamp(0.0, 1.0);
        let impact = Impact {
            step: self.steps + 1,
            time,
            bodies,
            point: contact.point,
            positions: (
                self.position_in_step(bodies.0, part),
                self.position_in_step(bodies.1, part),
            ),
            normal: contact.normal,
            impulse,
            speeds,
            feature: contact.feature,
        };
        if let Some(report) = &mut self.report {
            report.push(impact.clone());
        }
        self.last_impact = Some(impact);
    }

    /// Where a body that has an impact is at a part of the step, while that is resolved.
    fn position_in_step(&self, body: usize, part: f64) -> DVec3 {
        // Within the step the trajectory of what impacts move starts at the impact.
        if self.settings.collision == Collision::Continuous && self.is_movable(body) {
            return self.continuous.start.position[body];
        }
        self.previous.position[body].lerp(self.current.position[body], part)
    }

    pub(super) fn pair_restitution(&self, i: usize, j: usize) -> f64 {
        self.restitution(i).min(self.restitution(j))
    }

    /// The coefficient of friction between two bodies: the geometric mean of theirs, and 0 where one
    /// is smooth, whatever the other is.
    pub(super) fn pair_friction(&self, i: usize, j: usize) -> f64 {
        let (first, second) = (self.friction(i), self.friction(j));
        if first == 0.0 || second == 0.0 {
            return 0.0;
        }
        // Of the product, so that two equal coefficients give themselves to the bit.
        libm::sqrt(first * second)
    }
}
