//! Validated triangle meshes.

mod error;
mod repair;
mod topology;

use alloc::vec::Vec;
use glam::{DQuat, DVec3, Vec3};

use crate::Aabb;
pub use error::MeshError;
pub use repair::Repairs;
use topology::Topology;

/// A triangle mesh in its own frame: open or closed, concave or convex, in any number of pieces.
///
/// Vertices are finite and in metres, every triangle has three different corners, and there is
/// at least one triangle. Seen from outside, corners of a closed mesh run counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    bounds: Aabb,
    topology: Topology,
}

impl Mesh {
    /// Takes a mesh as it is, or says what is wrong with it. Files and other untrusted input go
    /// through [`Mesh::repaired`].
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        error::validate(&vertices, &triangles)?;
        if let Some(triangle) = triangles.iter().position(repair::has_repeated_corner) {
            return Err(MeshError::RepeatedCorner { triangle });
        }
        Ok(Mesh {
            bounds: Aabb::around(vertices.iter().copied()),
            topology: Topology::of(&triangles),
            vertices,
            triangles,
        })
    }

    /// Vertices, m.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Triangles as indices of [`Mesh::vertices`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Each edge once, as two vertices, the lower index first, in lexicographic order.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.topology.edges
    }

    /// For each triangle `[a, b, c]` the edges `ab`, `bc` and `ca` as indices of [`Mesh::edges`].
    pub fn triangle_edges(&self) -> &[[u32; 3]] {
        &self.topology.triangle_edges
    }

    /// The corners of a triangle, m.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// The least box around the vertices.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Whether every edge belongs to exactly two triangles.
    pub fn is_closed(&self) -> bool {
        self.topology.closed
    }

    /// Whether triangles that share an edge run along it in opposite directions, and none in
    /// the same one.
    pub fn is_oriented(&self) -> bool {
        self.topology.oriented
    }

    /// The enclosed volume, m³, by the divergence theorem; `None` unless the mesh is closed and
    /// oriented. Negative when wound inward.
    pub fn volume(&self) -> Option<f64> {
        (self.is_closed() && self.is_oriented()).then(|| {
            // About the box's centre, so that a mesh far from its origin loses no digits.
            let origin = self.bounds.centre();
            let six_volumes: f64 = (0..self.triangles.len())
                .map(|i| {
                    let [a, b, c] = self.corners(i).map(|v| v.as_dvec3() - origin);
                    a.dot(b.cross(c))
                })
                .sum();
            six_volumes / 6.0
        })
    }

    /// The mesh scaled along its own axes, then rotated, with vertices rounded to f32.
    ///
    /// Bodies do not turn as they move, so an orientation and a scale are paid for once, here.
    /// A scale that mirrors (an odd number of negative components) keeps the winding outward.
    /// The components of `scale` must be finite and not zero; `rotation` must be of unit length.
    pub fn transformed(&self, rotation: DQuat, scale: DVec3) -> Result<Mesh, MeshError> {
        let mut mesh = self.clone();
        if !(scale.is_finite() && scale.cmpne(DVec3::ZERO).all()) {
            return Err(MeshError::Scale { scale });
        }
        if !rotation.is_normalized() {
            return Err(MeshError::Rotation);
        }
        for (vertex, v) in mesh.vertices.iter_mut().enumerate() {
            *v = (rotation * (v.as_dvec3() * scale)).as_vec3();
            if !v.is_finite() {
                return Err(MeshError::NotFinite { vertex });
            }
        }
        if scale.x * scale.y * scale.z < 0.0 {
            mesh.reverse_winding();
        }
        mesh.bounds = Aabb::around(mesh.vertices.iter().copied());
        Ok(mesh)
    }

    /// Turns every triangle over.
    fn reverse_winding(&mut self) {
        for [_, b, c] in &mut self.triangles {
            core::mem::swap(b, c);
        }
        for [ab, _, ca] in &mut self.topology.triangle_edges {
            core::mem::swap(ab, ca);
        }
    }
}
