//! The only clock of the program; everything else receives durations.

use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// Time since the start. Simulations never read it: the elapsed time is passed to them.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts a stopwatch now.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since the start; it never decreases.
    pub fn read(&self) -> Duration {
        self.0.elapsed()
    }
}

/// Real time since the first call, ns: a clock for [`sim_core::World::step_profiled`].
pub fn nanoseconds() -> u64 {
    static START: LazyLock<Stopwatch> = LazyLock::new(Stopwatch::start);
    u64::try_from(START.read().as_nanos()).unwrap_or(u64::MAX)
}
