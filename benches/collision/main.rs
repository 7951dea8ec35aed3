//! Mesh contact compared with its peers: time, wrong answers, building, rays and growth.
//!
//! `cargo bench` runs everything, prints tables, writes them to `target/contact.md` and the figures to
//! `target/contact.csv`, and draws `docs/naive-vs-bvh.svg`.
//! `cargo bench -- contact/near` runs a part, `cargo bench -- --quick` everything in less time.
//!
//! `repeat near 100` only tests our method on the near placements of the smaller pairs, so that instructions can be
//! counted; PROGRAM is the path that `cargo bench --no-run` prints last:
//! that instructions can be counted; PROGRAM is what `cargo bench --no-run` prints last:
//!
//! ```sh
//! valgrind --tool=callgrind --toggle-collect='sim_core::collide::tree::intersect_at' \
//!   PROGRAM repeat near 100
//! ```

mod build;
mod contact;
mod contact_tables;
mod degenerate;
mod edge_tests;
mod growth;
mod meshes;
mod moller_trumbore;
mod peers;
mod placements;
mod plot;
mod rays;
mod report;
mod sweep;
mod table;

use crate::meshes::Solids;

/// The extent of the benchmarks.
#[derive(Clone, Copy)]
struct Scope {
    /// The number of directions from which a mesh approaches.
    directions: usize,
    /// Triangles of the largest mesh.
    largest: usize,
    /// Whether times are meaningful.
    is_timed: bool,
}

impl Scope {
    /// Without `--bench` of cargo bench, criterion runs everything once, as a test.
    fn of_args() -> Scope {
        if std::env::args().any(|arg| arg == "--bench") {
            Scope {
                directions: 200,
                largest: usize::MAX,
                is_timed: true,
            }
        } else {
            Scope {
                directions: 5,
                largest: 20_000,
                is_timed: false,
            }
        }
    }
}

fn main() {
    if let Some((class, times)) = repeat_of_args() {
        return contact::repeat(&class, times);
    }
    let scope = Scope::of_args();
    let mut criterion = sweep::criterion();
    let solids = Solids::default();
    let degenerate = degenerate::all(&solids);
    let contact = contact::bench(&mut criterion, &solids, scope);
    let edge_tests = edge_tests::bench(&mut criterion, &solids, scope, &degenerate);
    let builds = build::bench(&mut criterion, &solids, scope);
    let mut growth = growth::bench(&mut criterion, &solids, scope);
    growth.extend(growth::of_builds(&builds));
    let rays = rays::bench(&mut criterion, &solids, scope);
    criterion.final_summary();

    contact::assert_ours_is_right(&contact, &degenerate);
    if scope.is_timed {
        report::publish(&[
            contact_tables::of_classes(&contact, &degenerate),
            contact_tables::of_pairs(&contact),
            edge_tests,
            build::table(&builds),
            growth::table(&growth),
            rays,
        ]);
        report::record(&contact, &growth);
        // A picture of only a part of the sizes would be misleading.
        if growth::is_complete(&growth) {
            report::draw(&plot::naive_against_bvh(&growth));
        }
    }
}

/// The class and the number in arguments such as `repeat near 100`.
fn repeat_of_args() -> Option<(String, usize)> {
    let mut args = std::env::args().skip(1);
    let (_, class) = (args.next().filter(|arg| arg == "repeat")?, args.next()?);
    Some((class, args.next()?.parse().ok()?))
}
