//! Whether two meshes meet: time and wrong answers of each method, by class of placement.

use std::cell::OnceCell;
use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};

use crate::Scope;
use crate::degenerate::Degenerate;
use crate::meshes::{Shape, Solids};
use crate::peers::Method;
use crate::placements::{Class, Pair, Placement};
use crate::sweep::{median, sweep};

/// The results of one method for the placements of one class of a pair.
pub(crate) struct Outcome {
    pub(crate) class: Class,
    pub(crate) pair: &'static str,
    pub(crate) method: Method,
    /// The median time of a placement, s.
    pub(crate) time: f64,
    pub(crate) wrong: usize,
    pub(crate) placements: usize,
}

/// A pair that is made when the first of its benchmarks runs.
struct LazyPair<'a> {
    name: &'static str,
    /// The number of placements for the naive search, which takes 2 ms to 0.3 s for each.
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
            // With a gap of 3 % of the radius, parry's trees need 4 to 5 ms.
            let shapes = [Shape::Sphere(20_000, 1000), Shape::Sphere(20_000, 970)];
            Pair::nested(solids, shapes, 0.005, scope.directions.div_ceil(10))
        }),
        made: OnceCell::new(),
    };
    approaching.chain([nested]).collect()
}

const NESTED: &str = "sphere 20k in sphere 20k";

/// Runs the benchmarks that criterion selects.
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
        wrong,
        placements: swept.cases.len(),
        time: median(swept.times),
    })
}

/// Fails if any answer of ours is wrong, at any level, with or without trees.
pub(crate) fn assert_ours_is_right(outcomes: &[Outcome], degenerate: &[Degenerate]) {
    for outcome in outcomes.iter().filter(|o| o.method.is_ours()) {
        let (class, pair, method) = (outcome.class.name(), outcome.pair, outcome.method.name());
        assert_eq!(outcome.wrong, 0, "wrong answers: {method}, {class}, {pair}");
    }
    for method in Method::with_trees().into_iter().chain([Method::Naive]) {
        for d in degenerate.iter().filter(|_| method.is_ours()) {
            let meet = method.meet(&d.first, &d.second, d.placement.offset);
            assert_eq!(
                meet,
                d.placement.meet,
                "{}: {:?}",
                method.name(),
                d.placement
            );
        }
    }
}

/// Tests every placement of a class with our method, a number of times, for the smaller pairs: for counting
/// instructions.
pub(crate) fn repeat(class: &str, times: usize) {
    let solids = Solids::default();
    let scope = Scope {
        directions: 20,
        largest: 20_000,
        is_timed: false,
    };
    for pair in pairs(&solids, scope) {
        for class in Class::ALL.into_iter().filter(|c| c.name() == class) {
            let pair = pair.get();
            let placements = pair.placements(class);
            for placement in std::iter::repeat_n(placements, times).flatten() {
                let offset = black_box(placement.offset);
                let meet = Method::best_tree().meet(&pair.first, &pair.second, offset);
                assert_eq!(meet, placement.meet);
            }
        }
    }
}
