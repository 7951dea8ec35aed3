//! Times of contact, from moving points and edges to moving meshes, against rational arithmetic.

mod moving_oracle;

use moving_oracle::{Q, rational};
use proptest::prelude::*;
use sim_core::collide::moving::{edge_meets_edge, point_meets_edge, point_meets_triangle};
use sim_core::collide::touch::{first_touch, time_of_impact};
use sim_core::collide::{Feature, Touch, tree};
use sim_core::{Bvh, DQuat, DVec3, Mesh, Vec3};

/// Points that touch, coincide and lie in planes and lines more often than not: a small lattice, some
/// of it moved by an ulp, scaled by a power of two and moved far away; and a motion likewise.
fn hard_points<const N: usize>() -> impl Strategy<Value = ([DVec3; N], DVec3)> {
    let coordinate = (0..4i32, -1..=1i32);
    let points = prop::array::uniform::<_, N>(prop::array::uniform3(coordinate));
    let motion = prop::array::uniform3((-3..=3i32, -1..=1i32));
    let offset = prop_oneof![3 => Just(0.0), 1 => Just(1e8), 1 => Just(-0.1)];
    (points, motion, -60..60i32, offset, any::<bool>()).prop_map(
        |(points, motion, exponent, offset, nudge)| {
            let scale = 2.0_f64.powi(exponent);
            let at = |(cell, ulps): (i32, i32), offset: f64| {
                let x = f64::from(cell) + offset;
                // Next to zero an ulp would leave the range of exact products.
                let x = match ulps {
                    _ if !nudge => x,
                    _ if x == 0.0 => f64::from(ulps) * f64::EPSILON,
                    1 => x.next_up(),
                    -1 => x.next_down(),
                    _ => x,
                };
                x * scale
            };
            (
                points.map(|p| DVec3::from_array(p.map(|x| at(x, offset)))),
                DVec3::from_array(motion.map(|x| at(x, 0.0))),
            )
        },
    )
}

/// Any points and any motion, long enough to meet something.
fn any_points<const N: usize>() -> impl Strategy<Value = ([DVec3; N], DVec3)> {
    let points = prop::array::uniform::<_, N>(prop::array::uniform3(-1.0..1.0f64));
    (points, prop::array::uniform3(-3.0..3.0f64))
        .prop_map(|(points, motion)| (points.map(DVec3::from_array), DVec3::from_array(motion)))
}

fn points<const N: usize>() -> impl Strategy<Value = ([DVec3; N], DVec3)> {
    prop_oneof![hard_points(), any_points()]
}

