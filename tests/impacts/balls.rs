//! Balls and cubes on floors under gravity, in addition to the cases of `cases::hard_cases::balls`.

use std::sync::Arc;

use cases::hard_cases::balls::{dropped, floor, on_floor};
use kit::bodies::{ball, immovable, mesh_body, wall};
use kit::meshes::{boxes, cube};
use kit::worlds::{GRAVITY, add_gravity, precise, world_of};
use sim_core::{Body, DVec3, METHODS, Settings, Vec3};

use crate::worlds::{DT, run};

/// A constant force and a weight cause the same fall.
#[test]
fn a_constant_force_makes_bodies_bounce_as_gravity_does() {
    for method in METHODS {
        let mut by_weight = dropped(method, DT, 0.8);
        let mut by_force = dropped(method, DT, 0.8);
        by_force.remove_force(0).expect("a force");
        by_force.set_force(1, -GRAVITY * DVec3::Y).expect("a force");
        let counts = [&mut by_weight, &mut by_force].map(|world| run(world, 180).len());
        assert_eq!(counts[0], counts[1], "{}", method.name);
        let apart = by_weight.position(1) - by_force.position(1);
        assert!(apart.length() < 1e-12, "{}: {apart}", method.name);
    }
}

/// Bodies that lie on a surface at height 0.
fn lying(floor_mesh: &Arc<sim_core::Mesh>, restitution: f64) -> Vec<(String, Body, Body)> {
    let cube = mesh_body(&cube(0.5), DVec3::new(0.25, 0.5, -0.125), DVec3::ZERO);
    let sphere = ball(0.5, 0.5 * DVec3::Y, DVec3::ZERO);
    let slab = immovable(mesh_body(floor_mesh, DVec3::ZERO, DVec3::ZERO));
    let mut all = Vec::new();
    for (on, floor) in [("half-space", floor()), ("slab", slab)] {
        for (what, body) in [("cube", &cube), ("sphere", &sphere)] {
            let body = Body {
                restitution,
                ..body.clone()
            };
            all.push((
                format!("{what} on {on}, e = {restitution}"),
                body,
                floor.clone(),
            ));
        }
    }
    all
}

/// For 1000 s with the default method, for 10 s with all others.
#[test]
fn what_lies_on_a_floor_does_not_move() {
    let slab = boxes(&[[Vec3::new(-8.0, -1.0, -8.0), Vec3::new(8.0, 0.0, 8.0)]]);
    for method in METHODS {
        let is_default = method.name == Settings::default().method.name;
        let steps = if is_default { 60_000 } else { 600 };
        for restitution in [0.0, 0.5, 1.0] {
            for (what, body, floor) in lying(&slab, restitution) {
                let start = body.position;
                let mut world = on_floor(method, DT, body, floor);
                for _ in 0..steps {
                    world.step().expect("a step");
                    let moved = (world.position(1) - start).length();
                    assert!(moved <= 1e-9, "{}, {what}: moved {moved:e}", method.name);
                    let energy = world.kinetic_energy() + GRAVITY * (world.position(1) - start).y;
                    assert!(energy <= 1e-8, "{}, {what}: energy {energy:e}", method.name);
                }
            }
        }
    }
}

/// Sliding bodies have no impacts, near the origin or far from it, with any method.
#[test]
fn what_slides_down_a_slope_hits_nothing() {
    let slope = DVec3::new(0.2, 1.0, 0.1).normalize();
    for method in METHODS {
        for (restitution, radius, far) in [(0.0, 0.25, 0.0), (1.0, 0.25, 0.0), (0.5, 0.0, 1e3)] {
            let along = far * slope.any_orthonormal_vector();
            let body = Body {
                restitution,
                ..ball(radius, along + radius * slope, DVec3::ZERO)
            };
            let floor = wall(slope, DVec3::ZERO, DVec3::ZERO);
            let mut world = on_floor(method, 1.0 / 64.0, body, floor);
            let impacts = run(&mut world, 600).len();
            let what = format!("{}, e = {restitution}", method.name);
            assert_eq!(impacts, 0, "{what}");
            // It accelerates as on a slope without friction, minus half a step.
            let pull = GRAVITY * (DVec3::NEG_Y + slope.y * slope).length();
            let speed = world.velocity(1).length();
            assert!(
                (speed / (600.0 / 64.0 * pull) - 1.0).abs() < 2e-3,
                "{what}: {speed}"
            );
            // Its gap is a fraction of its coordinates, which grow.
            let away = world.velocity(1).dot(slope).abs();
            assert!(away < 1e-9 + 1e-11 * far, "{what}: leaves at {away:e}");
        }
    }
}

