//! Contacts with the next body if the surface below a sliding body ends.
//!
//! Tiles are bodies that end where others begin. A body that slides from one tile to the next is above both for a
//! while, but in contact with the first one only. Above the second one it has the same gap. When the first contact
//! ends, the second one begins, so that the body does not fall by that gap.

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

use super::super::stepping::Cause;
use super::{
    contact_motion::Surface, contact_set::ContactConstraint, solver::ContactSolver, view::View,
};

/// The greatest difference of the normals of level surfaces.
const LEVEL: f64 = 1e-9;

/// How far ahead a surface is searched, in gaps of bodies in contact.
const AHEAD: f64 = 16.0;

/// The greatest number of handovers of a body in a step, approximately, because contacts may end as soon as they
/// begin.
const MOST_HANDED: u32 = 8;

impl ContactSolver<'_> {
    /// Hands over bodies whose contacts end. Returns whether another body now supports any of them.
    pub(super) fn hand_over_all(
        &mut self,
        ended: &[ContactConstraint],
    ) -> Result<bool, (usize, Cause)> {
        let before = self.contacts.all().len();
        for constraint in ended {
            self.hand_over(constraint)?;
        }
        Ok(self.contacts.all().len() > before)
    }

    /// When a contact ends, finds contacts of its bodies with other bodies that are level with it. The trajectories
    /// of its bodies start at this time.
    pub(super) fn hand_over(&mut self, ended: &ContactConstraint) -> Result<(), (usize, Cause)> {
        // If bodies were just placed, all contacts are new.
        if ended.is_overlap || !self.knows_near() {
            return Ok(());
        }
        let (i, j) = ended.bodies;
        for body in [i, j] {
            let handed = self.tallies.handed.get(body).copied().unwrap_or(0);
            if !self.scene.bodies.is_movable(body) || handed >= MOST_HANDED {
                continue;
            }
            let mut partners: Vec<usize> = mem::take(&mut self.near.partners);
            partners.clear();
            let broad = &self.near.broad;
            broad.each_partner(body, |other| partners.push(other));
            for &other in &partners {
                let bodies = (body.min(other), body.max(other));
                // Away from the supporting body.
                let up = match (body == j) == (body == bodies.1) {
                    true => 1.0,
                    false => -1.0,
                };
                if bodies == ended.bodies || !self.scene.may_collide(bodies.0, bodies.1) {
                    continue;
                }
                self.scene.bodies.need_bvh(body);
                self.scene.bodies.need_bvh(other);
                let level = ContactConstraint {
                    bodies,
                    normal: up * ended.normal,
                    friction: up * ended.friction,
                    ahead: None,
                    ..*ended
                };
                let time = self.paths.since[body];
                let mut probe = mem::take(&mut self.paths.probe);
                let there = self.view().motion().motion_at(other, time, &mut probe);
                self.paths.probe = probe;
                let (at, moving) = there?;
                let start = &self.paths.start;
                let sign = if body == bodies.1 { 1.0 } else { -1.0 };
                let offset = sign * (start.position[body] - at);
                let velocity = sign * (start.velocity[body] - moving);
                if let Some(level) = self.view().level_with(&level, offset, velocity) {
                    let count = self.scene.bodies.len();
                    self.tallies.handed.resize(count, 0);
                    self.tallies.handed[body] += 1;
                    self.add_contact(level);
                }
            }
            self.near.partners = partners;
        }
        Ok(())
    }
}

impl View<'_> {
    /// A contact like `level` along its normal, if two bodies are no farther apart than bodies in contact and have no
    /// such contact yet. `offset` and `velocity` are those of the second body relative to the first.
    fn level_with(
        &self,
        level: &ContactConstraint,
        offset: DVec3,
        velocity: DVec3,
    ) -> Option<ContactConstraint> {
        let (i, j) = level.bodies;
        let is_known = |known: &ContactConstraint| known.normal.dot(level.normal) > 1.0 - LEVEL;
        if self.contacts.of_pair(i, j).any(is_known) {
            return None;
        }
        let hover = self.layout().hover_gap(i, j);
        // If a vertex is exactly above a vertex, the surface a little ahead is found instead.
        let ahead = AHEAD * hover * velocity.normalize_or_zero();
        // A surface on the other side of a body is found as if the two were in overlap, without a positive distance.
        let is_level = |surface: &Surface| {
            surface.distance > 0.0 && (surface.normal - level.normal).length() <= LEVEL
        };
        let mut surfaces = [offset, offset + ahead.reject_from_normalized(level.normal)]
            .into_iter()
            .filter_map(|offset| self.surface_below(level, offset, 4.0 * hover));
        let surface = surfaces.find(is_level)?;
        Some(ContactConstraint {
            normal: surface.normal,
            gap: surface.distance,
            point: surface.point,
            target: 0.0,
            is_turning: false,
            ends_at: f64::INFINITY,
            impulse: 0.0,
            ahead: None,
            ..*level
        })
    }
}
