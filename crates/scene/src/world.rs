//! A scene to a running world.

use std::sync::Arc;

use glam::{DQuat, DVec3, EulerRot};
use sim_core::{Body, Mesh, MeshError, Settings, Shape, World};

use crate::scene::{Scene, SceneBody, SceneShape};
use crate::{MeshRef, SceneError};

impl Scene {
    /// The world of this scene, at time 0, with the bodies in the same order.
    ///
    /// Rotation and scale are baked into the meshes; bodies with the same mesh, rotation and
    /// scale share one.
    pub fn world(&self) -> Result<World, SceneError> {
        let settings = Settings {
            dt: self.dt,
            method: self.method,
            collision: self.collision,
            tolerance: self.tolerance,
        };
        let mut world =
            World::new(settings).map_err(|error| self.world_error(None, None, error))?;
        let mut baked: Vec<Option<Arc<Mesh>>> = Vec::with_capacity(self.bodies.len());
        for (i, body) in self.bodies.iter().enumerate() {
            let mut earlier = self.bodies[..i].iter();
            let twin = earlier.position(|other| same_mesh(body, other));
            let mesh = match (body.mesh(), twin) {
                (Some(_), Some(twin)) => baked[twin].clone(),
                (Some(mesh), None) => Some(bake(mesh, body).map_err(|error| {
                    self.world_error(Some(body), Some(baked_field(&error)), error)
                })?),
                (None, _) => None,
            };
            baked.push(mesh.clone());
            let added = world.add(Body {
                shape: match body.shape {
                    SceneShape::Mesh(_) => mesh.map(Shape::Mesh),
                    SceneShape::Sphere { radius } => Some(Shape::Sphere { radius }),
                    SceneShape::HalfSpace { normal } => Some(Shape::HalfSpace { normal }),
                },
                position: body.position,
                velocity: body.velocity,
                mass: body.mass,
                force: body.force,
                restitution: body.restitution,
                friction: body.friction,
            });
            added.map_err(|error| self.world_error(Some(body), None, error))?;
        }
        for (i, force) in self.forces.iter().enumerate() {
            let field = format!("force {}", i + 1);
            let added = world.add_force(force.clone());
            added.map_err(|error| self.world_error(None, Some(&field), error))?;
        }
        Ok(world)
    }

    fn world_error(
        &self,
        body: Option<&SceneBody>,
        field: Option<&str>,
        what: impl std::fmt::Display,
    ) -> SceneError {
        SceneError::World {
            scene: self.name.clone(),
            body: body.map(|body| body.name.clone()),
            field: field.map(str::to_owned),
            what: what.to_string(),
        }
    }
}

fn same_mesh(a: &SceneBody, b: &SceneBody) -> bool {
    let meshes = a.mesh().zip(b.mesh());
    meshes.is_some_and(|(first, second)| Arc::ptr_eq(first.mesh(), second.mesh()))
        && a.rotation == b.rotation
        && a.scale == b.scale
}

/// The mesh of a body, turned and scaled.
pub(crate) fn bake(mesh: &MeshRef, body: &SceneBody) -> Result<Arc<Mesh>, MeshError> {
    if body.rotation == DVec3::ZERO && body.scale == DVec3::ONE {
        return Ok(mesh.mesh().clone());
    }
    // Fixed axes in the order x, y, z are moving axes in the order z, y, x.
    let [x, y, z] = body.rotation.to_array().map(f64::to_radians);
    let rotation = DQuat::from_euler(EulerRot::ZYX, z, y, x);
    mesh.mesh().transformed(rotation, body.scale).map(Arc::new)
}

/// The field that makes baking fail.
pub(crate) fn baked_field(error: &MeshError) -> &'static str {
    match error {
        MeshError::Rotation => "rotation",
        _ => "scale",
    }
}
