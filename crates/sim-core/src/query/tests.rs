//! Tests of spheres, half-spaces, rays and invalid input; the tests across crates cover meshes.

use alloc::vec::Vec;
use glam::DVec3;

use super::*;
use crate::{
    Bvh, Mesh,
    test_meshes::{cube, sphere},
    test_random::Random,
};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn ball(radius: f64, position: DVec3) -> Placed<'static> {
    Placed::sphere(radius, position).unwrap()
}

fn wall(normal: DVec3, position: DVec3) -> Placed<'static> {
    Placed::half_space(normal, position).unwrap()
}

fn at(tree: &Bvh, position: DVec3) -> Placed<'_> {
    Placed::mesh(tree, position).unwrap()
}

#[test]
fn every_pair_of_shapes_is_as_far_apart_as_it_looks() {
    let tree = Bvh::build(&cube());
    let x = DVec3::X;
    for (first, second, apart, points) in [
        (ball(1.0, -x), ball(0.5, 2.0 * x), 1.5, [0.0, 1.5]),
        (wall(2.0 * x, -x), ball(0.5, 2.0 * x), 2.5, [-1.0, 1.5]),
        (wall(x, -x), at(&tree, 2.0 * x), 2.5, [-1.0, 1.5]),
        (
            at(&tree, -x),
            ball(0.25, v(2.0, 0.1, 0.2)),
            2.25,
            [-0.5, 1.75],
        ),
        (at(&tree, -x), at(&tree, v(2.0, 0.1, 0.2)), 2.0, [-0.5, 1.5]),
    ] {
        let hit = distance(first, second).unwrap();
        assert_eq!((hit.time, hit.distance, hit.normal), (0.0, apart, x));
        assert_eq!(hit.points.map(|point| point.x), points);
        assert!((hit.points[1] - hit.points[0] - apart * x).length() < 1e-15);
        let turned = distance(second, first).unwrap();
        assert_eq!((turned.distance, turned.normal), (apart, -x));
        assert_eq!(turned.parts, [hit.parts[1], hit.parts[0]]);
        assert!(!intersects(first, second) && !intersects(second, first));
        // A motion that ends at the contact, and one of twice the length.
        for (way, time) in [(1.0, 1.0), (2.0, 0.5)] {
            let hit = time_of_impact(first, second, -way * apart * x);
            let hit = hit.unwrap().unwrap();
            assert!((hit.time - time).abs() < 1e-13, "{hit:?}");
            assert_eq!((hit.distance, hit.normal), (0.0, x));
        }
        assert_eq!(time_of_impact(first, second, apart * x), Ok(None));
        assert_eq!(time_of_impact(first, second, -0.9 * apart * x), Ok(None));
    }
}

#[test]
fn shapes_that_meet_share_the_point_that_is_told() {
    let tree = Bvh::build(&cube());
    let mut random = Random(3);
    let mut meetings = 0;
    for _ in 0..4000 {
        let offset = 1e-3 * random.vector(2000);
        let normal = random.vector(5);
        let shapes = [at(&tree, DVec3::ZERO), ball(0.6, DVec3::ZERO)];
        let mut others = Vec::from([at(&tree, offset), ball(0.7, offset)]);
        others.extend(Placed::half_space(normal, offset).ok());
        for first in shapes {
            for &second in &others {
                let hit = distance(first, second).unwrap();
                assert_eq!(hit.distance == 0.0, intersects(first, second));
                let [p, q] = hit.points;
                if hit.distance > 0.0 {
                    assert!((p.distance(q) - hit.distance).abs() < 1e-14);
                    assert!((q - p).distance(hit.distance * hit.normal) < 1e-12);
                    continue;
                }
                meetings += 1;
                assert_eq!((p, hit.normal), (q, DVec3::ZERO));
                for shape in [first, second] {
                    let point = ball(1e-12, p);
                    assert!(distance(shape, point).unwrap().distance == 0.0, "{hit:?}");
                }
                let moved = time_of_impact(first, second, 0.1 * DVec3::X).unwrap();
                assert_eq!(moved.unwrap().time, 0.0);
            }
        }
    }
    assert!(meetings > 4000, "{meetings}");
    let walls = (wall(DVec3::X, DVec3::ZERO), wall(DVec3::Y, DVec3::ZERO));
    assert_eq!(distance(walls.0, walls.1), None);
    assert!(!intersects(walls.0, walls.1));
}

#[test]
fn points_are_located_exactly() {
    let tree = Bvh::build(&cube());
    let lid_off = Mesh::new(cube().vertices().to_vec(), cube().triangles()[1..].to_vec());
    let open = Bvh::build(&lid_off.unwrap());
    let here = v(10.0, 0.0, 0.0);
    let up = 0.5_f64.next_up();
    for (shape, y, place) in [
        (at(&tree, here), 0.0, Some(Place::Inside)),
        (at(&tree, here), 0.5, Some(Place::On)),
        (at(&tree, here), up, Some(Place::Outside)),
        (at(&open, here), 0.0, None),
        (ball(0.5, here), 0.5_f64.next_down(), Some(Place::Inside)),
        (ball(0.5, here), 0.5, Some(Place::On)),
        (ball(0.5, here), up, Some(Place::Outside)),
        (wall(DVec3::Y, here), -5e-324, Some(Place::Inside)),
        (wall(DVec3::Y, here), 0.0, Some(Place::On)),
        (wall(DVec3::Y, here), -0.0, Some(Place::On)),
        (wall(DVec3::Y, here), 5e-324, Some(Place::Outside)),
    ] {
        assert_eq!(
            locate(shape, here + v(0.0, y, 0.0)),
            Ok(place),
            "{shape:?} {y}"
        );
    }
    // 3² + 4² = 5², and points a rounding beside it, at any size.
    for scale in [1e-90, 1.0, 1e90] {
        let at = scale * v(3.0, 4.0, 0.0);
        let radius = 5.0 * scale;
        let exact = scale == 1.0;
        for (radius, place) in [
            (radius.next_up(), Place::Inside),
            (radius.next_down(), Place::Outside),
        ] {
            assert_eq!(locate(ball(radius, DVec3::ZERO), at), Ok(Some(place)));
        }
        if exact {
            let on = locate(ball(radius, DVec3::ZERO), at);
            assert_eq!(on, Ok(Some(Place::On)));
        }
    }
    assert_eq!(locate(ball(0.0, here), here), Ok(Some(Place::On)));
}