/// The greatest f64 that is not above the exact time.
fn assert_rounded_down(time: Option<f64>, exact: Option<Q>) -> Result<(), TestCaseError> {
    prop_assert_eq!(time.is_some(), exact.is_some(), "{:?} {:?}", time, exact);
    if let Some((time, exact)) = time.zip(exact) {
        prop_assert!(rational(time) <= exact, "{} is late", time);
        prop_assert!(rational(time.next_up()) > exact, "{} is early", time);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn points_meet_triangles_when_they_do_in_rational_arithmetic(([p, a, b, c], motion) in points()) {
        let exact = moving_oracle::point_meets_triangle(p, motion, [a, b, c]);
        let time = point_meets_triangle(p, motion, [a, b, c]);
        prop_assert_eq!(time, point_meets_triangle(p, motion, [c, b, a]));
        assert_rounded_down(time, exact)?;
    }

    #[test]
    fn edges_meet_edges_when_they_do_in_rational_arithmetic(([a, b, c, d], motion) in points()) {
        let exact = moving_oracle::edge_meets_edge([a, b], [c, d], motion);
        let time = edge_meets_edge([a, b], [c, d], motion);
        prop_assert_eq!(time, edge_meets_edge([d, c], [a, b], -motion));
        assert_rounded_down(time, exact)?;
    }

    #[test]
    fn points_meet_edges_when_they_do_in_rational_arithmetic(([p, a, b], motion) in points()) {
        let exact = moving_oracle::point_meets_edge(p, motion, [a, b]);
        let time = point_meets_edge(p, motion, [a, b]);
        prop_assert_eq!(time, point_meets_edge(p, motion, [b, a]));
        assert_rounded_down(time, exact)?;
    }
}

/// A soup of triangles on a lattice, with degenerate ones, shared corners and coplanar faces.
fn lattice_soup(cells: i32, most: usize) -> impl Strategy<Value = Mesh> {
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
fn random_soup(most: usize) -> impl Strategy<Value = Mesh> {
    let corner = prop::array::uniform3(-1.0f32..1.0);
    let triangle = (corner.clone(), prop::array::uniform2(corner));
    prop::collection::vec(triangle, 1..most).prop_map(|soup| {
        let corners = soup.iter().flat_map(|&(at, arms)| {
            let at = Vec3::from_array(at);
            [
                at,
                at + Vec3::from_array(arms[0]) * 0.3,
                at + Vec3::from_array(arms[1]) * 0.3,
            ]
        });
        let triangles = (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        Mesh::new(corners.collect(), triangles.collect()).expect("three corners each")
    })
}

fn placed(mesh: &Mesh, offset: DVec3) -> Vec<[DVec3; 3]> {
    (0..mesh.triangles().len())
        .map(|i| mesh.corners(i).map(|v| v.as_dvec3() + offset))
        .collect()
}

/// First times over all features of all pairs of triangles.
#[derive(Default)]
struct First {
    /// Of all.
    impact: Option<Q>,
    /// Of those with a plane that the motion leads through.
    across: Option<Q>,
    /// Of those but edges that meet at an end.
    inside: Option<Q>,
}

fn brute_force(first: &Mesh, second: &Mesh, offset: DVec3, motion: DVec3) -> First {
    let (first, second) = (placed(first, DVec3::ZERO), placed(second, offset));
    let mut found = First::default();
    let sooner = |known: &mut Option<Q>, time: &Q| {
        if known.as_ref().is_none_or(|known| time < known) {
            *known = Some(time.clone());
        }
    };
    let mut note = |time: Option<Q>, u, v, ends: [Option<Q>; 4]| {
        let Some(time) = time else { return };
        sooner(&mut found.impact, &time);
        if moving_oracle::is_across(u, v, motion) {
            sooner(&mut found.across, &time);
            if !ends.contains(&Some(time.clone())) {
                sooner(&mut found.inside, &time);
            }
        }
    };
    let none = [const { None }; 4];
    for s in &first {
        for t in &second {
            for i in 0..3 {
                let time = moving_oracle::point_meets_triangle(t[i], motion, *s);
                note(time, [s[0], s[1]], [s[0], s[2]], none.clone());
                let time = moving_oracle::point_meets_triangle(s[i], -motion, *t);
                note(time, [t[0], t[1]], [t[0], t[2]], none.clone());
                for j in 0..3 {
                    let (s, t) = ([s[i], s[(i + 1) % 3]], [t[j], t[(j + 1) % 3]]);
                    let ends = [
                        moving_oracle::point_meets_edge(t[0], motion, s),
                        moving_oracle::point_meets_edge(t[1], motion, s),
                        moving_oracle::point_meets_edge(s[0], -motion, t),
                        moving_oracle::point_meets_edge(s[1], -motion, t),
                    ];
                    note(moving_oracle::edge_meets_edge(s, t, motion), s, t, ends);
                }
            }
        }
    }
    found
}

/// Against all features, the other way round, and mirrored.
fn check(first: &Mesh, second: &Mesh, offset: DVec3, motion: DVec3) -> Result<(), TestCaseError> {
    let (a, b) = (Bvh::build(first), Bvh::build(second));
    let time = time_of_impact(&a, &b, offset, motion);
    if tree::intersect(&a, &b, offset) {
        prop_assert_eq!(time, Some(0.0));
        return Ok(());
    }
    let exact = brute_force(first, second, offset, motion);
    assert_rounded_down(time, exact.impact)?;
    let touch = first_touch(&a, &b, offset, motion);
    // Edges that meet at an end enter only where they part the meshes.
    if exact.across == exact.inside || touch.is_none() {
        assert_rounded_down(touch.map(|touch| touch.time), exact.inside)?;
    } else if let Some(touch) = touch {
        prop_assert!(
            exact
                .across
                .is_some_and(|t| t < rational(touch.time.next_up()))
        );
        prop_assert!(exact.inside.is_none_or(|t| t >= rational(touch.time)));
    }
    if let Some(touch) = touch {
        prop_assert!((touch.normal.length() - 1.0).abs() < 1e-15);
        prop_assert!(touch.normal.dot(motion) < 1e-15 * motion.length());
    }
    // An offset that rounds no vertex leaves them the same numbers in the other's frame.
    if offset == offset.round() {
        let back = first_touch(&b, &a, -offset, -motion);
        prop_assert_eq!(back.map(|t| t.time), touch.map(|t| t.time));
        prop_assert_eq!(back.map(|t| -t.normal), touch.map(|t| t.normal));
        prop_assert_eq!(time_of_impact(&b, &a, -offset, -motion), time);
    }
    Ok(())
}

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(range).prop_map(DVec3::from_array)
}

fn lattice_vector(most: i32) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-most..=most).prop_map(|v| DVec3::from_array(v.map(f64::from)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn meshes_on_lattices_meet_when_a_feature_does(
        first in lattice_soup(4, 4),
        second in lattice_soup(4, 4),
        offset in lattice_vector(5),
        motion in prop_oneof![lattice_vector(6), vector(-6.0..6.0)],
    ) {
        check(&first, &second, offset, motion)?;
    }

    #[test]
    fn random_meshes_meet_when_a_feature_does(
        first in random_soup(6),
        second in random_soup(6),
        offset in vector(-2.0..2.0),
        turn in vector(-0.3..0.3),
    ) {
        // Towards the other mesh, more or less.
        check(&first, &second, offset, turn - 1.5 * offset)?;
    }
}

fn builtin(name: &str) -> Mesh {
    (*scene::mesh_file::builtin(name).expect("built in")).clone()
}

fn scaled(mesh: &Mesh, scale: DVec3) -> Mesh {
    mesh.transformed(DQuat::IDENTITY, scale).expect("a mesh")
}

/// Directions all around, none along an axis.
fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let height = (f64::from(2 * i + 1) / f64::from(count) - 1.0) * 0.99;
        let (sin, cos) = (2.4 * f64::from(i) + 0.1).sin_cos();
        let round = (1.0 - height * height).sqrt();
        DVec3::new(round * cos, height, round * sin)
    })
}

