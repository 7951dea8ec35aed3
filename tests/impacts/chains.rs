//! Many impacts one after the other: cases 15, 16, 17.

use std::sync::mpsc;
use std::time::Duration;

use kit::bodies::wall;
use kit::worlds::world_of;
use sim_core::{Body, DVec3, World};

use crate::worlds::{DT, Kept, ULP, assert_close, ball, run, settings, world};

/// A wall, a block at rest and one of 100^k times its mass that comes.
fn galperin(k: i32, radius: f64) -> World {
    let light = ball(radius, DVec3::X, DVec3::ZERO);
    let mut heavy = ball(radius, 2.0 * DVec3::X, -DVec3::X);
    heavy.mass = 100f64.powi(k);
    world(
        DT,
        &[wall(DVec3::X, DVec3::ZERO, DVec3::ZERO), light, heavy],
    )
}

/// Impacts until the blocks part for good, and the energy's relative error.
fn count(k: i32, radius: f64) -> (u64, f64) {
    let mut world = galperin(k, radius);
    let kept = Kept::of(&world);
    for _ in 0..1200 {
        world.step().expect("a step");
    }
    let (light, heavy) = (world.velocity(1).x, world.velocity(2).x);
    assert!(
        0.0 <= light && light <= heavy,
        "100^{k}, radius {radius}: {} impacts, still at {light} and {heavy}",
        world.impacts()
    );
    (world.impacts(), kept.energy_error(&world))
}

fn assert_digits_of_pi(exponents: std::ops::Range<i32>, radius: f64) {
    for k in exponents {
        let exact = (std::f64::consts::PI * 10f64.powi(k)).floor() as u64;
        let (impacts, energy) = count(k, radius);
        assert_eq!(impacts, exact, "mass 100^{k}");
        // Roundings add up like steps in random directions.
        let tolerance = f64::max(3e-13, 1e-15 * (impacts as f64).sqrt());
        assert!(energy <= tolerance, "100^{k}: energy off by {energy:e}");
    }
}

#[test]
fn blocks_count_the_digits_of_pi() {
    assert_digits_of_pi(0..5, 0.25);
}

#[test]
fn points_count_the_digits_of_pi() {
    assert_digits_of_pi(0..5, 0.0);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "millions of impacts: run it in release")]
fn blocks_count_seven_digits_of_pi() {
    assert_digits_of_pi(5..7, 0.25);
}

/// A point between a wall and one that comes with 1 m/s from 1 m.
fn closing_walls(dt: f64) -> World {
    world(
        dt,
        &[
            wall(DVec3::X, DVec3::ZERO, DVec3::ZERO),
            wall(-DVec3::X, DVec3::X, -DVec3::X),
            ball(0.0, DVec3::ZERO, 10.0 * DVec3::X),
        ],
    )
}

/// The wall comes with t; hit n of it is where 1 - t = 10 / (2n + 9) and makes v = 10 + 2n; the
/// point is back where 1 - t = 10 / v.
#[test]
fn closing_walls_give_two_metres_a_second_a_hit() {
    let impacts = run(&mut closing_walls(0.9981 / 50.0), 50);
    let moving: Vec<_> = impacts.iter().filter(|i| i.bodies == (1, 2)).collect();
    assert_eq!(moving.len(), 2627);
    for (n, impact) in (1..).zip(moving) {
        let v = 2.0 * f64::from(n) + 9.0;
        assert!((impact.speeds.0 - v).abs() <= 1e-11 * v, "hit {n}");
    }
}

#[test]
fn closing_walls_are_hit_in_time() {
    let impacts = run(&mut closing_walls(0.9981 / 50.0), 50);
    for impact in impacts {
        let invariant = (1.0 - impact.time) * impact.speeds.0 / 10.0;
        assert!((invariant - 1.0).abs() <= 1e-11, "{invariant}: {impact:?}");
    }
}

/// Infinitely many hits come before t = 1: an error, and never a hang.
#[test]
#[cfg_attr(debug_assertions, ignore = "ten million impacts: run it in release")]
fn closed_walls_end_in_an_error() {
    let (done, outcome) = mpsc::channel();
    std::thread::spawn(move || {
        let mut world = closing_walls(DT);
        let error = (0..70).find_map(|_| world.step().err());
        let _ = done.send((error, world.position(2)));
    });
    let patience = Duration::from_secs(60);
    let (error, position) = outcome.recv_timeout(patience).expect("no hang");
    let error = error.expect("no step can go through a point");
    assert!(error.to_string().contains("body"), "{error}");
    assert!((0.0..=1.0).contains(&position.x), "{position}");
}

