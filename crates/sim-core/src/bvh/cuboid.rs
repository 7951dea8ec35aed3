//! Meshes that are axis-aligned boxes.

use glam::DVec3;

use crate::{Aabb, Mesh};

/// A closed mesh of twelve triangles that is the whole surface of a box along the axes, wound outward.
///
/// Corners of a box are numbered by position: bit `k` is set at the high end of axis `k`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cuboid {
    /// Low and high corner, m.
    pub(crate) ends: [DVec3; 2],
    /// The mesh's vertex at each corner.
    pub(crate) vertices: [u32; 8],
    /// For each axis, the faces at the low and the high end.
    pub(crate) faces: [[Face; 2]; 3],
}

/// A side of a box: two triangles that share a diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Face {
    pub(crate) triangles: [u32; 2],
    /// The corner of the first triangle that is not on the diagonal.
    pub(crate) corner: usize,
}

impl Cuboid {
    pub(super) fn of(mesh: &Mesh) -> Option<Cuboid> {
        if mesh.triangles().len() != 12 {
            return None;
        }
        let Aabb { min, max } = mesh.bounds();
        if !min.cmplt(max).all() {
            return None;
        }
        let corner = |vertex: u32| {
            let v = mesh.vertices()[vertex as usize];
            let is_one = (v.cmpeq(min) | v.cmpeq(max)).all();
            is_one.then(|| v.cmpeq(max).bitmask() as usize)
        };
        let mut vertices = [None; 8];
        let mut faces = [[None::<Face>; 2]; 3];
        for (triangle, &[a, b, c]) in (0..).zip(mesh.triangles()) {
            let corners = [corner(a)?, corner(b)?, corner(c)?];
            for (corner, vertex) in corners.into_iter().zip([a, b, c]) {
                if *vertices[corner].get_or_insert(vertex) != vertex {
                    return None;
                }
            }
            let (axis, end) = outward(corners)?;
            // The two ends of the diagonal differ in both axes of the face.
            let diagonal = 7 ^ 1 << axis;
            let middle = (0..3).find(|&i| corners[(i + 1) % 3] ^ corners[(i + 2) % 3] == diagonal);
            let right = corners[middle?];
            match &mut faces[axis][end] {
                empty @ None => {
                    *empty = Some(Face {
                        triangles: [triangle; 2],
                        corner: right,
                    });
                }
                Some(Face { triangles, corner })
                    if triangles[0] == triangles[1] && *corner == right ^ diagonal =>
                {
                    triangles[1] = triangle;
                }
                Some(_) => return None,
            }
        }
        // Twelve triangles, at most two on a face, are two on each.
        let vertices = vertices.map(|vertex| vertex.unwrap_or(u32::MAX));
        let [x, y, z] = faces.map(|[low, high]| Some([low?, high?]));
        Some(Cuboid {
            ends: [min.as_dvec3(), max.as_dvec3()],
            vertices,
            faces: [x?, y?, z?],
        })
    }

    /// [`super::Bvh::least_along`].
    pub(super) fn least_along(&self, direction: DVec3) -> (f64, DVec3) {
        let [low, high] = self.ends;
        let (forward, along) = (direction.cmpgt(DVec3::ZERO), direction.cmpeq(DVec3::ZERO));
        let end = DVec3::select(forward, low, high);
        (
            end.dot(direction),
            DVec3::select(along, 0.5 * (low + high), end),
        )
    }

    /// The position of a corner of a box with low and high corner `ends`.
    pub(crate) fn corner(ends: &[DVec3; 2], corner: usize) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|axis| ends[corner >> axis & 1][axis]))
    }
}

/// The axis and end of the face in which a triangle of three corners of a box lies, if its winding
/// points out of the box.
fn outward([a, b, c]: [usize; 3]) -> Option<(usize, usize)> {
    let axis = (0..3).find(|&axis| (a ^ b | a ^ c) >> axis & 1 == 0)?;
    let along = |from: usize, to: usize, axis: usize| {
        let axis = axis % 3;
        (to >> axis & 1) as i32 - (from >> axis & 1) as i32
    };
    let (u, v) = (axis + 1, axis + 2);
    let cross = along(a, b, u) * along(a, c, v) - along(a, b, v) * along(a, c, u);
    let end = a >> axis & 1;
    (cross == 2 * end as i32 - 1).then_some((axis, end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};
    use glam::{DQuat, Vec3};

    #[test]
    fn boxes_are_known_whatever_their_triangles() {
        let known = Cuboid::of(&cube()).unwrap();
        for corner in 0..8 {
            let vertex = known.vertices[corner] as usize;
            let at = Cuboid::corner(&known.ends, corner);
            assert_eq!(cube().vertices()[vertex].as_dvec3(), at);
        }
        for (axis, face) in (0..3).flat_map(|axis| known.faces[axis].map(|face| (axis, face))) {
            let diagonal = 7 ^ 1 << axis;
            let corners = [face.corner, face.corner ^ diagonal];
            for (triangle, corner) in face.triangles.into_iter().zip(corners) {
                let names = cube().triangles()[triangle as usize];
                assert!(names.contains(&known.vertices[corner]));
                assert!(!names.contains(&known.vertices[corner ^ diagonal]));
            }
        }
        // Stretched, and with each diagonal exchanged.
        let long = cube().transformed(DQuat::IDENTITY, DVec3::new(3.0, 0.1, 1.0));
        assert!(Cuboid::of(&long.unwrap()).is_some());
        let mut triangles = cube().triangles().to_vec();
        for pair in triangles.chunks_exact_mut(2) {
            let ([a, b, c], d) = (pair[0], pair[1][2]);
            (pair[0], pair[1]) = ([a, b, d], [b, c, d]);
        }
        let turned = Mesh::new(cube().vertices().to_vec(), triangles).unwrap();
        assert!(Cuboid::of(&turned).is_some());
    }

    #[test]
    fn what_is_not_quite_a_box_is_none() {
        let not = |change: &dyn Fn(&mut Vec3, &mut [[u32; 3]])| {
            let mut vertices = cube().vertices().to_vec();
            let mut triangles = cube().triangles().to_vec();
            change(&mut vertices[7], &mut triangles);
            let mesh = Mesh::new(vertices, triangles).unwrap();
            assert_eq!(Cuboid::of(&mesh), None);
        };
        not(&|corner, _| corner.x = corner.x.next_up());
        not(&|corner, _| corner.x = 0.3);
        // A face with reversed winding, two halves that overlap, a wall inside.
        not(&|_, triangles| triangles[3].swap(0, 1));
        not(&|_, triangles| triangles[3] = [triangles[2][0], triangles[2][1], 5]);
        not(&|_, triangles| triangles[0] = [0, 5, 7]);
        let tilted = cube().transformed(DQuat::from_rotation_z(0.1), DVec3::ONE);
        assert_eq!(Cuboid::of(&tilted.unwrap()), None);
        assert_eq!(Cuboid::of(&sphere(4)), None);
    }
}
