//! Do two meshes meet? Time and wrong answers of each method, by class of placement.

use std::cell::OnceCell;

use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};

use crate::Scope;
use crate::degenerate::Degenerate;
use crate::meshes::{Shape, Solids};
use crate::peers::Method;
use crate::placements::{Class, Pair, Placement};
use crate::sweep::{geometric_mean, median, sweep};
use crate::table::{Table, three_digits, time};

/// What one method did with the placements of one class of a pair.
pub(crate) struct Outcome {
    pub(crate) class: Class,
    pub(crate) pair: &'static str,
    pub(crate) method: Method,
    /// Median of each placement, s.
    pub(crate) times: Vec<f64>,
    pub(crate) wrong: usize,
}

impl Outcome {
    fn median(&self) -> f64 {
        median(self.times.clone())
    }
}

/// A pair, made when the first of its benchmarks runs.
struct LazyPair<'a> {
    name: &'static str,
    /// Placements that the naive search gets: it takes 2 ms to 0.3 s for each.
    naive: usize,
    make: Box<dyn Fn() -> Pair + 'a>,
    made: OnceCell<Pair>,
}

impl LazyPair<'_> {
    fn get(&self) -> &Pair {
        self.made.get_or_init(&self.make)
    }
}

fn pairs(solids: &Solids, scope: Scope) -> Vec<LazyPair<'_>> {
    let approaching = [
        ("cube - cow 6k", 20, [Shape::Cube, Shape::Cow(6_000)]),
        ("cow 6k - cow 6k", 2, [Shape::Cow(6_000), Shape::Cow(6_000)]),
        (
            "knot 12k - bumpy 20k",
            0,
            [Shape::Knot(12_000), Shape::Bumpy(20_000)],
        ),
        (
            "cow 100k - knot 124k",
            0,
            [Shape::Cow(100_000), Shape::Knot(124_000)],
        ),
        ("cube - cow 100k", 0, [Shape::Cube, Shape::Cow(100_000)]),
    ];
    let approaching = approaching.into_iter().filter(move |(_, _, shapes)| {
        shapes
            .iter()
            .all(|shape| shape.triangles() <= scope.largest)
    });
    let approaching = approaching.map(move |(name, naive, shapes)| LazyPair {
        name,
        naive,
        make: Box::new(move || Pair::approaching(solids, shapes, scope.directions)),
        made: OnceCell::new(),
    });
    let nested = LazyPair {
        name: NESTED,
        naive: 0,
        make: Box::new(move || {
            // A gap of 3 % of the radius: parry's trees need 4 to 5 ms.
            let shapes = [Shape::Sphere(20_000, 1000), Shape::Sphere(20_000, 970)];
            Pair::nested(solids, shapes, 0.005, scope.directions.div_ceil(10))
        }),
        made: OnceCell::new(),
    };
    approaching.chain([nested]).collect()
}

const NESTED: &str = "sphere 20k in sphere 20k";

/// Runs what criterion lets run.
pub(crate) fn bench(c: &mut Criterion, solids: &Solids, scope: Scope) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    for pair in pairs(solids, scope) {
        for class in Class::ALL {
            if (class == Class::Nested) != (pair.name == NESTED) {
                continue;
            }
            let group = format!("contact/{}/{}", class.name(), pair.name);
            let mut group = c.benchmark_group(group);
            for method in Method::with_trees() {
                outcomes.extend(outcome(&mut group, class, &pair, method, usize::MAX));
            }
            if pair.naive > 0 {
                outcomes.extend(outcome(&mut group, class, &pair, Method::Naive, pair.naive));
            }
            group.finish();
        }
    }
    outcomes
}

fn outcome(
    group: &mut BenchmarkGroup<'_, WallTime>,
    class: Class,
    pair: &LazyPair<'_>,
    method: Method,
    most: usize,
) -> Option<Outcome> {
    let meet = |placement: &Placement| {
        let pair = pair.get();
        method.meet(&pair.first, &pair.second, placement.offset)
    };
    let placements = || {
        pair.get()
            .placements(class)
            .into_iter()
            .take(most)
            .collect()
    };
    let swept = sweep(group, &method.name(), placements, meet)?;
    let wrong = swept
        .cases
        .iter()
        .filter(|placement| meet(placement) != placement.meet)
        .count();
    Some(Outcome {
        class,
        pair: pair.name,
        method,
        times: swept.times,
        wrong,
    })
}

/// Rows of methods, columns of classes: the geometric mean over pairs of the median placement,
/// how many times that of the first method it is, and wrong answers of how many.
pub(crate) fn table(outcomes: &[Outcome], degenerate: &[Degenerate]) -> Table {
    let mut table = Table::new(
        "Contact: median placement, geometric mean over pairs; wrong answers",
        [
            "method",
            "near",
            "graze",
            "deep",
            "hair",
            "nested",
            "degenerate wrong",
            "wrong",
        ],
    );
    let of = |method, class| {
        let of = outcomes
            .iter()
            .filter(move |o| o.method == method && o.class == class);
        of.collect::<Vec<_>>()
    };
    let mean = |outcomes: &[&Outcome]| geometric_mean(outcomes.iter().map(|o| o.median()));
    if outcomes.is_empty() {
        return table;
    }
    for method in Method::with_trees() {
        let first = Method::best_tree();
        let mut row = vec![method.name()];
        let (mut wrong, mut all) = (0, 0);
        for class in Class::ALL {
            let of_class = of(method, class);
            let (bad, count) = tally(&of_class);
            let ratio = mean(&of_class) / mean(&of(first, class));
            row.push(match count {
                0 => "-".into(),
                _ => format!(
                    "{} x{} ({bad}/{count})",
                    time(mean(&of_class)),
                    three_digits(ratio)
                ),
            });
            wrong += bad;
            all += count;
        }
        let bad = degenerate
            .iter()
            .filter(|d| method.meet(&d.first, &d.second, d.placement.offset) != d.placement.meet);
        let bad = bad.count();
        row.push(format!("{bad}/{}", degenerate.len()));
        row.push(format!("{}/{}", wrong + bad, all + degenerate.len()));
        table.rows.push(row);
    }
    table
}

fn tally(outcomes: &[&Outcome]) -> (usize, usize) {
    let wrong = outcomes.iter().map(|o| o.wrong).sum();
    (wrong, outcomes.iter().map(|o| o.times.len()).sum())
}

/// The same for each pair.
pub(crate) fn table_of_pairs(outcomes: &[Outcome]) -> Table {
    let mut table = Table::new(
        "Contact by pair: median placement, wrong answers",
        ["pair", "method", "near", "graze", "deep", "hair", "nested"],
    );
    let mut pairs: Vec<&str> = outcomes.iter().map(|o| o.pair).collect();
    pairs.dedup();
    for pair in pairs {
        for method in Method::with_trees().into_iter().chain([Method::Naive]) {
            let of: Vec<&Outcome> = outcomes
                .iter()
                .filter(|o| o.pair == pair && o.method == method)
                .collect();
            if of.is_empty() {
                continue;
            }
            let cell = |class| match of.iter().find(|o| o.class == class) {
                Some(o) => format!("{} ({}/{})", time(o.median()), o.wrong, o.times.len()),
                None => "-".into(),
            };
            let row = [pair.to_string(), method.name()].into_iter();
            table.rows.push(row.chain(Class::ALL.map(cell)).collect());
        }
    }
    table
}
