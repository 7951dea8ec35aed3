//! Balls and cubes on floors under gravity: cases 18, 19, 27.

use std::sync::Arc;

use sim_core::{Body, DVec3, Force, METHODS, Method, Settings, Vec3, World};

use crate::shapes::{boxes, cube};
use crate::worlds::{DT, ball, immovable, mesh_body, run, settings, wall, world_with};

pub(crate) const G: f64 = 9.81;

fn weight() -> Force {
    Force::Gravity {
        acceleration: -G * DVec3::Y,
    }
}

/// A body above a floor, under gravity.
fn on_floor(method: &'static Method, dt: f64, body: Body, floor: Body) -> World {
    let settings = Settings {
        method,
        ..settings(dt)
    };
    let mut world = world_with(settings, &[floor, body]);
    world.add_force(weight()).expect("a force");
    world
}

fn floor() -> Body {
    wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO)
}

/// Dropped from 1 m.
fn dropped(method: &'static Method, dt: f64, restitution: f64) -> World {
    let point = Body {
        restitution,
        ..ball(0.0, DVec3::Y, DVec3::ZERO)
    };
    on_floor(method, dt, point, floor())
}

/// Methods that are exact for a parabola.
fn exact_in_flight() -> impl Iterator<Item = &'static Method> {
    METHODS.into_iter().filter(|method| method.order >= 2)
}

/// Time, from 0, of bounce `n` (from 1), and the speed after it.
fn bounce(n: i32, restitution: f64) -> (f64, f64) {
    let fall = (2.0 / G).sqrt();
    let flights: f64 = (1..n).map(|i| 2.0 * fall * restitution.powi(i)).sum();
    (fall + flights, G * fall * restitution.powi(n))
}

#[test]
fn a_ball_that_loses_a_fifth_of_its_speed_bounces_and_comes_to_rest() {
    for method in exact_in_flight() {
        for dt in [DT, 1.0 / 240.0] {
            let mut world = dropped(method, dt, 0.8);
            let impacts = run(&mut world, (3.0 / dt).round() as u64);
            let what = format!("{} at dt {dt}", method.name);
            assert_eq!(impacts.len(), 6, "{what}");
            for (n, impact) in (1..).zip(&impacts) {
                let (time, speed) = bounce(n, 0.8);
                assert!((impact.time - time).abs() < 1e-12, "{what}: bounce {n}");
                assert!(
                    (impact.speeds.1 - speed).abs() < 1e-12,
                    "{what}: bounce {n}"
                );
            }
            let height = world.position(1).y;
            assert!(
                (height - 0.06870746096576577).abs() < 1e-12,
                "{what}: {height}"
            );
            // There are infinitely many bounces in 4.0637 s.
            let impacts = run(&mut world, (7.0 / dt).round() as u64);
            assert!(impacts.len() < 10_000, "{what}: {}", impacts.len());
            let (height, speed) = (world.position(1).y, world.velocity(1).length());
            assert!(
                height.abs() < 1e-9 && speed < 1e-9,
                "{what}: {height} {speed}"
            );
        }
    }
}

#[test]
fn an_elastic_ball_bounces_a_hundred_and_eleven_times() {
    for method in exact_in_flight() {
        let mut world = dropped(method, DT, 1.0);
        let impacts = run(&mut world, 6000);
        assert_eq!(impacts.len(), 111, "{}", method.name);
        let height = world.position(1).y;
        let error = (height - 0.7215811544474912).abs();
        assert!(error < 1e-11, "{}: off by {error:e}", method.name);
        let energy = world.kinetic_energy() + G * height;
        let error = (energy / G - 1.0).abs();
        // Flights under other methods than those for free fall round at each step.
        assert!(error < 1e-13, "{}: energy off by {error:e}", method.name);
    }
}

/// A constant force and a weight are the same fall.
#[test]
fn a_constant_force_makes_bodies_bounce_as_gravity_does() {
    for method in METHODS {
        let mut by_weight = dropped(method, DT, 0.8);
        let mut by_force = dropped(method, DT, 0.8);
        by_force.remove_force(0).expect("a force");
        by_force.set_force(1, -G * DVec3::Y).expect("a force");
        let counts = [&mut by_weight, &mut by_force].map(|world| run(world, 180).len());
        assert_eq!(counts[0], counts[1], "{}", method.name);
        let apart = by_weight.position(1) - by_force.position(1);
        assert!(apart.length() < 1e-12, "{}: {apart}", method.name);
    }
}

/// Bodies that lie on something, with its surface at height 0.
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

/// For 1000 s under the default method, for 10 s under all others.
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
                    let energy = world.kinetic_energy() + G * (world.position(1) - start).y;
                    // Forward Euler moves first and falls then: by a step it is always late.
                    let late = if method.fall == Some(0.0) {
                        G * DT
                    } else {
                        0.0
                    };
                    assert!(
                        energy <= 1e-8 + 0.5 * late * late,
                        "{}, {what}: energy {energy:e}",
                        method.name
                    );
                }
            }
        }
    }
}

/// A stack of cubes and a cube in a corner stay as they are.
#[test]
fn stacks_stand() {
    let cube = cube(0.5);
    let mut world = world_with(settings(DT), &[floor()]);
    world
        .add(wall(DVec3::X, DVec3::ZERO, DVec3::ZERO))
        .expect("a wall");
    for level in 0..4 {
        let position = DVec3::new(0.5, 0.5 + f64::from(level), 0.0);
        let body = Body {
            restitution: 0.5,
            ..mesh_body(&cube, position, DVec3::ZERO)
        };
        world.add(body).expect("a cube");
    }
    world.add_force(weight()).expect("a force");
    let start: Vec<DVec3> = (0..world.len()).map(|i| world.position(i)).collect();
    run(&mut world, 600);
    for (i, &start) in start.iter().enumerate() {
        let moved = (world.position(i) - start).length();
        assert!(moved <= 1e-9, "body {i} moved {moved:e}");
    }
}
