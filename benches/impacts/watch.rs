//! Times runs of many steps under criterion, and keeps the time of a step.

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

/// Without cargo bench's `--bench` criterion runs everything once, as a test.
pub(crate) fn is_timed() -> bool {
    std::env::args().any(|arg| arg == "--bench")
}

/// Whether a part that criterion does not time is asked for: as criterion has it, by a filter that is
/// in its name.
pub(crate) fn is_asked(part: &str) -> bool {
    let filter = std::env::args().skip(1).find(|arg| !arg.starts_with("--"));
    filter.is_none_or(|filter| part.contains(&filter))
}

/// Time of the processor that this thread has had, s, so that the longest step is not that in which
/// another program had it.
#[cfg(unix)]
pub(crate) fn now() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Time on the wall since the first call, s.
#[cfg(not(unix))]
pub(crate) fn now() -> f64 {
    static FIRST: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// A step of an engine, which none refuses.
pub(crate) fn step(engine: &mut impl Engine) {
    engine.step().expect("a step");
}

/// Median time of a step over runs of `steps`, s, each from a fresh start and after a step to warm
/// up; `None` if criterion passes it over.
pub(crate) fn time<E: Engine>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: &str,
    steps: u32,
    start: impl Fn() -> E,
) -> Option<f64> {
    time_by(group, id, steps, start, step)
}

/// The same of something else that steps.
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