/// Meshes of the gallery, and a turned cube.
fn solids() -> Vec<Mesh> {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.5, 0.3, 0.1));
    let cube = builtin("cube.obj");
    let turned = cube.transformed(turn, DVec3::ONE).expect("a mesh");
    vec![cube, turned, builtin("cow.obj")]
}

/// Surfaces are apart up to a hair before the time and meet a hair after it, where neither only
/// grazes; and what is apart at the start and meets at the end has a first contact.
#[test]
fn surfaces_meet_after_the_first_touch_and_not_before() {
    let trees: Vec<Bvh> = solids().iter().map(Bvh::build).collect();
    for first in &trees {
        for second in &trees {
            let mut hits = 0;
            for (i, direction) in directions(150).enumerate() {
                let aim = DVec3::new(0.4, -0.3, 0.2) * (0.02 * i as f64 - 1.0);
                let (offset, motion) = (5.0 * direction, aim - 6.0 * direction);
                let at = |t: f64| tree::intersect(first, second, offset + t * motion);
                let touch = first_touch(first, second, offset, motion);
                let Some(touch) = touch else {
                    assert!((0..200).all(|k| !at(0.005 * f64::from(k))));
                    continue;
                };
                hits += 1;
                let (before, after) = (touch.time - 1e-13, touch.time + 1e-9);
                assert!(!at(before) && at(after), "{direction} {touch:?}");
                let impact = time_of_impact(first, second, offset, motion);
                assert_eq!(impact, Some(touch.time));
                assert!((0..50).all(|k| !at(0.02 * f64::from(k) * before)));
            }
            assert!(hits > 90, "{hits}");
        }
    }
}