#[test]
fn rays_hit_surfaces_from_either_side() {
    let tree = Bvh::build(&cube());
    let x = DVec3::X;
    let side = v(0.0, 0.1, 0.2);
    for (shape, from, along, time, normal) in [
        (at(&tree, 5.0 * x), side, 0.5 * x, 9.0, -x),
        (at(&tree, 5.0 * x), 5.0 * x + side, -x, 0.5, x),
        (ball(2.0, 5.0 * x), DVec3::ZERO, 2.0 * x, 1.5, -x),
        (ball(2.0, 5.0 * x), 5.0 * x, 2.0 * x, 1.0, -x),
        (wall(-x, 5.0 * x), side, 2.0 * x, 2.5, -x),
        (wall(-x, 5.0 * x), 6.0 * x, -2.0 * x, 0.5, x),
    ] {
        let hit = ray(shape, from, along).unwrap().unwrap();
        assert_eq!((hit.time, hit.normal), (time, normal), "{shape:?}");
        assert_eq!(hit.points, [from + time * along; 2]);
        let is_mesh = matches!(hit.parts[0], Some(Part::Face(_)));
        assert_eq!(
            is_mesh,
            shape.bounds().is_some_and(|[low, _]| low.x == -0.5)
        );
        assert_eq!(ray(shape, v(0.0, 0.0, 9.0), DVec3::Z), Ok(None));
    }
    // A distant and a small tangent; a point; and a ray along a plane.
    let far = ball(1.0, v(1e8, 1.0, 0.0));
    assert!(ray(far, DVec3::ZERO, x).unwrap().is_some());
    assert_eq!(ray(far, v(0.0, -1e-7, 0.0), x), Ok(None));
    let tiny = ray(ball(1e-80, x * 1e-70), DVec3::ZERO, 1e-70 * x);
    assert!((tiny.unwrap().unwrap().time - 1.0).abs() < 1e-9);
    assert!(ray(ball(0.0, x), DVec3::ZERO, x).unwrap().is_some());
    assert!(ray(ball(0.0, x), x, x).unwrap().is_some());
    assert_eq!(ray(wall(DVec3::Y, x), DVec3::Y, x), Ok(None));
    assert_eq!(ray(wall(DVec3::Y, x), DVec3::ZERO, x), Ok(None));
}

/// Rays hit a sphere and a fine mesh of it at the same place.
#[test]
fn rays_hit_a_ball_where_they_hit_its_mesh() {
    let tree = Bvh::build(&sphere(60));
    let mut random = Random(11);
    let mut hits = 0;
    for _ in 0..2000 {
        let (from, aim) = (1e-3 * random.vector(3000), 1e-3 * random.vector(800));
        let [round, flat] = [ball(1.0, DVec3::ZERO), at(&tree, DVec3::ZERO)]
            .map(|shape| ray(shape, from, aim - from).unwrap());
        if aim.length() < 0.9 {
            let (round, flat) = (round.unwrap(), flat.unwrap());
            let apart = round.points[0].distance(flat.points[0]);
            assert!(apart < 2e-2 && round.normal.distance(flat.normal) < 0.1);
            hits += 1;
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn what_is_no_number_or_too_far_is_refused_by_name() {
    let tree = Bvh::build(&cube());
    let one = ball(1.0, DVec3::ZERO);
    for bad in [f64::NAN, f64::INFINITY, 1.1e100] {
        let value = v(0.0, bad, 0.0);
        let is_bad = |found: QueryError, expected: &str| {
            let told = alloc::format!("{found}");
            assert!(told.starts_with(expected), "{told}");
        };
        is_bad(Placed::mesh(&tree, value).unwrap_err(), "position is");
        is_bad(Placed::sphere(1.0, value).unwrap_err(), "position is");
        is_bad(
            Placed::half_space(DVec3::Y, value).unwrap_err(),
            "position is",
        );
        is_bad(
            Placed::half_space(value, DVec3::Y).unwrap_err(),
            "normal is",
        );
        is_bad(Placed::sphere(bad, DVec3::Y).unwrap_err(), "radius is");
        is_bad(one.at(value).unwrap_err(), "position is");
        is_bad(time_of_impact(one, one, value).unwrap_err(), "motion is");
        is_bad(locate(one, value).unwrap_err(), "point is");
        is_bad(ray(one, value, DVec3::X).unwrap_err(), "origin is");
        is_bad(ray(one, DVec3::X, value).unwrap_err(), "direction is");
    }
    assert!(Placed::sphere(-1.0, DVec3::ZERO).is_err());
    assert!(Placed::half_space(DVec3::ZERO, DVec3::ZERO).is_err());
    assert!(ray(one, DVec3::ZERO, DVec3::ZERO).is_err());
    // The farthest positions that are allowed.
    let far = one.at(v(1e100, -1e100, 1e100)).unwrap();
    let hit = distance(at(&tree, v(-1e100, 1e100, -1e100)), far).unwrap();
    assert!((hit.distance / 1e100 - libm::sqrt(12.0)).abs() < 1e-15);
}
