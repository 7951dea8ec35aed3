//! The data that a step reads and does not change.

use super::{
    Settings,
    bodies::Bodies,
    forces::Forces,
    order::{self, InOrder, Key},
    overlap::Overlaps,
    state::State,
};

/// The scene of a world. A macro, so that other fields of the world can be borrowed mutably at the same time.
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

/// The data of a world for one step.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) settings: &'a Settings,
    pub(super) bodies: &'a Bodies,
    pub(super) forces: &'a Forces,
    /// The motion at the start of this step, and of the step before.
    pub(super) before: &'a State,
    pub(super) earlier: &'a State,
    /// The time at the start of the step, s.
    pub(super) time: f64,
    /// The number of the step, from 1.
    pub(super) step: u64,
    pub(super) overlaps: &'a Overlaps,
}

impl Scene<'_> {
    /// Whether two bodies with shapes can have an impact: one is movable, no filter keeps them from colliding, and
    /// they are not a pair that was placed in overlap and has not parted since.
    #[inline]
    pub(super) fn may_collide(&self, i: usize, j: usize) -> bool {
        let pair = (i.min(j), i.max(j));
        self.bodies.may_meet(i, j) && self.overlaps.pairs.binary_search(&pair).is_err()
    }

    /// The key that distinguishes a body from others: its motion at the start of the step.
    pub(super) fn motion_key(&self, body: usize) -> Key {
        order::key(self.bodies, self.before, body)
    }

    /// Some bodies, each once, in the order of their keys.
    pub(super) fn in_order(&self, these: impl Iterator<Item = usize>) -> InOrder {
        order::in_order(self.bodies, self.before, these)
    }

    /// Whether the previous step did not move a body.
    pub(super) fn stood_still(&self, body: usize) -> bool {
        self.earlier.position.get(body) == Some(&self.before.position[body])
    }
}
