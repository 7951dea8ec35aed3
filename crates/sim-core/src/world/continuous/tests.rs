//! Regression tests.

use alloc::{sync::Arc, vec::Vec};
use glam::DVec3;

use super::{super::scene::scene, position_correction::Correction};
use crate::{
    Body, BodyKind, Force, METHODS, Method, Settings, Shape, StepError, World, test_meshes::cube,
};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn world(bodies: impl IntoIterator<Item = Body>) -> World {
    let method = Method::named("velocity-verlet").unwrap();
    let settings = Settings {
        method,
        ..Settings::default()
    };
    let mut world = World::new(settings).unwrap();
    for body in bodies {
        world.add(body).unwrap();
    }
    world
}

fn body(shape: impl Into<Shape>, position: DVec3, velocity: DVec3) -> Body {
    Body {
        shape: Some(shape.into()),
        position,
        velocity,
        ..Body::default()
    }
}

fn ball(radius: f64) -> Shape {
    Shape::Sphere { radius }
}

fn floor() -> Body {
    Body {
        kind: BodyKind::Kinematic,
        ..body(
            Shape::HalfSpace { normal: DVec3::Y },
            DVec3::ZERO,
            DVec3::ZERO,
        )
    }
}

#[test]
fn bodies_in_overlap_may_become_immovable() {
    let cube = Arc::new(cube());
    let mut world = world([
        body(cube.clone(), v(-0.25, 0.0, 0.0), v(-0.1, 0.0, 0.0)),
        body(cube, v(0.25, 0.0, 0.0), v(0.1, 0.0, 0.0)),
    ]);
    world.step().unwrap();
    assert_eq!(world.overlapping(), [(0, 1)]);
    for (body, speed) in [(0, 1.0), (1, -1.0)] {
        world.set_kind(body, BodyKind::Kinematic).unwrap();
        world.set_velocity(body, v(speed, 0.0, 0.0)).unwrap();
    }
    for _ in 0..90 {
        world.step().unwrap();
    }
    assert!((world.position(0).x + 0.25 - 1.5).abs() < 0.01);
    // The body is movable again while the two are in overlap, from which they may separate.
    world.set_position(1, v(1.5, 0.25, 0.0)).unwrap();
    world.set_kind(1, BodyKind::Dynamic).unwrap();
    world.set_velocity(1, v(9.0, 0.0, 0.0)).unwrap();
    assert_eq!(world.overlapping(), [(0, 1)]);
    for _ in 0..60 {
        world.step().unwrap();
    }
    assert!(world.overlapping().is_empty() && world.position(1).x > 10.0);
}

#[test]
fn impacts_at_the_same_time_elsewhere_are_none_of_ours() {
    let pair = |x: f64, restitution: f64| {
        [-1.0, 1.0].map(|side| Body {
            restitution,
            ..body(ball(0.5), v(x, side, 0.0), v(0.0, -8.0 * side, 0.0))
        })
    };
    let mut world = world(pair(-32.0, 1.0).into_iter().chain(pair(32.0, 0.0)));
    let mut impacts = Vec::new();
    for _ in 0..60 {
        world.step_reporting(&mut impacts).unwrap();
    }
    assert_eq!(impacts.len(), 2);
    assert_eq!(impacts[0].time, impacts[1].time);
    let speeds = [0, 1, 2, 3].map(|i| world.velocity(i).y);
    assert_eq!(speeds, [-8.0, 8.0, 0.0, 0.0]);
}

#[test]
fn what_looks_flush_stands() {
    let cube = Arc::new(cube());
    for depth in [1e-9, 1e-8] {
        for shape in [ball(0.5), Shape::Mesh(cube.clone())] {
            let start = v(0.0, 0.5 - depth, 0.0);
            let mut world = world([floor(), body(shape, start, DVec3::ZERO)]);
            let acceleration = v(0.0, -9.81, 0.0);
            world.add_force(Force::Gravity { acceleration }).unwrap();
            for _ in 0..600 {
                world.step().unwrap();
            }
            assert!(world.overlapping().is_empty());
            assert!((world.position(1).y - 0.5).abs() < 2.0 * depth + 1e-12);
        }
    }
}

#[test]
fn a_failed_step_reports_nothing() {
    let bodies = [
        body(ball(0.5), v(-1.0, 0.0, 0.0), v(9.0, 0.0, 0.0)),
        body(ball(0.5), v(0.1, 0.0, 0.0), DVec3::ZERO),
        // Hits the light ball, which leaves at nearly twice the speed of this one, beyond the range.
        Body {
            mass: 1e6,
            ..body(ball(0.5), v(50.0, 0.0, 0.0), v(6e99, 0.0, 0.0))
        },
        body(ball(0.5), v(52.0, 0.0, 0.0), DVec3::ZERO),
    ];
    let mut world = world(bodies);
    let mut impacts = Vec::new();
    assert!(world.step_reporting(&mut impacts).is_err());
    assert_eq!((impacts.len(), world.impacts()), (0, 0));
    assert!(world.last_impact().is_none());
    world.set_velocity(2, DVec3::ZERO).unwrap();
    for _ in 0..60 {
        world.step_reporting(&mut impacts).unwrap();
    }
    assert_eq!((impacts.len(), world.impacts()), (1, 1));
}

