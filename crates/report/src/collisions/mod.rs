//! Collisions: error against the time of a step, over the length of a step and over speed.

mod bounce;

pub(crate) use bounce::Bounce;
use cases::scenes::{self, COLLISIONS, Known, Who};

use crate::scope::Scope;
use crate::stopwatch;

/// A run and what it got wrong.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) who: Who,
    /// Steps a second.
    pub(crate) rate: u32,
    /// m/s.
    pub(crate) speed: f64,
    pub(crate) found: scenes::Run,
    /// Of one step, s.
    pub(crate) seconds: f64,
}

/// All runs with one scene.
#[derive(Debug)]
pub(crate) struct Scenes {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) about: &'static str,
    pub(crate) runs: Vec<Run>,
}

pub(crate) struct Collisions {
    pub(crate) scenes: Vec<Scenes>,
    pub(crate) bounces: Vec<Bounce>,
}

/// The speed at which steps are swept, and the rate at which speeds are.
pub(crate) const SPEED: f64 = 10.0;
pub(crate) const RATE: u32 = 60;
const RATES: [u32; 6] = [30, 60, 120, 240, 480, 960];

pub(crate) fn measure(scope: Scope) -> Collisions {
    let scenes = COLLISIONS.iter().map(|family| {
        let mut runs = Vec::new();
        for &speed in family.speeds {
            for rate in RATES {
                let known = (family.make)(speed).at_rate(rate);
                let run = |&who| run(who, &known, rate, speed, scope);
                runs.extend(Who::ALL.iter().map(run));
            }
        }
        Scenes {
            name: family.name,
            title: family.title,
            about: family.about,
            runs,
        }
    });
    Collisions {
        scenes: scenes.collect(),
        bounces: bounce::measure(scope),
    }
}

/// The error, from one run, and the median time of others.
fn run(who: Who, known: &Known, rate: u32, speed: f64, scope: Scope) -> Run {
    let times = (0..scope.repeats()).map(|_| seconds(who, known));
    let mut samples: Vec<f64> = times.collect();
    Run {
        who,
        rate,
        speed,
        found: known.run(who),
        seconds: stopwatch::middle(&mut samples),
    }
}

/// Mean time of a step, s, of a run at which nothing looks.
pub(crate) fn seconds(who: Who, known: &Known) -> f64 {
    let mut engine = who.start(&known.scene);
    let steps = known.steps();
    let ((), seconds) = stopwatch::timed(|| {
        for _ in 0..steps {
            // What fails is told by where it leaves the bodies.
            let _ = engine.step();
        }
    });
    seconds / f64::from(steps)
}
