//! Speed against error: measures every method and solver on problems whose solution is known, and
//! writes one page about it, with its tables and figures beside it.
//!
//! ```sh
//! cargo run --release -p report              # a few minutes
//! cargo run --release -p report -- --quick   # seconds
//! ```

mod collisions;
mod contact;
mod drift;
mod machine;
mod page;
mod plots;
mod resting;
mod results;
mod runs;
mod scope;
mod stability;
mod stopwatch;
mod table;
mod tables;
mod turning;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;

use page::Drawn;
use plots::PLOTS;
use results::Results;
use scope::Scope;

/// Measure speed against error and write a page about it.
#[derive(Debug, Parser)]
#[command(version)]
struct Args {
    /// Folder for the page, its tables and its figures
    #[arg(short, long, value_name = "DIR", default_value = "target/report")]
    output: PathBuf,
    /// Few points and few repeats: seconds instead of minutes
    #[arg(long)]
    quick: bool,
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    let scope = if args.quick {
        Scope::Quick
    } else {
        Scope::Full
    };
    // Found out before minutes are spent.
    fs::create_dir_all(&args.output)
        .with_context(|| format!("cannot make the folder {}", args.output.display()))?;
    let clock = stopwatch::start();
    let results = results::measure(scope, |part| {
        eprintln!("{:6.1} s  {part}", clock.seconds());
    });
    write(&args.output, &results, scope)?;
    let page = args.output.join("index.html");
    eprintln!("{:6.1} s  wrote {}", clock.seconds(), page.display());
    Ok(())
}

/// Writes the page and what is beside it.
fn write(folder: &Path, results: &Results, scope: Scope) -> anyhow::Result<()> {
    let save = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
    };
    let plots: Vec<Drawn> = PLOTS
        .iter()
        .map(|&plot| (plot, (plot.draw)(results)))
        .collect();
    let facts = machine::facts();
    save("index.html", &page::render(results, &plots, &facts, scope))?;
    for figure in plots.iter().flat_map(|(_, figures)| figures) {
        save(&format!("{}.svg", figure.name), &figure.svg)?;
    }
    let tables = tables::all(results);
    for table in &tables {
        save(&format!("{}.csv", table.name), &table.csv())?;
    }
    let facts = facts
        .iter()
        .map(|(name, value)| format!("- {name}: {value}\n"));
    let facts: String = facts.collect();
    let tables: String = tables.iter().map(|table| table.markdown()).collect();
    save(
        "report.md",
        &format!("# Cowbell: speed against error\n\n{facts}\n{tables}"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quick_report_names_every_method_problem_solver_and_case() {
        let folder = tempfile::tempdir().expect("a folder");
        let results = results::measure(Scope::Quick, |_| ());
        write(folder.path(), &results, Scope::Quick).expect("the report is written");
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect(name);
        let page = read("index.html");
        let methods = sim_core::METHODS.iter().map(|m| m.title);
        let problems = results.diagrams.iter().map(|diagram| diagram.card.title);
        let cases = cases::CASES.iter().map(|case| case.title);
        let turning = &results.turning;
        let contacts = turning.contacts.iter().map(|it| it.contact.title);
        let tumblers = turning.tumbles.iter().map(|it| it.tumbler.title);
        let levers = turning.levers.iter().map(|it| it.lever.title);
        let turning = contacts.chain(tumblers).chain(levers);
        for name in methods.chain(problems).chain(cases).chain(turning) {
            let escaped = name.replace('&', "&amp;");
            assert!(page.contains(&escaped), "{name}");
        }
        // One page, without anything from elsewhere.
        for outside in ["<script", "<link", "src=", "url(http"] {
            assert!(!page.contains(outside), "{outside}");
        }
        for table in tables::all(&results) {
            let width = table.head.len();
            assert!(!table.rows.is_empty(), "{} is empty", table.name);
            for row in &table.rows {
                assert_eq!(row.len(), width, "{}: {row:?}", table.name);
            }
            assert!(read("report.md").contains(&table.title));
            let lines = read(&format!("{}.csv", table.name)).lines().count();
            assert_eq!(lines, table.rows.len() + 1, "{}", table.name);
        }
        for figure in PLOTS.iter().flat_map(|plot| (plot.draw)(&results)) {
            assert!(read(&format!("{}.svg", figure.name)).starts_with("<svg"));
        }
    }
}
