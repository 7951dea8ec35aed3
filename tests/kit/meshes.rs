//! Meshes.

use std::f32::consts::TAU;
use std::sync::Arc;

use sim_core::{DQuat, DVec3, Mesh, Vec3};

/// A mesh from valid vertices and triangles.
pub fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Arc<Mesh> {
    Arc::new(Mesh::new(vertices, triangles).expect("a mesh"))
}

/// A mesh of the gallery, by its file name.
pub fn builtin(name: &str) -> Arc<Mesh> {
    scene::mesh_file::builtin(name).expect("built in")
}

/// A scaled mesh.
pub fn scaled(mesh: &Mesh, scale: DVec3) -> Arc<Mesh> {
    Arc::new(mesh.transformed(DQuat::IDENTITY, scale).expect("a mesh"))
}

/// Some boxes as one mesh, by their least and greatest corners.
pub fn boxes(corners: &[[Vec3; 2]]) -> Arc<Mesh> {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for &[low, high] in corners {
        let first = vertices.len() as u32;
        // Bit k of a corner's number says whether it is at the upper end of axis k.
        vertices.extend((0..8).map(|i| {
            let pick = |axis: usize| [low, high][i >> axis & 1][axis];
            Vec3::new(pick(0), pick(1), pick(2))
        }));
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        for [a, b, c, d] in quads.map(|quad| quad.map(|v| first + v)) {
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh(vertices, triangles)
}

/// A box centred at the origin, by its half extents.
pub fn cuboid(half: impl Into<Vec3>) -> Arc<Mesh> {
    let half = half.into();
    boxes(&[[-half, half]])
}

/// A cube centred at the origin, by half its edge.
pub fn cube(half: f32) -> Arc<Mesh> {
    cuboid(Vec3::splat(half))
}

/// A grid of `n` by `n` quads, joined at its sides if it is closed; a position is given by two parameters from 0 to 1.
pub fn grid(n: u32, is_closed: bool, at: impl Fn(f32, f32) -> Vec3) -> Arc<Mesh> {
    let side = if is_closed { n } else { n + 1 };
    let place = |i: u32| i as f32 / n as f32;
    let vertices = (0..side * side).map(|k| at(place(k / side), place(k % side)));
    let corner = |i: u32, j: u32| i % side * side + j % side;
    let triangles = (0..n * n).flat_map(|k| {
        let (i, j) = (k / n, k % n);
        let [a, b] = [corner(i, j), corner(i + 1, j)];
        let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh(vertices.collect(), triangles.collect())
}

/// An open square of side 1 in the plane x = 0, bent by `bend` m.
pub fn sheet(bend: f32) -> Arc<Mesh> {
    grid(8, false, |y, z| {
        let (y, z) = (y - 0.5, z - 0.5);
        Vec3::new(bend * (5.0 * y + 3.0 * z).sin(), y, z)
    })
}

/// A torus about the z axis.
pub fn torus(around: f32, thick: f32) -> Arc<Mesh> {
    grid(16, true, |u, v| {
        let (u, v) = (TAU * u, TAU * v);
        let r = around + thick * v.cos();
        Vec3::new(r * u.cos(), r * u.sin(), thick * v.sin())
    })
}

/// A closed surface of spikes: the corners of a cube and of an octahedron, one of them long.
pub fn star(long: f32, short: f32) -> Arc<Mesh> {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { short } else { -short };
        Vec3::new(sign(0), sign(1), sign(2))
    };
    let mut vertices: Vec<Vec3> = (0..8).map(corner).collect();
    let mut triangles = Vec::new();
    let sides = [
        (-Vec3::Z, [0, 2, 3, 1]),
        (Vec3::Z, [4, 5, 7, 6]),
        (-Vec3::Y, [0, 1, 5, 4]),
        (Vec3::Y, [2, 6, 7, 3]),
        (-Vec3::X, [0, 4, 6, 2]),
        (Vec3::X, [1, 3, 7, 5]),
    ];
    for (axis, ring) in sides {
        let tip = vertices.len() as u32;
        vertices.push(long * axis);
        triangles.extend((0..4).map(|k| [ring[k], ring[(k + 1) % 4], tip]));
    }
    mesh(vertices, triangles)
}
