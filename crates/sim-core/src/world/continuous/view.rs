//! A read-only view of a step in the continuous mode.

use alloc::vec::Vec;

use glam::DQuat;

use super::super::{exchange::Instant, layout::Layout, order::ordinal, scene::Scene};
use super::{
    contact_set::{ContactConstraint, ContactSet},
    event::Event,
    tallies::Tallies,
    trajectory::{Motion, Trajectories},
};
use crate::collide::Contact;

/// The present trajectories and contacts.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) paths: &'a Trajectories,
    pub(super) contacts: &'a ContactSet,
    pub(super) tallies: &'a Tallies,
    /// By body, whether it is asleep: at rest until another body comes; empty if no body is.
    pub(super) asleep: &'a [bool],
    /// Pairs in overlap that move as one body in this step.
    pub(super) held: &'a [(usize, usize)],
}

impl<'a> View<'a> {
    #[inline]
    pub(super) fn motion(&self) -> Motion<'a> {
        Motion {
            scene: self.scene,
            paths: self.paths,
        }
    }

    /// The bodies at the ends of their trajectories.
    #[inline]
    pub(super) fn layout(&self) -> Layout<'a> {
        Layout {
            bodies: self.scene.bodies,
            at: &self.paths.end.position,
            turned: &self.paths.end.turned,
            before: self.scene.before,
            contacts: self.contacts,
            overlaps: self.scene.overlaps,
        }
    }

    /// Sorts events of one time in an order that does not depend on the indices of bodies.
    pub(super) fn sort_events(&self, events: &mut [Event]) {
        if events.len() < 2 {
            return;
        }
        let order = self.scene.in_order(
            events
                .iter()
                .flat_map(|event| [event.bodies.0, event.bodies.1]),
        );
        events.sort_by_cached_key(|event| {
            let time = ordinal(event.time);
            (time, order.between(event.bodies, event.contact.normal))
        });
    }

    /// The contacts of awake bodies, in an order that does not depend on the indices of bodies.
    pub(super) fn contacts_in_order(&self) -> Vec<usize> {
        let all = self.contacts.all();
        let is_awake = |&index: &usize| {
            let (i, j) = all[index].bodies;
            !self.is_asleep(i) && !self.is_asleep(j)
        };
        let mut awake: Vec<usize> = (0..all.len()).filter(is_awake).collect();
        let pairs = awake.iter().map(|&index| all[index].bodies);
        let order = self.scene.in_order(pairs.flat_map(|(i, j)| [i, j]));
        awake.sort_by_cached_key(|&index| order.between(all[index].bodies, all[index].normal));
        awake
    }

    /// A contact as an impact at a time.
    pub(super) fn event_of(&self, constraint: &ContactConstraint, time: f64) -> Event {
        let contact = Contact {
            time: 0.0,
            point: self.paths.start.position[constraint.bodies.0] + constraint.point,
            normal: constraint.normal,
            feature: None,
            face: None,
        };
        Event::impact(time, constraint.bodies, contact, 0.0, &self.paths.version)
    }

    /// The positions and rotations of two bodies that have an impact at a time, s from the step's start, at which the
    /// trajectories of the movable ones start.
    pub(super) fn instant(&self, bodies: (usize, usize), time: f64) -> Instant {
        let scene = self.scene;
        let place = |body: usize| match scene.bodies.is_movable(body) {
            true => self.paths.start.position[body],
            false => {
                let part = time / scene.settings.dt;
                scene.before.position[body].lerp(self.paths.end.position[body], part)
            }
        };
        let turned = |body: usize| match scene.bodies.turners.slot(body) {
            Some(slot) => {
                let there = self.motion().turned_at(slot, body, time);
                scene.bodies.rotation_of(slot, &there)
            }
            None => DQuat::IDENTITY,
        };
        Instant {
            time: scene.time + time,
            positions: (place(bodies.0), place(bodies.1)),
            rotations: (turned(bodies.0), turned(bodies.1)),
        }
    }
}
