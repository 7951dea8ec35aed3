//! Scenes in our worlds.

use std::sync::Arc;

use kit::meshes::builtin;
use sim_core::{
    Body, BodyKind, Bundled, Collision, DQuat, DVec3, Force, Mesh, Method, Settings, Shape,
    StepError, Turn, Vec3, World,
};

use super::{Engine, Form, Scene};

impl Engine for World {
    fn step(&mut self) -> Result<(), StepError> {
        World::step(self)
    }

    fn step_noting(&mut self) -> Result<Option<f64>, StepError> {
        let mut impacts = Vec::new();
        self.step_reporting(&mut impacts)?;
        Ok(impacts.first().map(|impact| impact.time))
    }

    fn position(&self, body: usize) -> DVec3 {
        World::position(self, body)
    }

    fn velocity(&self, body: usize) -> DVec3 {
        World::velocity(self, body)
    }

    fn rotation(&self, body: usize) -> DQuat {
        World::rotation(self, body)
    }

    fn spin(&self, body: usize) -> DVec3 {
        World::spin(self, body)
    }

    fn kinetic_energy(&self) -> f64 {
        World::kinetic_energy(self)
    }

    fn bundled(&self) -> Option<Bundled> {
        Some(World::bundled(self))
    }
}

/// A world with a collision mode and a method.
pub fn world(scene: &Scene, collision: Collision, method: &str) -> World {
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

/// A world in the continuous mode, with a method that is exact in free flight.
pub fn continuous(scene: &Scene) -> World {
    world(scene, Collision::Continuous, "velocity-verlet")
}

/// The cube in the assets has edges of 1 m.
fn scaled_cube(half: f64) -> Arc<Mesh> {
    let cube = builtin("cube.obj");
    let vertices = cube.vertices().iter();
    let vertices: Vec<Vec3> = vertices.map(|&v| v * (2.0 * half) as f32).collect();
    Arc::new(Mesh::new(vertices, cube.triangles().to_vec()).expect("a cube"))
}
