//! The mesh of a body: its name in the scene file, and the mesh itself.

use std::fmt;
use std::path::{self, Path, PathBuf};
use std::sync::Arc;

use sim_core::Mesh;

use crate::mesh_file::{self, MeshFileError, MeshReport};

/// A loaded mesh with its name in the scene. It is neither rotated nor scaled.
#[derive(Clone)]
pub struct MeshRef {
    name: String,
    path: Option<PathBuf>,
    mesh: Arc<Mesh>,
}

impl MeshRef {
    /// A built-in mesh, such as `cow.obj`.
    pub fn builtin(name: &str) -> Option<MeshRef> {
        mesh_file::builtin(name).map(|mesh| MeshRef {
            name: name.to_owned(),
            path: None,
            mesh,
        })
    }

    /// Loads a mesh from a file; its name is the path.
    pub fn load(path: &Path) -> Result<MeshRef, MeshFileError> {
        MeshRef::named(path.to_string_lossy().into_owned(), path)
    }

    /// Like [`load`](Self::load), with the figures of the mesh.
    pub fn load_reporting(path: &Path) -> Result<(MeshRef, MeshReport), MeshFileError> {
        let loaded = mesh_file::load(path)?;
        let report = loaded.report();
        let mesh = MeshRef {
            name: path.to_string_lossy().into_owned(),
            path: Some(path.to_owned()),
            mesh: Arc::new(loaded.mesh),
        };
        Ok((mesh, report))
    }

    /// Loads a mesh from a file and gives it the name that a scene file uses.
    pub(crate) fn named(name: String, path: &Path) -> Result<MeshRef, MeshFileError> {
        let loaded = mesh_file::load(path)?;
        Ok(MeshRef {
            name,
            path: Some(path.to_owned()),
            mesh: Arc::new(loaded.mesh),
        })
    }

    /// The name of the mesh in the scene file: a path as written there, or a built-in name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file of the mesh; `None` for a built-in mesh.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// The same mesh under another name.
    pub(crate) fn renamed(&self, name: String) -> MeshRef {
        MeshRef {
            name,
            ..self.clone()
        }
    }
}

/// Equal are meshes with the same contents, of the same file under any name or of the same built-in mesh.
impl PartialEq for MeshRef {
    fn eq(&self, other: &MeshRef) -> bool {
        let same_place = match (&self.path, &other.path) {
            (Some(a), Some(b)) => a == b || path::absolute(a).ok() == path::absolute(b).ok(),
            (None, None) => self.name == other.name,
            _ => false,
        };
        same_place && self.mesh == other.mesh
    }
}

/// Prints the name alone, because a mesh is too long.
impl fmt::Debug for MeshRef {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_tuple("MeshRef").field(&self.name).finish()
    }
}
