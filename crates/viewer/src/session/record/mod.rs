//! A reproducible run: the scene at its start, the inputs, and a hash of every state.

mod file;
mod input;
mod live;
mod replay;

use scene::Scene;
use sim_core::World;

pub use file::{RecordError, is_run_file};
pub use input::{Input, InputError};
pub use replay::{Divergence, Replay, ReplayError, Verdict, verify};

/// The most steps of a record, at 8 bytes each; further steps are not recorded.
pub const MOST_STEPS: usize = 4_000_000;

/// A recorded run.
#[derive(Clone, Debug)]
pub struct Record {
    /// The scene at the start.
    pub scene: Scene,
    /// The inputs, in order, each with the number of steps before it.
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

    /// Adds the state after a step; later states belong to another run and are removed.
    pub fn push(&mut self, step: u64, hash: u64) {
        let Ok(step) = usize::try_from(step) else {
            return;
        };
        // A step that does not follow a recorded one belongs to a run longer than the limit.
        if step == 0 || step > self.hashes.len() || step > MOST_STEPS {
            return;
        }
        self.hashes.truncate(step);
        self.hashes.push(hash);
        self.inputs.retain(|&(after, _)| after < step as u64);
    }

    /// Adds an input after a number of steps, and removes later ones.
    pub fn note(&mut self, after: u64, input: Input) {
        if after > self.steps() {
            return;
        }
        self.hashes.truncate(after as usize + 1);
        self.inputs.retain(|&(earlier, _)| earlier <= after);
        self.inputs.push((after, input));
    }
}
