//! Case 7: seven stars.

use sim_core::Method;

use super::{Finding, Measured};

pub(super) fn test(method: &'static Method, measured: &Measured<'_>) -> Finding {
    let diagram = measured.diagrams.iter().find(|d| d.card.name == "pleiades");
    let series = diagram.and_then(|diagram| diagram.by_name(method.name));
    let Some(series) = series else {
        return Finding::failed("it was not run");
    };
    let best = series.points().min_by(|a, b| a.error.total_cmp(&b.error));
    match best {
        Some(best) => {
            let why = format!("{} evaluations; {}", best.evaluations, series.ended);
            Finding::within(best.error, 1e-10, why)
        }
        None => Finding::failed("no run came near"),
    }
}
