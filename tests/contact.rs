//! Exact contact, from predicates to meshes: against rational arithmetic, and naive against BVH.

use std::sync::Arc;

use kit::agree::assert_same;
use kit::inputs::{hard_coordinate, soup};
use kit::meshes::{mesh, scaled};
use kit::oracle;
use kit::worlds::meet;
use proptest::prelude::*;
use sim_core::collide::predicates::{segment_meets_triangle, triangles_meet};
use sim_core::collide::{Placement, naive, tree};
use sim_core::{Bvh, DQuat, DVec3, Mesh, Shape, Vec3};

/// Points that mostly touch, coincide or lie in common planes: on a small lattice, some of them moved by an ulp, scaled
/// by a power of two and moved far away.
fn hard_points<const N: usize>() -> impl Strategy<Value = [DVec3; N]> {
    let coordinate = (0..5i32, -1..=1i32);
    let points = prop::array::uniform::<_, N>(prop::array::uniform3(coordinate));
    let offset = prop_oneof![Just(0.0), Just(1e8), Just(-0.1)];
    (points, -60..60i32, offset, any::<bool>()).prop_map(|(points, exponent, offset, nudge)| {
        let scale = 2.0_f64.powi(exponent);
        points.map(|p| {
            DVec3::from_array(p.map(|(cell, ulps)| {
                let ulps = if nudge { ulps } else { 0 };
                hard_coordinate(cell, ulps, offset) * scale
            }))
        })
    })
}

/// A soup of triangles on a lattice, with degenerate ones, shared corners and coplanar faces.
fn lattice_soup(most: usize) -> impl Strategy<Value = Mesh> {
    let vertex = prop::array::uniform3(0..6i32);
    let vertices = prop::collection::vec(vertex, 3..40);
    (
        vertices,
        prop::collection::vec(prop::array::uniform3(0..1000u32), 1..most),
    )
        .prop_filter_map("a mesh", |(vertices, triangles)| {
            let count = vertices.len() as u32;
            let vertices = vertices
                .iter()
                .map(|v| Vec3::from_array(v.map(|x| x as f32)))
                .collect();
            let triangles = triangles.iter().map(|t| t.map(|v| v % count)).collect();
            Mesh::repaired(vertices, triangles)
                .ok()
                .map(|(mesh, _)| mesh)
        })
}

/// A soup of small random triangles.
fn random_soup() -> impl Strategy<Value = Mesh> {
    let corner = prop::array::uniform3(-1.0f32..1.0);
    let triangle = (corner.clone(), prop::array::uniform2(corner));
    prop::collection::vec(triangle, 1..60).prop_map(|triangles| soup(&triangles))
}

/// Tests that naive and BVH agree, and that the order of the meshes does not matter.
fn assert_symmetric(first: &Mesh, second: &Mesh, offset: DVec3) {
    let meet = assert_same(first, second, offset);
    assert_eq!(meet, assert_same(second, first, -offset));
}

/// Whether bodies of these shapes overlap; the second one is displaced.
fn overlap(first: &Mesh, second: &Mesh, offset: DVec3) -> bool {
    let [first, second] = [first, second].map(|mesh| Shape::Mesh(Arc::new(mesh.clone())));
    meet(&first, &second, offset)
}

