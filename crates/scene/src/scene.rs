//! A scene in memory.

use std::cmp::Ordering;
use std::io;
use std::path::{self, Path};

use glam::DVec3;
use sim_core::{Collision, Force, Method};

use crate::file::{self, Refusal};
use crate::gallery::SCENES;
use crate::scene_file::{self, MeshSource};
use crate::{Format, MeshFileError, MeshRef, SceneError, shown};

/// The largest scene file that is read, in bytes.
const MAX_BYTES: u64 = 1 << 26;

/// The description of a world: its bodies, forces, method and step.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name in the gallery, or of the file without its extension.
    pub name: String,
    /// Title for people.
    pub title: String,
    /// A few sentences on what the scene shows; may be empty.
    pub about: String,
    /// Step in seconds, from 1e-9 to 1e3.
    pub dt: f64,
    /// The integration method.
    pub method: &'static Method,
    /// The collision mode.
    pub collision: Collision,
    /// Error tolerance of adaptive methods in a step, from 1e-15 to 1.
    pub tolerance: f64,
    /// The time at which the demonstration is over, s, above 0. A window pauses there once.
    pub ends: Option<f64>,
    /// The bodies in the order of the file; may be empty.
    pub bodies: Vec<SceneBody>,
    /// Forces other than the constant ones of the bodies. They refer to bodies by their index in `bodies`.
    pub forces: Vec<Force>,
}

/// A body of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneBody {
    /// Name, unique in the scene.
    pub name: String,
    /// The shape.
    pub shape: SceneShape,
    /// Position of the shape's origin in metres.
    pub position: DVec3,
    /// Rotations of a mesh about x, then y, then z, the axes of the world, in degrees; for a turning body, at the
    /// start. Other shapes have none.
    pub rotation: DVec3,
    /// Scale along the mesh's own axes, before the rotation; not 0. Other shapes have none.
    pub scale: DVec3,
    /// Velocity in metres per second; for a turning body, of its centre of mass.
    pub velocity: DVec3,
    /// Constant force in newtons.
    pub force: DVec3,
    /// Whether the body is immovable: it stands still or keeps its velocity. Half-spaces of a scene file are always
    /// immovable.
    pub immovable: bool,
    /// Mass in kilograms, above 0. It is used, and written to files, only while the body is movable.
    pub mass: f64,
    /// Coefficient of restitution, 0 to 1: the part of the approach speed with which the body leaves an impact.
    pub restitution: f64,
    /// Coefficient of friction, from 0 (smooth) to infinity (never slips). A contact uses the geometric mean of the two
    /// bodies' coefficients ([`sim_core::Body::friction`]).
    pub friction: f64,
    /// The names of the groups of the body; `None`: all groups, of all names.
    pub groups: Option<Vec<String>>,
    /// The names of the groups with which the body collides; `None`: all. Two bodies collide if each is in a group with
    /// which the other collides.
    pub collides_with: Option<Vec<String>>,
    /// The rotational properties of a turning body; `None` for a body that does not rotate.
    pub turn: Option<SceneTurn>,
    /// Colour as sRGB-encoded red, green and blue from 0 to 1, if the scene chooses one.
    pub colour: Option<[f32; 3]>,
}

/// The rotational properties of a turning body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SceneTurn {
    /// Angular velocity at the start, about the axes of the world, in radians per second.
    pub spin: DVec3,
    /// Constant torque about the axes of the world, in newton metres.
    pub torque: DVec3,
    /// Moments of inertia about the axes of the scaled mesh, kg m², with the centre of mass at its origin. `None`
    /// computes them for a homogeneous solid, about the centre of its volume.
    pub inertia: Option<DVec3>,
}

/// The shape of a body of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneShape {
    /// A mesh, before rotation and scale.
    Mesh(MeshRef),
    /// A sphere with its centre at the position.
    Sphere {
        /// Its radius in metres.
        radius: f64,
    },
    /// All points behind a plane through the position: a floor or a wall.
    HalfSpace {
        /// The outward normal, of any length but 0.
        normal: DVec3,
    },
}

impl SceneBody {
    /// An elastic, smooth body at rest at the origin. It has a mass of 1 kg; a half-space is immovable.
    pub fn new(name: String, shape: SceneShape) -> SceneBody {
        let is_half_space = matches!(shape, SceneShape::HalfSpace { .. });
        SceneBody {
            name,
            shape,
            position: DVec3::ZERO,
            rotation: DVec3::ZERO,
            scale: DVec3::ONE,
            velocity: DVec3::ZERO,
            force: DVec3::ZERO,
            immovable: is_half_space,
            mass: 1.0,
            restitution: 1.0,
            friction: 0.0,
            groups: None,
            collides_with: None,
            turn: None,
            colour: None,
        }
    }

    /// The mesh of the body before rotation and scale, if its shape is a mesh.
    pub fn mesh(&self) -> Option<&MeshRef> {
        match &self.shape {
            SceneShape::Mesh(mesh) => Some(mesh),
            SceneShape::Sphere { .. } | SceneShape::HalfSpace { .. } => None,
        }
    }
}

