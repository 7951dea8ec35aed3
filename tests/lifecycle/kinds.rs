//! Dynamic, kinematic and static bodies, and external impulses.

use kit::bodies::{at, body, wall};
use kit::shapes::{ball, cube};
use kit::worlds::{add_gravity, step, world, world_of};
use sim_core::{Body, BodyKind, DVec3, Settings, World, WorldError};

use super::MODES;

#[test]
fn a_kinematic_platform_carries_what_lies_on_it_and_stops_when_told() {
    let platform = Body {
        kind: BodyKind::Kinematic,
        ..body(&cube(), DVec3::ZERO, 0.5 * DVec3::Y)
    };
    let load = Body {
        restitution: 0.0,
        ..body(&cube(), DVec3::Y, 0.5 * DVec3::Y)
    };
    let mut world = world([platform, load]);
    add_gravity(&mut world, -9.81 * DVec3::Y);
    step(&mut world, 60);
    assert!((world.position(0).y - 0.5).abs() < 1e-12);
    assert!((world.position(1).y - 1.5).abs() < 1e-9);
    world.set_velocity(0, DVec3::ZERO).expect("it is kinematic");
    assert_eq!(world.kind(0), BodyKind::Kinematic, "at rest as well");
    step(&mut world, 120);
    assert!((world.position(1).y - 1.5).abs() < 1e-9);
}

#[test]
fn a_static_body_does_not_move_and_says_so() {
    let moving = Body {
        kind: BodyKind::Static,
        velocity: DVec3::X,
        ..Body::default()
    };
    let mut world = World::new(Settings::default()).expect("settings");
    let refused = world.add(moving.clone()).expect_err("it is static");
    let text =
        "velocity of body 0 is [1, 0, 0]: a static body has none; one that keeps it is kinematic";
    assert_eq!(refused.to_string(), text);
    let still = Body {
        velocity: DVec3::ZERO,
        ..moving
    };
    world.add(still).expect("a body");
    let refused = world.set_velocity(0, DVec3::X);
    assert!(matches!(
        refused,
        Err(WorldError::StaticVelocity { body: 0, .. })
    ));
    world.set_velocity(0, DVec3::ZERO).expect("none is right");
    world.set_kind(0, BodyKind::Kinematic).expect("a kind");
    world.set_velocity(0, DVec3::X).expect("a velocity");
    world.set_kind(0, BodyKind::Static).expect("a kind");
    assert_eq!(world.velocity(0), DVec3::ZERO, "it stands still");
    let endless = world.set_mass(0, f64::INFINITY).expect_err("no mass");
    assert!(endless.to_string().ends_with("is static or kinematic"));
}

#[test]
fn a_body_keeps_its_mass_while_it_does_not_count() {
    let heavy = Body {
        mass: 4.0,
        kind: BodyKind::Static,
        ..Body::default()
    };
    let mut world = world([Body::default(), heavy]);
    assert_eq!(world.mass(1), 4.0);
    assert_eq!(world.momentum(), DVec3::ZERO);
    world.set_kind(1, BodyKind::Dynamic).expect("a kind");
    world.apply_impulse(1, 8.0 * DVec3::X).expect("an impulse");
    assert_eq!(world.velocity(1), 2.0 * DVec3::X);
    world.set_kind(1, BodyKind::Kinematic).expect("a kind");
    world.set_mass(1, 5.0).expect("a mass");
    assert_eq!((world.mass(1), world.velocity(1)), (5.0, 2.0 * DVec3::X));
    assert_eq!((world.mass(0), world.kind(0)), (1.0, BodyKind::Dynamic));
    assert_eq!(world.kinetic_energy(), 0.0);
}

#[test]
fn kinds_bounce_as_they_should_in_every_mode() {
    for collision in MODES {
        for (kind, speed) in [
            (BodyKind::Static, 0.0),
            (BodyKind::Kinematic, 0.0),
            (BodyKind::Kinematic, -1.0),
        ] {
            let target = Body {
                kind,
                ..body(&ball(0.5), 2.0 * DVec3::X, speed * DVec3::X)
            };
            let mover = body(&ball(0.5), DVec3::ZERO, 2.0 * DVec3::X);
            let settings = Settings {
                collision,
                ..Settings::default()
            };
            let mut world = world_of(settings, [target, mover]);
            step(&mut world, 60);
            let expected = (2.0 * speed - 2.0) * DVec3::X;
            assert!((world.velocity(1) - expected).length() < 1e-12, "{kind:?}");
            assert_eq!(world.velocity(0), speed * DVec3::X);
        }
    }
}

#[test]
fn an_impulse_moves_what_sleeps_and_nothing_that_is_not_dynamic() {
    let lying = Body {
        mass: 2.0,
        restitution: 0.0,
        ..at(&cube(), 0.5 * DVec3::Y)
    };
    let mut world = world([wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO), lying]);
    add_gravity(&mut world, -9.81 * DVec3::Y);
    step(&mut world, 60);
    assert_eq!(world.velocity(1), DVec3::ZERO);
    world.apply_impulse(1, 6.0 * DVec3::X).expect("an impulse");
    assert_eq!(world.velocity(1), 3.0 * DVec3::X);
    step(&mut world, 60);
    assert!((world.position(1).x - 3.0).abs() < 1e-9);
    world.apply_impulse(0, DVec3::X).expect("it does nothing");
    assert_eq!(world.velocity(0), DVec3::ZERO);
    for bad in [f64::NAN, f64::INFINITY, 1e101] {
        let refused = world.apply_impulse(1, bad * DVec3::X);
        assert!(matches!(
            refused,
            Err(WorldError::Vector {
                field: "impulse",
                ..
            })
        ));
    }
    world.set_mass(1, 1e-50).expect("a mass");
    let refused = world.apply_impulse(1, 1e90 * DVec3::X);
    assert!(matches!(
        refused,
        Err(WorldError::Vector {
            field: "velocity",
            ..
        })
    ));
    assert!(world.apply_impulse(2, DVec3::X).is_err());
}

#[test]
fn a_view_of_a_body_has_all_that_the_columns_have() {
    let odd = Body {
        kind: BodyKind::Kinematic,
        mass: 3.0,
        force: DVec3::Z,
        friction: 0.5,
        restitution: 0.25,
        user_data: 77,
        ..body(&ball(0.5), DVec3::X, DVec3::Y)
    };
    let world = world([Body::default(), odd.clone()]);
    let view = world.bodies().next_back().expect("two bodies");
    assert_eq!((view.index, view.handle), (1, world.handle(1)));
    assert_eq!(view.to_body(), odd);
    assert_eq!(world.bodies().len(), 2);
    assert_eq!(world.body(0).to_body(), Body::default());
}
