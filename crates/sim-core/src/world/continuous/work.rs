//! What a step costs beside what it would cost without impacts, and how much of that is too much.
//!
//! Impacts of free bodies cost little, and may be very many ([`World::MOST_IMPACTS`]). Where a method
//! makes the trajectory, each question where a body is is a step of the method, of all that it is stepped
//! with, and one with error control takes steps of its own in each; and turning bodies are followed by
//! certificates. At speeds and forces far out of proportion to sizes all of it is asked without end. So a
//! step may cost what it costs without impacts times a number, and all its questions together as many of a
//! method's own steps as one may have. It is counted, not timed, and so the same on every machine and on any
//! number of threads.
//!
//! [`World::MOST_IMPACTS`]: crate::World::MOST_IMPACTS

use super::super::{bodies::Bodies, stepping::Cause};
use crate::integrate::adaptive::MOST_STEPS;

/// Bodies moved by the method, for each body of the world.
const MOST_MOVED: u64 = 1 << 14;

/// Pairs of boxes and of pieces certified, for each body of the world.
const MOST_CERTIFIED: u64 = 1 << 20;

/// What has been done.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::world) struct Work {
    /// Bodies that were moved by the method to some time within the step.
    pub(super) moved: u64,
    /// Bodies that were moved by each step that a method with error control has tried for that.
    pub(super) tried: u64,
    /// Pairs of boxes and of pieces that were certified to be apart.
    pub(super) certified: u64,
}

impl Work {
    #[cfg(feature = "rayon")]
    pub(super) fn is_none(&self) -> bool {
        self.moved == 0 && self.tried == 0 && self.certified == 0
    }

    pub(super) fn add(&mut self, other: Work) {
        self.moved += other.moved;
        self.tried += other.tried;
        self.certified += other.certified;
    }

    /// An error, at that of two bodies which moves, if this is too much for a world.
    pub(super) fn check(
        &self,
        (i, j): (usize, usize),
        bodies: &Bodies,
    ) -> Result<(), (usize, Cause)> {
        let all = bodies.len() as u64;
        if self.moved <= MOST_MOVED * all
            && self.tried <= u64::from(MOST_STEPS) * all
            && self.certified <= MOST_CERTIFIED * all
        {
            return Ok(());
        }
        let body = if bodies.is_movable(i) { i } else { j };
        Err((body, Cause::Work))
    }
}