#[test]
fn inelastic_rows_come_to_an_end() {
    let row = (0..30).map(|i| Body {
        restitution: 0.3,
        ..body(
            ball(0.5),
            v(0.0, 1.0 + 1.5 * f64::from(i), 0.0),
            v(0.0, -10.0, 0.0),
        )
    });
    let mut world = world([floor()].into_iter().chain(row));
    for _ in 0..600 {
        world.step().unwrap();
    }
    assert!(world.impacts() < 1_000_000, "{}", world.impacts());
}

/// A ball dropped from 5 m. The steps of every method that is exact for its order are points of one parabola. Each
/// bounce reverses it, and no height is lost.
#[test]
fn no_method_loses_height_at_a_bounce() {
    for method in METHODS {
        let settings = Settings {
            method,
            ..Settings::default()
        };
        let mut world = World::new(settings).unwrap();
        world.add(floor()).unwrap();
        let g = 9.81;
        world
            .add(body(ball(0.0), v(0.0, 5.0, 0.0), DVec3::ZERO))
            .unwrap();
        let acceleration = v(0.0, -g, 0.0);
        world.add_force(Force::Gravity { acceleration }).unwrap();
        let lag = (method.fall.unwrap() - 0.5) * settings.dt;
        let energy = |world: &World| {
            let speed = world.velocity(1).y - lag * g;
            0.5 * speed * speed + g * world.position(1).y
        };
        let start = energy(&world);
        while world.impacts() < 1000 {
            world.step().unwrap();
        }
        let error = (energy(&world) / start - 1.0).abs();
        assert!(error < 1e-12, "{}: {error:e}", method.name);
    }
}

/// A cube between two slabs that approach from both sides and do not stop.
fn squeezed(restitution: f64) -> World {
    let cube = Arc::new(cube());
    let slab = |side: f64| Body {
        kind: BodyKind::Kinematic,
        ..body(cube.clone(), v(1.25 * side, 0.0, 0.0), v(-side, 0.0, 0.0))
    };
    let caught = Body {
        restitution,
        ..body(cube.clone(), v(0.1, 0.0, 0.0), v(0.3, 0.0, 0.0))
    };
    world([slab(-1.0), slab(1.0), caught])
}

#[test]
fn what_is_squeezed_is_named_soon() {
    for restitution in [1.0, 0.5, 0.0] {
        let mut world = squeezed(restitution);
        let error = (0..60).find_map(|_| world.step().err()).unwrap();
        let StepError::Squeezed { body, between, .. } = error else {
            panic!("{restitution}: {error}");
        };
        assert_eq!((body, between), (2, (0, 1)), "{restitution}");
        // There is room until the end of the 15th step.
        assert!((14..=15).contains(&world.steps()), "{restitution}");
        assert!(world.impacts() < 100_000, "{restitution}");
    }
}

/// Bodies that meet at a step's end, which rounding should never cause.
#[test]
fn what_is_put_back_leaves_immovable_bodies_where_they_are() {
    let cube = Arc::new(cube());
    let lift = Body {
        kind: BodyKind::Kinematic,
        ..body(cube.clone(), v(0.0, 0.0, 0.0), v(0.0, 1.0, 0.0))
    };
    let on_it =
        [1.0, 2.0].map(|level| body(cube.clone(), v(0.0, 1.25 * level, 0.0), v(0.0, -1.0, 0.0)));
    let mut world = world([lift].into_iter().chain(on_it));
    world.step().unwrap();
    world.current.position[0].y += 0.5;
    world.current.position[1].y -= 0.5;
    let lifted = world.current.position[0];
    let mut correction = Correction {
        scene: &scene!(world),
        end: &mut world.current,
        contacts: &world.contacts,
        record: &mut world.record,
    };
    let mut near = alloc::vec![(0, 1)];
    assert!(correction.separate_meeting(&mut near).is_ok());
    assert_eq!(world.position(0), lifted);
    for (i, j) in [(0, 1), (1, 2), (0, 2)] {
        let offset = world.position(j) - world.position(i);
        assert!(!world.bodies.meet_at(i, j, offset), "{i} and {j}");
    }
}

/// An immovable body that hits a bystander far away does not squeeze these two blocks. The light block has some
/// 157,000 impacts with a wall at rest.
#[test]
fn who_moves_elsewhere_squeezes_nobody() {
    let immovable = |body| Body {
        kind: BodyKind::Kinematic,
        ..body
    };
    let mut blocks = world([
        immovable(body(
            Shape::HalfSpace { normal: DVec3::X },
            DVec3::ZERO,
            DVec3::ZERO,
        )),
        body(ball(0.25), v(1.0, 0.0, 0.0), DVec3::ZERO),
        Body {
            mass: 1e10,
            ..body(ball(0.25), v(2.0, 0.0, 0.0), v(-1.0, 0.0, 0.0))
        },
        immovable(body(ball(0.5), v(0.0, 100.0, 0.0), v(0.0, 2.0, 0.0))),
        body(ball(0.5), v(0.0, 101.5, 0.0), DVec3::ZERO),
    ]);
    let settings = Settings {
        dt: 4.0,
        ..*blocks.settings()
    };
    blocks.set_settings(settings).unwrap();
    blocks.step().unwrap();
    assert!(blocks.impacts() > 314_000, "{}", blocks.impacts());
    assert_eq!(blocks.velocity(4), v(0.0, 4.0, 0.0));
}

