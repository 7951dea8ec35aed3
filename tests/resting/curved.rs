//! Motion over curved surfaces without friction: the energy, the point where a body leaves, and the period in a bowl.

use std::f64::consts::{FRAC_PI_2, PI};

use kit::shapes::{ball, cube};
use kit::worlds::{GRAVITY, set_rate};
use sim_core::{Body, DVec3, World};

use crate::meshes::turned;
use crate::scenes::{conical_pendulum, fixed, ground, rk4, world};

fn at_rate(rate: f64) -> World {
    let mut world = world(rk4());
    set_rate(&mut world, rate);
    world
}

fn energy(world: &World, body: usize) -> f64 {
    0.5 * world.velocity(body).length_squared() + GRAVITY * world.position(body).y
}

/// A ball on top of a ball is pushed off. Returns the speed along x after it has left, m/s, and the greatest gain of
/// energy in a step and the total loss until then, relative to `g R`.
fn leave(rate: f64) -> (f64, f64, f64) {
    let mut world = at_rate(rate);
    let radius = 1.5;
    world.add(fixed(&ball(1.0), DVec3::ZERO)).expect("a ball");
    let rider = Body {
        shape: Some(ball(radius - 1.0)),
        position: radius * DVec3::Y,
        velocity: 0.3 * DVec3::X,
        restitution: 0.0,
        ..Body::default()
    };
    world.add(rider).expect("a rider");
    let start = energy(&world, 1);
    let mut gained: f64 = 0.0;
    let mut before = start;
    loop {
        world.step().expect("a step");
        let now = energy(&world, 1);
        gained = gained.max(now - before);
        before = now;
        if world.position(1).y < 0.0 {
            let lost = (start - now) / (GRAVITY * radius);
            return (world.velocity(1).x, gained / (GRAVITY * radius), lost);
        }
        assert!(world.time() < 5.0, "it never leaves");
    }
}

/// The horizontal speed, m/s, with which a body leaves a circle of a radius, m, if its speed on top is `speed`: it
/// leaves at
/// `cos a = 2/3 + v²/(3 g R)` with the speed `√(g R cos a)`.
fn speed_off_a_ball(speed: f64, radius: f64) -> f64 {
    let cosine = 2.0 / 3.0 + speed * speed / (3.0 * GRAVITY * radius);
    (GRAVITY * radius * cosine).sqrt() * cosine
}

/// The error is of the first order in the step.
#[test]
fn a_ball_leaves_a_ball_where_it_must() {
    let exact = speed_off_a_ball(0.3, 1.5);
    let mut errors = Vec::new();
    for rate in [60.0, 240.0, 960.0, 3840.0] {
        let (speed, gained, lost) = leave(rate);
        assert!(gained < 1e-12, "{rate}: gains {gained:e}");
        errors.push(((speed / exact - 1.0).abs(), lost));
    }
    for (at, (error, lost)) in errors.iter().enumerate() {
        let most = 0.01 / 4.0_f64.powi(at as i32);
        assert!(error.max(lost.abs()) < most, "{errors:?}");
    }
}

/// A cube slides over the edge at a ramp's top and falls from there.
#[test]
fn a_ramp_gives_a_body_the_speed_of_its_height() {
    for slope in [0.25_f64, 0.5, 1.0, 2.0] {
        let mut world = at_rate(60.0);
        let normal = DVec3::new(slope, 1.0, 0.0).normalize();
        // A slope and a floor, one body each.
        for normal in [normal, DVec3::Y] {
            world.add(ground(normal, DVec3::ZERO)).expect("a plane");
        }
        let height = 1.0;
        let foot = 0.5 * normal / normal.y;
        let at = foot + height * DVec3::new(-1.0 / slope, 1.0, 0.0);
        let rider = Body {
            shape: Some(ball(0.5)),
            position: at + (0.5 - normal.dot(at)) * normal,
            restitution: 0.0,
            ..Body::default()
        };
        let height = rider.position.y - 0.5;
        world.add(rider).expect("a rider");
        while world.position(2).y > 0.5 + 1e-9 {
            world.step().expect("a step");
            assert!(world.time() < 10.0, "{slope}: stuck");
        }
        // The floor absorbs the velocity component across it.
        let speed = (2.0 * GRAVITY * height).sqrt() * normal.y;
        let error = (world.velocity(2).x - speed).abs();
        assert!(error < 1e-9, "{slope}: {error:e}");
        assert_eq!(world.velocity(2).y, 0.0, "{slope}");
    }
}

