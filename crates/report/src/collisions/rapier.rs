//! Scenes of collisions in a world of Rapier, as its documentation advises: boxes and balls are its
//! own shapes, meshes are as they are (fixing internal edges costs the cube on the cow a quarter of
//! its energy), the limit on speeds is lifted, and the mover alone has `ccd_enabled`, as one such body never sweeps another.

use rapier3d_f64::prelude::*;
use sim_core::DVec3;

use super::scenes::{End, Form, Scene};
use crate::stopwatch;

/// A floor that is thick and wide, half of its sides, m.
const FLOOR: [f64; 3] = [100.0, 2.0, 100.0];

/// What a run ends with, and its time without setting it up, s. The time of an impact is the middle
/// of the step in which a velocity has changed by more than gravity.
pub(super) fn run(scene: &Scene, rate: u32) -> (End, f64) {
    let (mut world, bodies) = world(scene, rate);
    let dt = world.integration_parameters.dt;
    let motions = |world: &PhysicsWorld| {
        bodies.map(|body| {
            let body = &world.bodies[body];
            (from(body.translation()), from(body.linvel()))
        })
    };
    let mut time = None;
    let mut before = motions(&world);
    let ((), seconds) = stopwatch::timed(|| {
        for step in 0..scene.steps(rate) {
            world.step();
            if time.is_none() {
                let after = motions(&world);
                let change = (after[1].1 - before[1].1).length();
                if change > 2.0 * scene.gravity * dt + 1e-6 * before[1].1.length() {
                    time = Some((f64::from(step) + 0.5) * dt);
                }
                before = after;
            }
        }
    });
    let ends = motions(&world);
    let floor = scene.gravity != 0.0;
    let end = End {
        time,
        // The floor's middle is not its surface.
        positions: [if floor { DVec3::ZERO } else { ends[0].0 }, ends[1].0],
        velocities: ends.map(|end| end.1),
    };
    (end, seconds)
}

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn from(v: Vector) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

fn world(scene: &Scene, rate: u32) -> (PhysicsWorld, [RigidBodyHandle; 2]) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -scene.gravity, 0.0);
    let settings = &mut world.integration_parameters;
    settings.dt = 1.0 / f64::from(rate);
    settings.normalized_max_linear_velocity = Real::MAX;
    let bodies = [0, 1].map(|i| {
        let item = &scene.items[i];
        let is_floor = matches!(item.form, Form::Floor);
        let body = match is_floor {
            true => RigidBodyBuilder::fixed().translation(Vector::new(0.0, -FLOOR[1], 0.0)),
            false => RigidBodyBuilder::dynamic().translation(vector(item.position)),
        };
        let body = body
            .linvel(vector(item.velocity))
            .lock_rotations()
            .can_sleep(false)
            .ccd_enabled(i == 1);
        let collider = match &item.form {
            Form::Floor => ColliderBuilder::cuboid(FLOOR[0], FLOOR[1], FLOOR[2]),
            Form::Ball(radius) => ColliderBuilder::ball(*radius),
            Form::Cube(half, _) => ColliderBuilder::cuboid(*half, *half, *half),
            Form::Mesh(mesh) => {
                let vertices = mesh.vertices().iter().map(|v| vector(v.as_dvec3()));
                let (vertices, faces) = (vertices.collect(), mesh.triangles().to_vec());
                ColliderBuilder::trimesh(vertices, faces)
                    .unwrap_or_else(|error| unreachable!("{error}"))
            }
        };
        let collider = collider.mass(1.0).friction(0.0).restitution(1.0);
        world.insert(body, collider).0
    });
    (world, bodies)
}
