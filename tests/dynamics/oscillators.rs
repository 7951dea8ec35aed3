//! An oscillator over a thousand periods: the invariants of methods at every step.

use cases::hard_cases::oscillator;
use kit::worlds::step;
use sim_core::{DVec3, World};

use crate::worlds::method;

#[test]
fn symplectic_euler_keeps_its_own_energy_exactly() {
    let dt = 1.0 / 60.0;
    let world = oscillator::world(method("symplectic-euler"), dt, DVec3::X, DVec3::ZERO);
    let mut world = world.expect("a world");
    let energy = |world: &World| {
        let (q, p) = (world.position(0).x, world.velocity(0).x);
        0.5 * (p * p + q * q - dt * p * q)
    };
    let start = energy(&world);
    for _ in 0..376_991 {
        step(&mut world, 1);
        assert!((energy(&world) / start - 1.0).abs() < 1e-12);
    }
}

#[test]
fn order_eight_stays_with_an_oscillator_for_a_thousand_periods() {
    let world = oscillator::world(method("symplectic-8"), 0.2, DVec3::X, DVec3::ZERO);
    let mut world = world.expect("a world");
    step(&mut world, 31_416);
    let t = world.time();
    let (x, v) = (world.position(0).x, world.velocity(0).x);
    let amplitude = (x.hypot(v) - 1.0).abs();
    let error = (x - t.cos()).abs().max((v + t.sin()).abs());
    println!(
        "symplectic-8, 1000 periods at dt = 0.2: amplitude {amplitude:.1e}, error {error:.1e}"
    );
    assert!(amplitude < 1e-12 && error < 1e-7);
}
