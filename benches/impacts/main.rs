//! Continuous collisions compared with Rapier: time, impacts found, errors.
//!
//! `cargo bench -- impacts` runs everything, prints tables and writes them to `target/impacts.md`;
//! `cargo bench -- impacts/crowd` runs a part, `cargo bench -- impacts/heap` the heaps alone,
//! `cargo bench -- impacts/cases` the hard cases. It fails if an answer of ours is wrong.

mod boxes;
mod crowd;
mod galperin;
mod hard_cases;
mod heap;
mod levers;
mod one;
mod overlap;
mod pair;
// For the unit tests of the code of sim-core that [`boxes`] includes.
#[cfg(test)]
#[allow(dead_code, reason = "other unit tests of sim-core use the rest")]
#[path = "../../crates/sim-core/src/test_random.rs"]
mod test_random;

#[path = "../collision/table.rs"]
mod table;
mod turning;
mod watch;

extern crate alloc;

use std::path::Path;

use table::Table;

fn main() {
    let mut criterion = watch::criterion();
    let tables = [
        pair::bench(&mut criterion),
        boxes::bench(&mut criterion),
        crowd::bench(&mut criterion),
        one::bench(&mut criterion),
        galperin::bench(&mut criterion),
        turning::bench(&mut criterion),
        levers::bench(&mut criterion),
    ];
    criterion.final_summary();
    let (heaps, mut wrong) = heap::bench();
    let (cases, others) = hard_cases::bench();
    wrong.extend(others);
    let tables = tables.iter().flatten().chain(&heaps).chain(&cases);
    let text: String = tables.map(|table| table.markdown() + "\n").collect();
    // Without `--bench` everything runs once, as a test.
    if !text.is_empty() && watch::is_timed() {
        println!("\n{text}");
        publish(&text);
    }
    assert!(wrong.is_empty(), "wrong answers of ours: {wrong:#?}");
}

/// Writes the tables to cargo's build folder: this program is in its `release/deps`.
fn publish(text: &str) {
    let program = std::env::current_exe().expect("a program has a path");
    let target = program.ancestors().nth(3).expect("cargo builds in target");
    let path: &Path = &target.join("impacts.md");
    std::fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// An error to two digits.
fn short(error: f64) -> String {
    match error {
        0.0 => "0".into(),
        error if error.is_nan() => "-".into(),
        error => format!("{error:.1e}"),
    }
}

/// Adds a row of names and figures.
fn row(table: &mut Table, cells: &[&str]) {
    table.rows.push(cells.iter().map(|&c| c.into()).collect());
}
