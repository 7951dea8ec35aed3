//! The only clock of the project; everything else is handed durations.

use std::sync::LazyLock;
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

/// Real time since this was first asked, ns: a clock for [`sim_core::World::step_profiled`].
pub fn nanoseconds() -> u64 {
    static START: LazyLock<Stopwatch> = LazyLock::new(Stopwatch::start);
    u64::try_from(START.read().as_nanos()).unwrap_or(u64::MAX)
}