/// Balls of radius 1/2 in a row on the x axis; the first `arriving` come with 3 m/s.
fn cradle(gap: f64, arriving: usize) -> World {
    let bodies: Vec<_> = (0..5)
        .map(|i| {
            let comes = i < arriving;
            let start = if comes { -2.0 } else { 0.0 };
            let x = start + i as f64 * (1.0 + gap);
            ball(0.5, DVec3::X * x, DVec3::X * if comes { 3.0 } else { 0.0 })
        })
        .collect();
    world(DT, &bodies)
}

#[test]
fn as_many_balls_leave_the_cradle_as_arrive() {
    for gap in [0.0, 1e-12, 1e-3, 0.1] {
        for arriving in [1, 2] {
            let mut world = cradle(gap, arriving);
            let kept = Kept::of(&world);
            run(&mut world, 120);
            let what = format!("gap {gap:e}, {arriving} arriving");
            for i in 0..5 {
                let leaves = i >= 5 - arriving;
                let exact = if leaves { 3.0 * DVec3::X } else { DVec3::ZERO };
                assert_close(
                    world.velocity(i),
                    exact,
                    1e-14,
                    &format!("{what}, ball {i}"),
                );
            }
            kept.assert(&world, 1e-14, &what);
        }
    }
}

/// One ball comes upon two that lie side by side: whatever happens is its own mirror image.
#[test]
fn a_symmetric_break_stays_symmetric() {
    for (apart, radius) in [(0.5, 0.5), (0.5 + 1e-12, 0.5), (0.6, 0.5), (0.9, 0.625)] {
        for order in [[0, 1, 2], [1, 0, 2], [2, 1, 0], [1, 2, 0]] {
            let balls = [
                ball(radius, -3.0 * DVec3::X, DVec3::X * 2.0),
                ball(radius, DVec3::Y * apart, DVec3::ZERO),
                ball(radius, DVec3::Y * -apart, DVec3::ZERO),
            ];
            let bodies = order.map(|i| balls[i].clone());
            let mut world = world_of(settings(DT), &bodies);
            let kept = Kept::of(&world);
            let impacts = run(&mut world, 240);
            let [cue, up, down] = [0, 1, 2].map(|ball| {
                let i = order.iter().position(|&o| o == ball).expect("it is there");
                (world.position(i), world.velocity(i))
            });
            let mirrored = |(x, v): (DVec3, DVec3)| {
                let mirror = DVec3::new(1.0, -1.0, 1.0);
                (x * mirror, v * mirror)
            };
            let what = format!("{apart} {radius} {order:?}");
            assert!(!impacts.is_empty(), "{what}");
            assert_eq!(up, mirrored(down), "{what}");
            assert_eq!(cue, mirrored(cue), "{what}");
            assert!(up.1.y > 0.1, "{what}: {up:?}");
            kept.assert(&world, 4.0 * ULP, &what);
        }
    }
}

/// The least loss at each impact changes nothing to speak of, however many there are in a step.
#[test]
fn blocks_that_lose_a_last_bit_count_as_well() {
    let mut world = galperin(3, 0.25);
    for body in 0..3 {
        world.set_restitution(body, 1.0 - 1e-15).expect("less");
    }
    for _ in 0..1200 {
        world.step().expect("a step");
    }
    assert_eq!(world.impacts(), 3141);
    assert!((world.velocity(2).x - 1.0).abs() < 1e-3);
}

/// Gravity along the walls of a slot, or on all alike, has no part in impacts across it.
#[test]
fn common_gravity_changes_no_impact() {
    let slot = [1.0, -1.0].map(|s| Body {
        restitution: 0.999,
        ..wall(s * DVec3::X, -0.5001 * s * DVec3::X, DVec3::ZERO)
    });
    let rattling = Body {
        restitution: 0.999,
        ..ball(0.5, DVec3::ZERO, 0.15 * DVec3::X)
    };
    let in_slot = [slot.as_slice(), &[rattling]].concat();
    let falling = [(-1.001, 0.05, 1e4), (0.0, 0.0, 1.0), (1.002, -0.05, 1e4)];
    let falling = falling.map(|(x, v, mass)| Body {
        mass,
        restitution: 0.999,
        ..ball(0.5, x * DVec3::X, v * DVec3::X)
    });
    for bodies in [in_slot, falling.to_vec()] {
        let speeds = |g: f64| {
            let weigh = |body: &Body| Body {
                force: if body.mass.is_finite() {
                    -g * body.mass * DVec3::Y
                } else {
                    DVec3::ZERO
                },
                ..body.clone()
            };
            let bodies: Vec<Body> = bodies.iter().map(weigh).collect();
            let mut world = world(DT, &bodies);
            run(&mut world, 240);
            (0..bodies.len())
                .map(|i| world.velocity(i).x)
                .collect::<Vec<_>>()
        };
        for (with, without) in speeds(9.81).into_iter().zip(speeds(0.0)) {
            assert!((with - without).abs() < 1e-9, "{with} {without}");
        }
    }
}
