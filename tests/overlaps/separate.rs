//! Overlapping bodies are moved apart, and nothing overlaps afterwards.

use kit::bodies::{at, immovable};
use kit::random::Random;
use kit::shapes::{ball, cow, cuboid, half_space};
use kit::worlds::{add_gravity, meeting, world, world_of};
use sim_core::{Body, BodyKind, Collision, DVec3, SeparateError, Settings, World};

use crate::WEIGHT;

fn separated(world: &mut World, what: &str) -> Vec<usize> {
    let velocities: Vec<DVec3> = (0..world.len()).map(|i| world.velocity(i)).collect();
    let before: Vec<DVec3> = (0..world.len()).map(|i| world.position(i)).collect();
    let moved = world
        .separate()
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(meeting(world, Settings::default()), [], "{what}");
    assert_eq!(world.overlapping(), [], "{what}");
    assert_eq!(world.overlaps(), [], "{what}");
    for i in 0..world.len() {
        assert_eq!(world.velocity(i), velocities[i], "{what}");
        assert_eq!(moved.contains(&i), world.position(i) != before[i], "{what}");
        assert!(
            world.kind(i).is_movable() || world.position(i) == before[i],
            "{what}"
        );
    }
    moved
}

#[test]
fn pairs_of_all_shapes_are_moved_out_of_each_other() {
    let shapes = [
        ball(0.5),
        cuboid([0.5; 3]),
        cow(),
        cuboid([0.2, 0.7, 0.4]),
        ball(0.0),
        half_space(DVec3::new(0.3, 1.0, -0.2)),
    ];
    let mut random = Random::xorshift(17, 33);
    for first in &shapes {
        for second in &shapes {
            for _ in 0..4 {
                let mut pair = [
                    at(first, random.vector()),
                    at(second, 0.4 * random.vector()),
                ];
                pair[1].position += pair[0].position;
                for body in &mut pair {
                    body.velocity = random.vector();
                    body.mass = [1.0, 1e-3, 7.0][random.below(3)];
                }
                if random.below(2) == 0 {
                    pair[random.below(2)].kind = BodyKind::Kinematic;
                }
                let what = format!("{pair:?}");
                separated(&mut world(pair), &what[..what.len().min(400)]);
            }
        }
    }
}

#[test]
fn two_share_the_way_by_their_masses() {
    let mut world = world([
        Body {
            mass: 3.0,
            ..at(&ball(0.5), DVec3::ZERO)
        },
        at(&ball(0.5), DVec3::new(0.6, 0.0, 0.0)),
    ]);
    assert_eq!(separated(&mut world, "two balls"), [0, 1]);
    // 0.4 m are missing.
    assert!(
        (world.position(0).x + 0.1).abs() < 1e-11,
        "{}",
        world.position(0)
    );
    assert!(
        (world.position(1).x - 0.9).abs() < 1e-11,
        "{}",
        world.position(1)
    );
    assert_eq!(world.separate(), Ok(Vec::new()));
}

#[test]
fn chains_and_heaps_are_moved_apart() {
    for shape in [ball(0.5), cuboid([0.5; 3])] {
        let floor = immovable(at(&half_space(DVec3::Y), DVec3::ZERO));
        // Each overlaps the next one, and the lowest overlaps the floor.
        let chain = (0..20).map(|k| at(&shape, DVec3::Y * (0.2 + 0.7 * f64::from(k))));
        let mut chain = world(core::iter::once(floor.clone()).chain(chain));
        assert_eq!(separated(&mut chain, "chain").len(), 20);
        let top = chain.position(20).y;
        assert!((19.5 - 1e-6..20.0).contains(&top), "{top}");
        let mut random = Random::xorshift(23, 33);
        let heap = (0..60).map(|_| {
            let place = 1.5 * random.vector() + 1.2 * DVec3::Y;
            Body {
                mass: [1.0, 0.2, 5.0][random.below(3)],
                ..at(&shape, place)
            }
        });
        let mut heap = world(core::iter::once(floor).chain(heap.collect::<Vec<_>>()));
        assert!(heap.overlapping().len() > 100);
        separated(&mut heap, "heap");
        // No body is moved far.
        for body in 1..heap.len() {
            assert!(
                heap.position(body).length() < 8.0,
                "{}",
                heap.position(body)
            );
        }
        add_gravity(&mut heap, WEIGHT);
        for _ in 0..30 {
            heap.step().expect("a step");
            assert_eq!(heap.overlapping(), []);
        }
    }
    // All at one position.
    let mut crowd = world((0..12).map(|_| at(&ball(0.5), DVec3::ONE)));
    separated(&mut crowd, "all in one place");
    let mut herd =
        world((0..4).map(|k| at(&cow(), 0.3 * f64::from(k) * DVec3::new(1.0, 0.2, 0.1))));
    separated(&mut herd, "herd");
}

