//! Scenes in a world of Rapier, set up as its documentation advises.
//!
//! Boxes and balls are Rapier's primitives; walls are thick boxes. Meshes are used unchanged, which gives the least
//! errors for a cube on the cow, or with internal edges fixed, which gives the least for the cow on itself. The limit
//! on speeds is lifted. Continuous detection of moving bodies is enabled with `ccd_enabled`; one such body never sweeps
//! another, so of a pair only the moving body has it. Bodies sleep only if a scene allows it, so that all of them are
//! simulated.

use rapier3d_f64::prelude::*;
use sim_core::{DQuat, DVec3, StepError};

use super::{Engine, Form, Scene};

/// A world of Rapier.
pub struct Rapier {
    world: PhysicsWorld,
    handles: Vec<RigidBodyHandle>,
    turns: bool,
    steps: u64,
}

impl Engine for Rapier {
    fn step(&mut self) -> Result<(), StepError> {
        self.steps += 1;
        self.world.step();
        Ok(())
    }

    /// Returns the middle of the step, if the second body's velocity has changed by more than gravity explains.
    fn step_noting(&mut self) -> Result<Option<f64>, StepError> {
        let before = self.velocity(1);
        self.step()?;
        let change = (self.velocity(1) - before).length();
        let dt = self.world.integration_parameters.dt;
        let most = 2.0 * dt * self.world.gravity.length() + 1e-6 * before.length();
        Ok((change > most).then_some((self.steps as f64 - 0.5) * dt))
    }

    fn position(&self, body: usize) -> DVec3 {
        let p = self.world.bodies[self.handles[body]].translation();
        DVec3::new(p.x, p.y, p.z)
    }

    fn velocity(&self, body: usize) -> DVec3 {
        let v = self.world.bodies[self.handles[body]].linvel();
        DVec3::new(v.x, v.y, v.z)
    }

    fn rotation(&self, body: usize) -> DQuat {
        let r = self.world.bodies[self.handles[body]].rotation();
        DQuat::from_xyzw(r.x, r.y, r.z, r.w)
    }

    fn spin(&self, body: usize) -> DVec3 {
        let w = self.world.bodies[self.handles[body]].angvel();
        DVec3::new(w.x, w.y, w.z)
    }

    fn kinetic_energy(&self) -> f64 {
        if self.turns {
            let bodies = self.handles.iter().map(|&body| &self.world.bodies[body]);
            let movable = bodies.filter(|body| body.is_dynamic());
            return movable.map(RigidBody::kinetic_energy).sum();
        }
        // Every body has 1 kg.
        let squares = (0..self.handles.len()).map(|i| self.velocity(i).length_squared());
        0.5 * squares.sum::<f64>()
    }
}

pub(crate) fn vector(v: DVec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

impl Rapier {
    /// A world with unchanged meshes.
    pub fn new(scene: &Scene) -> Rapier {
        Rapier::with_flags(scene, TriMeshFlags::empty())
    }

    /// A world with meshes whose internal edges cause no contacts.
    pub fn with_internal_edges_fixed(scene: &Scene) -> Rapier {
        Rapier::with_flags(scene, TriMeshFlags::FIX_INTERNAL_EDGES)
    }

    fn with_flags(scene: &Scene, flags: TriMeshFlags) -> Rapier {
        let mut world = PhysicsWorld::new();
        world.gravity = vector(scene.gravity);
        let settings = &mut world.integration_parameters;
        settings.dt = scene.dt;
        settings.normalized_max_linear_velocity = Real::MAX;
        let handles = scene.items.iter().map(|item| {
            let body = match item.is_fixed() {
                true => RigidBodyBuilder::fixed(),
                false => RigidBodyBuilder::dynamic(),
            };
            let mut place = item.position;
            let collider = item.form.as_ref().map(|form| match form {
                Form::Wall(normal) => {
                    place -= THICK * *normal;
                    let half = normal.abs() * THICK + (DVec3::ONE - normal.abs()) * WIDE;
                    ColliderBuilder::cuboid(half.x, half.y, half.z)
                }
                Form::Ball(radius) => ColliderBuilder::ball(*radius),
                Form::Cube(half) => ColliderBuilder::cuboid(*half, *half, *half),
                Form::Mesh(mesh) | Form::Ground(mesh) => {
                    let vertices = mesh.vertices().iter().map(|v| vector(v.as_dvec3()));
                    let (vertices, faces) = (vertices.collect(), mesh.triangles().to_vec());
                    ColliderBuilder::trimesh_with_flags(vertices, faces, flags).expect("a mesh")
                }
            });
            let body = match scene.turns {
                true => body.angvel(vector(item.spin)),
                false => body.lock_rotations(),
            };
            let body = body
                .translation(vector(place))
                .linvel(vector(item.velocity))
                .can_sleep(scene.may_sleep)
                .ccd_enabled(item.is_bullet && !item.is_fixed());
            match collider {
                Some(collider) => {
                    let collider = collider.mass(1.0).friction(scene.friction);
                    let collider = collider.restitution(scene.restitution);
                    world.insert(body, collider).0
                }
                None => world.insert_body(body.additional_mass(1.0)),
            }
        });
        let handles = handles.collect();
        Rapier {
            world,
            handles,
            turns: scene.turns,
            steps: 0,
        }
    }
}

/// Half the thickness of a wall, and half its sides, m.
const THICK: f64 = 2.0;
const WIDE: f64 = 100.0;
