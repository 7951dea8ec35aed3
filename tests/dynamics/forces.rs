//! Every method with every force, chains of forces, and edits of forces.

use std::slice;

use cases::hard_cases::stiff_spring;
use kit::worlds::step;
use sim_core::{
    Body, BodyLaw, BodyMotion, DVec3, Force, Law, METHODS, Method, PairLaw, PairMotion, World,
};

use crate::worlds::{method, point, world};

/// Forces of all kinds on two bodies, each with a potential or a damping.
fn every_force() -> Vec<(&'static str, Force)> {
    #[derive(Debug)]
    struct Cubic;
    impl BodyLaw for Cubic {
        fn force(&self, at: &BodyMotion) -> DVec3 {
            -at.position * at.position.length_squared()
        }
    }
    #[derive(Debug)]
    struct Repulsion;
    impl PairLaw for Repulsion {
        fn force(&self, at: &PairMotion) -> DVec3 {
            -at.position / at.position.length_squared() - 0.1 * at.time.sin() * at.velocity
        }
    }
    vec![
        (
            "gravity",
            Force::Gravity {
                acceleration: DVec3::new(0.0, -9.81, 1.0),
            },
        ),
        (
            "linear drag",
            Force::LinearDrag {
                body: None,
                coefficient: 0.7,
            },
        ),
        (
            "quadratic drag",
            Force::QuadraticDrag {
                body: Some(1),
                coefficient: 0.4,
            },
        ),
        (
            "anchor",
            Force::Anchor {
                body: 1,
                point: None,
                anchor: DVec3::new(0.0, 1.0, 0.0),
                rest_length: 0.5,
                stiffness: 9.0,
                damping: 0.3,
            },
        ),
        (
            "spring",
            Force::Spring {
                bodies: [1, 0],
                points: None,
                rest_length: 0.8,
                stiffness: 9.0,
                damping: 0.3,
            },
        ),
        (
            "attraction",
            Force::Attraction {
                body: None,
                centre: DVec3::new(0.0, 0.0, -2.0),
                strength: 3.0,
            },
        ),
        ("gravitation", Force::Gravitation { constant: 2.0 }),
        (
            "body law",
            Force::Body {
                body: None,
                law: Law::new(Cubic),
            },
        ),
        (
            "pair law",
            Force::Pair {
                bodies: None,
                law: Law::of_pair(Repulsion),
            },
        ),
    ]
}

fn pair() -> [Body; 2] {
    [
        Body {
            mass: 2.0,
            ..point(DVec3::new(1.0, 0.2, 0.0), DVec3::new(0.0, 0.5, 0.3))
        },
        point(DVec3::new(-0.5, 0.0, 0.4), DVec3::new(0.2, -0.6, 0.0)),
    ]
}

#[test]
fn every_method_solves_every_force() {
    for (name, force) in every_force() {
        let end = |method: &'static Method, steps: u32| {
            let mut world = world(
                method,
                0.5 / f64::from(steps),
                &pair(),
                slice::from_ref(&force),
            );
            step(&mut world, u64::from(steps));
            (0..2)
                .flat_map(|i| [world.position(i), world.velocity(i)])
                .collect::<Vec<_>>()
        };
        let exact = end(method("dop853"), 1);
        for method in METHODS {
            let error = |steps| {
                let off = end(method, steps).into_iter().zip(&exact);
                off.map(|(a, b)| (a - *b).length()).fold(0.0, f64::max)
            };
            if method.adaptive {
                assert!(error(3) < 1e-11, "{} {name}: {}", method.name, error(3));
                continue;
            }
            let (coarse, fine) = (error(64), error(128));
            let order = (coarse / fine).log2();
            let as_claimed = order > f64::from(method.order) - 0.35 || fine < 1e-11;
            assert!(as_claimed, "{} {name}: {coarse:e} {fine:e}", method.name);
        }
    }
}

