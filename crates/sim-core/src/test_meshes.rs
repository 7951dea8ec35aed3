//! Small meshes for tests.

use alloc::vec::Vec;
use glam::Vec3;

use crate::Mesh;

/// A cube of side 1 m about its origin.
pub(crate) fn cube() -> Mesh {
    let vertices = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5)
        .collect();
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Mesh::new(vertices, triangles).expect("the cube is a mesh")
}

/// A sphere of radius 1 m, with `n` rings of `n` vertices between its poles.
pub(crate) fn sphere(n: u32) -> Mesh {
    let mut vertices = Vec::from([Vec3::Y, Vec3::NEG_Y]);
    for ring in 0..n {
        let polar = (ring + 1) as f32 * core::f32::consts::PI / (n + 1) as f32;
        for i in 0..n {
            let azimuth = i as f32 * core::f32::consts::TAU / n as f32;
            vertices.push(Vec3::new(
                libm::sinf(polar) * libm::cosf(azimuth),
                libm::cosf(polar),
                libm::sinf(polar) * libm::sinf(azimuth),
            ));
        }
    }
    let at = |ring: u32, i: u32| 2 + ring * n + i % n;
    let mut triangles = Vec::new();
    for i in 0..n {
        triangles.push([0, at(0, i + 1), at(0, i)]);
        triangles.push([1, at(n - 1, i), at(n - 1, i + 1)]);
        for ring in 0..n - 1 {
            triangles.push([at(ring, i), at(ring, i + 1), at(ring + 1, i)]);
            triangles.push([at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)]);
        }
    }
    Mesh::new(vertices, triangles).expect("the sphere is a mesh")
}
