//! Meshes made for the tests.

use std::f32::consts::TAU;
use std::sync::Arc;

use kit::meshes::{grid, mesh};
use sim_core::{Mesh, Vec3};

/// An open square of side 1 in the plane x = 0, bent by `bend` m.
pub(crate) fn sheet(bend: f32) -> Arc<Mesh> {
    grid(8, false, |y, z| {
        let (y, z) = (y - 0.5, z - 0.5);
        Vec3::new(bend * (5.0 * y + 3.0 * z).sin(), y, z)
    })
}

/// A torus about the z axis.
pub(crate) fn torus(around: f32, thick: f32) -> Arc<Mesh> {
    grid(16, true, |u, v| {
        let (u, v) = (TAU * u, TAU * v);
        let r = around + thick * v.cos();
        Vec3::new(r * u.cos(), r * u.sin(), thick * v.sin())
    })
}

/// A closed surface of spikes: the corners of a cube and of an octahedron, one of them long.
pub(crate) fn star(long: f32, short: f32) -> Arc<Mesh> {
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
