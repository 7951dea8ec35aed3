//! The hard cases of the crate `cases`, each once: the time until it reaches the expected verdict.

use cases::CASES;

use crate::row;
use crate::table::{Table, time};
use crate::watch;

/// Returns the table, and the cases with other verdicts.
pub(crate) fn bench() -> (Option<Table>, Vec<String>) {
    // Tests already try them all without optimisation.
    if !watch::is_timed() || !watch::is_asked("impacts/cases") {
        return Default::default();
    }
    let mut table = Table::new(
        "Hard cases: a run, as tests and report have it",
        &["case", "method", "run", "verdict"],
    );
    let mut wrong = Vec::new();
    for case in &CASES {
        for method in case.methods() {
            let clock = watch::now();
            let outcome = case.attempt(method);
            let seconds = watch::now() - clock;
            let name = method.map_or("any", |method| method.name);
            if !outcome.is_expected() {
                wrong.push(format!("{}, {name}: {:?}", case.title, outcome.finding));
            }
            let verdict = outcome.finding.verdict.name();
            row(&mut table, &[case.title, name, &time(seconds), verdict]);
        }
    }
    (Some(table), wrong)
}
