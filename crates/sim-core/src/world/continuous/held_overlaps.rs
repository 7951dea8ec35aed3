//! Overlaps get no deeper.
//!
//! Bodies in overlap are kept from closing along their shortest way out, as bodies in contact are along a normal.
//! This is sufficient if their surfaces are flat. Otherwise they may slide across that way to a place where the
//! overlap is deeper, or begin to separate and fall back within a step, in which no impact of the two is searched. If
//! an overlap gets deeper in a step than it was where the bodies were placed, the step is taken again with the two
//! *held*: they move as one body. Like an impact without restitution, this takes energy and gives none.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::{
    Bundled, World, layout::Layout, record::Checkpoint, state::State, stepping::Cause,
};
use super::{
    contact_set::{ContactConstraint, ContactSet},
    solver::ContactSolver,
    view::View,
};

/// How much deeper an overlap may get, in gaps of bodies in contact. It is more than rounding and an iterative solver
/// move held bodies.
const SLACK: f64 = 16.0;

/// The state at the start of a step, so that the step can be taken again.
struct Start {
    current: State,
    contacts: ContactSet,
    placed: bool,
    record: Checkpoint,
}

impl World {
    /// Resolves the collisions of a step, again if an overlap would get deeper.
    pub(super) fn collide_without_deepening(&mut self) -> Result<(), (usize, Cause)> {
        if self.overlaps.pairs.is_empty() {
            return self.collide_once();
        }
        let start = Start {
            current: self.current.clone(),
            contacts: self.contacts.clone(),
            placed: self.continuous.placed,
            record: self.record.checkpoint(),
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
        self.record.roll_back(&start.record);
        self.continuous.bundled = Bundled::default();
        self.continuous.wake_all();
    }

    /// Adds the pairs that have got deeper to the held ones, and returns whether there are new ones.
    fn hold_deepened(&mut self) -> bool {
        let layout = self.layout();
        let deepened = |&&(i, j): &&(usize, usize)| {
            let Some(start) = self.overlaps.depth_at_start((i, j)) else {
                return false;
            };
            let stands = |body: usize| self.current.position[body] == self.previous.position[body];
            if stands(i) && stands(j) {
                return false;
            }
            let most = start + SLACK * layout.hover_gap(i, j);
            let offset = self.current.position[j] - self.current.position[i];
            let is_held = self.continuous.held.binary_search(&(i, j)).is_ok();
            !is_held
                && self.bodies.meet_at(i, j, offset)
                && layout.penetration(i, j, offset).depth > most
        };
        let new: Vec<(usize, usize)> = self
            .overlaps
            .pairs
            .iter()
            .filter(deepened)
            .copied()
            .collect();
        self.continuous.held.extend(&new);
        self.continuous.held.sort_unstable();
        !new.is_empty()
    }
}

impl View<'_> {
    /// Whether two bodies in overlap move as one body in this step.
    pub(super) fn is_held(&self, i: usize, j: usize) -> bool {
        self.held.binary_search(&(i, j)).is_ok()
    }
}

impl Layout<'_> {
    /// The constraint that keeps two bodies in overlap from closing along a normal.
    pub(super) fn overlap_contact(
        &self,
        (i, j): (usize, usize),
        normal: DVec3,
    ) -> ContactConstraint {
        let gap = self.hover_gap(i, j);
        ContactConstraint {
            is_overlap: true,
            ..ContactConstraint::new((i, j), normal, gap, DVec3::ZERO)
        }
    }
}

impl ContactSolver<'_> {
    /// Keeps bodies in overlap from closing, also if they have begun to separate and forces have reversed their
    /// motion.
    pub(super) fn keep_overlap_contacts(&mut self) {
        for place in 0..self.scene.overlaps.pairs.len() {
            let (i, j) = self.scene.overlaps.pairs[place];
            let is_overlap = |known: &ContactConstraint| known.is_overlap;
            if (self.scene.bodies.is_movable(i) || self.scene.bodies.is_movable(j))
                && !self.scene.bodies.pair_tumbles(i, j)
                && !self.contacts.of_pair(i, j).any(is_overlap)
            {
                let at = &self.scene.before.position;
                let out = self.view().layout().penetration(i, j, at[j] - at[i]);
                let contact = self.view().layout().overlap_contact((i, j), out.normal);
                self.add_contact(contact);
            }
        }
    }

    /// Keeps held bodies from moving relative to each other.
    pub(super) fn hold_still(&mut self) {
        for place in 0..self.held.len() {
            let (i, j) = self.held[place];
            let known = self.contacts.of_pair(i, j).find(|known| known.is_overlap);
            let Some(&known) = known else { continue };
            let (one, other) = known.normal.any_orthonormal_pair();
            for normal in [-known.normal, one, -one, other, -other] {
                self.add_contact(ContactConstraint {
                    is_hold: true,
                    ..self.view().layout().overlap_contact((i, j), normal)
                });
            }
        }
    }
}
