//! The sources of the meshes of a scene.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::mesh_file::BUILTIN_MESHES;
use crate::{MeshRef, shown};

/// Finds meshes by the names in a scene file, and loads each once.
pub(crate) struct MeshSource {
    folder: Option<PathBuf>,
    known: HashMap<String, MeshRef>,
}

impl MeshSource {
    /// Built-in meshes only; no file is opened.
    pub(crate) fn builtin_only() -> MeshSource {
        MeshSource {
            folder: None,
            known: HashMap::new(),
        }
    }

    /// Files relative to the folder of a scene file, then built-in meshes.
    pub(crate) fn beside(scene: &Path) -> MeshSource {
        MeshSource {
            folder: Some(scene.parent().unwrap_or(Path::new("")).to_owned()),
            known: HashMap::new(),
        }
    }

    /// The mesh of that name, or the reason why there is none.
    pub(super) fn get(&mut self, name: &str) -> Result<MeshRef, String> {
        if let Some(known) = self.known.get(name) {
            return Ok(known.clone());
        }
        let mesh = self.find(name)?;
        self.known.insert(name.to_owned(), mesh.clone());
        Ok(mesh)
    }

    fn find(&self, name: &str) -> Result<MeshRef, String> {
        let path = self.folder.as_ref().map(|folder| folder.join(name));
        if let Some(path) = path.as_ref().filter(|path| path.exists()) {
            let mesh = MeshRef::named(name.to_owned(), path);
            return mesh.map_err(|error| error.to_string());
        }
        MeshRef::builtin(name).ok_or_else(|| {
            let builtin: Vec<&str> = BUILTIN_MESHES.iter().map(|mesh| mesh.name).collect();
            let builtin = builtin.join(", ");
            match path {
                Some(path) => format!(
                    "there is no mesh file {}, and the built-in meshes are {builtin}",
                    shown::path(&path)
                ),
                None => {
                    let name = shown::name(name);
                    format!("there is no mesh `{name}`: the built-in ones are {builtin}")
                }
            }
        })
    }
}
