//! Meshes on meshes, and through them, in addition to the cases of `cases::hard_cases::meshes`.

use std::sync::Arc;

use cases::Verdict;
use cases::hard_cases::meshes::Encountered;
use kit::bodies::mesh_body;
use kit::meshes::{builtin, cuboid, sheet, star, torus};
use sim_core::collide::touch::first_touch;
use sim_core::{Bvh, DVec3, Mesh, Vec3};

use crate::worlds::{DT, run, world};

#[track_caller]
fn assert_elastic_at_all_speeds_and_phases(first: &Arc<Mesh>, second: &Arc<Mesh>) {
    let all = Encountered::of(first, second).expect("steps");
    let finding = all.finding();
    assert_eq!(finding.verdict, Verdict::Pass, "{finding:?}");
}

#[test]
fn sheets_tori_and_stars_at_every_speed_and_phase() {
    let shapes = [sheet(0.0), sheet(0.125), torus(0.75, 0.25), star(1.0, 0.2)];
    for (i, first) in shapes.iter().enumerate() {
        // Equal open meshes touch everywhere simultaneously: see the next test.
        let others = if first.is_closed() { i } else { i + 1 };
        for second in &shapes[others..] {
            assert_elastic_at_all_speeds_and_phases(first, second);
        }
    }
}

/// Equal open meshes touch everywhere at once.
#[test]
fn sheets_that_fit_each_other_do_not_pass() {
    for bend in [0.0, 0.1] {
        let sheet = sheet(bend);
        assert_elastic_at_all_speeds_and_phases(&sheet, &sheet);
    }
}

/// Earliest time, in fractions of `motion`, at which the second mesh touches the first: every vertex against every face
/// and every edge against every edge, as described at the head of `touch.rs`.
fn earliest(first: &Mesh, second: &Mesh, offset: DVec3, motion: DVec3) -> f64 {
    let mut earliest = f64::INFINITY;
    let mut vertices_in_faces = |mover: &Mesh, still: &Mesh, offset: DVec3, motion: DVec3| {
        for triangle in 0..still.triangles().len() {
            let [a, b, c] = still.corners(triangle).map(|v| v.as_dvec3());
            let n = (b - a).cross(c - a);
            for vertex in mover.vertices() {
                let x = vertex.as_dvec3() + offset;
                let t = -n.dot(x - a) / n.dot(motion);
                let at = x + t * motion;
                let inside = [(a, b), (b, c), (c, a)]
                    .iter()
                    .all(|&(p, q)| (q - p).cross(at - p).dot(n) >= 0.0);
                if (0.0..earliest).contains(&t) && inside {
                    earliest = t;
                }
            }
        }
    };
    vertices_in_faces(second, first, offset, motion);
    vertices_in_faces(first, second, -offset, -motion);
    let ends = |mesh: &Mesh, edge: [u32; 2]| edge.map(|v| mesh.vertices()[v as usize].as_dvec3());
    for &edge in first.edges() {
        let [a, b] = ends(first, edge);
        for &other in second.edges() {
            let [c, d] = ends(second, other).map(|v| v + offset);
            let (u, w, m, e) = (b - a, d - c, c - a, -motion);
            let det = u.dot(w.cross(e));
            let t = u.dot(w.cross(m)) / det;
            let (s, q) = (m.dot(w.cross(e)) / det, -u.dot(m.cross(e)) / det);
            let both = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&q);
            if (0.0..earliest).contains(&t) && both {
                earliest = t;
            }
        }
    }
    earliest
}

#[test]
fn the_impact_is_when_the_earliest_features_touch() {
    let (cow, cube) = (builtin("cow.obj"), builtin("cube.obj"));
    for (offset, velocity) in [
        (DVec3::new(-3.0, 0.3, 0.2), DVec3::new(2.0, 0.1, -0.3)),
        (DVec3::new(0.4, 5.0, 0.1), DVec3::new(-0.2, -9.0, 0.1)),
        (DVec3::new(1.0, -0.5, -6.0), DVec3::new(-10.0, 5.0, 60.0)),
    ] {
        let exact = earliest(&cow, &cube, offset, velocity);
        let mut world = world(
            DT,
            &[
                mesh_body(&cow, DVec3::ZERO, DVec3::ZERO),
                mesh_body(&cube, offset, velocity),
            ],
        );
        let impacts = run(&mut world, 120);
        let time = impacts.first().expect("an impact").time;
        let error = (time / exact - 1.0).abs();
        assert!(error <= 1e-12, "{offset}: {time} and not {exact}");
    }
}

/// A small cube passes below the cow's belly. On both sides of its path, and above, the cow blocks the way.
#[test]
fn a_cube_passes_between_the_legs_of_the_cow() {
    let (cow, cube) = (builtin("cow.obj"), cuboid(Vec3::splat(0.05)));
    let trees = [Bvh::build(&cow), Bvh::build(&cube)];
    let bounds = cow.bounds();
    let (low, size) = (bounds.min.as_dvec3(), 2.0 * bounds.half_extent());
    // The cow is longer than it is wide.
    let (along, across) = match size.x > size.z {
        true => (DVec3::X, DVec3::Z),
        false => (DVec3::Z, DVec3::X),
    };
    const N: usize = 24;
    let lane = |i: usize, j: usize| {
        let part = |k: usize| k as f64 / N as f64;
        let place = low + along * size * part(i) + DVec3::Y * size * part(j);
        place - across * place - 4.0 * across
    };
    let is_free = |i, j| first_touch(&trees[0], &trees[1], lane(i, j), 8.0 * across).is_none();
    let free: Vec<Vec<bool>> = (0..=N)
        .map(|i| (0..=N).map(|j| is_free(i, j)).collect())
        .collect();
    let is_enclosed = |i: usize, j: usize| {
        let before = (0..i).any(|k| !free[k][j]);
        let behind = (i + 1..=N).any(|k| !free[k][j]);
        free[i][j] && before && behind && (j + 1..=N).any(|k| !free[i][k])
    };
    let lanes = (0..=N).flat_map(|i| (0..=N).map(move |j| (i, j)));
    let enclosed: Vec<_> = lanes.filter(|&(i, j)| is_enclosed(i, j)).collect();
    assert!(!enclosed.is_empty());
    for (i, j) in enclosed {
        for speed in [1.0, 30.0, 1000.0] {
            let velocity = speed * across;
            let bodies = [
                mesh_body(&cow, DVec3::ZERO, DVec3::ZERO),
                mesh_body(&cube, lane(i, j), velocity),
            ];
            let mut world = world(DT, &bodies);
            let steps = (8.0 / speed / DT).ceil() as u64;
            assert!(run(&mut world, steps).is_empty());
            assert_eq!(world.velocity(1), velocity);
        }
    }
}
