//! Scenes in a world of Rapier, as its documentation advises.
//!
//! Boxes and balls are shapes of its own, walls are thick boxes. Meshes are as they are, which of a
//! cube on the cow makes the least errors, or have internal edges fixed, which of the cow on itself
//! does. Its limit on speeds is lifted. Continuous detection of moving bodies is asked for with
//! `ccd_enabled`; as one such body never sweeps another, of a pair only
//! the mover has it. Bodies sleep only where a scene lets them, so that all of them are simulated.

use rapier3d_f64::prelude::*;
use sim_core::DVec3;

use crate::scene::{Form, Scene};
use crate::watch::Engine;

pub(crate) struct Rapier {
    pub(crate) world: PhysicsWorld,
    pub(crate) handles: Vec<RigidBodyHandle>,
}

impl Engine for Rapier {
    fn step(&mut self) {
        self.world.step();
    }
}

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

impl Rapier {
    pub(crate) fn new(scene: &Scene) -> Rapier {
        Rapier::with_flags(scene, TriMeshFlags::empty())
    }

    pub(crate) fn with_internal_edges_fixed(scene: &Scene) -> Rapier {
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
        Rapier { world, handles }
    }

    pub(crate) fn position(&self, body: usize) -> DVec3 {
        let p = self.world.bodies[self.handles[body]].translation();
        DVec3::new(p.x, p.y, p.z)
    }

    pub(crate) fn velocity(&self, body: usize) -> DVec3 {
        let v = self.world.bodies[self.handles[body]].linvel();
        DVec3::new(v.x, v.y, v.z)
    }

    pub(crate) fn is_movable(&self, body: usize) -> bool {
        self.world.bodies[self.handles[body]].is_dynamic()
    }

    /// Of one that may turn.
    pub(crate) fn energy_of(&self, body: usize) -> f64 {
        self.world.bodies[self.handles[body]].kinetic_energy()
    }

    /// Of all bodies, which have 1 kg each and do not turn.
    pub(crate) fn kinetic_energy(&self) -> f64 {
        let squares = (0..self.handles.len()).map(|i| self.velocity(i).length_squared());
        0.5 * squares.sum::<f64>()
    }
}

/// Half of a wall's thickness and of its sides, m.
const THICK: f64 = 2.0;
const WIDE: f64 = 100.0;