/// A stack of cubes and a cube in a corner remain unchanged.
#[test]
fn stacks_stand() {
    let cube = cube(0.5);
    for (method, restitution) in METHODS.iter().flat_map(|&m| [(m, 0.5), (m, 1.0)]) {
        let settings = Settings {
            method,
            ..precise(DT)
        };
        let mut world = world_of(settings, &[floor()]);
        world
            .add(wall(DVec3::X, DVec3::ZERO, DVec3::ZERO))
            .expect("a wall");
        for level in 0..4 {
            let position = DVec3::new(0.5, 0.5 + f64::from(level), 0.0);
            let body = Body {
                restitution,
                ..mesh_body(&cube, position, DVec3::ZERO)
            };
            world.add(body).expect("a cube");
        }
        add_gravity(&mut world, -GRAVITY * DVec3::Y);
        let start: Vec<DVec3> = (0..world.len()).map(|i| world.position(i)).collect();
        for _ in 0..600 {
            world.step().expect("a step");
            for (i, &start) in start.iter().enumerate() {
                let what = format!("{}, e = {restitution}: body {i}", method.name);
                let moved = (world.position(i) - start).length();
                assert!(moved <= 1e-9, "{what} moved {moved:e}");
                let speed = world.velocity(i).length();
                assert!(speed <= 1e-6, "{what} moves at {speed:e}");
            }
        }
    }
}

/// A ball is thrown up to a ceiling or another ball, and reaches it with little speed left.
#[test]
fn what_just_touches_at_its_turn_falls_back() {
    const HEIGHT: f64 = 4.0;
    let ball = |y: f64, speed: f64| ball(0.5, y * DVec3::Y, speed * DVec3::Y);
    // The distance by which the ceiling is lower than the highest point, m.
    for depth in [0.0, 1e-12, 1e-6] {
        for dt in [2.0, 0.75, 2.0 / 3.0, 1.0 / 16.0, DT] {
            let ceiling = wall(DVec3::NEG_Y, (HEIGHT + 0.5 - depth) * DVec3::Y, DVec3::ZERO);
            let other = immovable(ball(HEIGHT + 1.0 - depth, 0.0));
            for above in [ceiling, other] {
                let thrown = Body {
                    force: -8.0 * DVec3::Y,
                    ..ball(0.0, 8.0)
                };
                let mut world = world_of(precise(dt), &[thrown, above]);
                run(&mut world, (1.5 / dt).ceil() as u64);
                let t = world.time();
                let exact = 8.0 * t - 4.0 * t * t;
                // It is reflected with the remaining speed, so it is early by twice the time to the turning point.
                let early = 2.0 * (depth / 4.0).sqrt();
                let tolerance = 1e-6 + 1.1 * early * (8.0 * t - 8.0).abs();
                let off = (world.position(0).y - exact).abs();
                assert!(off <= tolerance, "{depth:e}, {dt}: {off:e}");
            }
        }
    }
}

/// An impact at the end of a step restores the same speed as any other one.
#[test]
fn the_end_of_a_step_takes_no_speed() {
    for restitution in [0.1, 0.9, 1.0] {
        for early in [0.0, 1e-15, 1e-14, 1e-12] {
            let dt = 1.0 / 64.0;
            let x = -0.5 - (3.0 - early) * dt;
            let thrown = Body {
                restitution,
                ..ball(0.5, x * DVec3::X, DVec3::X)
            };
            let wall = wall(DVec3::NEG_X, DVec3::ZERO, DVec3::ZERO);
            let mut world = world_of(precise(dt), &[thrown, wall]);
            run(&mut world, 8);
            let speed = -world.velocity(0).x;
            assert!(
                (speed - restitution).abs() < 1e-14,
                "{restitution}, {early:e}: {speed}"
            );
        }
    }
}

/// A ball that rolls off another one and is pushed back to it is detected at its return, however close it was at the
/// start.
#[test]
fn what_leaves_at_once_and_comes_back_is_met_there() {
    let end = |gap: f64| {
        let under = immovable(ball(0.5, DVec3::ZERO, DVec3::ZERO));
        let rolling = Body {
            force: DVec3::new(-16.0, -2.0, 0.0),
            ..ball(0.5, (1.0 + gap) * DVec3::Y, 2.0 * DVec3::X)
        };
        let mut world = world_of(precise(0.5), &[under, rolling]);
        assert!(world.overlapping().is_empty());
        assert!(run(&mut world, 1).len() > 2);
        (world.position(1), world.velocity(1))
    };
    // It falls once it has left the ball below for good.
    let exact = end(1e-13);
    assert!(exact.0.length() > 1.0 && exact.1.y < -0.1);
    for gap in [1e-15, 2e-15, 1e-14] {
        let found = end(gap);
        assert!((found.0 - exact.0).length() < 1e-9, "{gap:e}: {found:?}");
        assert!((found.1 - exact.1).length() < 1e-9, "{gap:e}: {found:?}");
    }
}
