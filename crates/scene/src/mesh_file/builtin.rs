//! Meshes that are part of the program, for scenes without mesh files.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use sim_core::Mesh;

use super::{Format, read};

/// The built-in meshes, by the file name that scenes use.
pub static BUILTIN_MESHES: [BuiltinMesh; 8] = [
    BuiltinMesh {
        name: "cube.obj",
        bytes: include_bytes!("../../assets/meshes/cube.obj"),
        mesh: OnceLock::new(),
    },
    BuiltinMesh {
        name: "cow.obj",
        bytes: include_bytes!("../../assets/meshes/cow.obj"),
        mesh: OnceLock::new(),
    },
    BuiltinMesh {
        name: "u-channel.obj",
        bytes: include_bytes!("../../assets/meshes/u-channel.obj"),
        mesh: OnceLock::new(),
    },
    BuiltinMesh {
        name: "funnel.obj",
        bytes: include_bytes!("../../assets/meshes/funnel.obj"),
        mesh: OnceLock::new(),
    },
    BuiltinMesh {
        name: "bolt.obj",
        bytes: include_bytes!("../../assets/meshes/bolt.obj"),
        mesh: OnceLock::new(),
    },
    BuiltinMesh {
        name: "nut.obj",
        bytes: include_bytes!("../../assets/meshes/nut.obj"),
        mesh: OnceLock::new(),
    },
    BuiltinMesh {
        name: "top.obj",
        bytes: include_bytes!("../../assets/meshes/top.obj"),
        mesh: OnceLock::new(),
    },
    BuiltinMesh {
        name: "link.obj",
        bytes: include_bytes!("../../assets/meshes/link.obj"),
        mesh: OnceLock::new(),
    },
];

/// A mesh file embedded in the program.
#[derive(Debug)]
pub struct BuiltinMesh {
    /// File name, such as `cow.obj`.
    pub name: &'static str,
    /// The file.
    pub bytes: &'static [u8],
    mesh: OnceLock<Arc<Mesh>>,
}

impl BuiltinMesh {
    /// The mesh, read once per process.
    pub fn mesh(&self) -> Arc<Mesh> {
        let mesh = self.mesh.get_or_init(|| {
            let path = Path::new(self.name);
            let loaded = Format::of(path).and_then(|format| read(format, path, self.bytes));
            // A test reads every built-in file.
            Arc::new(loaded.expect("a built-in mesh is valid").mesh)
        });
        mesh.clone()
    }
}

/// The built-in mesh of that name, if there is one.
pub fn builtin(name: &str) -> Option<Arc<Mesh>> {
    let found = BUILTIN_MESHES.iter().find(|builtin| builtin.name == name);
    found.map(BuiltinMesh::mesh)
}
