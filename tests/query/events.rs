//! Contacts that begin, persist and end.

use std::collections::BTreeSet;

use kit::bodies::{at, body, immovable, wall};
use kit::shapes::{ball, cube, cuboid};
use kit::worlds::{GRAVITY, add_gravity, step, world, world_of};
use scene::SCENES;
use sim_core::ContactEventKind::{Begun, Ended, Persisting};
use sim_core::{Body, Collision, ContactEvent, DVec3, Settings, Vec3, World};

fn listing(bodies: Vec<Body>) -> World {
    let mut world = world(bodies);
    add_gravity(&mut world, DVec3::Y * -GRAVITY);
    world.list_contact_events(true);
    world
}

fn floor() -> Body {
    wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO)
}

fn is_near(one: DVec3, other: DVec3, error: f64) -> bool {
    one.distance(other) <= error * other.length()
}

/// The pairs of bodies in contact.
fn pairs(world: &World) -> BTreeSet<(usize, usize)> {
    world.contacts().map(|contact| contact.bodies).collect()
}

#[test]
fn what_bounces_begins_and_ends_with_its_impulse() {
    let mut world = listing(vec![floor(), body(&ball(0.5), DVec3::Y, DVec3::X)]);
    let mut seen = 0;
    for _ in 0..200 {
        let mut impacts = Vec::new();
        world.step_reporting(&mut impacts).expect("a step");
        let events = world.contact_events();
        assert_eq!(events.len(), 2 * impacts.len());
        if let ([begun, ended], [impact]) = (events, &impacts[..]) {
            assert_eq!((begun.kind, ended.kind), (Begun, Ended));
            assert_eq!((begun.bodies, begun.normal), ((0, 1), DVec3::Y));
            assert_eq!(
                (begun.impulse, ended.impulse),
                (impact.impulse * DVec3::Y, DVec3::ZERO)
            );
            assert_eq!((begun.point, ended.point), (impact.point, impact.point));
            seen += 1;
        }
    }
    assert!(seen > 4, "{seen}");
}

#[test]
fn what_lies_is_pressed_with_its_weight() {
    let cubes = (0..3).map(|i| Body {
        restitution: 0.0,
        ..at(&cube(), DVec3::Y * (0.6 + 1.1 * f64::from(i)))
    });
    let mut world = listing([floor()].into_iter().chain(cubes).collect());
    step(&mut world, 120);
    let weight = GRAVITY * world.settings().dt;
    for _ in 0..20 {
        world.step().expect("a step");
        let events = world.contact_events();
        assert_eq!(events.len(), 3);
        for (i, event) in events.iter().enumerate() {
            assert_eq!((event.kind, event.bodies), (Persisting, (i, i + 1)));
            assert_eq!(event.normal, DVec3::Y);
            let load = weight * (3 - i) as f64;
            assert!(is_near(event.impulse, load * DVec3::Y, 1e-5), "{event:?}");
            assert!((event.point.y - i as f64).abs() < 1e-6);
        }
    }
}

#[test]
fn what_slides_is_rubbed_and_what_leaves_ends() {
    let friction = 0.25;
    let table = immovable(Body {
        friction,
        ..at(&cuboid(Vec3::new(2.0, 0.5, 2.0)), DVec3::Y * -0.5)
    });
    let slider = Body {
        friction,
        ..body(&cuboid(Vec3::splat(0.25)), DVec3::Y * 0.25, DVec3::X * 6.0)
    };
    let mut world = listing(vec![table, slider]);
    let weight = GRAVITY * world.settings().dt;
    let mut kinds = Vec::new();
    for k in 0..60 {
        world.step().expect("a step");
        kinds.extend(world.contact_events().iter().map(|event| event.kind));
        if let [event] = world.contact_events()
            && event.kind == Persisting
            && (2..20).contains(&k)
        {
            let expected = weight * (DVec3::Y - friction * DVec3::X);
            assert!(is_near(event.impulse, expected, 1e-6), "{k} {event:?}");
        }
    }
    assert_eq!(kinds[0], Begun);
    assert_eq!(kinds.iter().filter(|&&kind| kind == Begun).count(), 1);
    assert_eq!(
        kinds.iter().position(|&kind| kind == Ended),
        Some(kinds.len() - 1)
    );
    assert!(kinds.len() > 20);
}

#[test]
fn what_is_lifted_ends_and_what_is_listed_late_persists() {
    let cube = Body {
        restitution: 0.0,
        ..at(&cube(), DVec3::Y * 0.6)
    };
    let mut world = world([floor(), cube]);
    add_gravity(&mut world, DVec3::Y * -GRAVITY);
    step(&mut world, 60);
    assert!(world.contact_events().is_empty());
    world.list_contact_events(true);
    assert!(world.contact_events().is_empty());
    step(&mut world, 1);
    let kinds = |world: &World| -> Vec<_> {
        world
            .contact_events()
            .iter()
            .map(|event| event.kind)
            .collect()
    };
    assert_eq!(kinds(&world), [Persisting]);
    world.set_position(1, DVec3::Y * 5.0).expect("a place");
    step(&mut world, 1);
    assert_eq!(kinds(&world), [Ended]);
    assert_eq!(world.contact_events()[0].impulse, DVec3::ZERO);
    step(&mut world, 1);
    assert!(kinds(&world).is_empty());
    world.list_contact_events(false);
    step(&mut world, 120);
    assert!(world.contact_events().is_empty() && world.contacts().count() > 0);
}