/// A bowl of triangles, the lower half of a sphere, for a small ball.
fn in_bowl(rate: f64, sides: u32) -> World {
    let mut world = at_rate(rate);
    let outline: Vec<[f64; 2]> = (0..=sides / 4)
        .map(|k| {
            let (sin, cos) = (FRAC_PI_2 * f64::from(k) / f64::from(sides / 4)).sin_cos();
            [2.0 * sin, -2.0 * cos]
        })
        .collect();
    world
        .add(fixed(&turned(&outline, sides), DVec3::ZERO))
        .expect("a bowl");
    world
}

/// To and fro in a bowl, and around it: the energy does not grow, and the period is that of the pendulum.
#[test]
fn balls_circle_in_a_bowl() {
    let mut world = in_bowl(240.0, 96);
    let (radius, length) = (0.25, 1.75);
    // Placed in contact, at a small height, with the speed that keeps it there.
    let angle = 0.4_f64;
    let at = length * DVec3::new(angle.sin(), -angle.cos(), 0.0);
    let (speed, period) = conical_pendulum(length, angle);
    let rider = Body {
        shape: Some(ball(radius)),
        position: at * 0.99,
        velocity: speed * DVec3::Z,
        restitution: 0.0,
        ..Body::default()
    };
    world.add(rider).expect("a rider");
    let mut before = energy(&world, 1);
    let mut turned = 0.0;
    let mut last = 0.0_f64;
    let steps = (2.0 * period * 240.0) as u32;
    for count in 0..steps {
        world.step().expect("a step");
        let now = energy(&world, 1);
        assert!(now <= before + 1e-10, "{count}: gains {:e}", now - before);
        before = now;
        let at = world.position(1);
        let angle = at.z.atan2(at.x);
        turned += (angle - last + 3.0 * PI).rem_euclid(2.0 * PI) - PI;
        last = angle;
        assert!(at.length() < length + 1e-3, "{at}: through the bowl");
    }
    // The facets take some speed at each of their edges.
    assert!(turned.abs() > 1.5 * PI, "{turned}");
    assert!(world.position(1).y < -1.0);
}

/// Off a cube's edge: a body that slides over it continues as a projectile.
#[test]
fn off_an_edge_a_ball_flies_or_rolls_over_it() {
    for rate in [60.0, 1000.0] {
        for (speed, flies) in [(3.0, true), (1.0, false)] {
            let mut world = at_rate(rate);
            world.add(fixed(&cube(), -0.5 * DVec3::Y)).expect("a cube");
            let radius = 0.25;
            let rider = Body {
                shape: Some(ball(radius)),
                position: DVec3::new(0.0, radius, 0.0),
                velocity: speed * DVec3::X,
                restitution: 0.0,
                ..Body::default()
            };
            let start = 0.5 * speed * speed + GRAVITY * radius;
            world.add(rider).expect("a rider");
            let until = 0.5 / speed;
            while world.time() < until + 0.2 {
                world.step().expect("a step");
                assert!(energy(&world, 1) <= start + 1e-9, "{rate} {speed}");
            }
            let at = world.position(1);
            if flies {
                // Faster than the edge can curve its path: v² > g r.
                let time = world.time() - until;
                let x = 0.5 + speed * time;
                let y = radius - 0.5 * GRAVITY * time * time;
                let error = (at - DVec3::new(x, y, 0.0)).length();
                assert!(error < 1e-9, "{rate}: {error:e}, {at}");
            } else {
                let out = speed_off_a_ball(speed, radius);
                let error = (world.velocity(1).x - out).abs();
                assert!(error < 5.0 / rate, "{rate}: {error:e}");
            }
        }
    }
}
