//! Converts frame time to whole steps.
//!
//! Frames have any duration; a step is always `dt`. The clock adds elapsed time to the remainder of the
//! last frame, takes whole steps from the sum, and keeps the rest for the next frame (Fiedler 2004,
//! "Fix your timestep!").

use core::{ops::RangeInclusive, time::Duration};

/// Turns elapsed time into whole steps of `dt`, without drift.
///
/// Time is counted in integers: one unit is the last binary digit of `dt` in nanoseconds, so
/// that both `dt` and every [`Duration`] are whole numbers of units. After any number of frames
/// the steps taken are `floor(total / dt)`, exactly.
///
/// ```
/// use core::time::Duration;
/// use sim_core::FixedStep;
///
/// let mut clock = FixedStep::new(1.0 / 60.0, Duration::from_millis(250))?;
/// clock.advance(Duration::from_millis(40)); // the length of a frame
/// let mut steps = 0;
/// while clock.take() {
///     steps += 1; // world.step()
/// }
/// assert_eq!(steps, 2);
/// assert!((clock.fraction() - 0.4).abs() < 1e-9); // draw between the last two states
/// # Ok::<(), sim_core::ClockError>(())
/// ```
#[derive(Clone, Debug)]
pub struct FixedStep {
    dt: f64,
    /// One nanosecond is `1 << shift` units.
    shift: u32,
    step: u128,
    most_steps: u128,
    waiting: u128,
    dropped: Duration,
}

/// A step length that the clock does not support.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("dt = {dt} s: a clock steps by 1e-9 s to 1e3 s")]
pub struct ClockError {
    /// The step length, s.
    pub dt: f64,
}

/// The most nanoseconds counted at once, 4.9 hours. At the least step a nanosecond has 2^82 units, so twice 2^44 of
/// them, waiting and added, stay below 2^128.
const LONGEST_NS: u128 = 1 << 44;

impl FixedStep {
    /// Least and greatest step, s.
    pub const DT_RANGE: RangeInclusive<f64> = 1e-9..=1e3;

    /// A clock that steps by `dt` seconds (1e-9 to 1e3). At most `catch_up` (up to 4.8 hours) of elapsed time waits,
    /// but always at least one step.
    pub fn new(dt: f64, catch_up: Duration) -> Result<FixedStep, ClockError> {
        if !FixedStep::DT_RANGE.contains(&dt) {
            return Err(ClockError { dt });
        }
        // dt = mantissa · 2^exponent s = mantissa · 10^9 · 2^exponent ns.
        let bits = dt.to_bits();
        let mantissa = u128::from(bits & ((1 << 52) - 1) | 1 << 52);
        let exponent = (bits >> 52) as i32 - 1075;
        let shift = (-exponent).unsigned_abs();
        let step = mantissa * 1_000_000_000;
        let most_steps = (catch_up.as_nanos().min(LONGEST_NS) << shift) / step;
        Ok(FixedStep {
            dt,
            shift,
            step,
            most_steps: most_steps.max(1),
            waiting: 0,
            dropped: Duration::ZERO,
        })
    }

    /// Adds the time since the last call. Time beyond the catch-up limit is dropped and returned, so that one stall
    /// does not lead to ever longer frames.
    pub fn advance(&mut self, elapsed: Duration) -> Duration {
        let total_ns = elapsed.as_nanos();
        let counted_ns = total_ns.min(LONGEST_NS);
        self.waiting += counted_ns << self.shift;
        // Whole steps above the limit are dropped; the fraction stays, so that drawing does not jump.
        let excess = (self.waiting / self.step).saturating_sub(self.most_steps);
        self.give_up(excess, total_ns - counted_ns)
    }

    /// Takes one step from the waiting time, if it is long enough.
    pub fn take(&mut self) -> bool {
        let due = self.waiting >= self.step;
        if due {
            self.waiting -= self.step;
        }
        due
    }

    /// Drops the whole steps that wait, for a caller without time for them.
    pub fn drop_backlog(&mut self) -> Duration {
        self.give_up(self.waiting / self.step, 0)
    }

    /// The remaining time, in steps: 0 draws the previous state, 1 the current one.
    pub fn fraction(&self) -> f64 {
        // Below one step the ratio is below 1, but it may round to 1.
        (self.waiting as f64 / self.step as f64).min(1.0 - f64::EPSILON / 2.0)
    }

