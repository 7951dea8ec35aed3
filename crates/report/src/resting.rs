//! Friction, stacks and heaps: error against the time and the length of a step.

use cases::scenes::{self, RESTING, Who};

use crate::collisions::seconds;
use crate::scope::Scope;

/// Whose contacts last; the discrete mode has none.
pub(crate) const ENGINES: [Who; 2] = [Who::Continuous, Who::Rapier];

/// A run and what it got wrong.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) who: Who,
    /// Steps a second.
    pub(crate) rate: u32,
    pub(crate) found: scenes::Run,
    /// Mean of the steps, s.
    pub(crate) seconds: f64,
}

/// All runs with one scene.
#[derive(Debug)]
pub(crate) struct Resting {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) about: &'static str,
    pub(crate) error: &'static str,
    pub(crate) runs: Vec<Run>,
}

const RATES: [u32; 6] = [30, 60, 120, 240, 480, 960];

pub(crate) fn measure(scope: Scope) -> Vec<Resting> {
    let rates = match scope {
        Scope::Full => &RATES[..],
        Scope::Quick => &RATES[1..3],
    };
    let scenes = RESTING.iter().map(|family| {
        // They have one speed each.
        let known = (family.make)(0.0);
        let mut runs = Vec::new();
        for &rate in rates {
            let known = known.clone().at_rate(rate);
            runs.extend(ENGINES.map(|who| Run {
                who,
                rate,
                found: known.run(who),
                seconds: seconds(who, &known),
            }));
        }
        Resting {
            runs,
            name: family.name,
            title: family.title,
            about: family.about,
            error: known.goal.unit(),
        }
    });
    scenes.collect()
}
