//! What a step costs: one free body, a million of them, a chain of springs.
//!
//! `cargo run --release -p sim-core --example step_cost`

use std::hint::black_box;
use std::time::Instant;

use sim_core::{Body, DVec3, Force, METHODS, Method, Settings, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("one free body, one on a spring: ns a step; a chain of 100 and 1,000: µs a step,");
    println!("or NaN if the method cannot do it at 60 Hz");
    for method in METHODS {
        let free = world(method, 1)?;
        let mut spring = world(method, 1)?;
        spring.add_force(Force::Anchor {
            body: 0,
            point: None,
            anchor: DVec3::ZERO,
            rest_length: 0.0,
            stiffness: 10.0,
            damping: 1.0,
        })?;
        let (free, spring) = (cost(free, 50_000)?, cost(spring, 5_000)?);
        let chains = [chain(method, 100)?, chain(method, 1000)?];
        let [short, long] = chains.map(|world| cost(world, 5).map_or(f64::NAN, |ns| 1e-3 * ns));
        println!(
            "{:<18} {free:7.1} {spring:9.1} {short:9.0} {long:9.0}",
            method.name
        );
    }
    million()
}

fn world(method: &'static Method, bodies: usize) -> Result<World, Box<dyn std::error::Error>> {
    let mut world = World::new(Settings {
        method,
        ..Settings::default()
    })?;
    for i in 0..bodies {
        let x = i as f64;
        world.add(Body {
            position: DVec3::new(x, 1.0, 0.0),
            velocity: DVec3::new(1.0, 2.0, 0.0),
            force: -DVec3::Y,
            ..Body::default()
        })?;
    }
    Ok(world)
}

/// Bodies hung from each other, a metre apart, with 10 kN/m between them.
fn chain(method: &'static Method, links: usize) -> Result<World, Box<dyn std::error::Error>> {
    let mut world = world(method, links)?;
    world.add_force(Force::Anchor {
        body: 0,
        point: None,
        anchor: world.position(0),
        rest_length: 0.0,
        stiffness: 1e4,
        damping: 0.0,
    })?;
    for i in 1..links {
        world.add_force(Force::Spring {
            bodies: [i - 1, i],
            points: None,
            rest_length: 1.0,
            stiffness: 1e4,
            damping: 1.0,
        })?;
    }
    Ok(world)
}

/// Nanoseconds a step, the best of some rounds: other processes disturb the rest.
fn cost(mut world: World, steps: u32) -> Result<f64, sim_core::StepError> {
    world.step()?;
    let mut best = f64::INFINITY;
    for _ in 0..20 {
        let clock = Instant::now();
        for _ in 0..steps {
            black_box(&mut world).step()?;
        }
        best = best.min(clock.elapsed().as_secs_f64() * 1e9 / f64::from(steps));
    }
    Ok(best)
}

/// A million free bodies beside a copy of as many bytes: 72 read and 48 written a body.
fn million() -> Result<(), Box<dyn std::error::Error>> {
    const N: usize = 1_000_000;
    let step = cost(world(METHODS[0], N)?, 5)? / N as f64;
    let (from, mut to) = (vec![1.0_f64; 15 * N / 2], vec![0.0; 15 * N / 2]);
    let mut copy = f64::INFINITY;
    for _ in 0..10 {
        let clock = Instant::now();
        to.copy_from_slice(black_box(&from));
        black_box(&mut to);
        copy = copy.min(clock.elapsed().as_secs_f64() * 1e9 / N as f64);
    }
    println!(
        "a million free bodies: {step:.2} ns each, 120 bytes; copying 120 bytes: {copy:.2} ns"
    );
    Ok(())
}
