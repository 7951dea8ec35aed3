//! Friction, stacks and heaps: error against the time and the length of a step.

mod scenes;
mod worlds;

use scenes::{Goal, Scene};
use worlds::{Ours, Rapier};

use crate::collisions::Engine;
use crate::scope::Scope;
use crate::stopwatch;

/// Whose contacts last; the discrete mode has none.
pub(crate) const ENGINES: [Engine; 2] = [Engine::Continuous, Engine::Rapier];

/// A run and what it got wrong.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) engine: Engine,
    /// Steps a second.
    pub(crate) rate: u32,
    /// As the scene has it.
    pub(crate) error: f64,
    /// How deep bodies have been in each other at the end of a step, m.
    pub(crate) overlap: f64,
    /// The most that the energy has risen in a step, of that at the start.
    pub(crate) rise: f64,
    /// Energy that bundled contacts have taken, of that at the start; `None` where nothing is bundled.
    pub(crate) bundled: Option<f64>,
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
    let scenes = scenes::all().into_iter().map(|scene| {
        let runs = rates.iter().flat_map(|&rate| {
            let scene = &scene;
            ENGINES.into_iter().map(move |engine| match engine {
                Engine::Rapier => run(scene, rate, engine, || Rapier::new(scene, rate)),
                _ => run(scene, rate, engine, || Ours::new(scene, rate)),
            })
        });
        Resting {
            runs: runs.collect(),
            name: scene.name,
            title: scene.title,
            about: scene.about,
            error: scene.goal.unit(),
        }
    });
    scenes.collect()
}

/// Errors from a run step by step, time from another one, over which nothing is looked at.
fn run<E: worlds::Engine>(scene: &Scene, rate: u32, engine: Engine, start: impl Fn() -> E) -> Run {
    let steps = scene.steps(rate);
    let mut world = start();
    let before = scene.energy(&world.end());
    let (mut overlap, mut rise, mut now) = (0.0_f64, 0.0_f64, before);
    let (mut energy, mut distance) = (0.0, 0.0_f64);
    for _ in 0..steps {
        world.step();
        let end = world.end();
        overlap = overlap.max(scene.overlap(&end));
        let after = scene.energy(&end);
        rise = rise.max(after - now);
        now = after;
        let bundled = world.bundled().unwrap_or_default();
        energy += bundled.energy;
        distance = distance.max(bundled.distance);
    }
    let error = match &scene.goal {
        Goal::Places { at, way } => scene.farthest(&world.end(), at) / way,
        Goal::Heap => distance.max(overlap),
    };
    let mut world = start();
    let ((), seconds) = stopwatch::timed(|| (0..steps).for_each(|_| world.step()));
    Run {
        engine,
        rate,
        error,
        overlap,
        rise: rise / before,
        bundled: world.bundled().map(|_| energy / before),
        seconds: seconds / f64::from(steps),
    }
}
