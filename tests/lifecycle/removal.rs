//! After a removal the others continue as if the body had never existed.

use kit::bodies::{at, body, immovable, wall};
use kit::shapes::{ball, cube};
use kit::worlds::{add_gravity, step, world, world_of as built};
use sim_core::{Body, BodyKind, Collision, DVec3, Force, Settings, World, WorldError};

use super::{gallery, world_of};

/// The number of steps before and after the removal.
const BEFORE: u64 = 20;
const AFTER: u64 = 20;

/// Some bodies of so many: the first, the last and a few between.
fn some(bodies: usize) -> impl Iterator<Item = usize> {
    let places = [0, 1, 2, bodies / 3, bodies / 2, bodies.saturating_sub(1)];
    let mut places: Vec<usize> = places.into_iter().filter(|&i| i < bodies).collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter()
}

#[test]
fn a_body_that_goes_before_the_first_step_was_never_there() {
    let mut compared = 0;
    for (scene, mode) in gallery() {
        for gone in some(scene.bodies.len()) {
            let mut world = world_of(&scene, mode);
            let handles: Vec<_> = (0..world.len()).map(|i| world.handle(i)).collect();
            // For a turning body this is the position of its centre of mass, not of its origin as in the scene.
            let there = world.position(gone);
            let removed = world.remove(gone).expect("it is there");
            assert_eq!(removed.position, there);
            let mut without = scene.clone();
            without.remove_body(gone);
            let mut other = world_of(&without, mode);
            for _ in 0..AFTER {
                assert_eq!(world.step(), other.step());
            }
            let what = format!("{} without {gone}, {mode:?}", scene.name);
            assert_eq!(world.state_hash(), other.state_hash(), "{what}");
            assert_eq!(world.forces(), other.forces(), "{what}");
            for (before, &handle) in handles.iter().enumerate() {
                let now = world.index_of(handle).ok();
                let expected = (before != gone).then(|| before - usize::from(before > gone));
                assert_eq!(now, expected, "{what}");
            }
            compared += 1;
        }
    }
    assert!(compared > 200, "{compared}");
}

/// Whether a body has not interacted with any other so far, and no force on it acts on others.
fn is_alone(world: &World, body: usize, touched: &[bool]) -> bool {
    !touched[body]
        && world.forces().iter().all(|force| match force {
            Force::Gravitation { .. } => !world.kind(body).is_movable(),
            Force::Spring { bodies, .. } => !bodies.contains(&body),
            _ => true,
        })
}

#[test]
fn a_body_that_goes_in_a_run_leaves_those_alone_that_it_never_touched() {
    let mut compared = 0;
    for (scene, mode) in gallery() {
        let mut start = world_of(&scene, mode);
        let mut touched = vec![false; start.len()];
        let mut impacts = Vec::new();
        for _ in 0..BEFORE {
            start.step_reporting(&mut impacts).expect("a step");
            let contacts = start.contacts().map(|contact| contact.bodies);
            let pairs = start.overlapping().iter().copied();
            for (i, j) in contacts.chain(pairs) {
                (touched[i], touched[j]) = (true, true);
            }
        }
        for impact in &impacts {
            let (i, j) = impact.bodies;
            (touched[i], touched[j]) = (true, true);
        }
        let alone = (0..start.len()).find(|&body| is_alone(&start, body, &touched));
        for gone in some(start.len()).chain(alone) {
            let what = format!("{} without {gone}, {mode:?}", scene.name);
            let mut world = start.clone();
            world.remove(gone).expect("it is there");
            for _ in 0..AFTER {
                world
                    .step()
                    .unwrap_or_else(|error| panic!("{what}: {error}"));
                assert_eq!(world.meeting(), [], "{what}");
            }
            if is_alone(&start, gone, &touched) {
                let mut without = scene.clone();
                without.remove_body(gone);
                let mut other = world_of(&without, mode);
                step(&mut other, BEFORE + AFTER);
                assert_eq!(world.state_hash(), other.state_hash(), "{what}");
                compared += 1;
            }
        }
    }
    assert!(compared > 40, "{compared}");
}

#[test]
fn what_lay_on_a_body_falls_when_that_goes() {
    let floor = wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO);
    let cube = cube();
    let stack = (0..3).map(|i| Body {
        restitution: 0.0,
        ..at(&cube, (0.5 + f64::from(i)) * DVec3::Y)
    });
    let mut world = world([floor].into_iter().chain(stack));
    add_gravity(&mut world, -9.81 * DVec3::Y);
    step(&mut world, 60);
    assert_eq!(world.contacts().count(), 3);
    assert!((1..4).all(|i| world.velocity(i) == DVec3::ZERO), "at rest");
    world.remove(1).expect("the lowest cube");
    // The two above hang in the air together, one on the other.
    let dt = world.settings().dt;
    world.step().expect("a step");
    for body in [1, 2] {
        let speed = world.velocity(body).y;
        assert!((speed + 9.81 * dt).abs() < 1e-9, "{body}: {speed}");
    }
    step(&mut world, 60);
    for (body, height) in [(1, 0.5), (2, 1.5)] {
        assert!((world.position(body).y - height).abs() < 1e-9);
    }
}

