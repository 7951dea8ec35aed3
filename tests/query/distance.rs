//! Distances of meshes: of two triangles against rational arithmetic, of many against those of pairs.

use kit::meshes::{builtin, cube, grid, mesh};
use kit::rational::{Q, rational, zero};
use proptest::prelude::*;
use sim_core::query::{self, Hit, Part, Placed};
use sim_core::{Bvh, DQuat, DVec3, Mesh, Vec3};

use crate::oracle::{Triangle, distance_square};

/// The documented error, relative to the sizes of the triangles and their distance.
const ERROR: f64 = 16.0 * 0.5 * f64::EPSILON;

fn at(tree: &Bvh, position: DVec3) -> Placed<'_> {
    Placed::mesh(tree, position).expect("a position")
}

fn between(first: &Bvh, second: &Bvh, offset: DVec3) -> Hit {
    query::distance(at(first, DVec3::ZERO), at(second, offset)).expect("meshes")
}

fn triangle(corners: [Vec3; 3]) -> Bvh {
    Bvh::build(&mesh(corners.to_vec(), vec![[0, 1, 2]]))
}

/// The corners after placement.
fn placed(corners: [Vec3; 3], offset: DVec3) -> Triangle {
    corners.map(|v| v.as_dvec3() + offset)
}

fn size(s: Triangle) -> f64 {
    s[0].distance(s[1])
        .max(s[1].distance(s[2]))
        .max(s[2].distance(s[0]))
}

/// Compares the distance of two triangles with the exact one, and its points and features with the distance.
fn check(first: [Vec3; 3], second: [Vec3; 3], offset: DVec3) -> Result<bool, TestCaseError> {
    let (one, other) = (triangle(first), triangle(second));
    let found = between(&one, &other, offset);
    // The frame is that of the mesh with the lexicographically lower position; the other one's vertices are placed in
    // it.
    let (x, y, z) = offset.into();
    let (s, t) = match (x, y, z) < (0.0, 0.0, 0.0) {
        true => (placed(first, -offset), placed(second, DVec3::ZERO)),
        false => (placed(first, DVec3::ZERO), placed(second, offset)),
    };
    let exact = distance_square(s, t);
    let slack = ERROR * (size(s) + size(t) + found.distance);
    let square = |x: Q| &x * &x;
    let (low, high) = (found.distance - slack, found.distance + slack);
    prop_assert!(square(rational(high)) >= exact, "too near: {found:?}");
    prop_assert!(
        low <= 0.0 || square(rational(low)) <= exact,
        "too far: {found:?}"
    );
    prop_assert_eq!(found.distance == 0.0, exact == zero());
    let meets = query::intersects(at(&one, DVec3::ZERO), at(&other, offset));
    prop_assert_eq!(found.distance == 0.0, meets);
    let [p, q] = found.points;
    let largest = s
        .iter()
        .chain(&t)
        .fold(offset.abs(), |all, p| all.max(p.abs()));
    let rounding = 64.0 * f64::EPSILON * largest.max_element();
    prop_assert!(
        (p.distance(q) - found.distance).abs() <= rounding,
        "{found:?}"
    );
    if found.distance > 1e3 * rounding {
        let along = (q - p).normalize();
        prop_assert!(found.normal.distance(along) < 1e-2, "{found:?} {along}");
        prop_assert!((found.normal.length() - 1.0).abs() < 1e-14);
        for (part, (corners, point)) in found.parts.iter().zip([(first, p), (second, q - offset)]) {
            let [a, b, c] = corners.map(|v| v.as_dvec3());
            let ends = [[a, b], [b, c], [c, a]];
            // The point lies on the feature.
            let aside = match part.expect("parts are told") {
                Part::Vertex(k) => point.distance([a, b, c][k as usize]),
                Part::Edge(k) => {
                    // Edges are numbered by their vertices: 01, 02, 12.
                    let [start, end] = [ends[0], ends[2], ends[1]][k as usize];
                    let along = (end - start).normalize_or_zero();
                    let way = point - start;
                    (way - way.dot(along) * along).length()
                }
                Part::Face(k) => f64::from(k),
            };
            prop_assert!(aside <= rounding, "{found:?}: {aside}");
        }
    }
    Ok(found.distance > 0.0)
}