impl Scene {
    /// Loads a scene: of the gallery by its name, from a scene file by its path, which ends in `.toml`, or from a mesh
    /// file by its path. The scene of a mesh file has that mesh alone, of 1 kg and at rest.
    ///
    /// No file is opened for a gallery scene. A path need not be valid UTF-8.
    pub fn load(name_or_path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        let path = name_or_path.as_ref();
        if let Some(gallery) = SCENES.iter().find(|scene| path == Path::new(scene.name)) {
            return gallery.scene();
        }
        let extension = path.extension().unwrap_or_default();
        match Format::of(path) {
            Ok(_) => return Scene::of_mesh(path),
            Err(error @ MeshFileError::Gltf { .. }) => {
                return Err(SceneError::Mesh(Box::new(error)));
            }
            Err(_) => {}
        }
        if !extension.eq_ignore_ascii_case("toml") {
            return Err(SceneError::Unknown {
                name: path.to_string_lossy().into_owned(),
            });
        }
        let bytes = file::read(path, MAX_BYTES).map_err(|refusal| match refusal {
            Refusal::Io(error) => SceneError::Read {
                path: path.to_owned(),
                error,
            },
            Refusal::TooLarge(bytes) => SceneError::TooLarge {
                path: path.to_owned(),
                bytes,
                most: MAX_BYTES,
            },
        })?;
        // UTF-16 text contains zero bytes, which UTF-8 text never does.
        let valid = match std::str::from_utf8(&bytes) {
            Ok(text) => text.find('\0').unwrap_or(text.len()),
            Err(error) => error.valid_up_to(),
        };
        if valid < bytes.len() {
            let before = bytes[..valid].iter();
            return Err(SceneError::Content {
                file: path.to_owned(),
                line: Some(1 + before.filter(|&&byte| byte == b'\n').count()),
                body: None,
                field: None,
                what: "is not UTF-8 text: save as UTF-8".to_owned(),
            });
        }
        let text = String::from_utf8_lossy(&bytes);
        Scene::parse(&text, path)
    }

    fn of_mesh(path: &Path) -> Result<Scene, SceneError> {
        let mesh = MeshRef::load(path).map_err(|error| SceneError::Mesh(Box::new(error)))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        // Every body of a scene file needs a name.
        let name = match name.trim().is_empty() {
            true => "mesh".into(),
            false => name,
        };
        let mut scene = Scene::parse("rate = 60", path)?;
        scene.title = name.clone().into_owned();
        let shape = SceneShape::Mesh(mesh);
        scene.bodies.push(SceneBody::new(name.into_owned(), shape));
        Ok(scene)
    }

    /// A scene from the text of a scene file.
    ///
    /// `origin` is the path of the file: its stem becomes the scene's name, and mesh paths are relative to its folder.
    /// If a mesh file does not exist, a built-in mesh of that name is used.
    pub fn parse(text: &str, origin: &Path) -> Result<Scene, SceneError> {
        scene_file::parse(text, origin, MeshSource::beside(origin))
    }

    /// The text of a scene file that reproduces this scene when read in the same folder.
    ///
    /// Colours are rounded to the 256 steps that a file can store. Forces whose law is code ([`Force::Body`],
    /// [`Force::Pair`]) have no text and are left out.
    pub fn to_toml(&self) -> String {
        scene_file::write(self)
    }

    /// Removes a body and the forces that refer to it, and returns the number of these forces. The other forces keep
    /// their bodies, whose indices may change. Panics if there is no such body.
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

    /// Writes the whole scene to a file, or nothing. Meshes beside it get paths relative to its folder; meshes of other
    /// folders keep their paths.
    pub fn save(&self, path: &Path) -> Result<(), SceneError> {
        let text = self.text_at(path)?;
        file::write(path, text.as_bytes()).map_err(|error| SceneError::Write {
            path: path.to_owned(),
            error,
        })
    }

    /// The text of a scene file that reproduces this scene when read as the file at `path`. Meshes beside it get paths
    /// relative to its folder; meshes of other folders keep their paths.
    pub fn text_at(&self, path: &Path) -> Result<String, SceneError> {
        let refused = |error| SceneError::Write {
            path: path.to_owned(),
            error,
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let whole_folder = match folder == Path::new("") {
            true => std::env::current_dir(),
            false => path::absolute(folder),
        };
        let whole_folder = whole_folder.map_err(refused)?;
        let mut scene = self.clone();
        for body in &mut scene.bodies {
            let SceneShape::Mesh(mesh) = &mut body.shape else {
                continue;
            };
            let Some(mesh_file) = mesh.path() else {
                continue;
            };
            let absolute = path::absolute(mesh_file).map_err(refused)?;
            let found_from_there = folder.join(mesh.name()) == mesh_file;
            // The paths of meshes in the scene's folder or below are relative, so that the folder can be moved.
            let place = match absolute.strip_prefix(&whole_folder) {
                Ok(beneath) => beneath,
                Err(_) if found_from_there => continue,
                Err(_) => &absolute,
            };
            let Some(name) = place.to_str() else {
                return Err(refused(io::Error::other(format!(
                    "the path of the mesh {} is not text: rename it",
                    shown::path(&absolute)
                ))));
            };
            // Every system reads slashes.
            let name = match cfg!(windows) {
                true => name.replace('\\', "/"),
                false => name.to_owned(),
            };
            *mesh = mesh.renamed(name);
        }
        Ok(scene.to_toml())
    }
}
