//! Scenes of rest in a world of ours and in one of Rapier, which has its own boxes and balls, thick
//! boxes for walls, and may let bodies sleep, as it does unless told otherwise.

use std::sync::Arc;

use rapier3d_f64::prelude::*;
use sim_core::{Body, BodyKind, Bundled, DVec3, Force, Mesh, Settings, Shape, Vec3, World};

use super::scenes::{End, Form, Scene};

pub(super) trait Engine {
    fn step(&mut self);
    fn end(&self) -> End;
    /// What solving contacts at once has cost in the last step, where that is known.
    fn bundled(&self) -> Option<Bundled>;
}

pub(super) struct Ours(World);

impl Ours {
    pub(super) fn new(scene: &Scene, rate: u32) -> Ours {
        let settings = Settings {
            dt: 1.0 / f64::from(rate),
            ..Settings::default()
        };
        let mut world = World::new(settings).unwrap_or_else(|error| unreachable!("{error}"));
        for item in &scene.items {
            let is_wall = matches!(item.form, Form::Wall(_));
            let shape = match item.form {
                Form::Wall(normal) => Shape::HalfSpace { normal },
                Form::Ball(radius) => Shape::Sphere { radius },
                Form::Cube(half) => Shape::Mesh(cube(half)),
            };
            let body = Body {
                shape: Some(shape),
                position: item.position,
                velocity: item.velocity,
                kind: if is_wall {
                    BodyKind::Kinematic
                } else {
                    BodyKind::Dynamic
                },
                restitution: 0.0,
                friction: scene.friction,
                ..Body::default()
            };
            let added = world.add(body).map(drop);
            added.unwrap_or_else(|error| unreachable!("{error}"));
        }
        let acceleration = scene.gravity;
        let added = world.add_force(Force::Gravity { acceleration }).map(drop);
        added.unwrap_or_else(|error| unreachable!("{error}"));
        world.build_bvhs();
        Ours(world)
    }
}

/// The built-in cube has sides of 1 m.
fn cube(half: f64) -> Arc<Mesh> {
    let cube = scene::mesh_file::builtin("cube.obj");
    let cube = cube.unwrap_or_else(|| unreachable!("the cube is built in"));
    let vertices = cube.vertices().iter();
    let vertices: Vec<Vec3> = vertices.map(|&v| v * (2.0 * half) as f32).collect();
    let mesh = Mesh::new(vertices, cube.triangles().to_vec());
    Arc::new(mesh.unwrap_or_else(|error| unreachable!("{error}")))
}

impl Engine for Ours {
    fn step(&mut self) {
        // What fails is told by where it leaves the bodies.
        let _ = self.0.step();
    }

    fn end(&self) -> End {
        let motion = |i| (self.0.position(i), self.0.velocity(i));
        End((0..self.0.len()).map(motion).collect())
    }

    fn bundled(&self) -> Option<Bundled> {
        Some(self.0.bundled())
    }
}

pub(super) struct Rapier {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

/// Half of a wall's thickness and of its sides, m.
const THICK: f64 = 2.0;
const WIDE: f64 = 100.0;

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn from(v: Vector) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

impl Rapier {
    pub(super) fn new(scene: &Scene, rate: u32) -> Rapier {
        let mut world = PhysicsWorld::new();
        world.gravity = vector(scene.gravity);
        world.integration_parameters.dt = 1.0 / f64::from(rate);
        let bodies = scene.items.iter().map(|item| {
            let mut place = item.position;
            let (body, collider) = match item.form {
                Form::Wall(normal) => {
                    place -= THICK * normal;
                    let half = normal.abs() * THICK + (DVec3::ONE - normal.abs()) * WIDE;
                    let wall = ColliderBuilder::cuboid(half.x, half.y, half.z);
                    (RigidBodyBuilder::fixed(), wall)
                }
                Form::Ball(radius) => (RigidBodyBuilder::dynamic(), ColliderBuilder::ball(radius)),
                Form::Cube(half) => {
                    let cube = ColliderBuilder::cuboid(half, half, half);
                    (RigidBodyBuilder::dynamic(), cube)
                }
            };
            let body = body
                .translation(vector(place))
                .linvel(vector(item.velocity))
                .lock_rotations();
            let collider = collider.mass(1.0).friction(scene.friction);
            world.insert(body, collider.restitution(0.0)).0
        });
        let bodies = bodies.collect();
        Rapier { world, bodies }
    }
}

impl Engine for Rapier {
    fn step(&mut self) {
        self.world.step();
    }

    fn end(&self) -> End {
        let motions = self.bodies.iter().map(|&body| {
            let body = &self.world.bodies[body];
            (from(body.translation()), from(body.linvel()))
        });
        End(motions.collect())
    }

    fn bundled(&self) -> Option<Bundled> {
        None
    }
}
