//! Turning bodies placed in overlap: their depths, and moving them apart.

use kit::{bodies, random::Random, shapes, worlds};
use sim_core::{Body, Collision, DQuat, DVec3, Settings, Shape, Turn};

fn turned(shape: &Shape, position: DVec3, rotation: DQuat) -> Body {
    let turn = Turn {
        rotation,
        ..Turn::default()
    };
    Body {
        turn: Some(turn),
        ..bodies::at(shape, position)
    }
}

#[test]
fn depths_are_those_of_shapes_as_they_are_turned() {
    let cube = shapes::cuboid([0.5; 3]);
    let floor = bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO);
    // On an edge, with its centre half a metre above the floor.
    let on_edge = turned(
        &cube,
        0.5 * DVec3::Y,
        DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4),
    );
    for is_first in [true, false] {
        let pair = match is_first {
            true => [on_edge.clone(), floor.clone()],
            false => [floor.clone(), on_edge.clone()],
        };
        let overlaps = worlds::world(pair).overlaps();
        let [overlap] = overlaps[..] else {
            panic!("{overlaps:?}");
        };
        assert!((overlap.depth - (0.5_f64.sqrt() - 0.5)).abs() < 1e-15);
        assert_eq!(overlap.normal.y, if is_first { -1.0 } else { 1.0 });
        assert!(overlap.is_least);
    }
    // Two bodies with the same rotation, one beside the other along their x axis.
    let mut random = Random::splitmix(4);
    for _ in 0..20 {
        let rotation = DQuat::from_axis_angle(random.direction(), random.from(0.0, 3.0));
        let way = rotation * DVec3::new(0.75, 0.2, -0.1);
        let pair = [
            turned(&cube, DVec3::ONE, rotation),
            turned(&cube, DVec3::ONE + way, rotation),
        ];
        let overlaps = worlds::world(pair).overlaps();
        let [overlap] = overlaps[..] else {
            panic!("{overlaps:?}");
        };
        assert!((overlap.depth - 0.25).abs() < 1e-9, "{overlap:?}");
        assert!((overlap.normal - rotation * DVec3::X).length() < 1e-9);
    }
    // A body whose centre of mass is not its origin, in overlap with a ball.
    let cow = turned(&shapes::cow(), DVec3::ZERO, DQuat::from_rotation_x(0.3));
    let ball = bodies::at(&shapes::ball(0.5), DVec3::new(0.0, 0.7, 0.0));
    let mut world = worlds::world([cow, ball]);
    let [overlap] = world.overlaps()[..] else {
        panic!("they overlap");
    };
    // Moved by the depth they touch, and slightly farther they are apart.
    let place = world.position(1);
    for (part, meets) in [(1.0 - 1e-9, true), (1.0 + 1e-9, false)] {
        let there = place + part * overlap.depth * overlap.normal;
        world.set_position(1, there).expect("a place");
        assert_eq!(!world.overlapping().is_empty(), meets, "{part}");
    }
}

#[test]
fn turning_bodies_are_moved_out_of_each_other() {
    let mut random = Random::splitmix(8);
    for shape in [
        shapes::cuboid([0.5; 3]),
        shapes::cuboid([1.0, 0.1, 0.3]),
        shapes::cow(),
    ] {
        let mut all = vec![bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO)];
        for _ in 0..4 {
            let rotation = DQuat::from_axis_angle(random.direction(), random.from(0.0, 3.0));
            let place = 0.4 * random.vector() + 0.3 * DVec3::Y;
            all.push(turned(&shape, place, rotation));
        }
        all.push(bodies::at(&shapes::ball(0.4), 0.2 * DVec3::Y));
        for collision in [Collision::Continuous, Collision::Bvh] {
            let settings = Settings {
                collision,
                ..Settings::default()
            };
            let mut world = worlds::world_of(settings, &all);
            let turns: Vec<DQuat> = (0..world.len()).map(|body| world.rotation(body)).collect();
            assert!(world.overlaps().len() > 4, "{}", world.overlaps().len());
            let moved = world.separate().expect("there is room");
            assert!(moved.len() > 2, "{moved:?}");
            assert_eq!(world.overlaps(), []);
            assert_eq!(world.overlapping(), []);
            let now: Vec<DQuat> = (0..world.len()).map(|body| world.rotation(body)).collect();
            assert_eq!(now, turns);
            worlds::add_gravity(&mut world, -9.81 * DVec3::Y);
            for _ in 0..10 {
                worlds::step(&mut world, 1);
                assert_eq!(world.meeting(), []);
            }
        }
    }
}