/// The plain search over all pairs of triangles, with the predicates.
#[test]
fn trees_find_what_a_search_over_all_features_finds() {
    let (cow, turned) = (builtin("cow.obj"), solids().swap_remove(1));
    let small = scaled(&turned, DVec3::splat(0.25));
    let (a, b) = (Bvh::build(&cow), Bvh::build(&small));
    for direction in directions(4) {
        let (offset, motion) = (3.0 * direction, -4.0 * direction);
        let (first, second) = (placed(&cow, DVec3::ZERO), placed(&small, offset));
        let mut times = vec![];
        for s in &first {
            for t in &second {
                for i in 0..3 {
                    times.extend(point_meets_triangle(t[i], motion, *s));
                    times.extend(point_meets_triangle(s[i], -motion, *t));
                    let edge = [s[i], s[(i + 1) % 3]];
                    let time = |j| edge_meets_edge(edge, [t[j], t[(j + 1) % 3]], motion);
                    times.extend((0..3).filter_map(time));
                }
            }
        }
        let least = times.into_iter().min_by(f64::total_cmp);
        assert!(least.is_some());
        assert_eq!(time_of_impact(&a, &b, offset, motion), least);
        assert_eq!(first_touch(&a, &b, offset, motion).map(|t| t.time), least);
    }
}

/// All lengths scaled by a power of two: the same times and normals to the bit.
#[test]
fn scale_does_not_matter() {
    let cube = builtin("cube.obj");
    // Coordinates of few digits, so that none is lost at the ends of f32.
    let spike = Mesh::new(
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.25, 0.125],
            [0.5, 1.5, -0.25],
            [0.25, 0.5, 2.0],
        ]
        .map(Vec3::from_array)
        .to_vec(),
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    )
    .expect("a mesh");
    for direction in directions(12) {
        let (offset, motion) = (3.0 * direction, -3.5 * direction + DVec3::splat(0.1));
        let touches = [-100, -61, -7, 0, 1, 64, 100].map(|exponent| {
            let scale = 2.0_f64.powi(exponent);
            let [a, b] = [&cube, &spike].map(|m| Bvh::build(&scaled(m, DVec3::splat(scale))));
            let touch = first_touch(&a, &b, offset * scale, motion * scale)?;
            Some(Touch {
                point: touch.point / scale,
                ..touch
            })
        });
        assert!(touches.iter().all(|t| *t == touches[0]), "{touches:?}");
    }
}

#[test]
fn mirrored_and_exchanged_meshes_touch_alike() {
    let meshes = solids();
    let mirror = DVec3::new(-1.0, 1.0, 1.0);
    let trees: Vec<Bvh> = meshes.iter().map(Bvh::build).collect();
    let mirrored: Vec<Bvh> = meshes
        .iter()
        .map(|m| Bvh::build(&scaled(m, mirror)))
        .collect();
    for (first, first_mirrored) in trees.iter().zip(&mirrored) {
        for (second, second_mirrored) in trees.iter().zip(&mirrored) {
            for direction in directions(40) {
                // Coordinates of the second mesh keep all their digits.
                let offset = (4.0 * direction).round();
                let motion = DVec3::new(0.3, -0.2, 0.1) - offset;
                let touch = first_touch(first, second, offset, motion);
                let alike = |other: Option<Touch>, normal: DVec3, what: &str| {
                    assert_eq!(other.map(|t| t.time), touch.map(|t| t.time), "{what}");
                    if let Some((other, touch)) = other.zip(touch) {
                        let off = (normal * other.normal - touch.normal).length();
                        assert!(off < 1e-15, "{what}: {other:?} {touch:?}");
                    }
                };
                let other = (first_mirrored, second_mirrored);
                let seen = first_touch(other.0, other.1, mirror * offset, mirror * motion);
                alike(seen, mirror, "mirrored");
            }
        }
    }
}