#[test]
fn its_forces_go_with_it_and_the_others_follow_their_bodies() {
    let points = (0..4).map(|i| Body {
        position: f64::from(i) * DVec3::X,
        ..Body::default()
    });
    let mut world = built(Settings::default(), points);
    let spring = |i, j| Force::Spring {
        bodies: [i, j],
        points: None,
        rest_length: 1.0,
        stiffness: 3.0,
        damping: 0.0,
    };
    let drag = |body| Force::LinearDrag {
        body,
        coefficient: 1.0,
    };
    for force in [
        spring(0, 1),
        spring(3, 2),
        drag(Some(1)),
        drag(None),
        drag(Some(3)),
    ] {
        world.add_force(force).expect("a force");
    }
    step(&mut world, 3);
    world.remove(1).expect("it is there");
    assert_eq!(world.forces(), [spring(2, 1), drag(None), drag(Some(2))]);
    step(&mut world, 3);
    let nobody = WorldError::NoBody { body: 3, bodies: 3 };
    assert_eq!(world.remove(3), Err(nobody));
}

#[test]
fn the_latest_impact_is_of_bodies_that_are_there() {
    for collision in super::MODES {
        let settings = Settings {
            collision,
            ..Settings::default()
        };
        let ball = ball(0.5);
        let bodies = [
            at(&ball, 9.0 * DVec3::Y),
            at(&ball, DVec3::ZERO),
            body(&ball, 1.5 * DVec3::X, -9.0 * DVec3::X),
        ];
        let mut world = built(settings, &bodies);
        step(&mut world, 30);
        assert_eq!(
            world.last_impact().map(|impact| impact.bodies),
            Some((1, 2))
        );
        world.remove(0).expect("it is there");
        assert_eq!(
            world.last_impact().map(|impact| impact.bodies),
            Some((0, 1))
        );
        world.remove(1).expect("it is there");
        assert_eq!((world.impacts(), world.last_impact()), (1, None));
    }
}

#[test]
fn shapes_go_with_the_last_body_that_has_them() {
    let mut world = World::new(Settings::default()).expect("settings");
    let mesh = kit::shapes::cuboid([0.5; 3]);
    let shared = mesh.mesh().expect("a mesh").clone();
    let count = || std::sync::Arc::strong_count(&shared);
    let before = count();
    for i in 0..3 {
        world
            .add(at(&mesh, f64::from(3 * i) * DVec3::X))
            .expect("a body");
    }
    world.add(at(&ball(0.5), 3.0 * DVec3::Y)).expect("a body");
    world.step().expect("a step");
    for left in (1..=3).rev() {
        assert_eq!(count(), before + 1, "{left}");
        world.remove(0).expect("it is there");
    }
    assert_eq!(count(), before);
    assert_eq!(world.shape(0), Some(&ball(0.5)));
}

#[test]
fn bodies_that_come_and_go_at_random_leave_a_sound_world() {
    for collision in [Collision::Continuous, Collision::Bvh] {
        let mut random = kit::random::Random::xorshift(7, 33);
        let settings = Settings {
            collision,
            ..Settings::default()
        };
        let mut world = built(settings, [wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO)]);
        add_gravity(&mut world, -9.81 * DVec3::Y);
        let shapes = [ball(0.3), cube(), ball(0.0)];
        for _ in 0..300 {
            if world.len() < 12 || random.one_in(2) && world.len() < 40 {
                let place = 4.0 * random.vector() + 5.0 * DVec3::Y;
                let new = Body {
                    restitution: 0.3,
                    ..at(&shapes[random.below(3)], place)
                };
                let new = if random.one_in(6) {
                    immovable(new)
                } else {
                    new
                };
                let body = world.add(new).expect("a body");
                if random.one_in(4) {
                    let drag = Force::LinearDrag {
                        body: Some(body),
                        coefficient: 0.1,
                    };
                    world.add_force(drag).expect("drag");
                }
            } else {
                world
                    .remove(1 + random.below(world.len() - 1))
                    .expect("it is there");
            }
            world.step().expect("a step");
            assert_eq!(world.meeting(), []);
            assert!(world.contacts().all(|c| c.bodies.1 < world.len()));
        }
        assert!(world.impacts() > 10 && world.kind(0) == BodyKind::Kinematic);
    }
}
