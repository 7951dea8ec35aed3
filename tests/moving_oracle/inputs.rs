//! Points and meshes that mostly touch, and arbitrary ones.

use kit::inputs::{hard_coordinate, soup};
use proptest::prelude::*;
use sim_core::{DVec3, Mesh, Vec3};

/// Points that mostly touch, coincide or lie in common planes and lines: on a small lattice, some of them moved by an
/// ulp, scaled by a power of two and moved far away; with a motion of the same kind.
pub(crate) fn hard_points<const N: usize>() -> impl Strategy<Value = ([DVec3; N], DVec3)> {
    let coordinate = (0..4i32, -1..=1i32);
    let points = prop::array::uniform::<_, N>(prop::array::uniform3(coordinate));
    let motion = prop::array::uniform3((-3..=3i32, -1..=1i32));
    let offset = prop_oneof![3 => Just(0.0), 1 => Just(1e8), 1 => Just(-0.1)];
    (points, motion, -60..60i32, offset, any::<bool>()).prop_map(
        |(points, motion, exponent, offset, nudge)| {
            let scale = 2.0_f64.powi(exponent);
            let at = |(cell, ulps): (i32, i32), offset: f64| {
                let ulps = if nudge { ulps } else { 0 };
                hard_coordinate(cell, ulps, offset) * scale
            };
            (
                points.map(|p| DVec3::from_array(p.map(|x| at(x, offset)))),
                DVec3::from_array(motion.map(|x| at(x, 0.0))),
            )
        },
    )
}

/// Arbitrary points with an arbitrary motion, long enough to meet something.
pub(crate) fn any_points<const N: usize>() -> impl Strategy<Value = ([DVec3; N], DVec3)> {
    let points = prop::array::uniform::<_, N>(prop::array::uniform3(-1.0..1.0f64));
    (points, prop::array::uniform3(-3.0..3.0f64))
        .prop_map(|(points, motion)| (points.map(DVec3::from_array), DVec3::from_array(motion)))
}

pub(crate) fn points<const N: usize>() -> impl Strategy<Value = ([DVec3; N], DVec3)> {
    prop_oneof![hard_points(), any_points()]
}

/// A soup of triangles on a lattice, with degenerate ones, shared corners and coplanar faces.
pub(crate) fn lattice_soup(cells: i32, most: usize) -> impl Strategy<Value = Mesh> {
    let vertex = prop::array::uniform3(0..cells);
    let vertices = prop::collection::vec(vertex, 3..9);
    let triangles = prop::collection::vec(prop::array::uniform3(0..1000u32), 1..most);
    (vertices, triangles).prop_filter_map("a mesh", |(vertices, triangles)| {
        let count = vertices.len() as u32;
        let vertices = vertices
            .iter()
            .map(|v| Vec3::from_array(v.map(|x| x as f32)))
            .collect();
        let triangles = triangles.iter().map(|t| t.map(|v| v % count));
        let differ = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        Mesh::new(vertices, triangles.filter(differ).collect()).ok()
    })
}

/// A soup of random triangles.
pub(crate) fn random_soup(most: usize) -> impl Strategy<Value = Mesh> {
    let corner = prop::array::uniform3(-1.0f32..1.0);
    let triangle = (corner.clone(), prop::array::uniform2(corner));
    prop::collection::vec(triangle, 1..most).prop_map(|triangles| soup(&triangles))
}

pub(crate) fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(range).prop_map(DVec3::from_array)
}

pub(crate) fn lattice_vector(most: i32) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-most..=most).prop_map(|v| DVec3::from_array(v.map(f64::from)))
}
