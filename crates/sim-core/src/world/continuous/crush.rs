//! Bodies without room between two immovable bodies that close on each other.
//!
//! Elastic bodies have finitely many impacts with each other and with bodies that stand still, though there may be
//! millions (Burago, Ferleger, Kononenko 1998, "Uniform estimates on the number of collisions in semi-dispersing
//! billiards", Ann. of Math. 147, p. 695). This does not hold for immovable bodies that approach each other: `n`
//! impacts with them leave about `1/n` of the room, and there is no last one.
//!
//! So this module counts how often a body goes from one immovable body to another. In a row of bodies between them,
//! each body meets at most one of them. Therefore bodies that meet exchange the last immovable bodies stored for
//! them, as equal bodies in a row exchange their velocities, and the count also works along the row.

use alloc::vec::Vec;

use super::super::stepping::Cause;
use super::{
    event::{Event, EventKind},
    view::View,
};

/// The number of times in a step that a body may go from one immovable body to another that moves against it, before
/// it counts as having no room. A ball then has about 1e-5 of its former room.
const MAX_KINEMATIC_IMPACTS: u32 = 1 << 16;

/// The impacts with immovable bodies in a step.
#[derive(Clone, Debug, Default)]
pub(super) struct CrushDetector {
    /// By body, the last immovable body that it met, and the last one before with another velocity; empty until a
    /// body has met one.
    walls: Vec<[Option<usize>; 2]>,
    /// By body, the number of impacts with an immovable body after another one of another velocity.
    impacts: Vec<u32>,
}

impl CrushDetector {
    /// Begins a step.
    pub(super) fn begin(&mut self) {
        self.walls.clear();
        self.impacts.clear();
    }

    /// The two immovable bodies that move relative to each other and that a body has met.
    pub(super) fn between(&self, body: usize) -> Option<(usize, usize)> {
        let [last, other] = *self.walls.get(body)?;
        let (last, other) = last.zip(other)?;
        Some((last.min(other), last.max(other)))
    }
}

impl View<'_> {
    /// Counts impacts with immovable bodies, and returns an error if they would go on for ever.
    pub(super) fn watch(
        &self,
        group: &[Event],
        crush: &mut CrushDetector,
    ) -> Result<(), (usize, Cause)> {
        for event in group {
            if event.kind != EventKind::Impact {
                continue;
            }
            let (i, j) = event.bodies;
            let (wall, body) = match (
                self.scene.bodies.is_movable(i),
                self.scene.bodies.is_movable(j),
            ) {
                (true, true) => {
                    if !crush.walls.is_empty() {
                        crush.walls.swap(i, j);
                    }
                    continue;
                }
                (true, false) => (j, i),
                (false, _) => (i, j),
            };
            crush.walls.resize(self.scene.bodies.len(), [None; 2]);
            crush.impacts.resize(self.scene.bodies.len(), 0);
            let velocity = |wall: usize| self.scene.before.velocity[wall];
            let walls = &mut crush.walls[body];
            match walls[0] {
                Some(last) if velocity(last) != velocity(wall) => {
                    *walls = [Some(wall), Some(last)];
                    crush.impacts[body] += 1;
                }
                _ => walls[0] = Some(wall),
            }
            if crush.impacts[body] > MAX_KINEMATIC_IMPACTS
                && let Some(between) = crush.between(body)
            {
                return Err((body, Cause::Squeezed(between)));
            }
        }
        Ok(())
    }
}
