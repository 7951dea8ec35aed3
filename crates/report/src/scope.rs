//! How much is measured.

use std::ops::Range;

/// The whole report, or one in seconds that shows its form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    Full,
    Quick,
}

impl Scope {
    fn either<T>(self, full: T, quick: T) -> T {
        match self {
            Scope::Full => full,
            Scope::Quick => quick,
        }
    }

    /// From one number of steps to the next.
    pub(crate) fn step_factor(self) -> u64 {
        self.either(2, 16)
    }

    /// Tolerances are ten to the minus these.
    pub(crate) fn tolerance_exponents(self) -> std::iter::StepBy<Range<i32>> {
        self.either((2..14).step_by(1), (3..14).step_by(5))
    }

    /// A run that takes longer is the last one of its sweep, s.
    pub(crate) fn dearest_run(self) -> f64 {
        self.either(0.1, 0.003)
    }

    /// Timed repeats of each run, an odd number so that there is one in the middle.
    pub(crate) fn repeats(self) -> usize {
        self.either(5, 1)
    }

    /// Orbits over which drift is watched.
    pub(crate) fn orbits(self) -> usize {
        self.either(100, 20)
    }

    /// How long bodies tumble freely, s of motion.
    pub(crate) fn tumbling_time(self) -> u32 {
        self.either(600, 60)
    }

    /// From one number of steps of a lever to the next.
    pub(crate) fn lever_factor(self) -> u64 {
        self.either(2, 4)
    }

    /// Steps after which growth is measured for the stability map.
    pub(crate) fn growth_steps(self) -> u32 {
        self.either(2000, 400)
    }

    /// Columns of the stability map for each factor of ten.
    pub(crate) fn columns_per_decade(self) -> i32 {
        self.either(12, 4)
    }

    /// From one step to the next where a limit of stability is looked for.
    pub(crate) fn search_factor(self) -> f64 {
        self.either(1.004, 1.05)
    }
}
