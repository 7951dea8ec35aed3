//! Meshes as data: vertices and triangles. Reading one checks it as any other mesh is checked.

use alloc::{sync::Arc, vec::Vec};
use glam::Vec3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Mesh, MeshError};

#[derive(Deserialize)]
#[serde(rename = "Mesh", deny_unknown_fields)]
pub(super) struct MeshData {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl TryFrom<MeshData> for Mesh {
    type Error = MeshError;

    fn try_from(data: MeshData) -> Result<Mesh, MeshError> {
        Mesh::new(data.vertices, data.triangles)
    }
}

#[derive(Serialize)]
#[serde(rename = "Mesh")]
struct Borrowed<'a> {
    vertices: &'a [Vec3],
    triangles: &'a [[u32; 3]],
}

impl Serialize for Mesh {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let (vertices, triangles) = (self.vertices(), self.triangles());
        let data = Borrowed {
            vertices,
            triangles,
        };
        data.serialize(to)
    }
}

/// A mesh that several bodies may share; it is written once for each of them.
pub(crate) mod shared {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(mesh: &Arc<Mesh>, to: S) -> Result<S::Ok, S::Error> {
        mesh.as_ref().serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Arc<Mesh>, D::Error> {
        Mesh::deserialize(from).map(Arc::new)
    }
}
