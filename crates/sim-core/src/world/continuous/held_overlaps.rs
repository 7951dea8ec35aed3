//! Overlaps get no deeper.
//!
//! Bodies in overlap are kept from closing along their shortest way out, as bodies in contact are along
//! a normal. That is all there is to it in flat surfaces; but across that way they may slide to where
//! they are deeper in each other, and what begins to part may fall back within a step, where nobody
//! looks for an impact of the two. A step in which an overlap gets deeper than it was where the bodies
//! were placed is taken again, with the two *held*: they move as one. That takes energy, as an impact
//! without restitution does, and gives none.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::{Bundled, Impact, World, state::State, stepping::Cause};
use super::{
    Continuous,
    contact_set::{ContactConstraint, ContactSet},
};

/// Gaps of bodies in contact by which an overlap may get deeper: more than rounding and an iterative
/// solver move what is held.
const SLACK: f64 = 16.0;

/// What a step starts from, to be taken again.
struct Start {
    current: State,
    contacts: ContactSet,
    placed: bool,
    impacts: (u64, Option<Impact>),
    reported: Option<usize>,
}

impl Continuous {
    /// How deep two bodies in overlap were in each other where they were placed, m.
    pub(in crate::world) fn depth_at_start(&self, i: usize, j: usize) -> Option<f64> {
        self.depth_at_start.get(&(i, j)).copied()
    }
}

impl World {
    /// Does what is in a step, again where an overlap would get deeper.
    pub(super) fn collide_without_deepening(&mut self) -> Result<(), (usize, Cause)> {
        if self.overlapping.is_empty() {
            return self.collide_once();
        }
        let start = Start {
            current: self.current.clone(),
            contacts: self.contacts.clone(),
            placed: self.continuous.placed,
            impacts: (self.impacts, self.last_impact.clone()),
            reported: self.report.as_ref().map(Vec::len),
        };
        let mut done = self.collide_once();
        while done.is_ok() && self.hold_deepened() {
            self.start_again(&start);
            done = self.collide_once();
        }
        self.continuous.held.clear();
        self.contacts.retain(|constraint| !constraint.is_hold);
        done
    }

    fn start_again(&mut self, start: &Start) {
        self.current.clone_from(&start.current);
        self.contacts.clone_from(&start.contacts);
        self.continuous.placed = start.placed;
        (self.impacts, self.last_impact) = start.impacts.clone();
        if let Some((report, reported)) = self.report.as_mut().zip(start.reported) {
            report.truncate(reported);
        }
        self.bundled = Bundled::default();
        self.continuous.wake_all();
    }

    /// Whether the last step has left a body where it was.
    pub(super) fn stood_still(&self, body: usize) -> bool {
        self.earlier.position.get(body) == Some(&self.previous.position[body])
    }

    /// Notes the pairs to be held that have got deeper, and tells whether there are new ones.
    fn hold_deepened(&mut self) -> bool {
        let deepened = |&&(i, j): &&(usize, usize)| {
            let Some(start) = self.continuous.depth_at_start(i, j) else {
                return false;
            };
            let stands = |body: usize| self.current.position[body] == self.previous.position[body];
            if stands(i) && stands(j) {
                return false;
            }
            let most = start + SLACK * self.hover_gap(i, j);
            let offset = self.current.position[j] - self.current.position[i];
            !self.is_held(i, j)
                && self.bodies.meet_at(i, j, offset)
                && self.penetration(i, j, offset).depth > most
        };
        let new: Vec<(usize, usize)> = self.overlapping.iter().filter(deepened).copied().collect();
        self.continuous.held.extend(&new);
        self.continuous.held.sort_unstable();
        !new.is_empty()
    }

    /// Whether two bodies in overlap move as one in this step.
    pub(super) fn is_held(&self, i: usize, j: usize) -> bool {
        self.continuous.held.binary_search(&(i, j)).is_ok()
    }

    /// Keeps bodies in overlap from closing, also where they have begun to part and forces have turned
    /// them back.
    pub(super) fn keep_overlap_contacts(&mut self) {
        for place in 0..self.overlapping.len() {
            let (i, j) = self.overlapping[place];
            let is_overlap = |known: &ContactConstraint| known.is_overlap;
            if (self.bodies.is_movable(i) || self.bodies.is_movable(j))
                && !self.contacts.of_pair(i, j).any(is_overlap)
            {
                let at = &self.previous.position;
                let out = self.penetration(i, j, at[j] - at[i]);
                self.add_contact(self.overlap_contact((i, j), out.normal));
            }
        }
    }

    /// Keeps bodies that are held from moving against each other in any way.
    pub(super) fn hold_still(&mut self) {
        for place in 0..self.continuous.held.len() {
            let (i, j) = self.continuous.held[place];
            let known = self.contacts.of_pair(i, j).find(|known| known.is_overlap);
            let Some(&known) = known else { continue };
            let (one, other) = known.normal.any_orthonormal_pair();
            for normal in [-known.normal, one, -one, other, -other] {
                self.add_contact(ContactConstraint {
                    is_hold: true,
                    ..self.overlap_contact((i, j), normal)
                });
            }
        }
    }

    fn overlap_contact(&self, (i, j): (usize, usize), normal: DVec3) -> ContactConstraint {
        let gap = self.hover_gap(i, j);
        ContactConstraint {
            is_overlap: true,
            ..ContactConstraint::new((i, j), normal, gap, DVec3::ZERO)
        }
    }

    /// Notes how deep bodies are in each other where they have been placed.
    pub(super) fn note_depth(&mut self, pair: (usize, usize), depth: f64) {
        self.continuous.depth_at_start.entry(pair).or_insert(depth);
    }

    /// Forgets how deep bodies were in each other that are so no more.
    pub(in crate::world) fn forget_depths(&mut self) {
        let pairs = &self.overlapping;
        let depths = &mut self.continuous.depth_at_start;
        depths.retain(|pair, _| pairs.binary_search(pair).is_ok());
    }
}
