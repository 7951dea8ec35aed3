//! Every method under forces, with impacts within its steps.

use std::f64::consts::PI;

use kit::bodies::{ball, immovable, mesh_body, wall};
use kit::meshes::{cube, cuboid};
use kit::worlds::{GRAVITY, precise, world_of};
use sim_core::{Body, DVec3, Force, METHODS, Method, Settings, Vec3, World};

use crate::worlds::run;

fn world(method: &'static Method, dt: f64, bodies: &[Body], force: Force) -> World {
    let settings = Settings {
        method,
        ..precise(dt)
    };
    let mut world = world_of(settings, bodies);
    world.add_force(force).expect("a force");
    world
}

/// A body of 1 kg on a spring of 1 N/m to the origin, released at x = 1 m; a wall stops it at -1/2 m.
fn spring_and_wall(method: &'static Method, dt: f64, [wall, body]: [Body; 2]) -> World {
    let spring = Force::Anchor {
        body: 1,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness: 1.0,
        damping: 0.0,
    };
    world(method, dt, &[wall, body], spring)
}

/// Walls with the surface at -1/2 m for their body.
fn walls_and_bodies() -> [(&'static str, [Body; 2]); 3] {
    let plane = |x: f64| wall(DVec3::X, DVec3::X * x, DVec3::ZERO);
    let plate = cuboid(Vec3::new(0.125, 2.0, 2.0));
    let plate = immovable(mesh_body(&plate, DVec3::X * -0.875, DVec3::ZERO));
    let cube = mesh_body(&cube(0.25), DVec3::X, DVec3::ZERO);
    [
        (
            "a point and a half-space",
            [plane(-0.5), ball(0.0, DVec3::X, DVec3::ZERO)],
        ),
        ("a cube and a half-space", [plane(-0.75), cube.clone()]),
        ("a cube and a plate", [plate, cube]),
    ]
}

/// Tests that two step lengths show the order, or that the result is exact to rounding.
#[track_caller]
fn assert_order(method: &Method, errors: [f64; 2], what: &str) {
    let [coarse, fine] = errors;
    let order = (coarse / fine).log2();
    let as_claimed = order > f64::from(method.order) - 0.5 || fine < 1e-10;
    assert!(as_claimed, "{} {what}: {coarse:e} {fine:e}", method.name);
}

/// x = cos t until cos t = -1/2, repeatedly: impacts at 2π/3 + n 4π/3.
#[test]
fn a_spring_sends_a_body_against_a_wall_as_often_as_it_should() {
    for (what, bodies) in walls_and_bodies() {
        for method in METHODS {
            let errors = [64u32, 128].map(|rate| {
                let dt = 1.0 / f64::from(rate);
                let mut world = spring_and_wall(method, dt, bodies.clone());
                let mut impacts = Vec::new();
                for _ in 0..11 * rate {
                    world.step_reporting(&mut impacts).expect("a step");
                    let x = world.position(1).x;
                    assert!(x >= -0.5 - 1e-12, "{} {what}: x = {x}", method.name);
                }
                assert_eq!(impacts.len(), 3, "{} {what}", method.name);
                let errors = (0..).zip(&impacts).map(|(n, impact)| {
                    (impact.time - PI * (2.0 / 3.0 + 4.0 / 3.0 * f64::from(n))).abs()
                });
                errors.fold(0.0, f64::max)
            });
            assert_order(method, errors, what);
        }
    }
}

/// Dropped from 1 m: impacts at (2n - 1) √(2/g).
#[test]
fn a_ball_bounces_in_time_under_every_method() {
    let gravity = Force::Gravity {
        acceleration: -GRAVITY * DVec3::Y,
    };
    // A force without effect makes the method step the body itself, instead of the closed form.
    let no_drag = Force::LinearDrag {
        body: None,
        coefficient: 0.0,
    };
    let bodies = [
        wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO),
        ball(0.0, DVec3::Y, DVec3::ZERO),
    ];
    for method in METHODS {
        for forces in [1, 2] {
            let errors = [64u32, 128].map(|rate| {
                let dt = 1.0 / f64::from(rate);
                let mut world = world(method, dt, &bodies, gravity.clone());
                if forces == 2 {
                    world.add_force(no_drag.clone()).expect("a force");
                }
                let impacts = run(&mut world, u64::from(5 * rate / 2));
                let fall = (2.0 / GRAVITY).sqrt();
                assert_eq!(impacts.len(), 3, "{}", method.name);
                let errors = (1..)
                    .zip(&impacts)
                    .map(|(n, impact)| (impact.time - f64::from(2 * n - 1) * fall).abs());
                errors.fold(0.0, f64::max)
            });
            assert_order(method, errors, "fall");
        }
    }
}

/// Two bodies on a spring, one of which hits a wall: the spring couples them through the impact.
#[test]
fn coupled_bodies_keep_their_energy_through_impacts() {
    for method in METHODS.into_iter().filter(|method| method.order >= 4) {
        let spring = Force::Spring {
            bodies: [1, 2],
            points: None,
            rest_length: 1.0,
            stiffness: 40.0,
            damping: 0.0,
        };
        let bodies = [
            wall(DVec3::X, DVec3::ZERO, DVec3::ZERO),
            ball(0.25, DVec3::new(1.0, 0.1, 0.0), -3.0 * DVec3::X),
            ball(0.25, DVec3::new(2.0, 0.0, 0.0), -3.0 * DVec3::X),
        ];
        let mut world = world(method, 1.0 / 240.0, &bodies, spring);
        let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
        let start = energy(&world);
        let impacts = run(&mut world, 480);
        assert!(!impacts.is_empty(), "{}", method.name);
        let error = (energy(&world) / start - 1.0).abs();
        assert!(error < 1e-6, "{}: energy off by {error:e}", method.name);
    }
}
