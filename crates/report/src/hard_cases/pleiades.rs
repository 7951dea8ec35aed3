//! Case 7: seven stars.

use sim_core::Method;

use super::{Finding, Measured};

const TOLERANCE: f64 = 1e-10;

pub(super) fn test(method: &'static Method, measured: &Measured<'_>) -> Finding {
    let diagram = measured.diagrams.iter().find(|d| d.card.name == "pleiades");
    let series = diagram.and_then(|diagram| diagram.by_name(method.name));
    let Some(series) = series else {
        return Finding::failed("it was not run");
    };
    let best = series.points().min_by(|a, b| a.error.total_cmp(&b.error));
    match best {
        Some(best) => {
            let why = match best.error <= TOLERANCE || method.adaptive {
                true => format!("in {} evaluations", best.evaluations),
                false => {
                    // Error falls with evaluations to the power of the order.
                    let factor = (best.error / TOLERANCE).powf(1.0 / f64::from(method.order));
                    format!(
                        "in {} evaluations, where its sweep ends; by its order it would take {:.0e}",
                        best.evaluations,
                        best.evaluations as f64 * factor
                    )
                }
            };
            Finding::within(best.error, TOLERANCE, why)
        }
        None => Finding::failed("no run came near"),
    }
}
