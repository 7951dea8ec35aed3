//! Times many cases under criterion, and stores the time of each.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};

/// A case is repeated for this time, so that the clock, with a resolution of some 20 ns, does not dominate.
const AT_LEAST: Duration = Duration::from_micros(5);
const MOST_REPEATS: u32 = 16;

/// Runs are short, because there are many; a median over hundreds of repetitions is stable then.
pub(crate) fn criterion() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(150))
        .measurement_time(Duration::from_millis(450))
        .sample_size(10)
        .nresamples(2000)
        .without_plots()
        .configure_from_args()
}

/// Cases and the median time of each, s.
pub(crate) struct Swept<T> {
    pub(crate) cases: Vec<T>,
    pub(crate) times: Vec<f64>,
}

/// Times each case; one iteration of criterion is one pass over all cases. The cases are made only if criterion runs
/// the benchmark.
pub(crate) fn sweep<T, R>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: &str,
    make: impl FnOnce() -> Vec<T>,
    run: impl Fn(&T) -> R,
) -> Option<Swept<T>> {
    let mut make = Some(make);
    let mut cases = Vec::new();
    let mut times = Vec::new();
    let mut repeats = Vec::new();
    group.bench_function(id, |bencher| {
        if let Some(make) = make.take() {
            cases = make();
            times = vec![Vec::new(); cases.len()];
            repeats = cases.iter().map(|case| repeats_of(|| run(case))).collect();
        }
        bencher.iter_custom(|sweeps| {
            let mut total = Duration::ZERO;
            for _ in 0..sweeps {
                for (i, case) in cases.iter().enumerate() {
                    let start = Instant::now();
                    for _ in 0..repeats[i] {
                        black_box(run(black_box(case)));
                    }
                    let time = start.elapsed().as_secs_f64() / f64::from(repeats[i]);
                    times[i].push(time);
                    total += Duration::from_secs_f64(time);
                }
            }
            total
        });
    });
    (!cases.is_empty()).then(|| Swept {
        cases,
        times: times.into_iter().map(median).collect(),
    })
}

fn repeats_of<R>(run: impl Fn() -> R) -> u32 {
    let start = Instant::now();
    black_box(run());
    let once = start.elapsed().as_nanos().max(1);
    (AT_LEAST.as_nanos() / once).clamp(1, u128::from(MOST_REPEATS)) as u32
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[n / 2],
        n => (values[n / 2 - 1] + values[n / 2]) / 2.0,
    }
}

pub(crate) fn geometric_mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let logs: Vec<f64> = values.into_iter().map(f64::ln).collect();
    (logs.iter().sum::<f64>() / logs.len() as f64).exp()
}
