//! Tables of the contact benchmark.

use crate::contact::Outcome;
use crate::degenerate::Degenerate;
use crate::peers::Method;
use crate::placements::Class;
use crate::sweep::geometric_mean;
use crate::table::{Table, three_digits, time};

/// All outcomes of a method with placements of a class.
struct Cell {
    /// Geometric mean over pairs, s.
    time: f64,
    wrong: usize,
    placements: usize,
}

impl Cell {
    fn of(outcomes: &[Outcome], method: Method, class: Class) -> Cell {
        let of: Vec<&Outcome> = outcomes
            .iter()
            .filter(|o| o.method == method && o.class == class)
            .collect();
        Cell {
            time: geometric_mean(of.iter().map(|o| o.time)),
            wrong: of.iter().map(|o| o.wrong).sum(),
            placements: of.iter().map(|o| o.placements).sum(),
        }
    }
}

/// Rows of methods, columns of classes: the time, its ratio to that of ours, and wrong answers out of all; the last
/// columns are the degenerate placements and the sum.
pub(crate) fn of_classes(outcomes: &[Outcome], degenerate: &[Degenerate]) -> Table {
    let mut header = vec!["method"];
    header.extend(Class::ALL.map(Class::name));
    header.extend(["degenerate", "all"]);
    let mut table = Table::new(
        "Contact: median placement, geometric mean over pairs; wrong answers",
        &header,
    );
    let methods = Method::with_trees().into_iter();
    for method in methods.filter(|&m| outcomes.iter().any(|o| o.method == m)) {
        let mut row = vec![method.name()];
        let wrong_degenerate = degenerate
            .iter()
            .filter(|d| method.meet(&d.first, &d.second, d.placement.offset) != d.placement.meet)
            .count();
        let (mut wrong, mut all) = (wrong_degenerate, degenerate.len());
        for class in Class::ALL {
            let cell = Cell::of(outcomes, method, class);
            wrong += cell.wrong;
            all += cell.placements;
            if cell.placements == 0 {
                row.push("-".into());
                continue;
            }
            let ours = Cell::of(outcomes, Method::best_tree(), class).time;
            row.push(format!(
                "{} x{} ({}/{})",
                time(cell.time),
                three_digits(cell.time / ours),
                cell.wrong,
                cell.placements
            ));
        }
        row.push(format!("({wrong_degenerate}/{})", degenerate.len()));
        row.push(format!("({wrong}/{all})"));
        table.rows.push(row);
    }
    table
}

/// Rows of methods for each pair, including the naive search.
pub(crate) fn of_pairs(outcomes: &[Outcome]) -> Table {
    let mut header = vec!["pair", "method"];
    header.extend(Class::ALL.map(Class::name));
    let mut table = Table::new("Contact by pair: median placement, wrong answers", &header);
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
                Some(o) => format!("{} ({}/{})", time(o.time), o.wrong, o.placements),
                None => "-".into(),
            };
            let names = [pair.to_string(), method.name()].into_iter();
            table.rows.push(names.chain(Class::ALL.map(cell)).collect());
        }
    }
    table
}
