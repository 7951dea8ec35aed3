//! Output of the results: to the terminal, to text and data files, and to the plot in `docs`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::contact::Outcome;
use crate::growth::Series;
use crate::table::Table;

/// Prints the tables that have rows, and writes them as Markdown.
pub(crate) fn publish(tables: &[Table]) {
    let tables = tables.iter().filter(|table| !table.rows.is_empty());
    let text: String = tables.map(|table| table.markdown() + "\n").collect();
    // Criterion may only list the benchmarks.
    if !text.is_empty() {
        println!("\n{text}");
        save(&target().join("contact.md"), &text);
    }
}

/// Writes the figures as comma-separated values, in seconds.
pub(crate) fn record(contact: &[Outcome], growth: &[Series]) {
    let mut text = String::from("what,meshes,method,seconds,wrong,placements\n");
    for o in contact {
        let (what, method) = (o.class.name(), o.method.name());
        let _ = writeln!(
            text,
            "{what},{},{method},{:e},{},{}",
            o.pair, o.time, o.wrong, o.placements
        );
    }
    for series in growth {
        for (triangles, seconds) in &series.points {
            let (what, method) = (&series.what, &series.method);
            let _ = writeln!(text, "growth of {what},{triangles},{method},{seconds:e},,");
        }
    }
    if text.lines().count() > 1 {
        save(&target().join("contact.csv"), &text);
    }
}

/// Writes the plot to the place from which the README includes it.
pub(crate) fn draw(svg: &str) {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    save(&docs.join("naive-vs-bvh.svg"), svg);
}

fn save(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// Cargo's build folder: this program is in its `release/deps`.
fn target() -> PathBuf {
    let program = std::env::current_exe().expect("a program has a path");
    let target = program.ancestors().nth(3).expect("cargo builds in target");
    target.into()
}
