//! The mesh of a body: what the scene file calls it, and the mesh itself.

use std::fmt;
use std::path::{self, Path, PathBuf};
use std::sync::Arc;

use sim_core::Mesh;

use crate::mesh_file::{self, MeshFileError, MeshReport};

/// A mesh by its name in the scene, loaded: neither rotated nor scaled.
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

    /// A mesh from a file, which becomes its name.
    pub fn load(path: &Path) -> Result<MeshRef, MeshFileError> {
        MeshRef::named(path.to_string_lossy().into_owned(), path)
    }

    /// The same, with what is to be known of what was read.
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

    /// A mesh from a file under the name that a scene file uses for it.
    pub(crate) fn named(name: String, path: &Path) -> Result<MeshRef, MeshFileError> {
        let loaded = mesh_file::load(path)?;
        Ok(MeshRef {
            name,
            path: Some(path.to_owned()),
            mesh: Arc::new(loaded.mesh),
        })
    }

    /// What the scene file calls the mesh: a path as written there, or a built-in name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file it came from; `None` for a built-in mesh.
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

/// Of the same file, however that is called, or the same built-in mesh; and as it is in there.
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

/// The name alone: a mesh is too much to look at.
impl fmt::Debug for MeshRef {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_tuple("MeshRef").field(&self.name).finish()
    }
}
