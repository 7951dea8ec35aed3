//! A scene in memory.

use std::cmp::Ordering;
use std::fs;
use std::path::{self, Path};

use glam::DVec3;
use sim_core::{Collision, Force, Method};

use crate::gallery::SCENES;
use crate::scene_file::{self, MeshSource};
use crate::{MeshRef, SceneError};

/// The description of a world: its bodies and how time passes in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name in the gallery, or of the file without its extension.
    pub name: String,
    /// Title for people.
    pub title: String,
    /// A few sentences on what to look for; may be empty.
    pub about: String,
    /// Step in seconds, from 1e-9 to 1e3.
    pub dt: f64,
    /// How bodies move.
    pub method: &'static Method,
    /// How collisions are searched for.
    pub collision: Collision,
    /// Error that adaptive methods may make in a step, from 1e-15 to 1.
    pub tolerance: f64,
    /// The bodies in the order of the file; may be empty.
    pub bodies: Vec<SceneBody>,
    /// Forces beside the constant ones of the bodies, which they name by their place in `bodies`.
    pub forces: Vec<Force>,
}

/// A body of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneBody {
    /// Name, unique in the scene.
    pub name: String,
    /// Its mesh before rotation and scale.
    pub mesh: MeshRef,
    /// Position of the mesh's origin in metres.
    pub position: DVec3,
    /// Turns about x, then y, then z, the axes of the world, in degrees.
    pub rotation: DVec3,
    /// Scale along the mesh's own axes, before the rotation; not 0.
    pub scale: DVec3,
    /// Velocity in metres per second.
    pub velocity: DVec3,
    /// Constant force in newtons.
    pub force: DVec3,
    /// Mass in kilograms, above 0.
    pub mass: f64,
    /// Colour as sRGB-encoded red, green and blue from 0 to 1, if the scene chooses one.
    pub colour: Option<[f32; 3]>,
}

impl Scene {
    /// A scene of the gallery by its name, or a scene file by its path, which ends in `.toml`.
    ///
    /// A gallery scene opens no file.
    pub fn load(name_or_path: &str) -> Result<Scene, SceneError> {
        if let Some(gallery) = SCENES.iter().find(|scene| scene.name == name_or_path) {
            return gallery.scene();
        }
        let path = Path::new(name_or_path);
        let extension = path.extension().unwrap_or_default();
        if !extension.eq_ignore_ascii_case("toml") {
            return Err(SceneError::Unknown {
                name: name_or_path.to_owned(),
            });
        }
        let text = fs::read_to_string(path).map_err(|error| SceneError::Read {
            path: path.to_owned(),
            error,
        })?;
        Scene::parse(&text, path)
    }

    /// A scene from the text of a scene file.
    ///
    /// `origin` is the file: its stem becomes the scene's name, and mesh paths are relative to
    /// its folder. A mesh that is not there may be a built-in one.
    pub fn parse(text: &str, origin: &Path) -> Result<Scene, SceneError> {
        scene_file::parse(text, origin, MeshSource::beside(origin))
    }

    /// The text of a scene file that gives this scene again in the same folder.
    ///
    /// Colours are rounded to the 256 steps that a file can hold. Forces whose law is not data
    /// ([`Force::Body`], [`Force::Pair`]) have no text and are left out.
    pub fn to_toml(&self) -> String {
        scene_file::write(self)
    }

    /// Removes a body and the forces that name it, and says how many those were; the others follow
    /// their bodies to their new places. Panics if there is no such body, as vectors do.
    pub fn remove_body(&mut self, body: usize) -> usize {
        self.bodies.remove(body);
        let renumber = |i: usize| match i.cmp(&body) {
            Ordering::Less => Some(i),
            Ordering::Equal => None,
            Ordering::Greater => Some(i - 1),
        };
        let before = self.forces.len();
        let forces = self.forces.drain(..);
        self.forces = forces
            .filter_map(|force| force.renumbered(renumber))
            .collect();
        before - self.forces.len()
    }

    pub(crate) fn body_name(&self, body: usize) -> String {
        let body = self.bodies.get(body);
        body.map_or_else(String::new, |body| body.name.clone())
    }

    /// Writes the scene to a file. Meshes of other folders keep their place.
    pub fn save(&self, path: &Path) -> Result<(), SceneError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut scene = self.clone();
        for body in &mut scene.bodies {
            let Some(mesh) = body.mesh.path() else {
                continue;
            };
            let found_from_there = folder.join(body.mesh.name()) == mesh;
            if !found_from_there {
                let absolute = path::absolute(mesh).map_err(|error| SceneError::Write {
                    path: path.to_owned(),
                    error,
                })?;
                let name = absolute.to_string_lossy().into_owned();
                body.mesh = body.mesh.renamed(name);
            }
        }
        fs::write(path, scene.to_toml()).map_err(|error| SceneError::Write {
            path: path.to_owned(),
            error,
        })
    }
}
