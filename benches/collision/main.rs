//! Mesh contact beside its peers: time, wrong answers, building, rays and growth.
//!
//! `cargo bench` runs all and prints tables, which are also left in `target/contact.md`;
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
mod random;
mod rationals;
mod rays;
mod sweep;
mod table;

use std::path::{Path, PathBuf};

use crate::meshes::Solids;
use crate::table::Table;

/// How much is tried.
#[derive(Clone, Copy)]
struct Scope {
    /// From which a mesh comes in.
    directions: usize,
    /// Triangles of the largest mesh.
    largest: usize,
}

impl Scope {
    /// Without cargo bench's `--bench` criterion runs everything once, as a test.
    fn of_args() -> Scope {
        if std::env::args().any(|arg| arg == "--bench") {
            Scope {
                directions: 200,
                largest: usize::MAX,
            }
        } else {
            Scope {
                directions: 5,
                largest: 20_000,
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
    let outcomes = contact::bench(&mut criterion, &solids, scope);
    let edge_tests = edge_tests::bench(&mut criterion, &solids, scope, &degenerate);
    let builds = build::bench(&mut criterion, &solids, scope);
    let mut growth = growth::bench(&mut criterion, &solids, scope);
    growth.extend(growth::of_builds(&builds));
    let rays = rays::bench(&mut criterion, &solids, scope);
    criterion.final_summary();
    // A part of the growth would be a misleading picture.
    if growth::is_complete(&growth) {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
        std::fs::write(
            docs.join("naive-vs-bvh.svg"),
            plot::naive_against_bvh(&growth),
        )
        .expect("docs can be written");
    }
    publish(&[
        contact_tables::of_classes(&outcomes, &degenerate),
        contact_tables::of_pairs(&outcomes),
        edge_tests,
        build::table(&builds),
        growth::table(&growth),
        rays,
    ]);
}

/// From `repeat near 100`.
fn repeat_of_args() -> Option<(String, usize)> {
    let mut args = std::env::args().skip(1);
    let (_, class) = (args.next().filter(|arg| arg == "repeat")?, args.next()?);
    Some((class, args.next()?.parse().ok()?))
}

/// Prints the tables that have rows, and leaves them in cargo's target folder.
fn publish(tables: &[Table]) {
    let tables: Vec<&Table> = tables
        .iter()
        .filter(|table| !table.rows.is_empty())
        .collect();
    let text: String = tables.iter().map(|table| table.markdown() + "\n").collect();
    println!("\n{text}");
    let csv: Vec<String> = tables.iter().map(|table| table.csv()).collect();
    let target = target();
    std::fs::write(target.join("contact.md"), text).expect("target can be written");
    std::fs::write(target.join("contact.csv"), csv.join("\n")).expect("target can be written");
}

/// The folder that cargo builds in: that of this program is `target/release/deps`.
fn target() -> PathBuf {
    let program = std::env::current_exe().expect("a program has a path");
    program
        .ancestors()
        .nth(3)
        .expect("cargo builds in target")
        .into()
}
