//! Bodies that never collide do not influence each other in any mode.

use kit::bodies::{at, body, wall};
use kit::shapes::{ball, cow, cube};
use kit::worlds::{add_gravity, step, world_of};
use sim_core::{Body, Collision, DVec3, Force, Groups, Settings, Shape, World, WorldError};

use super::MODES;

fn world_in(collision: Collision, bodies: impl IntoIterator<Item = Body>) -> World {
    let settings = Settings {
        collision,
        ..Settings::default()
    };
    world_of(settings, bodies)
}

/// Two bodies of a shape that move towards each other.
fn meeting(shape: &Shape) -> [Body; 2] {
    let side = |sign: f64| body(shape, 2.5 * sign * DVec3::X, -2.0 * sign * DVec3::X);
    [side(-1.0), side(1.0)]
}

const A: u32 = 1;
const B: u32 = 2;

#[test]
fn both_have_to_collide_with_the_other() {
    let shy = Groups {
        member_of: A,
        collides_with: B,
    };
    let open = Groups {
        member_of: B,
        ..Groups::ALL
    };
    assert!(!shy.collide(shy) && shy.collide(open) && open.collide(shy));
    assert!(!Groups::NONE.collide(Groups::ALL) && Groups::ALL.collide(Groups::ALL));
}

#[test]
fn what_is_filtered_passes_and_what_is_not_bounces() {
    let shy = Groups {
        member_of: A,
        collides_with: B,
    };
    for collision in MODES {
        for shape in [ball(0.5), cube(), cow()] {
            for (groups, ignored, impacts) in [
                (Groups::ALL, false, 1),
                (shy, false, 0),
                (Groups::ALL, true, 0),
            ] {
                let bodies = meeting(&shape).map(|body| Body { groups, ..body });
                let mut world = world_in(collision, bodies);
                if ignored {
                    world.ignore_pair(1, 0).expect("a pair");
                }
                // A few bodies are tested one by one, many through boxes.
                for many in [false, true] {
                    let mut world = world.clone();
                    if many {
                        for i in 0..20 {
                            let far = (20.0 + 3.0 * f64::from(i)) * DVec3::Y;
                            world.add(at(&shape, far)).expect("a body");
                        }
                    }
                    for _ in 0..150 {
                        world.step().expect("a step");
                        assert_eq!(world.overlapping(), []);
                        assert_eq!((world.contacts().count(), world.meeting()), (0, vec![]));
                    }
                    assert_eq!(world.impacts(), impacts, "{collision:?} {groups:?}");
                    assert_eq!(world.position(0).x > 0.0, impacts == 0);
                }
            }
        }
    }
}

#[test]
fn what_is_filtered_is_not_in_overlap_and_not_moved_out_of_it() {
    for collision in MODES {
        let bodies = [at(&cube(), DVec3::ZERO), at(&cube(), 0.4 * DVec3::Y)];
        let mut world = world_in(collision, bodies);
        assert_eq!(world.overlapping(), [(0, 1)]);
        world.ignore_pair(0, 1).expect("a pair");
        assert_eq!((world.overlapping(), world.overlap(0, 1)), (&[][..], None));
        assert_eq!(world.separate(), Ok(vec![]));
        step(&mut world, 3);
        assert_eq!(world.position(1), 0.4 * DVec3::Y);
        // They collide again once the pair is heeded.
        world.heed_pair(1, 0).expect("a pair");
        assert_eq!(world.overlapping(), [(0, 1)]);
        assert_eq!(world.separate().expect("room"), [0, 1]);
        assert_eq!(world.ignored_pairs().count(), 0);
        // The same by groups.
        world.set_position(0, world.position(1)).expect("a place");
        world.set_groups(0, Groups::NONE).expect("groups");
        assert_eq!(world.overlapping(), []);
        world.set_groups(0, Groups::ALL).expect("groups");
        assert_eq!(world.overlapping(), [(0, 1)]);
    }
}

#[test]
fn a_floor_that_is_no_longer_heeded_lets_fall_what_lies_on_it() {
    let lying = Body {
        restitution: 0.0,
        ..at(&cube(), 0.5 * DVec3::Y)
    };
    let floor = wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO);
    for by_groups in [true, false] {
        let mut world = world_in(Collision::Continuous, [floor.clone(), lying.clone()]);
        add_gravity(&mut world, -9.81 * DVec3::Y);
        step(&mut world, 30);
        assert_eq!(world.contacts().count(), 1);
        match by_groups {
            true => world.set_groups(1, Groups::NONE).expect("groups"),
            false => world.ignore_pair(0, 1).expect("a pair"),
        }
        assert_eq!(world.contacts().count(), 0);
        step(&mut world, 30);
        assert!((world.position(1).y - 0.5 + 0.5 * 9.81 * 0.25).abs() < 1e-6);
    }
}

#[test]
fn bodies_on_a_spring_may_go_through_each_other_and_through_no_other() {
    let rest = 0.25;
    for collision in MODES {
        let apart = |x: f64| at(&ball(0.5), x * DVec3::X);
        let mut world = world_in(collision, [apart(0.0), apart(1.0), apart(-2.0)]);
        world.set_velocity(2, 3.0 * DVec3::X).expect("a velocity");
        let spring = Force::Spring {
            bodies: [0, 1],
            points: None,
            rest_length: rest,
            stiffness: 4.0,
            damping: 0.0,
        };
        world.add_force(spring).expect("a spring");
        world.ignore_pair(0, 1).expect("a pair");
        let mut nearest = f64::INFINITY;
        for _ in 0..120 {
            world.step().expect("a step");
            nearest = nearest.min(world.position(0).distance(world.position(1)));
        }
        assert!(nearest < 0.5, "{nearest}");
        assert!(world.impacts() > 0, "with the third");
    }
}

#[test]
fn pairs_and_groups_follow_their_bodies_and_cost_nothing_once_gone() {
    let balls = (0..5).map(|i| at(&ball(0.5), f64::from(3 * i) * DVec3::X));
    let mut world = world_in(Collision::Continuous, balls);
    world.set_groups(3, Groups::NONE).expect("groups");
    world.ignore_pair(4, 1).expect("a pair");
    world.ignore_pair(0, 2).expect("a pair");
    world.remove(2).expect("it is there");
    assert_eq!(world.ignored_pairs().collect::<Vec<_>>(), [(1, 3)]);
    assert_eq!([0, 2].map(|i| world.groups(i)), [Groups::ALL, Groups::NONE]);
    for refused in [world.ignore_pair(1, 1), world.heed_pair(2, 2)] {
        assert!(matches!(refused, Err(WorldError::SameBody { .. })));
    }
    assert!(world.ignore_pair(0, 4).is_err() && world.set_groups(4, Groups::ALL).is_err());
}
