//! Case 7: seven stars.

use sim_core::Method;

use super::{Finding, Tried};
use crate::problems::pleiades::problem;
use crate::problems::{Effort, Solve};

const TOLERANCE: f64 = 1e-10;

/// The first run with so many evaluations is the last one; a product with the Jacobian counts as four.
const MOST_CALLS: u64 = 200_000;

pub(super) fn test(method: &'static Method) -> Tried {
    let problem = problem();
    let [fewest, most] = problem.card().steps;
    let efforts: Vec<Effort> = match method.adaptive {
        true => (2..14).map(|n| Effort::Tolerance(10f64.powi(-n))).collect(),
        false => {
            let doubled = std::iter::successors(Some(fewest), |n| Some(2 * n));
            doubled
                .take_while(|&n| n <= most)
                .map(Effort::Steps)
                .collect()
        }
    };
    let mut best = None;
    for effort in efforts {
        // A method can fail if its steps are too long.
        let Ok(end) = problem.by_method(method, effort, true) else {
            continue;
        };
        if best.is_none_or(|(least, _)| end.error < least) {
            best = Some((end.error, end.evaluations));
        }
        if end.error <= TOLERANCE || end.evaluations + 4 * end.jacobians >= MOST_CALLS {
            break;
        }
    }
    let Some((error, evaluations)) = best else {
        return Ok(Finding::failed("no run came near"));
    };
    let why = match error <= TOLERANCE || method.adaptive {
        true => format!("in {evaluations} evaluations"),
        false => {
            // The error decreases with the number of evaluations to the power of the order.
            let factor = (error / TOLERANCE).powf(1.0 / f64::from(method.order));
            let needed = evaluations as f64 * factor;
            format!("in {evaluations} evaluations; by its order it would take {needed:.0e}")
        }
    };
    Ok(Finding::within(error, TOLERANCE, why))
}
