//! The cost of one edge-triangle test: the naive search compared with a plain loop.

use criterion::Criterion;
use sim_core::collide::naive;
use sim_core::{DVec3, Mesh};

use crate::Scope;
use crate::degenerate::Degenerate;
use crate::meshes::{Shape, Solids};
use crate::moller_trumbore;
use crate::placements::{Class, Pair};
use crate::sweep::{median, sweep};
use crate::table::{Table, three_digits};

type Meet = fn(&Mesh, &Mesh, DVec3) -> bool;

const METHODS: [(&str, Meet); 3] = [
    ("ours naive", naive::intersect),
    ("Möller-Trumbore f32", moller_trumbore::meet::<f32>),
    ("Möller-Trumbore f64", moller_trumbore::meet::<f64>),
];

/// The time of a test if nothing stops the search early, and wrong answers for touching meshes.
pub(crate) fn bench(
    c: &mut Criterion,
    solids: &Solids,
    scope: Scope,
    degenerate: &[Degenerate],
) -> Table {
    let mut table = Table::new(
        "One test of an edge with a triangle: near placements; wrong answers where meshes touch",
        &[
            "pair",
            "method",
            "ns a test",
            "graze wrong",
            "hair wrong",
            "degenerate wrong",
        ],
    );
    for (name, shapes) in [
        ("cube - cow 6k", [Shape::Cube, Shape::Cow(6_000)]),
        ("cow 1k - cow 1k", [Shape::Cow(1_000), Shape::Cow(1_000)]),
    ] {
        let mut group = c.benchmark_group(format!("naive/{name}"));
        let pair = std::cell::LazyCell::new(|| {
            Pair::approaching(solids, shapes, scope.directions.min(20))
        });
        for (method, meet) in METHODS {
            let run = |offset: &DVec3| meet(&pair.first.mesh, &pair.second.mesh, *offset);
            let cases = || {
                pair.placements(Class::Near)
                    .iter()
                    .take(5)
                    .map(|p| p.offset)
                    .collect()
            };
            let Some(swept) = sweep(&mut group, method, cases, run) else {
                continue;
            };
            let tests = edge_tests(&pair.first.mesh, &pair.second.mesh);
            let wrong = |class| {
                let placements = pair.placements(class);
                let wrong = placements
                    .iter()
                    .filter(|p| run(&p.offset) != p.meet)
                    .count();
                format!("{wrong}/{}", placements.len())
            };
            let wrong_degenerate = degenerate
                .iter()
                .filter(|d| {
                    meet(&d.first.mesh, &d.second.mesh, d.placement.offset) != d.placement.meet
                })
                .count();
            table.rows.push(vec![
                name.into(),
                method.into(),
                three_digits(median(swept.times) * 1e9 / tests as f64),
                wrong(Class::Graze),
                wrong(Class::Hair),
                format!("{wrong_degenerate}/{}", degenerate.len()),
            ]);
        }
        group.finish();
    }
    table
}

fn edge_tests(first: &Mesh, second: &Mesh) -> usize {
    first.edges().len() * second.triangles().len() + second.edges().len() * first.triangles().len()
}