/// Arbitrary rotations, and those by right angles, which map lattices to lattices exactly or up to rounding.
fn rotations() -> impl Strategy<Value = DQuat> {
    let any = prop::array::uniform4(-1.0..1.0f64).prop_filter_map("a direction", |q| {
        let q = DQuat::from_array(q);
        (q.length() > 0.1).then(|| q.normalize())
    });
    let axis = prop_oneof![Just(DVec3::X), Just(DVec3::Y), Just(DVec3::Z)];
    let right = (axis, 0..4i32).prop_map(|(axis, quarters)| {
        DQuat::from_axis_angle(axis, f64::from(quarters) * std::f64::consts::FRAC_PI_2)
    });
    prop_oneof![any, right]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn segments_and_triangles_agree_with_rational_arithmetic(
        [p, q, a, b, c] in hard_points(),
    ) {
        let exact = oracle::segment_meets_triangle(p, q, [a, b, c]);
        prop_assert_eq!(segment_meets_triangle(p, q, [a, b, c]), exact);
        prop_assert_eq!(segment_meets_triangle(q, p, [c, b, a]), exact);
    }

    #[test]
    fn any_triangles_agree_with_rational_arithmetic(
        corners in prop::array::uniform6(prop::array::uniform3(-1.0..1.0f64)),
    ) {
        let [a, b, c, d, e, f] = corners.map(DVec3::from_array);
        let (s, t) = ([a, b, c], [d, e, f]);
        let exact = oracle::triangles_meet(s, t);
        prop_assert_eq!(triangles_meet(s, t), exact);
        prop_assert_eq!(triangles_meet(t, [c, b, a]), exact);
    }

    #[test]
    fn triangles_agree_with_rational_arithmetic([a, b, c, d, e, f] in hard_points()) {
        let (s, t) = ([a, b, c], [d, e, f]);
        let exact = oracle::triangles_meet(s, t);
        prop_assert_eq!(triangles_meet(s, t), exact);
        prop_assert_eq!(triangles_meet(t, s), exact);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn naive_and_bvh_agree_on_lattices(
        first in lattice_soup(40),
        second in lattice_soup(40),
        offset in prop::array::uniform3(-6..6i32),
        scale in prop_oneof![Just(1.0), Just(1e-10), Just(1e10), Just(1e-36), Just(3e13), Just(5e37)],
    ) {
        let [first, second] = [first, second].map(|mesh| scaled(&mesh, DVec3::splat(scale)));
        let offset = DVec3::from_array(offset.map(f64::from)) * scale;
        // An offset that f32 represents places vertices without rounding.
        assert_symmetric(&first, &second, offset.as_vec3().as_dvec3());
        // Otherwise the order of meshes determines which one is rounded; the order of bodies does not.
        assert_same(&first, &second, offset);
        assert_same(&second, &first, -offset);
        prop_assert_eq!(overlap(&first, &second, offset), overlap(&second, &first, -offset));
    }

    #[test]
    fn naive_and_bvh_agree_on_random_soups(
        first in random_soup(),
        second in random_soup(),
        offset in prop::array::uniform3(-2.0..2.0),
    ) {
        assert_symmetric(&first, &second, DVec3::from_array(offset));
    }

    #[test]
    fn naive_and_bvh_agree_on_turned_soups(
        first in prop_oneof![random_soup(), lattice_soup(40)],
        second in prop_oneof![random_soup(), lattice_soup(40)],
        offset in prop::array::uniform3(prop_oneof![-2.0..2.0, Just(0.0), Just(1.0)]),
        rotation in rotations(),
    ) {
        let at = Placement::turned(rotation, DVec3::from_array(offset)).expect("of unit length");
        assert_same(&first, &second, at);
    }
}

/// Found by a random search: a corner lies on an edge if placed in one frame, and beside it if placed in the other.
#[test]
fn bodies_that_touch_by_a_rounding_do_so_in_either_order() {
    let tiny = |corners: [[f32; 3]; 3]| {
        let mesh = mesh(corners.map(Vec3::from_array).to_vec(), vec![[0, 2, 1]]);
        scaled(&mesh, DVec3::splat(1e-10))
    };
    let first = tiny([[0.0, 2.0, 0.0], [3.0, 0.0, 1.0], [0.0, 0.0, 0.0]]);
    let second = tiny([[3.0, 4.0, 2.0], [1.0, 0.0, 0.0], [3.0, 0.0, 1.0]]);
    let offset = 1e-10 * DVec3::new(0.0, -4.0, -1.0);
    assert!(naive::intersect(&first, &second, offset));
    assert!(!naive::intersect(&second, &first, -offset));
    let meet = overlap(&first, &second, offset);
    assert_eq!(meet, overlap(&second, &first, -offset));
}

/// Found by a random search: a vertex so close to a plane that the determinant underflows.
#[test]
fn offsets_below_any_product_count_as_none() {
    let triangle =
        |corners: [[f32; 3]; 3]| mesh(corners.map(Vec3::from_array).to_vec(), vec![[0, 1, 2]]);
    let flat = triangle([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 3.0, 0.0]]);
    let upright = triangle([[1.0, 3.0, 0.0], [1.0, 3.0, 1.0], [0.0, 0.0, 0.0]]);
    let least_kept = 2.0_f64.powi(-250);
    for (z, meet) in [
        (5e-324, true),
        (least_kept / 2.0, true),
        (least_kept, false),
        (1e-40, false),
    ] {
        let offset = DVec3::new(0.0, 0.0, z);
        assert_eq!(assert_same(&flat, &upright, offset), meet, "{z}");
        assert!(assert_same(&flat, &upright, -offset), "-{z}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn hits_are_those_of_rational_arithmetic(
        first in lattice_soup(9),
        second in lattice_soup(9),
        offset in prop::array::uniform3(-3..3i32),
    ) {
        let offset = DVec3::from_array(offset.map(f64::from));
        let (a, b) = (Bvh::build(&first), Bvh::build(&second));
        let mut exact = Vec::new();
        let at = |mesh: &Mesh, v: u32, offset: DVec3| mesh.vertices()[v as usize].as_dvec3() + offset;
        let zero = DVec3::ZERO;
        for (edges, edges_at, faces, faces_at) in
            [(&first, zero, &second, offset), (&second, offset, &first, zero)]
        {
            for (edge, ends) in edges.edges().iter().enumerate() {
                for (face, corners) in faces.triangles().iter().enumerate() {
                    let [p, q] = ends.map(|v| at(edges, v, edges_at));
                    if oracle::segment_meets_triangle(p, q, corners.map(|v| at(faces, v, faces_at))) {
                        exact.push((edge as u32, face as u32));
                    }
                }
            }
        }
        let found = tree::hits(&a, &b, offset);
        prop_assert_eq!(found.iter().map(|h| (h.edge, h.face)).collect::<Vec<_>>(), exact);
    }
}
