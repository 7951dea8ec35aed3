//! Scenes: descriptions of bodies in text files, from which a [`World`](sim_core::World) is made.
//!
//! [`Scene::load`] takes the name of a scene of the gallery ([`SCENES`]) or the path of a
//! `.toml` file; [`mesh_file::load`] reads the mesh files in [`mesh_file::FORMATS`].
//!
//! ```
//! let scene = scene::Scene::load("cube-cow")?;
//! let mut world = scene.world()?;
//! assert_eq!(world.len(), scene.bodies.len());
//! # Ok::<(), scene::SceneError>(())
//! ```

mod colour;
mod error;
pub mod file;
mod gallery;
pub mod mesh_file;
mod mesh_ref;
mod scene;
mod scene_file;
pub mod shown;
mod world;

pub use error::SceneError;
pub use gallery::{GalleryScene, SCENES};
pub use mesh_file::{FORMATS, Format, LoadedMesh, MeshFileError, MeshReport};
pub use mesh_ref::MeshRef;
pub use scene::{Scene, SceneBody, SceneShape, SceneTurn};
