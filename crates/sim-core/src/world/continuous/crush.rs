//! Bodies without room between two that close on each other.
//!
//! Elastic bodies have finitely many impacts with each other and with what stands still (Burago,
//! Ferleger, Kononenko 1998, "Uniform estimates on the number of collisions in semi-dispersing
//! billiards", Ann. of Math. 147, p. 695), be they millions. Immovable ones that come together are
//! another matter: `n` impacts with them leave about `1/n` of the room, and there is no last one.
//!
//! What counts is how often a body goes from one to the other. In a row between them each body meets
//! one of them at most: so bodies that meet change places in this, as equal ones in a row change their
//! velocities, and what has been at the one comes to the other from hand to hand.

use alloc::vec::Vec;

use super::super::stepping::Cause;
use super::{
    event::{Event, EventKind},
    view::View,
};

/// Ways of one body in a step from one immovable body to another that moves against it, after which it
/// has no room: to a ball they leave some 1e-5 of what it had.
const MAX_KINEMATIC_IMPACTS: u32 = 1 << 16;

/// What immovable bodies have done in a step.
#[derive(Clone, Debug, Default)]
pub(super) struct CrushDetector {
    /// Of each body the last immovable one it has been at, and the last before it of another velocity;
    /// empty until one has.
    walls: Vec<[Option<usize>; 2]>,
    /// Impacts of each body with one after another one of another velocity.
    impacts: Vec<u32>,
}

impl CrushDetector {
    /// Begins a step.
    pub(super) fn begin(&mut self) {
        self.walls.clear();
        self.impacts.clear();
    }

    /// Immovable bodies that move against each other and that a body has been at.
    pub(super) fn between(&self, body: usize) -> Option<(usize, usize)> {
        let [last, other] = *self.walls.get(body)?;
        let (last, other) = last.zip(other)?;
        Some((last.min(other), last.max(other)))
    }
}

impl View<'_> {
    /// Notes impacts with immovable bodies, and stops where they would go on for ever.
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