/// A ball without restitution that lands gets an impulse for its lost speed and one against gravity.
#[test]
fn impulses_are_what_momentum_lacks() {
    for restitution in [0.0, 0.5, 1.0] {
        let ball = Body {
            restitution,
            ..body(&ball(0.5), DVec3::Y * 1.3, DVec3::X)
        };
        let mut world = listing(vec![
            floor(),
            Body {
                restitution,
                ..ball
            },
        ]);
        let weight = GRAVITY * world.settings().dt * DVec3::Y;
        let mut contacts = 0;
        for k in 0..240 {
            let before = world.velocity(1);
            world.step().expect("a step");
            let given: DVec3 = world
                .contact_events()
                .iter()
                .map(|event| event.impulse)
                .sum();
            let lacking = world.velocity(1) - before + weight;
            assert!(
                (given - lacking).length() < 1e-9,
                "{restitution} {k}: {given} {lacking}"
            );
            contacts += world.contact_events().len();
        }
        assert!(contacts > 4, "{restitution}");
    }
}

/// The number of begun contacts minus that of ended ones is the number of contacts, in each mode; and listing does not
/// change steps.
#[test]
fn what_has_begun_and_not_ended_is_in_contact() {
    let mut seen = [0; 3];
    for entry in SCENES {
        for collision in [Collision::Continuous, Collision::Bvh] {
            let mut scene = entry.scene().expect("a gallery scene");
            scene.collision = collision;
            // The discrete modes rotate no bodies.
            let turns = scene.bodies.iter().any(|body| body.turn.is_some());
            if turns && collision != Collision::Continuous {
                continue;
            }
            let mut world = scene.world().expect("a world");
            let mut unlisted = world.clone();
            world.list_contact_events(true);
            let mut open: BTreeSet<(usize, usize)> = BTreeSet::new();
            for k in 0..150 {
                let mut impacts = Vec::new();
                world.step_reporting(&mut impacts).expect("a step");
                unlisted.step().expect("a step");
                let events = world.contact_events();
                assert!(events.is_sorted_by_key(|event| event.bodies));
                for event in events {
                    let ContactEvent { kind, bodies, .. } = *event;
                    assert!(bodies.0 < bodies.1);
                    assert!((event.normal.length() - 1.0).abs() < 1e-12);
                    assert!(event.impulse.is_finite() && event.point.is_finite());
                    let is_right = match kind {
                        Begun => open.insert(bodies),
                        Persisting => open.contains(&bodies),
                        Ended => open.remove(&bodies),
                    };
                    assert!(is_right, "{} step {k}: {event:?}", entry.name);
                    seen[kind as usize] += 1;
                }
                assert_eq!(open, pairs(&world), "{} step {k}", entry.name);
                for impact in &impacts {
                    let (i, j) = impact.bodies;
                    let of_pair = |event: &&ContactEvent| event.bodies == (i.min(j), i.max(j));
                    assert!(events.iter().any(|event| of_pair(&event)), "{}", entry.name);
                }
                if collision == Collision::Bvh {
                    let listed: f64 = impacts.iter().map(|impact| impact.impulse).sum();
                    let given: f64 = events.iter().map(|e| e.impulse.length()).sum();
                    assert!(given <= listed * (1.0 + 1e-12));
                }
            }
            assert_eq!(world.state_hash(), unlisted.state_hash(), "{}", entry.name);
        }
    }
    assert!(seen.iter().all(|&count| count > 500), "{seen:?}");
}

/// A failed step neither changes events nor leaves new ones.
#[test]
fn a_step_that_fails_lists_nothing() {
    let squeezed = [
        wall(DVec3::X, DVec3::X * -2.0, DVec3::X),
        wall(DVec3::NEG_X, DVec3::X * 2.0, DVec3::NEG_X),
        at(&ball(1.0), DVec3::ZERO),
    ];
    let mut world = world_of(Settings::default(), squeezed);
    world.list_contact_events(true);
    for _ in 0..200 {
        let before = world.contact_events().to_vec();
        if world.step().is_err() {
            assert_eq!(world.contact_events(), before);
            world.set_position(2, DVec3::X * -40.0).expect("a place");
            world.set_position(0, DVec3::X * -90.0).expect("a place");
            step(&mut world, 1);
            assert!(
                world
                    .contact_events()
                    .iter()
                    .all(|event| event.kind == Ended)
            );
            return;
        }
    }
    panic!("it is crushed");
}
