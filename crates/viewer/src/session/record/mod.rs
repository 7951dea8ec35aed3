//! A run that can be had again: the scene it began with, what was done to it on the way, and a hash of
//! every state.

mod file;
mod input;
mod live;
mod replay;

use scene::Scene;
use sim_core::World;

pub use file::{RecordError, is_run_file};
pub use input::{Input, InputError};
pub use replay::{Divergence, Replay, ReplayError, Verdict, verify};

/// Steps that are recorded, at 8 bytes each; a longer run is recorded as far as that.
pub const MOST_STEPS: usize = 4_000_000;

/// A recorded run.
#[derive(Clone, Debug)]
pub struct Record {
    /// The scene that it began with.
    pub scene: Scene,
    /// What was done, and after how many steps, in that order.
    pub inputs: Vec<(u64, Input)>,
    /// [`World::state_hash`] at the start, and after each step.
    pub hashes: Vec<u64>,
}

impl Record {
    /// Begins with a world just made from a scene.
    pub fn begin(scene: &Scene, world: &World) -> Self {
        Self {
            scene: scene.clone(),
            inputs: Vec::new(),
            hashes: vec![world.state_hash()],
        }
    }

    /// Steps recorded.
    pub fn steps(&self) -> u64 {
        self.hashes.len() as u64 - 1
    }

    /// Takes in the state after a step; what was after it is of another run, and goes.
    pub fn push(&mut self, step: u64, hash: u64) {
        let Ok(step) = usize::try_from(step) else {
            return;
        };
        // A step that does not follow on what is known belongs to a run that is longer than is recorded.
        if step == 0 || step > self.hashes.len() || step > MOST_STEPS {
            return;
        }
        self.hashes.truncate(step);
        self.hashes.push(hash);
        self.inputs.retain(|&(after, _)| after < step as u64);
    }

    /// Takes in what was done after a number of steps, and forgets what had been after that.
    pub fn note(&mut self, after: u64, input: Input) {
        if after > self.steps() {
            return;
        }
        self.hashes.truncate(after as usize + 1);
        self.inputs.retain(|&(earlier, _)| earlier <= after);
        self.inputs.push((after, input));
    }
}
