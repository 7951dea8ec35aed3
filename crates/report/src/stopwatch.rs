//! The only clocks.

use std::hint::black_box;
use std::time::Instant;

/// Time on the wall, for progress.
pub(crate) struct Stopwatch(Instant);

pub(crate) fn start() -> Stopwatch {
    Stopwatch(Instant::now())
}

impl Stopwatch {
    pub(crate) fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// What times are: on the processor where the system tells it, so that other programs, which make
/// a run of milliseconds wait, do not count.
pub(crate) const WHAT_IS_TIMED: &str = if cfg!(unix) {
    "processor time of the one thread that runs"
} else {
    "time on the wall"
};

/// Time that this thread has spent on a processor, s.
#[cfg(unix)]
fn now() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Time on the wall since the first call, s.
#[cfg(not(unix))]
fn now() -> f64 {
    static FIRST: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// What a run returns and the time it takes, s.
pub(crate) fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let start = now();
    let result = black_box(run());
    (result, now() - start)
}

/// A sample shorter than this is one of several runs, s: to ask for the time takes up to half a microsecond.
const LEAST_SAMPLE: f64 = 100e-6;

/// Time of a run, s, that is known to take about `rough`: once, or over so many that the clock
/// does not matter, after one to warm up.
pub(crate) fn sample<T>(rough: f64, mut run: impl FnMut() -> T) -> f64 {
    let batch = (LEAST_SAMPLE / rough.max(1e-9)).ceil() as usize;
    // A long run warms itself up.
    if batch > 1 {
        black_box(run());
    }
    let ((), time) = timed(|| {
        for _ in 0..batch {
            black_box(run());
        }
    });
    time / batch as f64
}

/// Median time of a run, s.
pub(crate) fn median<T>(repeats: usize, mut run: impl FnMut() -> T) -> f64 {
    let (_, rough) = timed(&mut run);
    let mut samples: Vec<f64> = (0..repeats).map(|_| sample(rough, &mut run)).collect();
    middle(&mut samples)
}

/// The median.
pub(crate) fn middle(samples: &mut [f64]) -> f64 {
    samples.sort_by(f64::total_cmp);
    let half = samples.len() / 2;
    match samples.len() % 2 {
        1 => samples[half],
        _ => 0.5 * (samples[half - 1] + samples[half]),
    }
}

#[cfg(test)]
mod tests {
    use super::middle;

    #[test]
    fn the_median_is_not_moved_by_one_slow_run() {
        assert_eq!(middle(&mut [3.0, 100.0, 1.0]), 3.0);
        assert_eq!(middle(&mut [3.0, 100.0, 1.0, 2.0]), 2.5);
    }
}
