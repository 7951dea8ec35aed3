//! Repairs of meshes from files.

use alloc::{vec, vec::Vec};
use glam::Vec3;
use robust::{Coord, orient2d};

use super::{Mesh, MeshError, error};

/// The changes that [`Mesh::repaired`] made. The set of points that the triangles cover stays the same, except for
/// triangles that had shrunk to a segment or a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Vertices merged into an earlier one at the same position.
    pub welded_vertices: usize,
    /// Triangles dropped because they have no area: their corners lie on a line, by exact arithmetic, or two corners
    /// are the same vertex.
    pub degenerate_triangles: usize,
    /// Triangles dropped because an earlier one has the same corners.
    pub duplicate_triangles: usize,
    /// Vertices dropped because no triangle uses them.
    pub unreferenced_vertices: usize,
    /// Whether a closed mesh was wound inward and was turned outward. If it has several pieces, the sum of their
    /// volumes decides for all.
    pub reversed_winding: bool,
}

impl Repairs {
    /// Whether the mesh was not changed.
    pub fn is_empty(&self) -> bool {
        *self == Repairs::default()
    }
}

impl Mesh {
    /// Welds vertices at equal positions, drops triangles without area or with the corners of an earlier one, drops
    /// vertices without a triangle, and turns a closed mesh outward.
    ///
    /// Triangles on a line stay if they close the mesh, for example between the two halves of a side and the whole
    /// side: without them the mesh would have no inside.
    ///
    /// Files split vertices at seams of normals and texture coordinates; without the weld no such mesh would be closed.
    /// Positions are compared exactly: there is no tolerance, and no vertex moves.
    pub fn repaired(
        mut vertices: Vec<Vec3>,
        mut triangles: Vec<[u32; 3]>,
    ) -> Result<(Mesh, Repairs), MeshError> {
        error::validate(&vertices, &triangles)?;
        let mut repairs = Repairs {
            unreferenced_vertices: drop_unreferenced(&mut vertices, &mut triangles),
            ..Repairs::default()
        };
        repairs.welded_vertices = weld(&mut vertices, &mut triangles);

        let before = triangles.len();
        triangles.retain(|t| !has_repeated_corner(t));
        repairs.degenerate_triangles = before - triangles.len();
        repairs.duplicate_triangles = drop_duplicates(&mut triangles);
        let with_area = |t: &[u32; 3]| !is_on_a_line(t.map(|v| vertices[v as usize]));
        let solid: Vec<[u32; 3]> = triangles.iter().copied().filter(with_area).collect();
        let on_a_line = triangles.len() - solid.len();
        let needed = on_a_line > 0
            && !solid.is_empty()
            && Mesh::new(vertices.clone(), triangles.clone())?.is_closed()
            && !Mesh::new(vertices.clone(), solid.clone())?.is_closed();
        if !needed {
            triangles = solid;
            repairs.degenerate_triangles += on_a_line;
        }
        // A vertex that only dropped triangles used is dropped too.
        drop_unreferenced(&mut vertices, &mut triangles);

        let mut mesh = Mesh::new(vertices, triangles)?;
        if mesh.volume().is_some_and(|v| v < 0.0) {
            mesh.reverse_winding();
            repairs.reversed_winding = true;
        }
        Ok((mesh, repairs))
    }
}

pub(super) fn has_repeated_corner(&[a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Whether three points are on a line, exactly: their projections on all three coordinate planes are on a line.
fn is_on_a_line(corners: [Vec3; 3]) -> bool {
    [[0, 1], [1, 2], [2, 0]].into_iter().all(|[u, v]| {
        let [a, b, c] = corners.map(|p| Coord {
            x: f64::from(p[u]),
            y: f64::from(p[v]),
        });
        orient2d(a, b, c) == 0.0
    })
}

/// Gives all vertices at the same position the index of the first one.
fn weld(vertices: &mut Vec<Vec3>, triangles: &mut [[u32; 3]]) -> usize {
    let key = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits()); // -0 is at 0
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(vertices[i as usize]), i));

    let mut first = vec![0u32; vertices.len()];
    for same in order.chunk_by(|&i, &j| key(vertices[i as usize]) == key(vertices[j as usize])) {
        for &i in same {
            first[i as usize] = same[0];
        }
    }
    let before = vertices.len();
    for v in triangles.iter_mut().flatten() {
        *v = first[*v as usize];
    }
    drop_unreferenced(vertices, triangles);
    before - vertices.len()
}

/// Keeps the vertices that triangles use, in their order.
fn drop_unreferenced(vertices: &mut Vec<Vec3>, triangles: &mut [[u32; 3]]) -> usize {
    let mut index = vec![0u32; vertices.len()];
    for &v in triangles.iter().flatten() {
        index[v as usize] = 1;
    }
    let before = vertices.len();
    let mut kept = 0;
    for old in 0..before {
        if index[old] == 1 {
            vertices[kept] = vertices[old];
            index[old] = kept as u32;
            kept += 1;
        }
    }
    vertices.truncate(kept);
    for v in triangles.iter_mut().flatten() {
        *v = index[*v as usize];
    }
    before - kept
}

/// Of triangles with the same three vertices, keeps the first one, whatever their winding.
fn drop_duplicates(triangles: &mut Vec<[u32; 3]>) -> usize {
    let key = |t: [u32; 3]| {
        let mut sorted = t;
        sorted.sort_unstable();
        sorted
    };
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(triangles[i as usize]), i));
    let mut keep = vec![false; triangles.len()];
    for same in order.chunk_by(|&i, &j| key(triangles[i as usize]) == key(triangles[j as usize])) {
        keep[same[0] as usize] = true;
    }
    let before = triangles.len();
    let mut keep = keep.into_iter();
    triangles.retain(|_| keep.next().is_some_and(|k| k));
    before - triangles.len()
}
