//! Bodies that just touch, or just do not: case 22.

use std::sync::Arc;

use kit::bodies::wall;
use kit::meshes::cube;
use sim_core::{Body, BodyKind, DVec3, Mesh, World};

use crate::shapes::star;
use crate::worlds::{DT, Kept, ball, bits, mesh_body, run, run_apart, world};

/// A body that passes one at rest, on its way to a wall at x = 6 and back.
fn passing(mover: &Body, still: &Body, aside: DVec3, velocity: DVec3) -> World {
    let mover = Body {
        position: aside - 3.0 * DVec3::X,
        velocity,
        ..mover.clone()
    };
    let end = wall(-DVec3::X, 6.0 * DVec3::X, DVec3::ZERO);
    world(DT, &[still.clone(), mover, end])
}

fn at_rest(mesh: &Arc<Mesh>) -> Body {
    mesh_body(mesh, DVec3::ZERO, DVec3::ZERO)
}

#[test]
fn a_picometre_decides_between_hit_and_miss() {
    let cube = at_rest(&cube(0.5));
    let sphere = ball(0.5, DVec3::ZERO, DVec3::ZERO);
    for (what, body) in [("cubes", &cube), ("spheres", &sphere)] {
        for speed in [0.5, 7.0, 300.0] {
            for (aside, hits) in [(1e-12, false), (-1e-12, true)] {
                let velocity = speed * DVec3::X;
                let mut world = passing(body, body, DVec3::Y * (1.0 + aside), velocity);
                let kept = Kept::of(&world);
                // To the middle between the body at rest and the wall.
                let steps = (6.0 / speed / DT) as u64;
                let impacts = run_apart(&mut world, steps);
                let with_still = impacts.iter().filter(|i| i.bodies == (0, 1)).count();
                let what = format!("{what} at {speed} m/s, {aside:e} m aside");
                assert_eq!(with_still > 0, hits, "{what}");
                if impacts.is_empty() {
                    assert_eq!(world.velocity(1), velocity, "{what}");
                }
                if impacts.len() == with_still {
                    kept.assert(&world, 1e-14, &what);
                }
            }
        }
    }
}

/// Faces on faces, edges on edges, a vertex on a vertex, exactly: no contact is documented for
/// motion along surfaces, any for the others; what comes out is a number, does not depend on the
/// order of the bodies, and the wall behind is not missed.
#[test]
fn exact_ties_are_decided_the_same_way_in_every_order() {
    let (cube, star) = (at_rest(&cube(0.5)), at_rest(&star(1.0, 0.25)));
    let straight = 5.0 * DVec3::X;
    let cases = [
        ("face along face", &cube, DVec3::Y, straight),
        (
            "face along face, shifted",
            &cube,
            DVec3::new(0.0, 1.0, 0.25),
            straight,
        ),
        (
            "edge along edge",
            &cube,
            DVec3::new(0.0, 1.0, 1.0),
            straight,
        ),
        (
            "edge on edge",
            &cube,
            DVec3::new(0.0, 4.0, 0.0),
            DVec3::new(4.0, -6.0, 0.0),
        ),
        (
            "vertex on vertex",
            &cube,
            DVec3::new(-1.0, 4.0, 4.0),
            DVec3::new(3.0, -3.0, -3.0),
        ),
        ("tip on tip", &star, DVec3::ZERO, straight),
        ("tip past tip", &star, DVec3::Y * 2.0, straight),
        ("tip on face", &star, DVec3::new(0.0, 0.25, 0.0), straight),
    ];
    for (what, body, aside, velocity) in cases {
        let mut in_order = passing(body, body, aside, velocity);
        let mut bodies: Vec<Body> = Vec::new();
        for i in [1, 2, 0] {
            bodies.push(in_order.body(i).to_body());
        }
        let mut reordered = world(DT, &bodies);
        let energy = in_order.kinetic_energy();
        let impacts = run_apart(&mut in_order, 240);
        run(&mut reordered, 240);
        let (a, b) = (bits(&in_order), bits(&reordered));
        assert_eq!([a[1], a[2], a[0]], [b[0], b[1], b[2]], "{what}");
        let error = (in_order.kinetic_energy() / energy - 1.0).abs();
        assert!(error <= 1e-14, "{what}: energy off by {error:e}");
        let movers = || (0..2).map(|i| in_order.position(i).x);
        assert!(movers().all(|x| x < 6.0), "{what}: through the wall");
        assert!(
            impacts.iter().any(|i| i.bodies.1 == 2),
            "{what}: {impacts:?}"
        );
    }
}

/// A cube slides along a floor of four cubes, a hair above it, and is not stopped where they join.
#[test]
fn joints_of_a_floor_stop_nothing() {
    let tile = cube(0.5);
    for height in [1.0 + 1e-12, 1.0 + 1e-9] {
        let mut bodies: Vec<Body> = (0..4)
            .map(|i| Body {
                kind: BodyKind::Static,
                ..mesh_body(&tile, DVec3::X * f64::from(i), DVec3::ZERO)
            })
            .collect();
        let velocity = DVec3::new(2.0, 0.0, 0.5);
        bodies.push(mesh_body(&tile, DVec3::new(-2.0, height, -0.25), velocity));
        let mut world = world(DT, &bodies);
        assert!(run(&mut world, 200).is_empty(), "height {height}");
        assert_eq!(world.velocity(4), velocity);
    }
}
