//! What goes on bearing a body where what it slides on ends.
//!
//! Tiles are bodies that end where others begin. A body that slides from one to the next lies on both for
//! a while and is in contact with the first one only: it hovers over the second one at the same gap.
//! Where the one contact ends the other one begins, so that nothing falls by that gap.

use alloc::vec::Vec;
use core::mem;

use super::super::World;
use super::contact_motion::Surface;
use super::contact_set::ContactConstraint;

/// What normals of level surfaces may be off by.
const LEVEL: f64 = 1e-9;

/// How far ahead is looked for a surface, in gaps of bodies in contact.
const AHEAD: f64 = 16.0;

/// How often a body is handed over in a step at most, about, as contacts may end as they begin.
const MOST_HANDED: u32 = 8;

impl World {
    /// Finds the contacts of the bodies of one that ends with others that are level with it, and tells
    /// whether there are any.
    pub(super) fn hand_over(&mut self, ended: &ContactConstraint) -> bool {
        // Where bodies have just been placed all contacts are new.
        if ended.is_overlap || !self.continuous.knows_near {
            return false;
        }
        let (i, j) = ended.bodies;
        let before = self.contacts.all().len();
        for body in [i, j] {
            let handed = self.continuous.handed.get(body).copied().unwrap_or(0);
            if !self.is_movable(body) || handed >= MOST_HANDED {
                continue;
            }
            let mut partners: Vec<usize> = mem::take(&mut self.continuous.partners);
            partners.clear();
            let broad = &self.continuous.broad;
            broad.each_partner(body, |other| partners.push(other));
            for &other in &partners {
                let bodies = (body.min(other), body.max(other));
                // Up from what bears it.
                let normal = match (body == j) == (body == bodies.1) {
                    true => ended.normal,
                    false => -ended.normal,
                };
                if bodies == ended.bodies || !self.may_collide(bodies.0, bodies.1) {
                    continue;
                }
                self.need_bvh(body);
                self.need_bvh(other);
                let level = ContactConstraint {
                    bodies,
                    normal,
                    ..*ended
                };
                if let Some(level) = self.level_with(&level) {
                    let count = self.len();
                    self.continuous.handed.resize(count, 0);
                    self.continuous.handed[body] += 1;
                    self.add_contact(level);
                }
            }
            self.continuous.partners = partners;
        }
        self.contacts.all().len() > before
    }

    /// A contact along a normal, if two bodies are no farther apart than those in contact and have none
    /// like it.
    fn level_with(&self, level: &ContactConstraint) -> Option<ContactConstraint> {
        let (i, j) = level.bodies;
        let is_known = |known: &ContactConstraint| known.normal.dot(level.normal) > 1.0 - LEVEL;
        if self.contacts.of_pair(i, j).any(is_known) {
            return None;
        }
        let start = &self.continuous.start;
        let hover = self.hover_gap(i, j);
        let offset = start.position[j] - start.position[i];
        // Where a vertex is above one, the surface ahead is.
        let ahead = start.velocity[j] - start.velocity[i];
        let ahead = AHEAD * hover * ahead.normalize_or_zero();
        // What lies on the other side of a body is found as if it were in it.
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
            ..*level
        })
    }
}
