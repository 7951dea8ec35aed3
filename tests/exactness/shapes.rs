//! Meshes of these scenes.

use std::f32::consts::PI;

use kit::shapes::{self, mesh, scaled};
use sim_core::{DVec3, Shape, Vec3};

/// A flat parallelogram centred at the origin, by two adjacent corners.
pub(crate) fn sheet(p: Vec3, q: Vec3) -> Shape {
    mesh(vec![p, q, -p, -q], vec![[0, 1, 2], [0, 2, 3]])
}

pub(crate) fn cube(half: f32) -> Shape {
    scaled(&shapes::cube(), DVec3::splat(2.0 * f64::from(half)))
}

pub(crate) fn tetrahedron(size: f32) -> Shape {
    let corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
    let vertices = corners.map(|c| Vec3::from_array(c.map(|x| x as f32 * size)));
    mesh(
        vertices.to_vec(),
        vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
    )
}

/// A channel along z, open at the top: a floor and two walls in one mesh.
pub(crate) fn channel(size: f32) -> Shape {
    let outline = [
        [-0.5, 0.0],
        [0.5, 0.0],
        [0.5, 1.0],
        [0.25, 1.0],
        [0.25, 0.25],
        [-0.25, 0.25],
        [-0.25, 1.0],
        [-0.5, 1.0],
    ];
    let ring = |z: f32| outline.map(|[x, y]| size * Vec3::new(x, y, z));
    let vertices = [ring(-0.5), ring(0.5)].concat();
    let mut triangles = Vec::new();
    for [a, b, c, d] in [[0, 1, 4, 5], [1, 2, 3, 4], [0, 5, 6, 7]] {
        triangles.extend([[a + 8, b + 8, c + 8], [a + 8, c + 8, d + 8]]);
        triangles.extend([[a, c, b], [a, d, c]]);
    }
    for i in 0..8 {
        let j = (i + 1) % 8;
        triangles.extend([[i, j, j + 8], [i, j + 8, i + 8]]);
    }
    mesh(vertices, triangles)
}

/// A triangulated sphere with so many rings from pole to pole.
pub(crate) fn globe(rings: u32, radius: f32) -> Shape {
    let round = 2 * rings;
    let mut vertices = vec![Vec3::new(0.0, radius, 0.0)];
    for i in 1..rings {
        for j in 0..round {
            let (down, about) = (PI * i as f32 / rings as f32, PI * j as f32 / rings as f32);
            let aside = down.sin();
            let at = Vec3::new(aside * about.cos(), down.cos(), aside * about.sin());
            vertices.push(radius * at);
        }
    }
    let last = vertices.len() as u32;
    vertices.push(Vec3::new(0.0, -radius, 0.0));
    let at = |i: u32, j: u32| 1 + (i - 1) * round + j % round;
    let mut triangles = Vec::new();
    for j in 0..round {
        triangles.push([0, at(1, j + 1), at(1, j)]);
        for i in 1..rings - 1 {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
        triangles.push([last, at(rings - 1, j), at(rings - 1, j + 1)]);
    }
    mesh(vertices, triangles)
}
