//! Collisions: error against the time of a step, over the length of a step and over speed.

mod bounce;
mod ours;
mod rapier;
mod scenes;

pub(crate) use bounce::Bounce;
use scenes::{End, Scene};

use crate::scope::Scope;
use crate::stopwatch;

/// Who steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Engine {
    Continuous,
    Discrete,
    Rapier,
}

impl Engine {
    pub(crate) const ALL: [Engine; 3] = [Engine::Continuous, Engine::Discrete, Engine::Rapier];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Engine::Continuous => "continuous",
            Engine::Discrete => "discrete",
            Engine::Rapier => "Rapier f64",
        }
    }

    fn run(self, scene: &Scene, rate: u32) -> (End, f64) {
        match self {
            Engine::Continuous => ours::run(scene, rate, sim_core::Collision::Continuous),
            Engine::Discrete => ours::run(scene, rate, sim_core::Collision::Bvh),
            Engine::Rapier => rapier::run(scene, rate),
        }
    }
}

/// A run and what it got wrong.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) engine: Engine,
    /// Steps a second.
    pub(crate) rate: u32,
    /// m/s.
    pub(crate) speed: f64,
    /// Of the first impact, s; `None` if there was none.
    pub(crate) time: Option<f64>,
    /// Of the ends, parts of the way.
    pub(crate) position: f64,
    /// Of the kinetic energy, or of the whole under gravity, relative.
    pub(crate) energy: f64,
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
const SPEEDS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

pub(crate) fn measure(scope: Scope) -> Collisions {
    let scenes = scenes::FAMILIES.iter().map(|family| {
        let mut runs = Vec::new();
        for &speed in &SPEEDS[..family.speeds] {
            let scene = (family.make)(speed);
            for rate in RATES {
                for engine in Engine::ALL {
                    runs.push(run(engine, &scene, rate, speed, scope));
                }
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

/// The error, from one run, and the median time of several.
fn run(engine: Engine, scene: &Scene, rate: u32, speed: f64, scope: Scope) -> Run {
    let (end, seconds) = engine.run(scene, rate);
    let more = (1..scope.repeats()).map(|_| engine.run(scene, rate).1);
    let mut samples: Vec<f64> = more.chain([seconds]).collect();
    let steps = f64::from(scene.steps(rate));
    Run {
        engine,
        rate,
        speed,
        time: end.time.map(|time| (time - scene.impact).abs()),
        position: scene.position_error(&end),
        energy: scene.energy_error(&end),
        seconds: stopwatch::middle(&mut samples) / steps,
    }
}
