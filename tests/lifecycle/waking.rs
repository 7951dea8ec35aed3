//! Bodies that sleep: a step changes nothing but the time, and every change from outside wakes them.

use kit::bodies::at;
use kit::shapes::cube;
use kit::worlds::{add_gravity, step, world};
use sim_core::{Body, BodyKind, DVec3, Force, Groups, Settings, World};

/// A change of a world, and its name.
type Change = (&'static str, fn(&mut World));

/// A cube asleep on a static one. Friction holds it against a force to the side.
fn asleep() -> World {
    let floor = Body {
        kind: BodyKind::Static,
        friction: 1.0,
        ..at(&cube(), DVec3::ZERO)
    };
    let lying = Body {
        restitution: 0.0,
        friction: 1.0,
        force: DVec3::X,
        ..at(&cube(), DVec3::Y)
    };
    let mut world = world([floor, lying]);
    add_gravity(&mut world, -9.81 * DVec3::Y);
    step(&mut world, 120);
    assert_eq!(world.velocity(1), DVec3::ZERO);
    world
}

#[test]
fn sleep_changes_nothing_but_the_time() {
    let mut world = asleep();
    let (at, contacts) = (world.position(1), world.contacts().count());
    for _ in 0..100 {
        step(&mut world, 1);
        assert_eq!(world.position(1), at);
        assert_eq!(world.previous_position(1), at);
        assert_eq!(world.velocity(1), DVec3::ZERO);
        assert_eq!(world.contacts().count(), contacts);
    }
    assert_eq!(world.steps(), 220);
    assert!((world.time() - 220.0 / 60.0).abs() < 1e-12);
}

#[test]
fn every_change_wakes_what_sleeps() {
    let changes: [Change; 15] = [
        ("velocity", |world| {
            world.set_velocity(1, DVec3::Z).expect("a velocity");
        }),
        ("impulse", |world| {
            world.apply_impulse(1, DVec3::Z).expect("an impulse");
        }),
        ("force", |world| {
            world.set_force(1, 20.0 * DVec3::Z).expect("a force");
        }),
        ("friction", |world| {
            world.set_friction(1, 0.0).expect("a friction");
        }),
        ("friction of the floor", |world| {
            world.set_friction(0, 0.0).expect("a friction");
        }),
        ("mass", |world| {
            world.set_mass(1, 0.01).expect("a mass");
        }),
        ("position", |world| {
            let above = world.position(1) + DVec3::Y;
            world.set_position(1, above).expect("a position");
        }),
        ("position of the floor", |world| {
            world.set_position(0, -DVec3::Y).expect("a position");
        }),
        ("kind of the floor", |world| {
            world.set_kind(0, BodyKind::Dynamic).expect("a kind");
        }),
        ("a floor that moves", |world| {
            world.set_kind(0, BodyKind::Kinematic).expect("a kind");
            world.set_velocity(0, DVec3::Y).expect("a velocity");
        }),
        ("a new force", |world| {
            let acceleration = 10.0 * DVec3::Y;
            let force = Force::Gravity { acceleration };
            world.add_force(force).expect("a force");
        }),
        ("no weight", |world| {
            world.remove_force(0).expect("a force");
        }),
        ("groups", |world| {
            world.set_groups(0, Groups::NONE).expect("groups");
        }),
        ("an ignored pair", |world| {
            world.ignore_pair(0, 1).expect("a pair");
        }),
        ("a body that hits it", |world| {
            let hail = Body {
                velocity: 50.0 * DVec3::X,
                ..at(&cube(), DVec3::new(-3.0, 1.2, 0.2))
            };
            world.add(hail).expect("a body");
        }),
    ];
    for (name, change) in changes {
        let mut world = asleep();
        let at = world.position(1);
        change(&mut world);
        step(&mut world, 10);
        let moved = (world.position(1) - at).length();
        assert!(moved > 1e-3, "{name}: it has moved by {moved:e} m");
    }
}

#[test]
fn a_removed_floor_and_other_steps_wake_what_sleeps() {
    let mut world = asleep();
    let at = world.position(1);
    world.remove(0).expect("a floor");
    step(&mut world, 10);
    assert!(world.position(0).y < at.y - 0.1);

    let mut world = asleep();
    let settings = Settings {
        dt: 0.25,
        ..*world.settings()
    };
    world.set_settings(settings).expect("settings");
    let before = world.time();
    step(&mut world, 4);
    assert!((world.time() - before - 1.0).abs() < 1e-12);
    assert_eq!(world.position(1), at);
}
