//! The cost of each aspect: a single body, a body with a shape, one that might collide, and one that does; and the
//! bouncing ball.

use cases::scenes::{Form, Item, Rapier, Scene, Who, bouncing_ball, world};
use criterion::Criterion;
use kit::meshes::builtin;
use sim_core::{Collision, DVec3};

use crate::table::{Table, three_digits, time};
use crate::watch;
use crate::{row, short};

const STEPS: u32 = 2_000;

/// Scenes with the aspects, and their collision modes.
fn aspects() -> Vec<(&'static str, Scene, Collision)> {
    let (cow, velocity) = (Form::Mesh(builtin("cow.obj")), 0.3 * DVec3::X);
    let point = Item {
        form: None,
        ..Item::new(cow.clone(), DVec3::ZERO, velocity)
    };
    let alone = Item::new(cow.clone(), DVec3::ZERO, velocity);
    let far = Item::new(cow, 1e3 * DVec3::Y, -velocity);
    let one = |item: &Item| Scene::new(vec![item.clone()]);
    let two = |item: &Item| Scene::new(vec![item.clone(), far.clone()]);
    // A cube that moves to and fro between two walls, with one impact per step.
    let busy = Scene::new(vec![
        Item::new(Form::Wall(DVec3::X), -DVec3::X, DVec3::ZERO),
        Item::new(Form::Wall(-DVec3::X), DVec3::X, DVec3::ZERO),
        Item::new(Form::Cube(0.5), DVec3::ZERO, 60.0 * DVec3::X),
    ]);
    vec![
        ("a point", one(&point), Collision::Continuous),
        ("one cow", one(&alone), Collision::Continuous),
        ("two points", two(&point), Collision::Continuous),
        ("two cows far apart, discrete", two(&alone), Collision::Bvh),
        ("two cows far apart", two(&alone), Collision::Continuous),
        ("a cube with an impact a step", busy, Collision::Continuous),
        (
            "a bouncing ball",
            bouncing_ball().scene,
            Collision::Continuous,
        ),
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
        let start = world(&scene, collision, "velocity-verlet");
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
            bounce_errors()
        });
        row(
            &mut table,
            &cells.iter().map(String::as_str).collect::<Vec<_>>(),
        );
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}

/// Errors of height and energy, for our engine and Rapier.
fn bounce_errors() -> [String; 4] {
    let known = bouncing_ball();
    let [ours, theirs] = [Who::Continuous, Who::Rapier].map(|who| known.run(who));
    assert!(
        ours.error <= 1e-11 && ours.energy <= 1e-13,
        "the ball: {ours:?}"
    );
    [ours.error, ours.energy, theirs.error, theirs.energy].map(short)
}
