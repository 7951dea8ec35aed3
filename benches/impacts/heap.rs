//! Balls that fall on a heap between walls, and give back a part of their speed only.

use std::time::Instant;

use sim_core::DVec3;

use crate::ours;
use crate::random::Random;
use crate::rapier::Rapier;
use crate::scene::{Form, HALF, Scene, item};
use crate::table::{Table, three_digits, time};
use crate::watch::{self, Engine};
use crate::{row, short};

/// Two seconds, in which they fall, and settle.
const STEPS: usize = 120;
const WALLS: usize = 5;

/// Layers of so many by so many, a fifth of a ball apart, above a floor.
fn scene(balls: usize, side: usize, restitution: f64, friction: f64) -> Scene {
    let pitch = 2.4 * HALF;
    let half = 0.5 * pitch * side as f64;
    let mut random = Random(5);
    let mut items = vec![item(Form::Wall(DVec3::Y), DVec3::ZERO, DVec3::ZERO)];
    for normal in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
        items.push(item(Form::Wall(normal), -half * normal, DVec3::ZERO));
    }
    for i in 0..balls {
        let cell = [i % side, i / side / side, i / side % side].map(|c| (c as f64 + 0.5) * pitch);
        let shake = DVec3::from_array([(); 3].map(|()| 2.0 * random.unit() - 1.0));
        let at = DVec3::from_array(cell) - DVec3::new(half, 0.0, half) + 0.02 * shake;
        items.push(item(Form::Ball(HALF), at, DVec3::ZERO));
    }
    Scene {
        gravity: -9.81 * DVec3::Y,
        restitution,
        friction,
        ..Scene::new(items)
    }
}

/// What a run has shown.
#[derive(Default)]
struct Run {
    mean: f64,
    worst: f64,
    /// Most that the energy has risen in a step, and the energy at the start, J.
    rise: f64,
    start: f64,
    /// How deep a ball has been in another one or in a wall at the end of a step, m.
    depth: f64,
}

fn run<E: Engine>(
    scene: &Scene,
    mut engine: E,
    kinetic: impl Fn(&E) -> f64,
    position: impl Fn(&E, usize) -> DVec3,
) -> Run {
    let energy = |engine: &E| {
        let heights = (WALLS..scene.items.len()).map(|i| position(engine, i).y);
        kinetic(engine) + 9.81 * heights.sum::<f64>()
    };
    let mut run = Run {
        start: energy(&engine),
        ..Run::default()
    };
    let mut before = run.start;
    for _ in 0..STEPS {
        let clock = Instant::now();
        engine.step();
        let seconds = clock.elapsed().as_secs_f64();
        run.mean += seconds / STEPS as f64;
        run.worst = run.worst.max(seconds);
        let after = energy(&engine);
        run.rise = run.rise.max(after - before);
        before = after;
        let at = |i: usize| position(&engine, i);
        for j in WALLS..scene.items.len() {
            let depths = (0..j).map(|i| match &scene.items[i].form {
                Some(Form::Wall(normal)) => HALF - normal.dot(at(j) - scene.items[i].position),
                _ => 2.0 * HALF - (at(i) - at(j)).length(),
            });
            run.depth = depths.fold(run.depth, f64::max);
        }
    }
    run
}

pub(crate) fn bench() -> Option<Table> {
    // Once, as a test, it takes a second; unoptimised a minute.
    if !watch::is_timed() {
        return None;
    }
    let mut table = Table::new(
        "Heaps of balls, 2 s: the energy of the start is some 600 J for 30, 3 kJ for 100",
        &[
            "balls",
            "restitution",
            "friction",
            "engine",
            "step",
            "ratio",
            "longest step",
            "energy rises by, J",
            "overlap, m",
        ],
    );
    for (balls, side, restitution, friction) in [
        (30, 3, 0.0, 0.0),
        (30, 3, 0.3, 0.0),
        (30, 3, 0.7, 0.0),
        (30, 3, 0.0, 0.3),
        (30, 3, 0.3, 0.3),
        (100, 4, 0.0, 0.0),
        (100, 4, 0.0, 0.3),
        (100, 4, 0.3, 0.3),
    ] {
        let scene = scene(balls, side, restitution, friction);
        let ours = run(
            &scene,
            ours::continuous(&scene),
            |world| world.kinetic_energy(),
            |world, body| world.position(body),
        );
        assert!(
            ours.rise <= 1e-12 * ours.start,
            "energy up by {:e}",
            ours.rise
        );
        assert!(ours.depth <= 1e-15, "{:e} m in each other", ours.depth);
        let theirs = run(
            &scene,
            Rapier::new(&scene),
            Rapier::kinetic_energy,
            Rapier::position,
        );
        let first = ours.mean;
        for (engine, run) in [("ours", ours), ("rapier 0.36", theirs)] {
            let cells = [
                &balls.to_string(),
                &restitution.to_string(),
                &friction.to_string(),
                engine,
                &time(run.mean),
                &three_digits(run.mean / first),
                &time(run.worst),
                &short(run.rise.max(0.0)),
                &short(run.depth.max(0.0)),
            ];
            row(&mut table, &cells);
        }
    }
    Some(table)
}
