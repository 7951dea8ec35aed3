//! Scenes of collisions in a world of ours.

use sim_core::{Body, BodyKind, Collision, DVec3, Force, Method, Settings, Shape, World};

use super::scenes::{End, Form, Scene};
use crate::stopwatch;

/// What a run ends with, and its time without setting it up, s.
pub(super) fn run(scene: &Scene, rate: u32, collision: Collision) -> (End, f64) {
    let mut world = world(scene, rate, collision);
    let mut impacts = Vec::new();
    let ((), seconds) = stopwatch::timed(|| {
        for _ in 0..scene.steps(rate) {
            // What fails is told by where it leaves the bodies.
            let _ = world.step_reporting(&mut impacts);
        }
    });
    let end = End {
        time: impacts.first().map(|impact| impact.time),
        positions: [0, 1].map(|i| world.position(i)),
        velocities: [0, 1].map(|i| world.velocity(i)),
    };
    (end, seconds)
}

fn world(scene: &Scene, rate: u32, collision: Collision) -> World {
    let settings = Settings {
        dt: 1.0 / f64::from(rate),
        collision,
        method: Method::named("velocity-verlet").unwrap_or(Settings::default().method),
        ..Settings::default()
    };
    let mut world = World::new(settings).unwrap_or_else(|error| unreachable!("{error}"));
    for item in &scene.items {
        let is_floor = matches!(item.form, Form::Floor);
        let shape = match &item.form {
            Form::Floor => Shape::HalfSpace { normal: DVec3::Y },
            &Form::Ball(radius) => Shape::Sphere { radius },
            Form::Cube(_, mesh) | Form::Mesh(mesh) => Shape::Mesh(mesh.clone()),
        };
        let body = Body {
            shape: Some(shape),
            position: item.position,
            velocity: item.velocity,
            kind: if is_floor {
                BodyKind::Static
            } else {
                BodyKind::Dynamic
            },
            ..Body::default()
        };
        let added = world.add(body).map(drop);
        added.unwrap_or_else(|error| unreachable!("{error}"));
    }
    if scene.gravity != 0.0 {
        let acceleration = -scene.gravity * DVec3::Y;
        let added = world.add_force(Force::Gravity { acceleration }).map(drop);
        added.unwrap_or_else(|error| unreachable!("{error}"));
    }
    world.build_bvhs();
    world
}