#[test]
fn what_is_moved_out_of_a_floor_lies_on_it() {
    let floor = immovable(at(&half_space(DVec3::Y), DVec3::ZERO));
    let mut world = world([floor, at(&cuboid([0.5; 3]), DVec3::new(0.0, 0.3, 0.0))]);
    add_gravity(&mut world, WEIGHT);
    separated(&mut world, "cube in a floor");
    for _ in 0..60 {
        world.step().expect("a step");
        assert_eq!(world.kinetic_energy(), 0.0);
    }
    assert_eq!(world.impacts(), 0);
    assert!((world.position(1).y - 0.5).abs() < 1e-11);
    assert_eq!(world.contacts().count(), 1);
}

#[test]
fn what_is_between_two_immovable_bodies_goes_out_aside() {
    for shape in [ball(0.5), cuboid([0.5; 3])] {
        let block = cuboid([0.5, 2.0, 2.0]);
        let jaws = [-0.9, 0.9].map(|x| immovable(at(&block, DVec3::X * x)));
        let [left, right] = jaws;
        let mut world = world([left, at(&shape, DVec3::new(0.0, 1.6, 0.1)), right]);
        assert_eq!(separated(&mut world, "between blocks"), [1]);
        assert!(
            (world.position(1).y - 2.5).abs() < 0.6,
            "{}",
            world.position(1)
        );
    }
    // Two balls in a slot that is wide enough for one.
    let walls = [DVec3::Y, DVec3::NEG_Y].map(|n| immovable(at(&half_space(n), -0.75 * n)));
    let [floor, ceiling] = walls;
    let balls = [-0.25, 0.25].map(|y| at(&ball(0.5), DVec3::Y * y));
    let [low, high] = balls;
    let mut world = world([floor, ceiling, low, high]);
    separated(&mut world, "two balls in a slot");
}

#[test]
fn what_fits_nowhere_is_told_and_nothing_is_moved() {
    let walls = [DVec3::Y, DVec3::NEG_Y].map(|n| immovable(at(&half_space(n), -0.4 * n)));
    let [floor, ceiling] = walls;
    for shape in [ball(0.5), cuboid([0.5; 3])] {
        let bystanders = [5.0, 5.5].map(|x| at(&ball(0.3), DVec3::X * x));
        let [one, other] = bystanders;
        let mut world = world([
            at(&shape, DVec3::ZERO),
            floor.clone(),
            one,
            immovable(at(&half_space(DVec3::X), -9.0 * DVec3::X)),
            ceiling.clone(),
            other,
        ]);
        let before = world.state_hash();
        let error = world.separate().expect_err("there is no room");
        let walls = vec![1, 4];
        assert_eq!(error, SeparateError::Caught { body: 0, walls });
        assert!(error.to_string().contains("body 0 does not fit"), "{error}");
        assert_eq!(world.state_hash(), before);
        assert_eq!(world.overlaps().len(), 3);
        // The world can be stepped nevertheless.
        add_gravity(&mut world, WEIGHT);
        for _ in 0..30 {
            world.step().expect("a step");
        }
    }
    // A full box of half-spaces.
    let walls = DVec3::AXES.iter().flat_map(|&n| [n, -n]);
    let walls = walls.map(|n| immovable(at(&half_space(n), -0.6 * n)));
    let balls = [at(&ball(0.5), DVec3::ZERO), at(&ball(0.5), 0.1 * DVec3::X)];
    let mut world = world(walls.chain(balls));
    let before = world.state_hash();
    let error = world.separate().expect_err("there is no room");
    assert_eq!(
        error,
        SeparateError::NoRoom {
            body: 7,
            others: vec![6]
        }
    );
    assert_eq!(world.state_hash(), before);
}

#[test]
fn all_modes_go_on_from_where_bodies_were_moved_to() {
    for collision in [Collision::Naive, Collision::Bvh, Collision::Continuous] {
        let settings = Settings {
            collision,
            ..Settings::default()
        };
        let shapes = [cuboid([0.5; 3]), cow(), ball(0.5)];
        let bodies = shapes.iter().enumerate().map(|(k, shape)| Body {
            velocity: DVec3::new(-(k as f64), 0.1, 0.0),
            ..at(shape, 0.2 * k as f64 * DVec3::X)
        });
        let mut world = world_of(settings, bodies);
        separated(&mut world, "three");
        let energy = world.kinetic_energy();
        for _ in 0..120 {
            world.step().expect("a step");
            assert_eq!(meeting(&world, Settings::default()), []);
        }
        assert!((world.kinetic_energy() / energy - 1.0).abs() < 1e-13);
    }
}
