//! Validated triangle meshes.

#[cfg(feature = "serde")]
pub(crate) mod data;
mod error;
mod repair;
mod topology;

use alloc::{sync::Arc, vec::Vec};
use glam::{DQuat, DVec3, Vec3};

use crate::Aabb;
pub use error::MeshError;
pub use repair::Repairs;
pub(crate) use topology::Topology;

/// A triangle mesh in its own frame: open or closed, concave or convex, in any number of pieces.
///
/// Vertices are finite and in metres, every triangle has three different corners, and there is
/// at least one triangle. Seen from outside, corners of a closed mesh run counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize),
    serde(try_from = "data::MeshData")
)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    bounds: Aabb,
    topology: Arc<Topology>,
}

impl Mesh {
    /// Takes a mesh unchanged, or returns an error. For files and other untrusted input use [`Mesh::repaired`].
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        error::validate(&vertices, &triangles)?;
        if let Some(triangle) = triangles.iter().position(repair::has_repeated_corner) {
            return Err(MeshError::RepeatedCorner { triangle });
        }
        Ok(Mesh {
            bounds: Aabb::around(vertices.iter().copied()),
            topology: Arc::new(Topology::of(vertices.len(), triangles)),
            vertices,
        })
    }

    /// Vertices, m.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Triangles as indices of [`Mesh::vertices`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.topology.triangles
    }

    /// Each edge once, as two vertices, the lower index first, in lexicographic order.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.topology.edges
    }

    /// For each triangle `[a, b, c]` the edges `ab`, `bc` and `ca` as indices of [`Mesh::edges`].
    pub fn triangle_edges(&self) -> &[[u32; 3]] {
        &self.topology.triangle_edges
    }

    /// The triangles and edges, to be shared.
    pub(crate) fn topology(&self) -> &Arc<Topology> {
        &self.topology
    }

    /// The corners of a triangle, m.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.topology.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// The least box around the vertices.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Whether every edge belongs to exactly two triangles.
    pub fn is_closed(&self) -> bool {
        self.topology.closed
    }

    /// Whether any two triangles that share an edge traverse it in opposite directions.
    pub fn is_oriented(&self) -> bool {
        self.topology.oriented
    }

    /// The enclosed volume, m³, by the divergence theorem; `None` unless the mesh is closed and oriented. Negative if
    /// the triangles are wound inward.
    pub fn volume(&self) -> Option<f64> {
        (self.is_closed() && self.is_oriented()).then(|| {
            // About the box's centre, so that a mesh far from its origin loses no digits.
            let origin = self.bounds.centre();
            let six_volumes: f64 = (0..self.triangles().len())
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
    /// A fixed orientation and scale are applied once, here. A scale that mirrors (an odd number of negative
    /// components) keeps the winding outward. The components of `scale` must be finite and not zero; `rotation` must
    /// be of unit length.
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
        if scale.to_array().iter().filter(|&&s| s < 0.0).count() % 2 == 1 {
            mesh.reverse_winding();
        }
        mesh.bounds = Aabb::around(mesh.vertices.iter().copied());
        let gone = |bounds: Aabb| bounds.half_extent() == DVec3::ZERO;
        if gone(mesh.bounds) && !gone(self.bounds) {
            return Err(MeshError::Scale { scale });
        }
        Ok(mesh)
    }

    /// Reverses the winding of every triangle.
    fn reverse_winding(&mut self) {
        Arc::make_mut(&mut self.topology).reverse_winding();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};
    use alloc::vec;

    #[test]
    fn a_cube_is_closed_outward_and_one_cubic_metre() {
        let mesh = cube();
        assert!(mesh.is_closed() && mesh.is_oriented());
        assert_eq!(mesh.volume(), Some(1.0));
        assert_eq!(
            (
                mesh.vertices().len(),
                mesh.edges().len(),
                mesh.triangles().len()
            ),
            (8, 18, 12)
        );
        for (triangle, edges) in mesh.triangles().iter().zip(mesh.triangle_edges()) {
            for i in 0..3 {
                let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
                assert_eq!(mesh.edges()[edges[i] as usize], [a.min(b), a.max(b)]);
            }
        }
    }

    #[test]
    fn openness_and_winding_are_seen() {
        let all = cube().triangles().to_vec();
        let with = |triangles| Mesh::new(cube().vertices().to_vec(), triangles).unwrap();
        let open = with(all[1..].to_vec());
        assert!(!open.is_closed() && open.is_oriented() && open.volume().is_none());
        let mut turned = all.clone();
        turned[3].swap(0, 1);
        let turned = with(turned);
        assert!(turned.is_closed() && !turned.is_oriented() && turned.volume().is_none());
        let inward = with(all.iter().map(|&[a, b, c]| [a, c, b]).collect());
        assert_eq!(inward.volume(), Some(-1.0));
    }

    #[test]
    fn transformed_meshes_stay_outward() {
        let turn = DQuat::from_rotation_z(core::f64::consts::FRAC_PI_2);
        let scaled = cube()
            .transformed(turn, DVec3::new(-2.0, 3.0, 0.5))
            .unwrap();
        assert!((scaled.volume().unwrap() - 3.0).abs() < 1e-6);
        assert!((scaled.bounds().half_extent() - DVec3::new(1.5, 1.0, 0.25)).length() < 1e-6);
        let rebuilt = Mesh::new(scaled.vertices().to_vec(), scaled.triangles().to_vec());
        assert_eq!(rebuilt.as_ref(), Ok(&scaled));
        for scale in [
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::splat(f64::NAN),
            DVec3::splat(1e300),
            DVec3::splat(1e-60),
        ] {
            assert!(
                cube().transformed(DQuat::IDENTITY, scale).is_err(),
                "{scale}"
            );
        }
        assert!(
            cube()
                .transformed(DQuat::from_xyzw(1.0, 1.0, 0.0, 0.0), DVec3::ONE)
                .is_err()
        );
    }

    #[test]
    fn what_is_not_a_mesh_is_refused_by_name() {
        let points = || vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(Mesh::new(points(), vec![]), Err(MeshError::Empty));
        let far = Mesh::new(points(), vec![[0, 1, 2], [0, 1, 3]]);
        assert_eq!(
            far,
            Err(MeshError::IndexOutOfRange {
                triangle: 1,
                index: 3,
                vertices: 3
            })
        );
        let twice = Mesh::new(points(), vec![[0, 1, 1]]);
        assert_eq!(twice, Err(MeshError::RepeatedCorner { triangle: 0 }));
        for bad in [f32::NAN, f32::INFINITY] {
            let broken = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::splat(bad)], vec![[0, 1, 2]]);
            assert_eq!(broken, Err(MeshError::NotFinite { vertex: 2 }));
        }
        // A triangle that has shrunk to a segment is removed.
        let gone = Mesh::repaired(vec![Vec3::ZERO, Vec3::X, Vec3::X], vec![[0, 1, 2]]);
        assert_eq!(gone.unwrap_err(), MeshError::Empty);
    }

    #[test]
    fn a_soup_of_separate_triangles_becomes_the_mesh() {
        for mesh in [cube(), sphere(9)] {
            let corners = (0..mesh.triangles().len()).flat_map(|i| mesh.corners(i));
            let mut vertices: Vec<Vec3> = corners.collect();
            let faces = mesh.triangles().len() as u32;
            let mut triangles: Vec<_> = (0..faces).map(|i| [3 * i, 3 * i + 2, 3 * i + 1]).collect();
            triangles.push([0, 1, 1]);
            triangles.push([1, 0, 2]);
            vertices.push(Vec3::ONE);
            let (made, repairs) = Mesh::repaired(vertices, triangles).unwrap();
            assert!((made.volume().unwrap() - mesh.volume().unwrap()).abs() < 1e-6);
            assert!(made.is_closed() && made.is_oriented());
            assert_eq!(
                repairs,
                Repairs {
                    welded_vertices: 3 * faces as usize - mesh.vertices().len(),
                    degenerate_triangles: 1,
                    duplicate_triangles: 1,
                    unreferenced_vertices: 1,
                    reversed_winding: true,
                }
            );
            let (again, none) =
                Mesh::repaired(made.vertices().to_vec(), made.triangles().to_vec()).unwrap();
            assert!(none.is_empty() && again == made);
        }
    }

    #[test]
    fn triangles_on_a_line_go_unless_they_close_the_mesh() {
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|v| v * 0.1);
        // Beside the surface: the point is off the line by one last bit, as exact arithmetic shows.
        let (third, off) = (Vec3::splat(0.1), Vec3::new(0.2, 0.2, 0.2_f32.next_up()));
        let vertices = |last| [&points[..], &[third, last]].concat();
        let with = |triangle| [&tetrahedron[..], &[triangle]].concat();
        let (mesh, repairs) = Mesh::repaired(vertices(Vec3::splat(0.2)), with([0, 4, 5])).unwrap();
        assert_eq!(
            (mesh.triangles().len(), repairs.degenerate_triangles),
            (4, 1)
        );
        assert!(mesh.is_closed() && mesh.vertices().len() == 4);
        let (mesh, repairs) = Mesh::repaired(vertices(off), with([0, 4, 5])).unwrap();
        assert_eq!(
            (mesh.triangles().len(), repairs.degenerate_triangles),
            (5, 0)
        );
        // The side from 0 to 1 is one edge below and two halves above: a triangle fills the seam.
        let halved = [
            [0, 2, 1],
            [0, 4, 3],
            [4, 1, 3],
            [1, 2, 3],
            [2, 0, 3],
            [0, 1, 4],
        ];
        let seam = [&points[..], &[Vec3::X * 0.05]].concat();
        let (mesh, repairs) = Mesh::repaired(seam, halved.to_vec()).unwrap();
        assert!(mesh.is_closed() && mesh.volume().is_some() && repairs.is_empty());
        let alone = Mesh::repaired(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2]]);
        assert_eq!(alone.unwrap_err(), MeshError::Empty);
    }

    #[test]
    fn minus_zero_is_zero_to_the_weld() {
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, -Vec3::ZERO, -Vec3::X];
        let (mesh, repairs) = Mesh::repaired(vertices, vec![[0, 1, 2], [3, 2, 4]]).unwrap();
        assert_eq!((repairs.welded_vertices, mesh.edges().len()), (1, 5));
    }
}
