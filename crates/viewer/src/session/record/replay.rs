//! Replays of recorded runs.

use std::fmt;

use sim_core::{StepError, World};

use super::Record;
use super::input::InputError;

/// A record with which the run is compared as it continues.
#[derive(Clone, Debug)]
pub struct Replay {
    /// The record.
    pub record: Record,
    /// The number of inputs made.
    pub made: usize,
    /// The first different state.
    pub divergence: Option<Divergence>,
}

/// A state that differs from the recorded one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// The number of steps before it; 0 is the start.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// The recorded hash, and that of this run.
    pub hashes: [u64; 2],
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { step, time, hashes } = self;
        let [recorded, own] = hashes;
        write!(
            f,
            "differs from the record at step {step}, t = {time} s: state hash {own:016x}, recorded {recorded:016x}"
        )
    }
}

impl Replay {
    /// At the start of a record.
    pub fn new(record: Record) -> Self {
        Self {
            record,
            made: 0,
            divergence: None,
        }
    }

    /// Steps until the next input is due or the record ends.
    pub fn steps_ahead(&self, step: u64) -> u64 {
        let next = self.record.inputs.get(self.made);
        let until = next.map_or(self.record.steps(), |&(after, _)| after);
        until.saturating_sub(step)
    }

    /// Compares a state with the recorded one.
    pub fn compare(&mut self, step: u64, time: f64, hash: u64) {
        let recorded = usize::try_from(step)
            .ok()
            .and_then(|step| self.record.hashes.get(step));
        if let Some(&recorded) = recorded.filter(|&&recorded| recorded != hash) {
            let hashes = [recorded, hash];
            self.divergence
                .get_or_insert(Divergence { step, time, hashes });
        }
    }
}

/// The result of a replay.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The number of steps.
    pub steps: u64,
    /// The number of inputs.
    pub inputs: usize,
    /// The first different state.
    pub divergence: Option<Divergence>,
    /// The last state of the replay.
    pub world: World,
}

/// The reason why a replay fails.
#[derive(Debug)]
pub enum ReplayError {
    /// No world can be made from the scene.
    Scene(scene::SceneError),
    /// A step fails.
    Step(StepError),
    /// An input is refused, after so many steps.
    Input(u64, InputError),
}

/// Runs a record again until it ends or `go_on`, called with the number of steps taken, returns false. Compares all
/// states up to the first difference.
pub fn verify(record: Record, mut go_on: impl FnMut(u64) -> bool) -> Result<Verdict, ReplayError> {
    let mut world = record.scene.world().map_err(ReplayError::Scene)?;
    let mut replay = Replay::new(record);
    replay.compare(0, 0.0, world.state_hash());
    loop {
        let step = world.steps();
        while let Some((after, input)) = replay.record.inputs.get(replay.made)
            && *after <= step
        {
            input
                .apply(&mut world)
                .map_err(|error| ReplayError::Input(step, error))?;
            replay.made += 1;
        }
        let is_over = step >= replay.record.steps() || replay.divergence.is_some();
        if is_over || !go_on(step) {
            break;
        }
        world.step().map_err(ReplayError::Step)?;
        replay.compare(world.steps(), world.time(), world.state_hash());
    }
    Ok(Verdict {
        steps: world.steps(),
        inputs: replay.made,
        divergence: replay.divergence,
        world,
    })
}
