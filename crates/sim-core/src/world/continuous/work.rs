//! The work of a step beyond what it would cost without impacts, and its limits.
//!
//! Impacts of free bodies cost little, and there may be very many ([`World::MOST_IMPACTS`]). If a method computes the
//! trajectory, each evaluation of a position is a step of the method, with all coupled bodies. A method with error
//! control takes steps of its own in each of these. Turning bodies are followed by certificates. If speeds and forces
//! are far out of proportion to sizes, this work has no end. So a step may cost a fixed multiple of its cost without
//! impacts, and all its evaluations together may take as many of a method's own steps as one evaluation may. The work
//! is counted, not timed, and so it is the same on every machine and with any number of threads.
//!
//! [`World::MOST_IMPACTS`]: crate::World::MOST_IMPACTS

use super::super::{bodies::Bodies, stepping::Cause};
use crate::integrate::adaptive::MOST_STEPS;

/// The greatest number of bodies moved by the method, for each body of the world.
const MOST_MOVED: u64 = 1 << 14;

/// The greatest number of certified pairs of boxes and of pieces, for each body of the world.
const MOST_CERTIFIED: u64 = 1 << 18;

/// The work done.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::world) struct Work {
    /// Bodies that were moved by the method to some time within the step.
    pub(super) moved: u64,
    /// Bodies that were moved by each step that a method with error control has tried for these times.
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

    /// Returns an error at the movable one of two bodies if the work is too much for the world.
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
