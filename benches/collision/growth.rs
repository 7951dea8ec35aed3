//! Growth of the time of a query with the number of triangles: two cows of 1,000 to 400,000 each.

use std::cell::OnceCell;

use criterion::Criterion;

use crate::Scope;
use crate::build::Build;
use crate::meshes::{Shape, Solids};
use crate::peers::Method;
use crate::placements::{Class, Pair, Placement};
use crate::sweep::{median, sweep};
use crate::table::{Table, three_digits, time};

const SIZES: [usize; 6] = [1_000, 2_500, 6_000, 25_000, 100_000, 400_000];

/// With more triangles the naive search takes seconds.
const MOST_NAIVE: usize = 6_000;

/// Times of one method, by triangles of each mesh.
pub(crate) struct Series {
    pub(crate) what: String,
    pub(crate) method: String,
    /// Triangles, and the time in s.
    pub(crate) points: Vec<(f64, f64)>,
}

impl Series {
    /// The exponent of the power law fitted by least squares of logarithms.
    fn exponent(&self) -> f64 {
        let logs: Vec<_> = self
            .points
            .iter()
            .map(|(n, time)| (n.ln(), time.ln()))
            .collect();
        let count = logs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|log| log.0), mean(|log| log.1));
        let products = logs
            .iter()
            .map(|log| (log.0 - x) * (log.1 - y))
            .sum::<f64>();
        products / logs.iter().map(|log| (log.0 - x).powi(2)).sum::<f64>()
    }
}

/// Queries of two cows, *near* and *deep*.
pub(crate) fn bench(c: &mut Criterion, solids: &Solids, scope: Scope) -> Vec<Series> {
    let methods = [
        Method::best_tree(),
        Method::ParryTree,
        Method::ParryQuery,
        Method::Naive,
    ];
    let mut all = Vec::new();
    for class in [Class::Near, Class::Deep] {
        all.extend(methods.map(|method| Series {
            what: class.name().into(),
            method: method.name(),
            points: Vec::new(),
        }));
    }
    for size in SIZES.into_iter().filter(|&size| size <= scope.largest) {
        let pair = OnceCell::new();
        let pair = || {
            let shapes = [Shape::Cow(size); 2];
            pair.get_or_init(|| Pair::approaching(solids, shapes, scope.directions.min(40)))
        };
        for (class, series) in [Class::Near, Class::Deep]
            .into_iter()
            .zip(all.chunks_mut(methods.len()))
        {
            let mut group = c.benchmark_group(format!("growth/{}/{size}", class.name()));
            for (method, series) in methods.into_iter().zip(series) {
                let most = match method {
                    Method::Naive if size > MOST_NAIVE => continue,
                    // Every miss takes the same time.
                    Method::Naive if class == Class::Near => 2,
                    _ => usize::MAX,
                };
                let run = |placement: &Placement| {
                    method.meet(&pair().first, &pair().second, placement.offset)
                };
                let placements = || pair().placements(class).into_iter().take(most).collect();
                if let Some(swept) = sweep(&mut group, &method.name(), placements, run) {
                    series.points.push((size as f64, median(swept.times)));
                }
            }
            group.finish();
        }
    }
    all.retain(|series| !series.points.is_empty());
    all
}

/// The build times of cows, by builder.
pub(crate) fn of_builds(builds: &[Build]) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    for build in builds {
        let Shape::Cow(triangles) = build.shape else {
            continue;
        };
        let point = (triangles as f64, build.time);
        match all.iter_mut().find(|series| series.method == build.builder) {
            Some(series) => series.points.push(point),
            None => all.push(Series {
                what: "build".into(),
                method: build.builder.into(),
                points: vec![point],
            }),
        }
    }
    all
}

/// Whether queries of every size have been timed.
pub(crate) fn is_complete(all: &[Series]) -> bool {
    let complete = |class: Class| {
        let mut series = all.iter().filter(|series| series.what == class.name());
        series.any(|series| series.points.len() == SIZES.len())
    };
    complete(Class::Near) && complete(Class::Deep)
}

pub(crate) fn table(all: &[Series]) -> Table {
    let sizes = SIZES.map(|size| format!("{}k", size as f64 / 1000.0));
    let mut header = vec!["what", "method"];
    header.extend(sizes.iter().map(String::as_str));
    header.push("exponent");
    let mut table = Table::new(
        "Growth: two cows of so many triangles, median placement",
        &header,
    );
    for series in all {
        let cell = |size: usize| {
            let point = series.points.iter().find(|(n, _)| *n == size as f64);
            point.map_or("-".into(), |&(_, t)| time(t))
        };
        let exponent = match series.points.len() {
            0..2 => "-".into(),
            _ => three_digits(series.exponent()),
        };
        let row = [series.what.clone(), series.method.clone()].into_iter();
        table
            .rows
            .push(row.chain(SIZES.map(cell)).chain([exponent]).collect());
    }
    table
}
