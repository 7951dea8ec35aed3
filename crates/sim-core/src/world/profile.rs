//! The time of each phase of a step, on request.

use alloc::vec::Vec;

use super::{Impact, StepError, World, record::Record};

/// A part of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The motion under forces.
    Integrate,
    /// The search for pairs that come near each other.
    Broad,
    /// The tests whether and when near pairs meet.
    Narrow,
    /// Impulses, and lasting contacts.
    Respond,
}

impl Phase {
    /// All phases, in the order of a step.
    pub const ALL: [Phase; 4] = [
        Phase::Integrate,
        Phase::Broad,
        Phase::Narrow,
        Phase::Respond,
    ];
}

/// The time spent in each phase, in units of the given clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile([u64; Phase::ALL.len()]);

impl Profile {
    /// The time spent in a phase.
    pub fn spent(&self, phase: Phase) -> u64 {
        self.0[phase as usize]
    }
}

/// Reads a clock between phases.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timer {
    clock: fn() -> u64,
    phase: Phase,
    since: u64,
    profile: Profile,
}

impl Timer {
    fn enter(&mut self, phase: Phase) {
        let now = (self.clock)();
        self.profile.0[self.phase as usize] += now.saturating_sub(self.since);
        (self.phase, self.since) = (phase, now);
    }
}

impl World {
    /// [`World::step_reporting`], which adds the time of each phase to a profile, in units of `clock`.
    ///
    /// Other steps read no clock. This one reads it a few times a step, and twice for each impact.
    pub fn step_profiled(
        &mut self,
        impacts: &mut Vec<Impact>,
        clock: fn() -> u64,
        profile: &mut Profile,
    ) -> Result<(), StepError> {
        self.record.timer = Some(Timer {
            clock,
            phase: Phase::Integrate,
            since: clock(),
            profile: *profile,
        });
        let outcome = self.step_reporting(impacts);
        if let Some(mut timer) = self.record.timer.take() {
            timer.enter(Phase::Integrate);
            *profile = timer.profile;
        }
        outcome
    }
}

impl Record {
    /// Begins another phase; returns the one that ends.
    pub(super) fn enter(&mut self, phase: Phase) -> Phase {
        let Some(timer) = &mut self.timer else {
            return phase;
        };
        let before = timer.phase;
        timer.enter(phase);
        before
    }
}
