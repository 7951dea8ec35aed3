//! Makes a running world from a scene.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use glam::{DQuat, DVec3, EulerRot};
use sim_core::{
    Body, BodyKind, Groups, Inertia, Mesh, MeshError, Settings, Shape, Solid, Turn, World,
};

use crate::scene::{Scene, SceneBody, SceneShape};
use crate::{MeshRef, SceneError};

impl Scene {
    /// The world of this scene, at time 0, with the bodies in the same order.
    ///
    /// Rotation and scale are baked into the meshes; bodies with the same mesh, rotation and scale share one. Turning
    /// bodies instead start with their rotation as state, so they share a mesh at any rotation.
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
            return Err(self.world_error(None, Some("groups"), TOO_MANY_GROUPS));
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
            let inertia = baked.inertia(body).map_err(|error| {
                let given = body.turn.and_then(|turn| turn.inertia);
                let field = given.map_or("turns", |_| "inertia");
                self.world_error(Some(body), Some(field), error)
            })?;
            let turn = body.turn.zip(inertia).map(|(turn, inertia)| Turn {
                rotation: rotation(body.rotation),
                spin: turn.spin,
                torque: turn.torque,
                inertia: Some(inertia),
            });
            let added = world.add(Body {
                shape: Some(shape),
                position: body.position + turn.map_or(DVec3::ZERO, to_centre),
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
                turn,
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

/// The most groups of a scene.
pub(crate) const MOST_GROUPS: usize = 32;

/// The error for a scene with more groups.
pub(crate) const TOO_MANY_GROUPS: &str =
    "more than 32 groups are named up to here: use some of them for several bodies";

/// The names of all groups of some bodies, in order of first appearance.
fn group_names(bodies: &[SceneBody]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    bodies.iter().for_each(|body| note_groups(body, &mut names));
    names
}

/// Adds the new group names of a body; stops once there are more than the limit.
pub(crate) fn note_groups<'a>(body: &'a SceneBody, names: &mut Vec<&'a str>) {
    let own = body.groups.iter().chain(&body.collides_with).flatten();
    for name in own {
        if !names.contains(&name.as_str()) && names.len() <= MOST_GROUPS {
            names.push(name);
        }
    }
}

/// One bit for each of the groups; all bits for `None`.
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

/// The vector from the origin of a mesh to its centre of mass at the start, m.
fn to_centre(turn: Turn) -> DVec3 {
    let centre = turn.inertia.map_or(DVec3::ZERO, |inertia| inertia.centre());
    turn.rotation * centre
}

/// The rotation about the fixed axes x, then y, then z, in degrees, as a quaternion.
fn rotation(degrees: DVec3) -> DQuat {
    // Rotations about the fixed axes x, y, z in order equal rotations about the moving axes z, y, x in order.
    let [x, y, z] = degrees.to_array().map(f64::to_radians);
    DQuat::from_euler(EulerRot::ZYX, z, y, x)
}

/// The initial angular momentum of a body in its world, kg m²/s.
pub(crate) fn angular_momentum(body: &SceneBody, inertia: &Inertia, spin: DVec3) -> DVec3 {
    let axes = rotation(body.rotation).normalize() * inertia.axes();
    axes * (inertia.moments() * (axes.inverse() * spin))
}

/// Caches transformed meshes and their mass properties.
#[derive(Default)]
pub(crate) struct Baked {
    /// The key: the address of the mesh, its rotation and scale.
    known: HashMap<(usize, [u64; 6]), Arc<Mesh>>,
    /// The key: the address of the transformed mesh, which `known` or the scene keeps alive.
    solids: HashMap<usize, Solid>,
}

impl Baked {
    /// The mesh of a body in its world: scaled, and rotated unless the body is a turning body.
    pub(crate) fn mesh(
        &mut self,
        mesh: &MeshRef,
        body: &SceneBody,
    ) -> Result<Arc<Mesh>, MeshError> {
        match body.turn {
            Some(_) => self.transformed(mesh, DVec3::ZERO, body.scale),
            None => self.turned(mesh, body),
        }
    }

    /// The mesh of a body, rotated and scaled.
    pub(crate) fn turned(
        &mut self,
        mesh: &MeshRef,
        body: &SceneBody,
    ) -> Result<Arc<Mesh>, MeshError> {
        self.transformed(mesh, body.rotation, body.scale)
    }

    /// The inertia of a turning body, or the reason why it has none.
    pub(crate) fn inertia(&mut self, body: &SceneBody) -> Result<Option<Inertia>, String> {
        let Some(turn) = body.turn else {
            return Ok(None);
        };
        if let Some(moments) = turn.inertia {
            let inertia = Inertia::new(moments, DQuat::IDENTITY, DVec3::ZERO);
            return inertia.map(Some).map_err(|error| error.to_string());
        }
        if body.mass.is_infinite() {
            // Nothing changes the spin of an immovable body, so its moments do not matter; it rotates about its origin.
            let any = Inertia::new(DVec3::ONE, DQuat::IDENTITY, DVec3::ZERO);
            return any.map(Some).map_err(|error| error.to_string());
        }
        let inertia = match &body.shape {
            SceneShape::Mesh(mesh) => {
                let mesh = self.mesh(mesh, body).map_err(|error| error.to_string())?;
                let solid = match self.solids.entry(Arc::as_ptr(&mesh) as usize) {
                    Entry::Occupied(known) => Ok(*known.get()),
                    Entry::Vacant(new) => Solid::of(&mesh).map(|solid| *new.insert(solid)),
                };
                solid.and_then(|solid| solid.inertia(body.mass))
            }
            &SceneShape::Sphere { radius } => Inertia::ball(radius, body.mass),
            SceneShape::HalfSpace { .. } => {
                return Err("a half-space cannot turn: leave it out".to_owned());
            }
        };
        inertia.map(Some).map_err(|error| error.to_string())
    }

    fn transformed(
        &mut self,
        mesh: &MeshRef,
        degrees: DVec3,
        scale: DVec3,
    ) -> Result<Arc<Mesh>, MeshError> {
        if degrees == DVec3::ZERO && scale == DVec3::ONE {
            return Ok(mesh.mesh().clone());
        }
        // Adding +0 turns -0 into +0.
        let [x, y, z] = (degrees + DVec3::ZERO).to_array();
        let [u, v, w] = scale.to_array();
        let key = (
            Arc::as_ptr(mesh.mesh()) as usize,
            [x, y, z, u, v, w].map(f64::to_bits),
        );
        if let Some(known) = self.known.get(&key) {
            return Ok(known.clone());
        }
        let baked = Arc::new(mesh.mesh().transformed(rotation(degrees), scale)?);
        self.known.insert(key, baked.clone());
        Ok(baked)
    }
}

/// The field that causes the error of baking.
pub(crate) fn baked_field(error: &MeshError) -> &'static str {
    match error {
        MeshError::Rotation => "rotation",
        _ => "scale",
    }
}
