//! Mesh contact beside its peers: time, wrong answers, building, rays and growth.
//!
//! `cargo bench` runs all, prints tables, leaves them in `target/contact.md` and the figures in
//! `target/contact.csv`, and draws `docs/naive-vs-bvh.svg`.
//! `cargo bench -- contact/near` runs a part, `cargo bench -- --quick` all of it in less time.
//!
//! `repeat near 100` asks ours about the near placements of the smaller pairs and does no more, so
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

/// How much is tried.
#[derive(Clone, Copy)]
struct Scope {
    /// From which a mesh comes in.
    directions: usize,
    /// Triangles of the largest mesh.
    largest: usize,
    /// Whether times mean anything.
    is_timed: bool,
}

impl Scope {
    /// Without cargo bench's `--bench` criterion runs everything once, as a test.
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
        // A part of the growth would be a misleading picture.
        if growth::is_complete(&growth) {
            report::draw(&plot::naive_against_bvh(&growth));
        }
    }
}

/// From `repeat near 100`.
fn repeat_of_args() -> Option<(String, usize)> {
    let mut args = std::env::args().skip(1);
    let (_, class) = (args.next().filter(|arg| arg == "repeat")?, args.next()?);
    Some((class, args.next()?.parse().ok()?))
}
