//! Where results go: the terminal, files for people and for programs, the picture in `docs`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::contact::Outcome;
use crate::growth::Series;
use crate::table::Table;

/// Prints the tables that have rows, and leaves them as Markdown.
pub(crate) fn publish(tables: &[Table]) {
    let tables = tables.iter().filter(|table| !table.rows.is_empty());
    let text: String = tables.map(|table| table.markdown() + "\n").collect();
    // Criterion may have been asked for a list only.
    if !text.is_empty() {
        println!("\n{text}");
        save(&target().join("contact.md"), &text);
    }
}

/// Leaves the figures as comma-separated values, in seconds.
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

/// Leaves the picture where the README shows it.
pub(crate) fn draw(svg: &str) {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    save(&docs.join("naive-vs-bvh.svg"), svg);
}

fn save(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// The folder that cargo builds in: this program is in its `release/deps`.
fn target() -> PathBuf {
    let program = std::env::current_exe().expect("a program has a path");
    let target = program.ancestors().nth(3).expect("cargo builds in target");
    target.into()
}
