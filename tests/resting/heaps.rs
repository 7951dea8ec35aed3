//! Heaps and stacks settle, stand, have no overlaps and gain no energy.

use kit::random::Random;
use kit::shapes::{ball, cube};
use kit::worlds::{GRAVITY, set_rate, step};
use sim_core::{Body, DVec3, World};

use crate::scenes::{ground, rk4, world};

fn energy(world: &World) -> f64 {
    let movable = (0..world.len()).filter(|&body| world.kind(body).is_movable());
    let of = |body: usize| {
        let (mass, at, velocity) = (world.mass(body), world.position(body), world.velocity(body));
        mass * (0.5 * velocity.length_squared() + GRAVITY * at.y)
    };
    movable.map(of).sum()
}

/// Balls of radius 0.25 m, above each other in a bin that is slightly wider than two of them.
fn bin(balls: usize, restitution: f64, friction: f64, seed: u64) -> World {
    let mut world = world(rk4());
    let half = 0.6;
    let walls = [
        (DVec3::Y, DVec3::ZERO),
        (DVec3::X, -half * DVec3::X),
        (DVec3::NEG_X, half * DVec3::X),
        (DVec3::Z, -half * DVec3::Z),
        (DVec3::NEG_Z, half * DVec3::Z),
    ];
    for (normal, at) in walls {
        let wall = Body {
            restitution,
            friction,
            ..ground(normal, at)
        };
        world.add(wall).expect("a wall");
    }
    let mut random = Random::linear(seed);
    let mut random = || random.unit() - 0.5;
    for i in 0..balls {
        let side = |bit: usize| 0.28 * ((i >> bit & 1) as f64 * 2.0 - 1.0);
        let level = 0.3 + 0.55 * (i / 4) as f64;
        let at = DVec3::new(side(0) + 0.04 * random(), level, side(1) + 0.05 * random());
        let ball = Body {
            shape: Some(ball(0.25)),
            position: at,
            restitution,
            friction,
            ..Body::default()
        };
        world.add(ball).expect("a ball");
    }
    world
}

/// The least distance between surfaces, m.
fn least_gap(world: &World) -> f64 {
    let mut least = f64::INFINITY;
    for i in 5..world.len() {
        let at = world.position(i);
        let walls = [at.y, at.x + 0.6, 0.6 - at.x, at.z + 0.6, 0.6 - at.z];
        least = walls
            .into_iter()
            .fold(least, |least, d| least.min(d - 0.25));
        for j in 5..i {
            least = least.min((at - world.position(j)).length() - 0.5);
        }
    }
    least
}

#[test]
fn heaps_settle_without_overlap_or_gain() {
    let mut steps = 0;
    for (balls, restitution, friction) in [
        (12, 0.0, 0.0),
        (12, 0.3, 0.0),
        (12, 0.7, 0.0),
        (30, 0.0, 0.0),
        (30, 0.3, 0.0),
        (30, 0.0, 0.4),
        (30, 0.3, 0.4),
    ] {
        let mut world = bin(balls, restitution, friction, 7);
        let mut before = energy(&world);
        let most = before;
        let name = format!("{balls} balls, e = {restitution}, friction {friction}");
        let mut settled = None;
        for count in 0..1200 {
            step(&mut world, 1);
            let after = energy(&world);
            assert!(
                after - before < 1e-12 * most,
                "{name}: {:e}",
                after - before
            );
            assert!(
                least_gap(&world) > -1e-15,
                "{name}: {:e}",
                least_gap(&world)
            );
            assert_eq!(world.overlapping(), []);
            before = after;
            steps += 1;
            let is_still = |body: usize| world.velocity(body) == DVec3::ZERO;
            if (5..world.len()).all(is_still) {
                settled = Some(count);
                break;
            }
        }
        assert!(settled.is_some(), "{name}: not at rest after 20 s");
        // It stays so, bit for bit.
        let hash: Vec<DVec3> = (5..world.len()).map(|body| world.position(body)).collect();
        step(&mut world, 50);
        for (body, at) in (5..world.len()).zip(hash) {
            assert_eq!(world.position(body), at, "{name}");
        }
    }
    assert!(steps > 700, "{steps}");
}

#[test]
fn thirty_cubes_stand_for_a_thousand_seconds() {
    for heavy in [1.0, 1e3, 1e-3] {
        let mut world = world(rk4());
        world.add(ground(DVec3::Y, DVec3::ZERO)).expect("a floor");
        for level in 0..30 {
            let brick = Body {
                shape: Some(cube()),
                position: DVec3::new(0.0, 0.5 + f64::from(level), 0.0),
                mass: if level < 15 { 1.0 } else { heavy },
                restitution: 0.5,
                ..Body::default()
            };
            world.add(brick).expect("a brick");
        }
        step(&mut world, 60_000);
        for level in 0..30_u32 {
            let off = world.position(1 + level as usize).y - 0.5 - f64::from(level);
            assert!(off.abs() < 1e-9, "{heavy}, {level}: {off:e}");
            assert_eq!(world.velocity(1 + level as usize), DVec3::ZERO);
        }
    }
}

#[test]
fn what_bundling_costs_is_told() {
    let mut world = bin(12, 0.0, 0.0, 7);
    let mut most = world.bundled();
    while most.bodies < 12 {
        step(&mut world, 1);
        let bundled = world.bundled();
        assert!(bundled.energy >= 0.0 && bundled.distance >= 0.0);
        most.bodies = most.bodies.max(bundled.bodies);
        most.energy = most.energy.max(bundled.energy);
        most.distance = most.distance.max(bundled.distance);
        assert!(world.steps() < 1200, "{most:?}");
    }
    assert!(most.energy > 0.0 && most.distance > 0.0, "{most:?}");
    // No flying or resting body is bundled.
    while (5..world.len()).any(|body| world.velocity(body) != DVec3::ZERO) {
        step(&mut world, 1);
    }
    step(&mut world, 2);
    let after = world.bundled();
    assert_eq!((after.bodies, after.energy, after.distance), (0, 0.0, 0.0));
}

/// The mean distance by which contacts are closed ahead of their time or kept from flying, over the steps in which a
/// heap settles, at least halves with the step, and the dissipation is as before.
#[test]
fn what_bundling_costs_shrinks_with_the_step() {
    let mut figures = Vec::new();
    for rate in [60.0, 120.0, 240.0, 480.0] {
        let mut world = bin(12, 0.0, 0.0, 7);
        set_rate(&mut world, rate);
        let (mut distance, mut energy, mut steps) = (0.0, 0.0, 0);
        for _ in 0..(3.0 * rate) as u32 {
            step(&mut world, 1);
            let bundled = world.bundled();
            if bundled.distance > 0.0 {
                distance += bundled.distance;
                steps += 1;
            }
            energy += bundled.energy;
        }
        figures.push((rate, distance / f64::from(steps.max(1)), energy));
    }
    for pair in figures.windows(2) {
        assert!(pair[1].1 <= 0.5 * pair[0].1, "{figures:?}");
        assert!(pair[1].2 <= 1.25 * pair[0].2, "{figures:?}");
    }
}
