//! The only clock of the project; everything else is handed durations.

use std::time::{Duration, Instant};

/// Time since it was started, s. Simulations never read it: they are told how much time passed.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts a stopwatch now.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since the start; never goes back.
    pub fn read(&self) -> Duration {
        self.0.elapsed()
    }
}