/// On a lattice: parallel faces and edges, corners over edges, coplanar faces, needles, points.
fn lattice() -> impl Strategy<Value = [Vec3; 3]> {
    let corner = || prop::array::uniform3(-3_i8..=3).prop_map(|p| Vec3::from(p.map(f32::from)));
    prop::array::uniform3(corner())
}

fn anywhere() -> impl Strategy<Value = [Vec3; 3]> {
    prop::array::uniform3(prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from))
}

/// Long and thin, down to the rounding of its corners, and nearly along x.
fn needle() -> impl Strategy<Value = [Vec3; 3]> {
    (anywhere(), -24_i32..0, -24_i32..0).prop_map(|(corners, thin, aside)| {
        let [a, b, c] = corners;
        let thin = Vec3::new(1.0, (2.0_f32).powi(thin), (2.0_f32).powi(thin));
        let aside = Vec3::new(1.0, (2.0_f32).powi(aside), (2.0_f32).powi(aside));
        [a * aside, b * aside, a * aside + c * thin]
    })
}

fn offset() -> impl Strategy<Value = DVec3> {
    let small = prop::array::uniform3(-4_i8..=4).prop_map(|p| 0.5 * DVec3::from(p.map(f64::from)));
    let any = prop::array::uniform3(-2.0_f64..2.0).prop_map(DVec3::from);
    let near = (prop::array::uniform3(-1.0_f64..1.0), 0_i32..60)
        .prop_map(|(p, k)| DVec3::from(p) * 2.0_f64.powi(-k));
    prop_oneof![small, any, near]
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: prop::test_runner::RngSeed::Fixed(13),
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config(1500))]

    #[test]
    fn triangles_are_as_far_apart_as_in_rational_arithmetic(
        first in prop_oneof![lattice(), anywhere(), needle()],
        second in prop_oneof![lattice(), anywhere(), needle()],
        offset in offset(),
        scale in -20_i32..=20,
        other in -20_i32..=20,
    ) {
        let proper = |[a, b, c]: [Vec3; 3]| a != b && b != c && c != a;
        prop_assume!(proper(first) && proper(second));
        // From 1e-6 to 1e6, with equal sizes or not.
        let scales = [2.0_f32.powi(scale), 2.0_f32.powi(if other % 2 == 0 { scale } else { other })];
        let first = first.map(|v| scales[0] * v);
        let second = second.map(|v| scales[1] * v);
        check(first, second, f64::from(scales[0].max(scales[1])) * offset)?;
    }
}

proptest! {
    #![proptest_config(config(200))]

    /// Trees skip nothing: the distance is the least of all pairs of triangles.
    #[test]
    fn meshes_are_as_far_apart_as_their_nearest_triangles(
        shapes in prop::array::uniform2(0_usize..4),
        turn in prop::array::uniform4(-1.0_f64..1.0),
        direction in prop::array::uniform3(-1.0_f64..1.0),
        way in -3.0_f64..3.0,
        scale in -20_i32..=20,
    ) {
        let scale = 2.0_f64.powi(scale);
        let turn = DQuat::from_array(turn);
        prop_assume!(turn.length() > 0.1 && DVec3::from(direction).length() > 0.1);
        let meshes = shapes.map(|k| shape(k).transformed(turn.normalize(), DVec3::splat(scale)));
        let [first, second] = meshes.map(|mesh| mesh.expect("a mesh"));
        let offset = scale * way * DVec3::from(direction).normalize();
        let found = between(&Bvh::build(&first), &Bvh::build(&second), offset);
        let parts = |mesh: &Mesh| -> Vec<Bvh> {
            (0..mesh.triangles().len()).map(|i| triangle(mesh.corners(i))).collect()
        };
        let (ones, others) = (parts(&first), parts(&second));
        let pairs = ones.iter().flat_map(|one| others.iter().map(move |other| (one, other)));
        let nearest = pairs
            .map(|(one, other)| between(one, other, offset).distance)
            .fold(f64::INFINITY, f64::min);
        let slack = 2.0 * ERROR * (4.0 * scale + found.distance);
        prop_assert!((found.distance - nearest).abs() <= slack, "{found:?} {nearest}");
        prop_assert_eq!(found.distance == 0.0, nearest == 0.0);
        // The distance of a point of one mesh to the other is no greater.
        let [p, _] = found.points;
        let point = Placed::sphere(0.0, p).expect("a point");
        let second = Bvh::build(&second);
        let apart = query::distance(at(&second, offset), point).expect("a mesh");
        prop_assert!((apart.distance - found.distance).abs() <= slack);
    }
}