/// A row of balls between two walls that close on each other; no ball meets both.
#[test]
fn a_row_is_squeezed_too() {
    let wall = |side: f64| Body {
        kind: BodyKind::Kinematic,
        ..body(
            Shape::HalfSpace {
                normal: v(-side, 0.0, 0.0),
            },
            v(4.0 * side, 0.0, 0.0),
            v(-side, 0.0, 0.0),
        )
    };
    let row = [-2.0, 0.0, 2.0].map(|x| body(ball(0.5), v(x, 0.0, 0.0), v(0.3 * x, 0.0, 0.0)));
    let mut world = world([wall(-1.0), wall(1.0)].into_iter().chain(row));
    let error = (0..600).find_map(|_| world.step().err()).unwrap();
    let StepError::Squeezed { between, .. } = error else {
        panic!("{error}");
    };
    assert_eq!(between, (0, 1));
    assert!((2.4..2.6).contains(&world.time()), "{}", world.time());
}

/// A body between walls that fit it, and in the corner of three.
#[test]
fn what_has_no_room_stops_the_step_soon() {
    let wall = |normal: DVec3, far: f64| Body {
        kind: BodyKind::Kinematic,
        ..body(Shape::HalfSpace { normal }, far * normal, DVec3::ZERO)
    };
    let directions = |count: i32| {
        (0..count).map(move |k| {
            let angle = core::f64::consts::TAU * f64::from(k) / f64::from(count);
            v(libm::cos(angle), libm::sin(angle), 0.0)
        })
    };
    let mut refused = 0;
    for count in [2, 3, 5] {
        for room in [0.0, 1e-15, 1e-14] {
            for velocity in [v(1.0, 0.0, 0.0), v(0.8, -0.6, 0.3), v(100.0, 1.0, 0.0)] {
                let walls = directions(count).map(|normal| wall(normal, -0.5 - room));
                let caught = body(ball(0.5), DVec3::ZERO, velocity);
                let elsewhere = body(ball(0.5), v(0.0, 0.0, 40.0), DVec3::ZERO);
                let mut world = world(walls.chain([caught, elsewhere]));
                let before = world.state_hash();
                // Some bodies come to rest by rounding.
                let Err(error) = world.step() else {
                    continue;
                };
                refused += 1;
                let StepError::TooManyImpacts { body, impacts, .. } = error else {
                    panic!("{error}");
                };
                assert!(body == count as usize && impacts < 100_000, "{error}");
                assert_eq!(world.state_hash(), before);
            }
        }
    }
    assert!(refused >= 12, "{refused}");
}

/// A step fails after bodies have been moved apart by a rounding, with impacts, and with a body at rest. The world is
/// as if the step had not been tried.
#[test]
fn a_failed_step_changes_nothing() {
    let cube = Arc::new(cube());
    let mut world = squeezed(1.0);
    world
        .add(Body {
            position: v(0.0, -7.0, 0.0),
            ..floor()
        })
        .unwrap();
    // The blocks overlap by a rounding.
    for level in 0..3 {
        let at = v(20.1, -6.5 + f64::from(level) * (1.0 - 1e-9), 0.3);
        let stacked = body(cube.clone(), at, DVec3::ZERO);
        let force = v(0.0, -9.81, 0.0);
        world.add(Body { force, ..stacked }).unwrap();
    }
    // The slabs close within the step.
    let settings = Settings {
        dt: 0.5,
        ..*world.settings()
    };
    world.set_settings(settings).unwrap();
    let placed = world.clone();
    let hash = world.state_hash();
    let error = world.step().unwrap_err();
    assert_eq!(world.state_hash(), hash);
    assert_eq!(world.step().unwrap_err(), error);
    assert_eq!(world.state_hash(), hash);
    assert_eq!(world.overlapping(), placed.overlapping());
    // Both worlds continue alike once the slabs stop.
    let mut fresh = placed;
    for world in [&mut world, &mut fresh] {
        for slab in [0, 1] {
            world.set_velocity(slab, DVec3::ZERO).unwrap();
        }
        for _ in 0..3 {
            world.step().unwrap();
        }
    }
    assert_eq!(world.state_hash(), fresh.state_hash());
    // The same after successful steps.
    for (slab, speed) in [(0, 1.0), (1, -1.0)] {
        world.set_velocity(slab, v(speed, 0.0, 0.0)).unwrap();
    }
    let hash = world.state_hash();
    world.step().unwrap_err();
    assert_eq!(world.state_hash(), hash);
}
