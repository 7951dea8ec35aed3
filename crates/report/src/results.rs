//! Everything that is measured, in the order in which it is.

use cases::hard_cases::attempt_all;
use cases::{Outcome, problems};

use crate::collisions::{self, Collisions};
use crate::contact;
use crate::drift::{self, Drift};
use crate::resting::{self, Resting};
use crate::runs::{self, Diagram};
use crate::scope::Scope;
use crate::stability;
use crate::turning::{self, Turning};

pub(crate) struct Results {
    pub(crate) diagrams: Vec<Diagram>,
    pub(crate) drifts: Vec<Drift>,
    pub(crate) stability: Vec<stability::Row>,
    pub(crate) cases: Vec<Outcome>,
    pub(crate) contact: Vec<contact::Row>,
    pub(crate) collisions: Collisions,
    pub(crate) resting: Vec<Resting>,
    pub(crate) turning: Turning,
}

/// Measures all, and says what it is at.
pub(crate) fn measure(scope: Scope, mut progress: impl FnMut(&str)) -> Results {
    let problems = problems::all();
    let count = problems.len();
    let mut diagrams: Vec<Diagram> = problems
        .iter()
        .enumerate()
        .map(|(i, problem)| {
            let title = problem.card().title;
            progress(&format!("problem {} of {count}: {title}", i + 1));
            runs::diagram(problem.as_ref(), scope)
        })
        .collect();
    let passes = scope.repeats();
    runs::time(&problems, &mut diagrams, scope, |pass| {
        progress(&format!("timing, pass {pass} of {passes}"));
    });
    progress("naive against BVH");
    let contact = contact::measure(scope);
    progress("collisions");
    let collisions = collisions::measure(scope);
    progress("friction, stacks and heaps");
    let resting = resting::measure(scope);
    progress("bodies that turn");
    let turning = turning::measure(scope);
    progress("drift");
    let drifts = drift::measure(scope);
    progress("stability");
    let stability = stability::measure(scope);
    progress("hard cases");
    let cases = attempt_all();
    Results {
        diagrams,
        drifts,
        stability,
        cases,
        contact,
        collisions,
        resting,
        turning,
    }
}
