//! Two bodies head on: cases 9, 10, 13, 14, 21.

use kit::bodies::{immovable, wall};
use kit::meshes::{cube, cuboid};
use sim_core::{Body, DVec3, Shape, Vec3};

use crate::shapes::sheet;
use crate::worlds::{DT, ULP, assert_close, bits, mesh_body, run, run_apart, world};

const STEPS: u64 = 8;
const PHASES: u32 = 16;
/// Largest half extent of a shape here, m.
const LARGEST: f64 = 4.0;
const SPEEDS: [f64; 10] = [1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6];

/// Two bodies on the x axis, the first one coming from the left.
struct HeadOn {
    name: &'static str,
    bodies: [Body; 2],
    /// Distance of the positions at contact, m.
    reach: f64,
}

/// Equal pairs of all kinds of shapes, at rest.
fn equal_pairs() -> Vec<HeadOn> {
    let of = |name, shape: Shape, reach| {
        let body = Body {
            shape: Some(shape),
            ..Body::default()
        };
        HeadOn {
            name,
            bodies: [body.clone(), body],
            reach,
        }
    };
    vec![
        of("cubes", Shape::Mesh(cube(0.5)), 1.0),
        of("spheres", Shape::Sphere { radius: 0.5 }, 1.0),
    ]
}

fn points() -> HeadOn {
    let point = Body {
        shape: Some(Shape::Sphere { radius: 0.0 }),
        ..Body::default()
    };
    HeadOn {
        name: "points",
        bodies: [point.clone(), point],
        reach: 0.0,
    }
}

/// Puts the bodies so that, approaching at `speeds`, they touch at a phase of the fourth step, and
/// holds what they are after eight steps to the outcome.
fn assert_outcome(pair: &HeadOn, speeds: [f64; 2], after: [f64; 2], phase: u32) {
    assert_outcome_at(1.0, pair, speeds, after, phase);
}

/// With the second body at `origin` on the x axis.
fn assert_outcome_at(origin: f64, pair: &HeadOn, speeds: [f64; 2], after: [f64; 2], phase: u32) {
    let approach = speeds[0] - speeds[1];
    let hit = (3.0 + f64::from(phase) / f64::from(PHASES)) * DT;
    let gap = approach * hit;
    let mut bodies = pair.bodies.clone();
    let places = [origin - pair.reach - gap, origin];
    for i in 0..2 {
        bodies[i].position = DVec3::X * places[i];
        bodies[i].velocity = DVec3::X * speeds[i];
    }
    let mut world = world(DT, &bodies);
    let impacts = run(&mut world, STEPS);
    let what = format!("{} at {speeds:?}, phase {phase}", pair.name);
    assert_eq!(impacts.len(), 1, "{what}: {impacts:?}");
    // A rounding a step of the largest coordinate, and twice what bodies are kept apart by.
    let farthest = origin + LARGEST + gap + approach * STEPS as f64 * DT;
    let rounding = (STEPS as f64 + 32.0) * ULP * farthest;
    let exact = gap / approach;
    let late = (impacts[0].time - exact).abs();
    let tolerance = 1e-12 * DT + rounding / approach;
    assert!(late <= tolerance, "{what}: {late:e} s late");
    for i in 0..2 {
        let end = places[i] + speeds[i] * exact + after[i] * (STEPS as f64 * DT - exact);
        let what = format!("{what}, body {i}");
        let own_scale = after[i].abs().max(speeds[i].abs());
        assert_close(
            world.velocity(i),
            DVec3::X * after[i],
            2.0 * ULP * own_scale,
            &what,
        );
        let tolerance = 1e-12 * approach * DT + rounding;
        assert_close(world.position(i), DVec3::X * end, tolerance, &what);
    }
}

#[test]
fn equal_masses_exchange_their_velocities_at_every_phase_and_speed() {
    for pair in equal_pairs() {
        for speed in SPEEDS {
            for phase in 0..PHASES {
                assert_outcome(&pair, [speed, 0.0], [0.0, speed], phase);
            }
        }
    }
}

#[test]
fn points_exchange_their_velocities_at_the_origin() {
    for speed in SPEEDS {
        for phase in 0..PHASES {
            assert_outcome_at(0.0, &points(), [speed, 0.0], [0.0, speed], phase);
        }
    }
}

#[test]
fn points_exchange_their_velocities_as_others_do() {
    for speed in SPEEDS {
        for phase in 0..PHASES {
            assert_outcome(&points(), [speed, 0.0], [0.0, speed], phase);
        }
    }
}

#[test]
fn two_fast_bodies_bounce() {
    let small = Shape::Mesh(cube(0.1));
    let body = Body {
        shape: Some(small),
        ..Body::default()
    };
    let reach = 2.0 * f64::from(0.1f32);
    let cubes = HeadOn {
        name: "small cubes",
        bodies: [body.clone(), body],
        reach,
    };
    for pair in equal_pairs().into_iter().chain([cubes]) {
        for phase in 0..PHASES {
            assert_outcome(&pair, [200.0, -200.0], [-200.0, 200.0], phase);
        }
    }
}