    /// The step length, s.
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// The sum of dropped time: the delay of the simulation behind real time.
    pub fn dropped(&self) -> Duration {
        self.dropped
    }

    fn give_up(&mut self, steps: u128, uncounted_ns: u128) -> Duration {
        let units = steps * self.step;
        self.waiting -= units;
        let time = duration((units >> self.shift) + uncounted_ns);
        self.dropped = self.dropped.saturating_add(time);
        time
    }
}

fn duration(ns: u128) -> Duration {
    Duration::new(
        (ns / 1_000_000_000).min(u128::from(u64::MAX)) as u64,
        (ns % 1_000_000_000) as u32,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Duration = Duration::from_nanos(16_666_667);

    fn steps(clock: &mut FixedStep) -> u64 {
        let mut n = 0;
        while clock.take() {
            n += 1;
        }
        n
    }

    #[test]
    fn a_million_frames_give_exactly_floor_of_total_over_dt() {
        // dt is a binary fraction of a second, so total / dt is exact in integers.
        let dt = 1.0 / 64.0;
        let mut clock = FixedStep::new(dt, Duration::from_secs(1)).unwrap();
        let mut random = 0x9e37_79b9_7f4a_7c15_u64;
        let (mut total_ns, mut taken) = (0u128, 0u64);
        for _ in 0..1_000_000 {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let frame = Duration::from_nanos(random % 100_000_000); // 0 to 0.1 s
            total_ns += frame.as_nanos();
            assert_eq!(clock.advance(frame), Duration::ZERO);
            taken += steps(&mut clock);
        }
        assert_eq!(u128::from(taken), total_ns * 64 / 1_000_000_000);
        let left_ns = (total_ns * 64 % 1_000_000_000) as f64 / 64.0;
        assert!((clock.fraction() * dt * 1e9 - left_ns).abs() < 1e-6);
    }

    #[test]
    fn sixty_hertz_does_not_drift() {
        let mut clock = FixedStep::new(1.0 / 60.0, Duration::from_secs(1)).unwrap();
        let mut taken = 0;
        for _ in 0..1_000_000 {
            clock.advance(FRAME);
            taken += steps(&mut clock);
        }
        // 16,666,667 ns a frame is 1e6 + 0.02 steps in all; f32 sums would be off by hundreds.
        assert_eq!(taken, 1_000_000);
        assert!((clock.fraction() - 0.02).abs() < 1e-6);
    }

    #[test]
    fn a_stall_is_capped_and_reported() {
        let mut clock = FixedStep::new(1.0 / 128.0, Duration::from_millis(250)).unwrap();
        let dropped = clock.advance(Duration::from_secs(10));
        assert_eq!(steps(&mut clock), 32);
        assert!((dropped.as_secs_f64() - 9.75).abs() < 1e-9);
        assert_eq!(clock.dropped(), dropped);
        assert!(clock.fraction() < 1.0);
    }

    #[test]
    fn the_backlog_can_be_given_up_and_the_fraction_stays() {
        let mut clock = FixedStep::new(0.1, Duration::from_secs(1)).unwrap();
        clock.advance(Duration::from_millis(570));
        assert!(clock.take());
        let dropped = clock.drop_backlog();
        assert!((dropped.as_secs_f64() - 0.4).abs() < 1e-9);
        assert_eq!(steps(&mut clock), 0);
        assert!((clock.fraction() - 0.7).abs() < 1e-9);
    }

    #[test]
    fn at_least_one_step_may_wait_however_small_the_cap() {
        let mut clock = FixedStep::new(0.25, Duration::ZERO).unwrap();
        for _ in 0..11 {
            clock.advance(Duration::from_millis(125));
        }
        assert_eq!(steps(&mut clock), 1);
    }

    #[test]
    fn a_nanosecond_and_an_age_are_counted() {
        let mut clock = FixedStep::new(1e-9, Duration::MAX).unwrap();
        clock.advance(Duration::from_nanos(1));
        assert!(steps(&mut clock) <= 1);
        clock.advance(Duration::MAX);
        clock.advance(Duration::MAX);
        assert!(clock.drop_backlog() > Duration::from_secs(3600));
        assert!(clock.fraction() < 1.0);
        assert_eq!(clock.dropped(), Duration::MAX);
    }

    #[test]
    fn steps_that_are_no_length_of_time_are_refused() {
        for dt in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-10, 1e4, -0.0] {
            assert!(FixedStep::new(dt, FRAME).is_err(), "{dt}");
        }
    }
}
