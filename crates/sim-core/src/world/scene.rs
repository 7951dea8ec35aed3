//! The data that a step reads and does not change.

use super::{
    Settings,
    bodies::Bodies,
    forces::Forces,
    order::{self, InOrder, Key},
    overlap::Overlaps,
    state::State,
};

/// The scene of a world, of whose other fields something may be borrowed for a change.
macro_rules! scene {
    ($world:expr) => {
        $crate::world::scene::Scene {
            settings: &$world.settings,
            bodies: &$world.bodies,
            forces: &$world.forces,
            before: &$world.previous,
            earlier: &$world.earlier,
            time: $world.elapsed.time(&$world.settings),
            step: $world.elapsed.steps + 1,
            overlaps: &$world.overlaps,
        }
    };
}
pub(super) use scene;

/// A world as a step finds it.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) settings: &'a Settings,
    pub(super) bodies: &'a Bodies,
    pub(super) forces: &'a Forces,
    /// Motion where the step starts, and where the one before it did.
    pub(super) before: &'a State,
    pub(super) earlier: &'a State,
    /// When the step starts, s.
    pub(super) time: f64,
    /// Its number, from 1.
    pub(super) step: u64,
    pub(super) overlaps: &'a Overlaps,
}

impl Scene<'_> {
    /// Whether two bodies with shapes can have an impact: not if nothing moves either, nor if they are
    /// filtered, nor if they began in overlap and have not parted since.
    #[inline]
    pub(super) fn may_collide(&self, i: usize, j: usize) -> bool {
        let pair = (i.min(j), i.max(j));
        self.bodies.may_meet(i, j) && self.overlaps.pairs.binary_search(&pair).is_err()
    }

    /// What tells a body from others: its motion where the step begins.
    pub(super) fn motion_key(&self, body: usize) -> Key {
        order::key(self.bodies, self.before, body)
    }

    /// Some bodies, once each, in that order.
    pub(super) fn in_order(&self, these: impl Iterator<Item = usize>) -> InOrder {
        order::in_order(self.bodies, self.before, these)
    }

    /// Whether the step before has left a body where it was.
    pub(super) fn stood_still(&self, body: usize) -> bool {
        self.earlier.position.get(body) == Some(&self.before.position[body])
    }
}
