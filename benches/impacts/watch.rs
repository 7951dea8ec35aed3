//! Times runs of many steps under criterion, and stores the time of a step.

use std::time::{Duration, Instant};

use cases::scenes::Engine;
use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};

pub(crate) fn criterion() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800))
        .sample_size(10)
        .nresamples(2000)
        .without_plots()
        .configure_from_args()
}

/// Without `--bench` of cargo bench, criterion runs everything once, as a test.
pub(crate) fn is_timed() -> bool {
    std::env::args().any(|arg| arg == "--bench")
}

/// Whether a part that criterion does not time is selected: as in criterion, by a filter that occurs in its name.
pub(crate) fn is_asked(part: &str) -> bool {
    let filter = std::env::args().skip(1).find(|arg| !arg.starts_with("--"));
    filter.is_none_or(|filter| part.contains(&filter))
}

/// Processor time of this thread, s, so that a step interrupted by another program does not count as the longest.
#[cfg(unix)]
pub(crate) fn now() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Wall-clock time since the first call, s.
#[cfg(not(unix))]
pub(crate) fn now() -> f64 {
    static FIRST: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// Makes a step of an engine; no engine may fail.
pub(crate) fn step(engine: &mut impl Engine) {
    engine.step().expect("a step");
}

/// Median time of a step over runs of `steps` steps, s, each from a new start and after one warm-up step; `None` if
/// criterion skips it.
pub(crate) fn time<E: Engine>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: &str,
    steps: u32,
    start: impl Fn() -> E,
) -> Option<f64> {
    time_by(group, id, steps, start, step)
}

/// The same for other objects that step.
pub(crate) fn time_by<E>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: &str,
    steps: u32,
    start: impl Fn() -> E,
    step: impl Fn(&mut E),
) -> Option<f64> {
    let mut times = Vec::new();
    group.bench_function(id, |bencher| {
        bencher.iter_custom(|runs| {
            let mut total = Duration::ZERO;
            for _ in 0..runs {
                let mut engine = start();
                step(&mut engine);
                let clock = Instant::now();
                for _ in 1..steps {
                    step(&mut engine);
                }
                let time = clock.elapsed();
                times.push(time.as_secs_f64() / f64::from(steps - 1));
                total += time;
            }
            total
        });
    });
    times.sort_unstable_by(f64::total_cmp);
    times.get(times.len() / 2).copied()
}
