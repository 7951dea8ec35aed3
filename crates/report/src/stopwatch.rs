//! The only clock.

use std::hint::black_box;
use std::time::Instant;

use crate::scope::Scope;

pub(crate) struct Stopwatch(Instant);

pub(crate) fn start() -> Stopwatch {
    Stopwatch(Instant::now())
}

impl Stopwatch {
    pub(crate) fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// A sample shorter than this is one of several runs, s: the clock itself takes some 25 ns.
const LEAST_SAMPLE: f64 = 20e-6;

/// Median time of a run, s, after one to warm up.
pub(crate) fn median<T>(scope: Scope, mut run: impl FnMut() -> T) -> f64 {
    let clock = start();
    black_box(run());
    let rough = clock.seconds().max(1e-9);
    let batch = (LEAST_SAMPLE / rough).ceil().max(1.0) as usize;
    let [fewest, most] = scope.repeats();
    let patience = scope.patience().as_secs_f64();
    let whole = start();
    let mut samples = Vec::new();
    while samples.len() < most && (samples.len() < fewest || whole.seconds() < patience) {
        let clock = start();
        for _ in 0..batch {
            black_box(run());
        }
        samples.push(clock.seconds() / batch as f64);
    }
    middle(&mut samples)
}

fn middle(samples: &mut [f64]) -> f64 {
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
