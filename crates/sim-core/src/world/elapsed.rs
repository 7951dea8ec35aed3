//! The number of steps so far, and their time.

use super::Settings;

/// Steps and time since the world was made.
#[derive(Clone, Debug, Default)]
pub(super) struct Elapsed {
    pub(super) steps: u64,
    /// Time and step at which `dt` was last set. The time since then is the number of steps times `dt`, without drift.
    pub(super) since: (f64, u64),
}

impl Elapsed {
    /// Simulated time, s.
    pub(super) fn time(&self, settings: &Settings) -> f64 {
        let (time, step) = self.since;
        time + (self.steps - step) as f64 * settings.dt
    }

    /// Continues with another `dt` than that of the settings so far.
    pub(super) fn change_dt(&mut self, before: &Settings) {
        self.since = (self.time(before), self.steps);
    }
}
