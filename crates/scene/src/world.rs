//! A scene to a running world.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DQuat, DVec3, EulerRot};
use sim_core::{Body, BodyKind, Groups, Mesh, MeshError, Settings, Shape, World};

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
        let names = group_names(&self.bodies);
        if names.len() > MOST_GROUPS {
            let what = format!(
                "{} groups are named: there can be {MOST_GROUPS}",
                names.len()
            );
            return Err(self.world_error(None, Some("groups"), what));
        }
        let mut baked = Baked::default();
        for body in &self.bodies {
            let shape = match &body.shape {
                SceneShape::Mesh(mesh) => {
                    let mesh = baked.mesh(mesh, body);
                    Shape::Mesh(mesh.map_err(|error| {
                        self.world_error(Some(body), Some(baked_field(&error)), error)
                    })?)
                }
                &SceneShape::Sphere { radius } => Shape::Sphere { radius },
                &SceneShape::HalfSpace { normal } => Shape::HalfSpace { normal },
            };
            let added = world.add(Body {
                shape: Some(shape),
                position: body.position,
                velocity: body.velocity,
                kind: kind(body),
                mass: body.mass,
                force: body.force,
                restitution: body.restitution,
                friction: body.friction,
                groups: Groups {
                    member_of: bits(&names, body.groups.as_deref()),
                    collides_with: bits(&names, body.collides_with.as_deref()),
                },
                ..Body::default()
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

/// Groups that bodies of a scene can be in.
const MOST_GROUPS: usize = 32;

/// The names of all groups of some bodies, in the order in which they come up.
fn group_names(bodies: &[SceneBody]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for body in bodies {
        let own = body.groups.iter().chain(&body.collides_with).flatten();
        for name in own {
            // More than there can be are not counted one by one.
            if !names.contains(&name.as_str()) && names.len() <= MOST_GROUPS {
                names.push(name);
            }
        }
    }
    names
}

/// A bit for each of some groups, all bits where none are named.
fn bits(names: &[&str], groups: Option<&[String]>) -> u32 {
    let bit = |name: &String| names.iter().position(|known| known == name);
    groups.map_or(u32::MAX, |groups| {
        groups
            .iter()
            .filter_map(bit)
            .fold(0, |bits, bit| bits | 1 << bit)
    })
}

fn kind(body: &SceneBody) -> BodyKind {
    match (body.immovable, body.velocity == DVec3::ZERO) {
        (false, _) => BodyKind::Dynamic,
        (true, false) => BodyKind::Kinematic,
        (true, true) => BodyKind::Static,
    }
}

/// Meshes that have been turned and scaled, each once.
#[derive(Default)]
pub(crate) struct Baked {
    /// By the mesh, as a place in memory, rotation and scale.
    known: HashMap<(usize, [u64; 6]), Arc<Mesh>>,
}

impl Baked {
    /// The mesh of a body, turned and scaled.
    pub(crate) fn mesh(
        &mut self,
        mesh: &MeshRef,
        body: &SceneBody,
    ) -> Result<Arc<Mesh>, MeshError> {
        if body.rotation == DVec3::ZERO && body.scale == DVec3::ONE {
            return Ok(mesh.mesh().clone());
        }
        // Zero is the same with either sign.
        let [x, y, z] = (body.rotation + DVec3::ZERO).to_array();
        let [u, v, w] = body.scale.to_array();
        let key = (
            Arc::as_ptr(mesh.mesh()) as usize,
            [x, y, z, u, v, w].map(f64::to_bits),
        );
        if let Some(known) = self.known.get(&key) {
            return Ok(known.clone());
        }
        // Fixed axes in the order x, y, z are moving axes in the order z, y, x.
        let [x, y, z] = body.rotation.to_array().map(f64::to_radians);
        let rotation = DQuat::from_euler(EulerRot::ZYX, z, y, x);
        let baked = Arc::new(mesh.mesh().transformed(rotation, body.scale)?);
        self.known.insert(key, baked.clone());
        Ok(baked)
    }
}

/// The field that makes baking fail.
pub(crate) fn baked_field(error: &MeshError) -> &'static str {
    match error {
        MeshError::Rotation => "rotation",
        _ => "scale",
    }
}
