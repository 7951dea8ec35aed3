//! What each aspect costs: a body that is alone, that has a shape, that might meet another, that
//! does; and the bouncing ball.

use criterion::Criterion;
use sim_core::{Collision, DVec3, World};

use crate::rapier::Rapier;
use crate::scene::{Form, Item, Scene, builtin, item};
use crate::table::{Table, three_digits, time};
use crate::watch::{self, Engine};
use crate::{ours, row, short};

const STEPS: u32 = 2_000;
const G: f64 = 9.81;

/// A ball of no size, dropped from 1 m.
fn bounce() -> Scene {
    Scene {
        gravity: -G * DVec3::Y,
        ..Scene::new(vec![
            item(Form::Wall(DVec3::Y), DVec3::ZERO, DVec3::ZERO),
            item(Form::Ball(RADIUS), (1.0 + RADIUS) * DVec3::Y, DVec3::ZERO),
        ])
    }
}

const RADIUS: f64 = 0.25;

/// Seconds that the ball bounces for, and its height then: 1 - (t - 2 n √(2/g))² g/2.
const BOUNCING: f64 = 10.0;

fn height() -> f64 {
    let fall = (2.0 / G).sqrt();
    let from_top = BOUNCING - 2.0 * fall * (BOUNCING / (2.0 * fall)).round();
    1.0 - 0.5 * G * from_top * from_top
}

/// Where the ball is, and its energy, relative.
fn errors(height_now: f64, speed: f64) -> (f64, f64) {
    let energy = 0.5 * speed * speed + G * height_now;
    ((height_now - height()).abs(), (energy / G - 1.0).abs())
}

/// Scenes of what may cost something, and how they are asked.
fn aspects() -> Vec<(&'static str, Scene, Collision)> {
    let (cow, velocity) = (Form::Mesh(builtin("cow.obj")), 0.3 * DVec3::X);
    let point = Item {
        form: None,
        ..item(cow.clone(), DVec3::ZERO, velocity)
    };
    let alone = item(cow.clone(), DVec3::ZERO, velocity);
    let far = item(cow, 1e3 * DVec3::Y, -velocity);
    let one = |item: &Item| Scene::new(vec![item.clone()]);
    let two = |item: &Item| Scene::new(vec![item.clone(), far.clone()]);
    // A cube that goes to and fro between two walls, with an impact a step.
    let busy = Scene::new(vec![
        item(Form::Wall(DVec3::X), -DVec3::X, DVec3::ZERO),
        item(Form::Wall(-DVec3::X), DVec3::X, DVec3::ZERO),
        item(Form::Cube(0.5), DVec3::ZERO, 60.0 * DVec3::X),
    ]);
    vec![
        ("a point", one(&point), Collision::Continuous),
        ("one cow", one(&alone), Collision::Continuous),
        ("two points", two(&point), Collision::Continuous),
        ("two cows far apart, discrete", two(&alone), Collision::Bvh),
        ("two cows far apart", two(&alone), Collision::Continuous),
        ("a cube with an impact a step", busy, Collision::Continuous),
        ("a bouncing ball", bounce(), Collision::Continuous),
    ]
}

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "One or two bodies: a step; the ball's height and energy after 10 s",
        &[
            "what",
            "ours",
            "rapier 0.36",
            "ratio",
            "ours: height, m",
            "energy",
            "rapier: height, m",
            "energy",
        ],
    );
    let mut group = criterion.benchmark_group("impacts/one");
    for (name, scene, collision) in aspects() {
        let start = ours::world(&scene, collision, "velocity-verlet");
        let ours = watch::time(&mut group, &format!("{name}/ours"), STEPS, || start.clone());
        let theirs = watch::time(&mut group, &format!("{name}/rapier"), STEPS, || {
            Rapier::new(&scene)
        });
        let Some((ours, theirs)) = ours.zip(theirs) else {
            continue;
        };
        let mut cells = vec![
            name.to_owned(),
            time(ours),
            time(theirs),
            three_digits(theirs / ours),
        ];
        cells.extend(if scene.gravity == DVec3::ZERO {
            [(); 4].map(|()| "-".into())
        } else {
            bounce_errors(start, Rapier::new(&scene))
        });
        row(
            &mut table,
            &cells.iter().map(String::as_str).collect::<Vec<_>>(),
        );
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}

/// Of ours and of theirs: height, energy.
fn bounce_errors(mut world: World, mut rapier: Rapier) -> [String; 4] {
    for _ in 0..(BOUNCING * 60.0) as u32 {
        Engine::step(&mut world);
        rapier.step();
    }
    let ours = errors(world.position(1).y - RADIUS, world.velocity(1).length());
    let theirs = errors(rapier.position(1).y - RADIUS, rapier.velocity(1).length());
    assert!(ours.0 <= 1e-11 && ours.1 <= 1e-13, "the ball: {ours:?}");
    [ours.0, ours.1, theirs.0, theirs.1].map(short)
}
