//! Many impacts in succession, in addition to the cases of `cases::hard_cases::chains`.

use cases::hard_cases::chains::galperin;
use kit::bodies::{ball, wall};
use sim_core::{Body, DVec3};

use crate::worlds::{DT, run, world};

/// A minimal loss at each impact has no noticeable effect, however many impacts a step has.
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

/// Gravity along the walls of a slot, or equal gravity on all bodies, does not influence impacts across it.
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
