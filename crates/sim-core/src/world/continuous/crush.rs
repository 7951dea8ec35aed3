//! Bodies without room between two that close on each other.
//!
//! Elastic bodies have finitely many impacts with each other and with what stands still (Burago,
//! Ferleger, Kononenko 1998, "Uniform estimates on the number of collisions in semi-dispersing
//! billiards", Ann. of Math. 147, p. 695), be they millions. Immovable ones that come together are
//! another matter: `n` impacts with them leave about `1/n` of the room, and there is no last one.

use alloc::vec::Vec;

use super::super::{World, stepping::Cause};
use super::Event;

/// Impacts in a step of one body with immovable ones, after which it has no room if those move
/// against each other: to a ball they leave some 1e-5 of what it had.
const MAX_KINEMATIC_IMPACTS: u32 = 1 << 16;

/// What immovable bodies have done in a step.
#[derive(Clone, Debug, Default)]
pub(super) struct CrushDetector {
    /// The last one in an impact, and the last before it of another velocity.
    walls: [Option<usize>; 2],
    /// Impacts of each body with one since there were both; empty until then.
    impacts: Vec<u32>,
}

impl World {
    /// Notes impacts with immovable bodies, and stops where they would go on for ever.
    pub(super) fn watch(
        &self,
        group: &[Event],
        crush: &mut CrushDetector,
    ) -> Result<(), (usize, Cause)> {
        for &Event { bodies: (i, j), .. } in group {
            let (wall, body) = match (self.mass[i].is_finite(), self.mass[j].is_finite()) {
                (true, true) => continue,
                (true, false) => (j, i),
                (false, _) => (i, j),
            };
            let velocity = |wall: usize| self.previous.velocity[wall];
            match crush.walls {
                [Some(last), _] if velocity(last) != velocity(wall) => {
                    crush.walls = [Some(wall), Some(last)];
                }
                [_, other] => crush.walls = [Some(wall), other],
            }
            if let Some(other) = crush.walls[1] {
                crush.impacts.resize(self.len(), 0);
                crush.impacts[body] += 1;
                if crush.impacts[body] > MAX_KINEMATIC_IMPACTS {
                    let between = (wall.min(other), wall.max(other));
                    return Err((body, Cause::Squeezed(between)));
                }
            }
        }
        Ok(())
    }
}
