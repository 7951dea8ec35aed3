//! The time of each phase of a step, on request.

use alloc::vec::Vec;

use super::{Impact, StepError, World, record::Record};

/// A part of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Motion under forces.
    Integrate,
    /// Which bodies come near each other.
    Broad,
    /// Whether and when two bodies that are near meet.
    Narrow,
    /// Impulses, and contacts that last.
    Respond,
}

impl Phase {
    /// All of them, in the order of a step.
    pub const ALL: [Phase; 4] = [
        Phase::Integrate,
        Phase::Broad,
        Phase::Narrow,
        Phase::Respond,
    ];
}

/// Time spent in each phase, in units of the clock that has been handed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile([u64; Phase::ALL.len()]);

impl Profile {
    /// Time spent in a phase.
    pub fn spent(&self, phase: Phase) -> u64 {
        self.0[phase as usize]
    }
}

/// Reads a clock where one phase ends and the next begins.
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
    /// [`World::step_reporting`], adding to a profile the time that each phase takes, as `clock` counts it.
    ///
    /// Other steps read no clock. Here it is read some times a step, and twice for each impact.
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
    /// Another phase begins; tells which one ends.
    pub(super) fn enter(&mut self, phase: Phase) -> Phase {
        let Some(timer) = &mut self.timer else {
            return phase;
        };
        let before = timer.phase;
        timer.enter(phase);
        before
    }
}