#[test]
fn forces_between_bodies_keep_momentum_and_forces_with_a_potential_energy() {
    for (name, force) in every_force() {
        let mut world = world(method("dop853"), 0.02, &pair(), slice::from_ref(&force));
        let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
        let (start, momentum) = (energy(&world), world.momentum());
        step(&mut world, 50);
        if matches!(name, "spring" | "gravitation" | "pair law") {
            assert!((world.momentum() - momentum).length() < 1e-13, "{name}");
        }
        let change = energy(&world) - start;
        match name {
            "gravity" | "attraction" | "gravitation" => assert!(change.abs() < 1e-10, "{name}"),
            "linear drag" | "quadratic drag" | "anchor" | "spring" => {
                assert!(change < -1e-4, "{name}: {change}");
            }
            _ => {}
        }
    }
}

#[test]
fn editing_forces_takes_effect_from_the_next_step() {
    let world = stiff_spring::world(method("rk4"), 1e-3);
    let mut world = world.expect("a world");
    step(&mut world, 10);
    world.remove_force(0).expect("a force");
    assert_eq!(world.forces().len(), 1);
    let (x, v) = (world.position(0).x, world.velocity(0).x);
    step(&mut world, 1);
    assert!((world.velocity(0).x - (v - 9.81e-3)).abs() < 1e-13);
    assert!((world.position(0).x - (x + 1e-3 * v - 0.5 * 9.81e-6)).abs() < 1e-13);
    let drag = Force::LinearDrag {
        body: Some(0),
        coefficient: 5.0,
    };
    world.replace_force(0, drag).expect("a force");
    let v = world.velocity(0).x;
    step(&mut world, 1);
    assert!((world.velocity(0).x / v - (-5e-3f64).exp()).abs() < 1e-12);
}

#[test]
fn bodies_without_forces_move_as_if_there_were_none() {
    for method in METHODS {
        let bodies: Vec<Body> = (0..300)
            .map(|i| Body {
                force: -DVec3::Y,
                ..point(
                    f64::from(i) * DVec3::X,
                    DVec3::new(1.0, 0.1 * f64::from(i), 0.0),
                )
            })
            .collect();
        let mut free = world(method, 0.01, &bodies, &[]);
        let spring = Force::Spring {
            bodies: [100, 103],
            points: None,
            rest_length: 1.0,
            stiffness: 5.0,
            damping: 0.1,
        };
        let mut some = world(method, 0.01, &bodies, &[spring]);
        step(&mut free, 20);
        step(&mut some, 20);
        for i in (0..100).chain(104..300) {
            assert_eq!(free.position(i), some.position(i), "{} {i}", method.name);
        }
        assert_ne!(free.position(100), some.position(100));
    }
}

// A chain of stiffly coupled bodies.

fn chain(method: &'static Method, links: usize) -> World {
    let bodies: Vec<Body> = (0..links)
        .map(|i| point(i as f64 * DVec3::X, DVec3::ZERO))
        .collect();
    let mut forces: Vec<Force> = (1..links)
        .map(|i| Force::Spring {
            bodies: [i - 1, i],
            points: None,
            rest_length: 1.0,
            stiffness: 1e5,
            damping: 10.0,
        })
        .collect();
    forces.push(Force::Anchor {
        body: 0,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness: 1e5,
        damping: 10.0,
    });
    forces.push(Force::Gravity {
        acceleration: -9.81 * DVec3::Y,
    });
    world(method, 1.0 / 60.0, &bodies, &forces)
}

#[test]
fn a_stiff_chain_of_a_thousand_steps_at_sixty_hertz() {
    for name in ["backward-euler", "implicit-midpoint"] {
        let mut world = chain(method(name), 1000);
        let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
        let start = energy(&world);
        step(&mut world, 60);
        let gain = (energy(&world) - start) / world.kinetic_energy();
        assert!(gain < 1e-3, "{name}: {gain}");
        // The free end falls freely, because no signal from the anchor has reached it yet.
        let end = world.position(999);
        assert!((end.y / (-0.5 * 9.81) - 1.0).abs() < 0.05, "{name}: {end}");
    }
}

// Determinism.

#[test]
fn two_runs_give_the_same_bits() {
    for method in METHODS {
        let forces: Vec<Force> = every_force().into_iter().map(|(_, force)| force).collect();
        let [first, second] = [0, 1].map(|_| {
            let mut world = world(method, 0.01, &pair(), &forces);
            step(&mut world, 30);
            [0, 1].map(|i| (world.position(i), world.velocity(i)))
        });
        assert_eq!(first, second, "{}", method.name);
    }
}