#[test]
fn what_touches_at_the_start_touches_at_once_or_parts() {
    let cube = builtin("cube.obj");
    let bvh = |m: &Mesh| Bvh::build(m);
    let diamond = |axis| {
        let turn = DQuat::from_axis_angle(axis, std::f64::consts::FRAC_PI_4);
        // Edges in front, rounded to the same distance wherever they point.
        cube.transformed(turn, DVec3::splat(std::f64::consts::FRAC_1_SQRT_2))
            .expect("a mesh")
    };
    let (along_z, along_y) = (diamond(DVec3::Z), diamond(DVec3::Y));
    let reach = f64::from(along_z.bounds().max.x);
    let bar = |scale| bvh(&scaled(&cube, scale));
    let x = DVec3::X;
    let cases = [
        ("faces", bvh(&cube), bvh(&cube), x),
        (
            "overhanging faces",
            bvh(&cube),
            bvh(&cube),
            DVec3::new(1.0, 0.25, -0.5),
        ),
        (
            "crossed bars",
            bar(DVec3::new(1.0, 4.0, 1.0)),
            bar(DVec3::new(1.0, 1.0, 4.0)),
            x,
        ),
        (
            "crossed edges",
            bvh(&along_z),
            bvh(&along_y),
            x * (2.0 * reach),
        ),
        (
            "an edge on a face",
            bvh(&along_z),
            bvh(&cube),
            x * (reach + 0.5),
        ),
        (
            "a face on an edge",
            bvh(&cube),
            bvh(&along_y),
            x * (reach + 0.5),
        ),
    ];
    for (what, first, second, offset) in &cases {
        assert!(tree::intersect(first, second, *offset), "{what}");
        for motion in [-x, DVec3::new(-1.0, 0.3, 0.2)] {
            for (first, second, sign) in [(first, second, 1.0), (second, first, -1.0)] {
                let (offset, motion) = (sign * *offset, sign * motion);
                let touch = first_touch(first, second, offset, motion).expect(what);
                assert_eq!(
                    (touch.time, touch.normal),
                    (0.0, sign * x),
                    "{what} {motion}"
                );
                assert_eq!(time_of_impact(first, second, offset, motion), Some(0.0));
                let apart = offset + sign * x;
                let touch = first_touch(first, second, apart, motion - sign * x).expect(what);
                assert_eq!(touch.normal, sign * x, "{what} from afar");
            }
        }
        for motion in [
            x,
            0.25 * DVec3::Y,
            DVec3::ZERO,
            DVec3::new(1e-12, 0.0, 0.25),
        ] {
            assert_eq!(first_touch(first, second, *offset, motion), None, "{what}");
            assert_eq!(
                first_touch(second, first, -*offset, -motion),
                None,
                "{what}"
            );
            assert_eq!(time_of_impact(first, second, *offset, motion), Some(0.0));
        }
    }
}

/// Along a face there is an impact and no entering contact, past a hair's breadth neither.
#[test]
fn sliding_is_an_impact_and_no_contact() {
    let cube = Bvh::build(&builtin("cube.obj"));
    let (from, along) = (DVec3::new(1.0, 3.0, 0.0), DVec3::new(0.0, -4.0, 0.0));
    assert_eq!(time_of_impact(&cube, &cube, from, along), Some(0.5));
    let wall = scaled(&builtin("cube.obj"), DVec3::new(1.0, 8.0, 8.0));
    assert_eq!(first_touch(&Bvh::build(&wall), &cube, from, along), None);
    let beside = DVec3::new(1.0_f64.next_up(), 3.0, 0.0);
    assert_eq!(time_of_impact(&cube, &cube, beside, along), None);
    let within = DVec3::new(1.0 - f64::EPSILON, 3.0, 0.0);
    let touch = first_touch(&cube, &cube, within, along).expect("in the way");
    assert!(matches!(
        touch.feature,
        Feature::FaceVertex { .. } | Feature::VertexFace { .. }
    ));
    assert_eq!((touch.time, touch.normal), (0.5, DVec3::Y));
}

#[test]
fn what_is_no_number_or_too_far_touches_nothing() {
    let cube = Bvh::build(&builtin("cube.obj"));
    for bad in [f64::NAN, f64::INFINITY, 1e101] {
        for (offset, motion) in [
            (DVec3::X * bad, -DVec3::X),
            (DVec3::X * 2.0, -DVec3::X * bad),
        ] {
            assert_eq!(first_touch(&cube, &cube, offset, motion), None);
            assert_eq!(time_of_impact(&cube, &cube, offset, motion), None);
        }
    }
    let touch = first_touch(&cube, &cube, DVec3::X * 1e99, DVec3::X * -2e99);
    // A vertex at -0.5 m is in the way.
    assert_eq!(
        touch.map(|t| (t.time, t.normal)),
        Some((0.5_f64.next_down(), DVec3::X))
    );
}
