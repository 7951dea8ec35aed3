//! The impulse that two bodies exchange.

use glam::{DQuat, DVec3};

use super::{Collision, scene::Scene, state::State};
use crate::{
    Feature,
    collide::{self, Contact, naive, snap},
    impulse,
};

/// An exchange of an impulse between two bodies.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// How their shapes were turned into the world then; not at all where bodies do not turn.
    pub rotations: (DQuat, DQuat),
    /// Unit normal, from the first body to the second.
    pub normal: DVec3,
    /// Impulse on the second body along the normal, and on the first against it, N s.
    pub impulse: f64,
    /// Speeds along the normal at which they approached and at which they part, m/s.
    pub speeds: (f64, f64),
    /// What touched, where both are meshes and it is known.
    pub feature: Option<Feature>,
}

/// When two bodies have an impact, s, where they are then, m, and how they are turned.
#[derive(Clone, Copy)]
pub(super) struct Instant {
    pub(super) time: f64,
    pub(super) positions: (DVec3, DVec3),
    pub(super) rotations: (DQuat, DQuat),
}

impl Scene<'_> {
    /// Whether two bodies meet where they are at the end of the step, as the mode has it.
    pub(super) fn meet(&self, end: &State, i: usize, j: usize) -> bool {
        if self.bodies.pair_tumbles(i, j) {
            // Whoever asks, vertices are placed in the frame of the lower one.
            let (i, j) = (i.min(j), i.max(j));
            return match self.settings.collision {
                Collision::Naive => self.bodies.meet_naively_in(end, i, j),
                Collision::Bvh | Collision::Continuous => self.bodies.meet_in(end, i, j),
            };
        }
        let offset = end.position[j] - end.position[i];
        let meshes = match self.settings.collision {
            Collision::Naive => self.bodies.mesh(i).zip(self.bodies.mesh(j)),
            Collision::Bvh | Collision::Continuous => None,
        };
        let Some((first, second)) = meshes else {
            return self.bodies.meet_at(i, j, offset);
        };
        if !first.bounds().meets(&second.bounds(), snap(offset)) {
            return false;
        }
        match collide::is_turned(offset) {
            true => naive::intersect(second, first, -offset),
            false => naive::intersect(first, second, offset),
        }
    }

    /// Where two bodies that meet at the end of the step have touched first on the straight way there, in
    /// the world; `None` if nothing moves them against each other.
    pub(super) fn contact_on_way(&self, end: &State, i: usize, j: usize) -> Option<Contact> {
        self.bodies.need_bvh(i);
        self.bodies.need_bvh(j);
        let (start, end) = (&self.before.position, &end.position);
        let offset = start[j] - start[i];
        let motion = (end[j] - end[i]) - offset;
        let forms = self.bodies.forms(i, j);
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

    /// Lets two bodies that touch on the way of the step part by their restitution at its end.
    pub(super) fn exchange_on_way(
        &self,
        bodies: (usize, usize),
        contact: &Contact,
        end: &mut State,
    ) -> Option<Impact> {
        let at = self.on_way(bodies, contact, end);
        self.exchange(bodies, contact, &mut end.velocity, at)
    }

    /// When two bodies touch on the way of the step, and where they are then.
    pub(super) fn on_way(&self, (i, j): (usize, usize), contact: &Contact, end: &State) -> Instant {
        let part = contact.time;
        let place = |body: usize| self.before.position[body].lerp(end.position[body], part);
        Instant {
            time: self.time + part * self.settings.dt,
            positions: (place(i), place(j)),
            // The discrete modes turn nothing.
            rotations: (DQuat::IDENTITY, DQuat::IDENTITY),
        }
    }

    /// Lets two bodies part by their restitution, if they approach each other. The contact's point is in
    /// the world.
    pub(super) fn exchange(
        &self,
        (i, j): (usize, usize),
        contact: &Contact,
        velocity: &mut [DVec3],
        at: Instant,
    ) -> Option<Impact> {
        let (normal, restitution) = (contact.normal, self.bodies.pair_restitution(i, j));
        let masses = (self.bodies.mass[i], self.bodies.mass[j]);
        let (v1, v2) = (velocity[i], velocity[j]);
        let given = impulse::between((masses.0, v1), (masses.1, v2), normal, restitution)?;
        let mut after = given.after;
        let speeds = ((v1 - v2).dot(normal), (after.1 - after.0).dot(normal));
        if self.bodies.is_rough() {
            let friction = self.bodies.pair_friction(i, j);
            after = impulse::rub(masses, after, normal, friction, given.impulse);
        }
        for (body, after) in [(i, after.0), (j, after.1)] {
            if self.bodies.is_movable(body) {
                velocity[body] = after;
            }
        }
        Some(self.impact((i, j), contact, (given.impulse, speeds), at))
    }

    pub(super) fn impact(
        &self,
        bodies: (usize, usize),
        contact: &Contact,
        (impulse, speeds): (f64, (f64, f64)),
        at: Instant,
    ) -> Impact {
        Impact {
            step: self.step,
            time: at.time,
            bodies,
            point: contact.point,
            positions: at.positions,
            rotations: at.rotations,
            normal: contact.normal,
            impulse,
            speeds,
            feature: contact.feature,
        }
    }
}