fn shape(k: usize) -> Mesh {
    let round = |i: f32, j: f32| {
        let (i, j) = (i * std::f32::consts::TAU, j * std::f32::consts::TAU);
        Vec3::new(
            (1.0 + 0.4 * j.cos()) * i.cos(),
            0.4 * j.sin(),
            (1.0 + 0.4 * j.cos()) * i.sin(),
        )
    };
    let mesh = match k {
        0 => cube(0.5),
        1 => grid(7, true, round),
        2 => grid(6, false, |x, z| Vec3::new(x - 0.5, 0.0, z - 0.5)),
        _ => mesh(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ),
    };
    Mesh::clone(&mesh)
}

#[test]
fn cubes_face_edge_and_corner_on_are_as_far_apart_as_their_corners_say() {
    let cube = Bvh::build(&cube(0.5));
    let v = DVec3::new;
    for (offset, distance) in [
        (v(3.0, 0.0, 0.0), 2.0),
        (v(3.0, 0.3, -0.2), 2.0),
        (v(4.0, 5.0, 0.0), 5.0),
        (v(2.0, 3.0, 3.0), 3.0),
        (v(-2.0, -3.0, 3.0), 3.0),
        (v(1.0, 0.0, 0.0), 0.0),
        (v(0.2, 0.1, 0.0), 0.0),
        (v(1.0_f64.next_up(), 0.0, 0.0), f64::EPSILON),
        (v(1e100, 0.0, 0.0), 1e100),
    ] {
        let found = between(&cube, &cube, offset);
        assert_eq!(found.distance, distance, "{offset} {found:?}");
        let normal = if distance == 0.0 {
            DVec3::ZERO
        } else {
            (offset.abs() - 1.0).max(DVec3::ZERO).normalize() * offset.signum()
        };
        assert!(found.normal.distance(normal) < 1e-15, "{found:?}");
    }
}

/// Many ties: every triangle of one has the same distance.
#[test]
fn parallel_sheets_are_one_metre_apart() {
    let sheet = |n| Bvh::build(&grid(n, false, |x, z| Vec3::new(x, 0.0, z)));
    let found = between(&sheet(100), &sheet(80), DVec3::new(0.2, 1.0, 0.1));
    assert_eq!((found.distance, found.normal), (1.0, DVec3::Y));
}

#[test]
fn a_cow_is_as_far_from_another_as_a_point_of_it_is() {
    let cow = Bvh::build(&builtin("cow.obj"));
    for k in 0..40 {
        let angle = f64::from(k);
        let offset = DVec3::new(3.0 * angle.cos(), 0.1 * angle, 3.0 * angle.sin());
        let found = between(&cow, &cow, offset);
        let turned = between(&cow, &cow, -offset);
        assert!((found.distance - turned.distance).abs() < 1e-15 * 8.0);
        let ball = Placed::sphere(0.25, found.points[1]).expect("a ball");
        let apart = query::distance(at(&cow, DVec3::ZERO), ball).expect("a mesh");
        assert!((apart.distance - (found.distance - 0.25).max(0.0)).abs() < 1e-14);
    }
}
