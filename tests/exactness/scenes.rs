//! Generates scenes of a kind and judges them.

use std::env;

use kit::random::Random;
use kit::worlds::{meeting, world_of};
use sim_core::{Body, Collision, Impact, Settings, World};

/// The statistics of a kind.
#[derive(Default)]
struct Tally {
    judged: usize,
    wrong: usize,
    shown: Vec<String>,
}

/// Judges scenes of a kind: the requested number, or the usual one. A scene that does not belong to its kind, for
/// example because bodies overlap from the start, does not count.
pub(crate) fn judge(usual: usize, case: impl Fn(&mut Random) -> Option<Result<(), String>>) {
    judge_from(0, usual, case);
}

/// The same, beginning at another scene.
pub(crate) fn judge_from(
    begin: usize,
    usual: usize,
    case: impl Fn(&mut Random) -> Option<Result<(), String>>,
) {
    let number = |name| {
        env::var(name)
            .ok()
            .map(|text: String| text.parse().expect("a number"))
    };
    let count: usize = number("CASES").unwrap_or(usual);
    let first = number("FIRST").unwrap_or(begin);
    let mut tally = Tally::default();
    for index in first.. {
        if tally.judged == count || index == first + 8 * count {
            break;
        }
        // Each scene has its own seed, so that it can be generated alone.
        let mut random = Random::splitmix((index as u64).wrapping_mul(0xd134_2543_de82_ef95));
        let Some(verdict) = case(&mut random) else {
            continue;
        };
        tally.judged += 1;
        if let Err(what) = verdict {
            tally.wrong += 1;
            if tally.shown.len() < 6 {
                tally.shown.push(format!("FIRST={index}: {what}"));
            }
        }
    }
    let Tally {
        judged,
        wrong,
        shown,
    } = tally;
    println!("{judged} judged, {wrong} wrong");
    assert_eq!(judged, count, "too few scenes of this kind");
    assert_eq!(wrong, 0, "of {judged}:\n{}", shown.join("\n"));
}

pub(crate) fn world(dt: f64, bodies: Vec<Body>) -> World {
    let settings = Settings {
        dt,
        collision: Collision::Continuous,
        ..Settings::default()
    };
    world_of(settings, bodies)
}

/// The most impacts of a step with a few bodies.
const MOST: usize = 2_000;

/// Makes a step and checks it: for an error, too many impacts, or overlapping bodies.
pub(crate) fn step(world: &mut World) -> Result<Vec<Impact>, String> {
    let mut impacts = Vec::new();
    let at = world.steps() + 1;
    world
        .step_reporting(&mut impacts)
        .map_err(|error| error.to_string())?;
    if impacts.len() > MOST {
        return Err(format!("step {at}: {} impacts", impacts.len()));
    }
    let pairs = meeting(world, *world.settings());
    match pairs.is_empty() {
        true => Ok(impacts),
        false => Err(format!("step {at}: {pairs:?} meet")),
    }
}

/// Kinetic energy, and potential energy under a weight along -y, J.
pub(crate) fn energy(world: &World, gravity: f64) -> f64 {
    let movable = (0..world.len()).filter(|&i| world.kind(i).is_movable());
    let potential = movable.map(|i| world.mass(i) * gravity * world.position(i).y);
    world.kinetic_energy() + potential.sum::<f64>()
}