#[test]
fn points_cubes_and_spheres_come_back_from_walls() {
    let at_rest = |shape| Body {
        shape: Some(shape),
        ..Body::default()
    };
    let side = wall(-DVec3::X, DVec3::ZERO, DVec3::ZERO);
    let thin = immovable(at_rest(Shape::Mesh(cuboid(Vec3::new(0.0005, 4.0, 4.0)))));
    let open = immovable(at_rest(Shape::Mesh(sheet(0.0))));
    let half = f64::from(0.0005f32);
    for (name, wall, thickness) in [
        ("half-space", side, 0.0),
        ("plate of 1 mm", thin, half),
        ("sheet without thickness", open, 0.0),
    ] {
        for (shape, radius) in [
            (Shape::Sphere { radius: 0.0 }, 0.0),
            (Shape::Sphere { radius: 0.25 }, 0.25),
            (Shape::Mesh(cube(0.25)), 0.25),
        ] {
            let pair = HeadOn {
                name,
                bodies: [at_rest(shape), wall.clone()],
                reach: radius + thickness,
            };
            for speed in SPEEDS {
                for phase in 0..PHASES {
                    assert_outcome(&pair, [speed, 0.0], [-speed, 0.0], phase);
                }
            }
        }
    }
}

#[test]
fn a_cube_at_a_thousand_metres_a_second_stays_on_its_side_of_a_thin_wall() {
    let wall = cuboid(Vec3::new(0.0005, 4.0, 4.0));
    let cube = cube(0.5);
    for phase in 0..PHASES {
        let x = -0.6 - 1000.0 * DT * (1.0 + f64::from(phase) / f64::from(PHASES));
        let mut world = world(
            DT,
            &[
                mesh_body(&cube, DVec3::X * x, DVec3::X * 1000.0),
                immovable(mesh_body(&wall, DVec3::ZERO, DVec3::ZERO)),
            ],
        );
        let impacts = run_apart(&mut world, 6);
        assert_eq!(impacts.len(), 1, "phase {phase}");
        assert_eq!(world.velocity(0), -1000.0 * DVec3::X);
        assert_eq!(world.position(1), DVec3::ZERO);
    }
}

#[test]
fn masses_of_any_ratio_follow_the_two_body_formula() {
    for mut pair in equal_pairs() {
        for ratio in [1e3, 1e6, 1e9, 1e12] {
            for masses in [[1.0, ratio], [ratio, 1.0]] {
                for (body, mass) in pair.bodies.iter_mut().zip(masses) {
                    body.mass = mass;
                }
                let [m1, m2] = masses;
                let v = 10.0;
                let after = [(m1 - m2) / (m1 + m2) * v, 2.0 * m1 / (m1 + m2) * v];
                for phase in 0..PHASES {
                    assert_outcome(&pair, [v, 0.0], after, phase);
                }
            }
        }
    }
}

#[test]
fn far_from_the_origin_is_as_at_the_origin() {
    const STEPS: u64 = 4;
    for pair in equal_pairs() {
        for phase in 0..PHASES {
            let gap = 60.0 * DT * (1.0 + f64::from(phase) / f64::from(PHASES));
            let at = |origin: DVec3| {
                let mut bodies = pair.bodies.clone();
                // Rounded to the grid of the farthest place, so that the start is the same.
                let place = -((pair.reach + gap) * 2f64.powi(24)).round() * 2f64.powi(-24);
                bodies[0].position = origin + DVec3::X * place;
                bodies[1].position = origin;
                bodies[0].velocity = DVec3::X * 60.0;
                let mut world = world(DT, &bodies);
                assert_eq!(run(&mut world, STEPS).len(), 1, "{origin}");
                [0, 1].map(|i| (world.position(i) - origin, world.velocity(i)))
            };
            let near = at(DVec3::ZERO);
            for far in [1e4, 1e6, 1e8] {
                for axis in [DVec3::X, DVec3::new(1.0, 1.0, -1.0)] {
                    let found = at(far * axis);
                    for i in 0..2 {
                        let what = format!("{} at {far:e}, phase {phase}", pair.name);
                        assert_eq!(found[i].1, near[i].1, "{what}");
                        // Rounding, and twice what bodies are kept apart by.
                        let tolerance = 12.0 * ULP * far;
                        assert_close(found[i].0, near[i].0, tolerance, &what);
                    }
                }
            }
        }
    }
}

#[test]
fn bodies_that_nothing_meets_move_as_points_do() {
    let cube = cube(0.5);
    let cubes = [0.0, 3.0, 7.0].map(|y| mesh_body(&cube, DVec3::Y * y, DVec3::new(50.0, 0.0, 1.0)));
    let points = cubes.clone().map(|body| Body {
        shape: None,
        ..body
    });
    let [mut cubes, mut points] = [world(DT, &cubes), world(DT, &points)];
    assert!(run(&mut cubes, 100).is_empty());
    run(&mut points, 100);
    assert_eq!(bits(&cubes), bits(&points));
}
