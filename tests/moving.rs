//! Times of contact, from moving points and edges to moving meshes, against rational arithmetic.

#[path = "moving_oracle/borders.rs"]
mod borders;
#[path = "moving_oracle/crossing.rs"]
mod crossing;
mod moving_oracle;

use std::sync::Arc;

use kit::meshes::{builtin, mesh, scaled};
use kit::rational::rational;
use moving_oracle::assert_rounded_down;
use moving_oracle::brute::{brute_force, placed};
use moving_oracle::inputs::{lattice_soup, lattice_vector, points, random_soup, vector};
use proptest::prelude::*;
use sim_core::collide::moving::{edge_meets_edge, point_meets_edge, point_meets_triangle};
use sim_core::collide::touch::{first_touch, time_of_impact};
use sim_core::collide::{Touch, tree};
use sim_core::{Bvh, DQuat, DVec3, Mesh, Vec3};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

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

/// Tests against all features, with the meshes exchanged, and mirrored.
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
    // At borders only blocking contacts count, and edges only if they separate the meshes.
    match &touch {
        _ if exact.across == exact.sure => {
            assert_rounded_down(touch.map(|touch| touch.time), exact.sure)?;
        }
        Some(touch) => {
            let (from, until) = (rational(touch.time.next_up()), rational(touch.time));
            prop_assert!(exact.across.is_some_and(|t| t < from));
            prop_assert!(exact.sure.is_none_or(|t| t >= until));
        }
        None => prop_assert_eq!(exact.sure, None),
    }
    if let Some(touch) = touch {
        prop_assert!((touch.normal.length() - 1.0).abs() < 1e-15);
        prop_assert!(touch.normal.dot(motion) < 1e-15 * motion.length());
    }
    // If the offset rounds no vertex, the coordinates are the same in the other's frame.
    if offset == offset.round() {
        let back = first_touch(&b, &a, -offset, -motion);
        prop_assert_eq!(back.map(|t| t.time), touch.map(|t| t.time));
        prop_assert_eq!(back.map(|t| -t.normal), touch.map(|t| t.normal));
        prop_assert_eq!(time_of_impact(&b, &a, -offset, -motion), time);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

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
        // Approximately towards the other mesh.
        check(&first, &second, offset, turn - 1.5 * offset)?;
    }
}

/// Directions distributed over the sphere, none along an axis.
fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let height = (f64::from(2 * i + 1) / f64::from(count) - 1.0) * 0.99;
        let (sin, cos) = (2.4 * f64::from(i) + 0.1).sin_cos();
        let round = (1.0 - height * height).sqrt();
        DVec3::new(round * cos, height, round * sin)
    })
}

/// Meshes of the gallery, and a rotated cube.
fn solids() -> Vec<Arc<Mesh>> {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.5, 0.3, 0.1));
    let cube = builtin("cube.obj");
    let turned = cube.transformed(turn, DVec3::ONE).expect("a mesh");
    vec![cube, Arc::new(turned), builtin("cow.obj")]
}

/// Surfaces are apart until just before the time and meet just after it, unless one only grazes the other. If they are
/// apart at the start and meet at the end, there is a first contact.
#[test]
fn surfaces_meet_after_the_first_touch_and_not_before() {
    let trees: Vec<Bvh> = solids().iter().map(|mesh| Bvh::build(mesh)).collect();
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

/// A brute-force search over all pairs of triangles, with the predicates.
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

/// All lengths scaled by a power of two: the same times and normals, bit for bit.
#[test]
fn scale_does_not_matter() {
    let cube = builtin("cube.obj");
    // Coordinates with few digits, so that none is lost at the limits of f32.
    let spike = mesh(
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.25, 0.125],
            [0.5, 1.5, -0.25],
            [0.25, 0.5, 2.0],
        ]
        .map(Vec3::from_array)
        .to_vec(),
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    );
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
    let trees: Vec<Bvh> = meshes.iter().map(|mesh| Bvh::build(mesh)).collect();
    let mirrored: Vec<Bvh> = meshes
        .iter()
        .map(|m| Bvh::build(&scaled(m, mirror)))
        .collect();
    for (first, first_mirrored) in trees.iter().zip(&mirrored) {
        for (second, second_mirrored) in trees.iter().zip(&mirrored) {
            for direction in directions(40) {
                // The coordinates of the second mesh keep all their digits.
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
    // A vertex at -0.5 m blocks the way.
    assert_eq!(
        touch.map(|t| (t.time, t.normal)),
        Some((0.5_f64.next_down(), DVec3::X))
    );
}
