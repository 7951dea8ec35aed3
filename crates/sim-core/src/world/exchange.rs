//! The impulse that two bodies exchange.

use glam::{DQuat, DVec3};

use super::{Collision, scene::Scene, state::State};
use crate::{
    Feature,
    collide::{self, Contact, naive, snap},
    impulse,
};

/// An impulse exchanged between two bodies.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Impact {
    /// The step in which it happened, from 1.
    pub step: u64,
    /// The time of the impact, s. In the discrete modes it is the time of the first contact on the straight path from
    /// the start of the step to its end.
    pub time: f64,
    /// The bodies.
    pub bodies: (usize, usize),
    /// Point of contact in the world, m.
    pub point: DVec3,
    /// The positions of the bodies at that time, m; also in the discrete modes, though the bodies go back from there.
    pub positions: (DVec3, DVec3),
    /// The rotations of their shapes into the world at that time; the identity for bodies that do not turn.
    pub rotations: (DQuat, DQuat),
    /// Unit normal, from the first body to the second.
    pub normal: DVec3,
    /// Impulse on the second body along the normal, and on the first against it, N s.
    pub impulse: f64,
    /// The closing speed before and the opening speed after the impact, along the normal, m/s.
    pub speeds: (f64, f64),
    /// The features that touched, if both shapes are meshes and the features are known.
    pub feature: Option<Feature>,
}

/// The time of an impact of two bodies, s, and their positions, m, and rotations at that time.
#[derive(Clone, Copy)]
pub(super) struct Instant {
    pub(super) time: f64,
    pub(super) positions: (DVec3, DVec3),
    pub(super) rotations: (DQuat, DQuat),
}

impl Scene<'_> {
    /// Whether two bodies meet at the end of the step, by the test of the mode.
    pub(super) fn meet(&self, end: &State, i: usize, j: usize) -> bool {
        if self.bodies.pair_tumbles(i, j) {
            // Vertices are always placed in the frame of the lower body, for either order of the arguments.
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

    /// The first contact, on the straight path of the step, of two bodies that meet at its end; in the world. `None`
    /// if the bodies do not move relative to each other.
    pub(super) fn contact_on_way(&self, end: &State, i: usize, j: usize) -> Option<Contact> {
        self.bodies.need_bvh(i);
        self.bodies.need_bvh(j);
        let (start, end) = (&self.before.position, &end.position);
        let offset = start[j] - start[i];
        let motion = (end[j] - end[i]) - offset;
        let forms = self.bodies.forms(i, j);
        let contact = forms.and_then(|(a, b)| collide::first_contact(a, b, offset, motion));
        // Bodies that meet after a motion have touched on the way. If rounding hides the place, reverse the motion
        // itself.
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

    /// Resolves a contact of two bodies on the path of the step, by their restitution.
    pub(super) fn exchange_on_way(
        &self,
        bodies: (usize, usize),
        contact: &Contact,
        end: &mut State,
    ) -> Option<Impact> {
        let at = self.on_way(bodies, contact, end);
        self.exchange(bodies, contact, &mut end.velocity, at)
    }

    /// The time of a contact of two bodies on the path of the step, and their positions at that time.
    pub(super) fn on_way(&self, (i, j): (usize, usize), contact: &Contact, end: &State) -> Instant {
        let part = contact.time;
        let place = |body: usize| self.before.position[body].lerp(end.position[body], part);
        Instant {
            time: self.time + part * self.settings.dt,
            positions: (place(i), place(j)),
            // The rotations of turning bodies are not computed here.
            rotations: (DQuat::IDENTITY, DQuat::IDENTITY),
        }
    }

    /// Resolves a contact of two bodies by their restitution, if they approach each other. The contact's point is in
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
