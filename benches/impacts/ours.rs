//! Scenes in a world of ours.

use std::sync::Arc;

use sim_core::{
    Body, BodyKind, Collision, DVec3, Force, Mesh, Method, Settings, Shape, Turn, Vec3, World,
};

use crate::scene::{Form, Scene};
use crate::watch::Engine;

impl Engine for World {
    fn step(&mut self) {
        World::step(self).expect("a step");
    }
}

pub(crate) fn world(scene: &Scene, collision: Collision, method: &str) -> World {
    let settings = Settings {
        dt: scene.dt,
        collision,
        method: Method::named(method).expect("a method"),
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("settings");
    let mut cube: Option<(f64, Arc<Mesh>)> = None;
    for item in &scene.items {
        let shape = item.form.as_ref().map(|form| match form {
            &Form::Wall(normal) => Shape::HalfSpace { normal },
            &Form::Ball(radius) => Shape::Sphere { radius },
            &Form::Cube(half) => {
                let known = cube.take().filter(|(known, _)| *known == half);
                let (_, mesh) = cube.insert(known.unwrap_or_else(|| (half, scaled_cube(half))));
                Shape::Mesh(mesh.clone())
            }
            Form::Mesh(mesh) | Form::Ground(mesh) => Shape::Mesh(mesh.clone()),
        });
        let body = Body {
            shape,
            position: item.position,
            velocity: item.velocity,
            kind: if item.is_fixed() {
                BodyKind::Kinematic
            } else {
                BodyKind::Dynamic
            },
            restitution: scene.restitution,
            friction: scene.friction,
            turn: (scene.turns && !item.is_fixed()).then(|| Turn {
                spin: item.spin,
                ..Turn::default()
            }),
            ..Body::default()
        };
        world.add(body).expect("a body");
    }
    if scene.gravity != DVec3::ZERO {
        let acceleration = scene.gravity;
        world
            .add_force(Force::Gravity { acceleration })
            .expect("a force");
    }
    world.build_bvhs();
    world
}

pub(crate) fn continuous(scene: &Scene) -> World {
    world(scene, Collision::Continuous, "velocity-verlet")
}

/// The cube of the assets has sides of 1 m.
fn scaled_cube(half: f64) -> Arc<Mesh> {
    let cube = crate::scene::builtin("cube.obj");
    let vertices = cube.vertices().iter();
    let vertices: Vec<Vec3> = vertices.map(|&v| v * (2.0 * half) as f32).collect();
    Arc::new(Mesh::new(vertices, cube.triangles().to_vec()).expect("a cube"))
}
