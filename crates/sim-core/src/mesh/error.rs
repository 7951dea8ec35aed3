//! Errors of meshes.

use glam::{DVec3, Vec3};

/// The reason why triangles do not form a mesh.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is no triangle.
    #[error("the mesh has no triangle with an area: a mesh needs at least one")]
    Empty,
    /// A coordinate is NaN, infinite, or beyond the range of f32.
    #[error("vertex {vertex} is not finite: coordinates must be numbers within ±3.4e38 m")]
    NotFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {index}, but there are {vertices} (indices from 0)")]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The index of the vertex in the triangle.
        index: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A triangle uses a vertex twice.
    #[error("triangle {triangle} uses a vertex twice: drop it, or load through Mesh::repaired")]
    RepeatedCorner {
        /// Index of the triangle, from 0.
        triangle: usize,
    },
    /// More triangles or vertices than 32-bit indices allow.
    #[error("the mesh has {count} elements: at most 1,000,000,000 triangles and as many vertices")]
    TooLarge {
        /// The number of triangles or vertices.
        count: usize,
    },
    /// A scale that is zero or not finite along some axis.
    #[error(
        "scale [{:e}, {:e}, {:e}] leaves nothing of the mesh: every component must be finite and not \
         0, and sizes in m must be within f32",
        scale.x, scale.y, scale.z
    )]
    Scale {
        /// The scale.
        scale: DVec3,
    },
    /// A rotation that is not a unit quaternion.
    #[error("the rotation is not a unit quaternion")]
    Rotation,
}

/// The indices of three edges for each triangle must fit 32 bits.
const MOST: usize = 1_000_000_000;

/// Checks sizes, coordinates and indices.
pub(super) fn validate(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    let count = vertices.len().max(triangles.len());
    if count > MOST {
        return Err(MeshError::TooLarge { count });
    }
    if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
        return Err(MeshError::NotFinite { vertex });
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
            return Err(MeshError::IndexOutOfRange {
                triangle,
                index,
                vertices: vertices.len(),
            });
        }
    }
    Ok(())
}
