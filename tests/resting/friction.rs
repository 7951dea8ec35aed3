//! Coulomb friction of bodies that only translate.

use cases::scenes::{landing_way, sliding_way};
use kit::shapes::{ball, cube};
use kit::worlds::{GRAVITY, set_rate, step};
use sim_core::{Body, BodyKind, DVec3, METHODS, Method, World};

use crate::scenes::{ground, rk4, world};

/// A floor and a body on it, both with a coefficient of friction.
fn on_floor(method: &'static Method, friction: f64, body: Body) -> World {
    let mut world = world(method);
    let floor = Body {
        friction,
        ..ground(DVec3::Y, DVec3::ZERO)
    };
    world.add(floor).expect("a floor");
    world.add(Body { friction, ..body }).expect("a body");
    world
}

/// Normal and downhill direction of a plane that falls by `slope` m for each m along -x.
fn slope_of(slope: f64) -> (DVec3, DVec3) {
    let cos = 1.0 / (1.0 + slope * slope).sqrt();
    let normal = DVec3::new(-slope * cos, cos, 0.0);
    (normal, DVec3::new(-cos, -slope * cos, 0.0))
}

#[test]
fn what_slides_comes_to_rest_where_it_must() {
    let (friction, speed) = (0.4, 5.0);
    let way = sliding_way(speed, friction);
    let mut slides = 0;
    for method in METHODS {
        for shape in [ball(0.5), cube()] {
            for restitution in [0.0, 0.5, 1.0] {
                for direction in 0..12 {
                    let (sin, cos) = (f64::from(direction) * 30.0_f64.to_radians()).sin_cos();
                    let along = DVec3::new(cos, 0.0, sin);
                    let slider = Body {
                        shape: Some(shape.clone()),
                        position: 0.5 * DVec3::Y,
                        velocity: speed * along,
                        restitution,
                        ..Body::default()
                    };
                    let mut world = on_floor(method, friction, slider);
                    world.set_restitution(0, restitution).expect("a floor");
                    step(&mut world, 120);
                    let at = world.position(1) - 0.5 * DVec3::Y;
                    // First-order methods have the velocity of half a step before or after.
                    let tolerance = match method.order {
                        1 => 0.51 * speed / 60.0,
                        _ => 1e-12,
                    };
                    let error = (at - way * along).length();
                    assert!(error <= tolerance, "{} {direction}: {error:e}", method.name);
                    assert_eq!(world.velocity(1), DVec3::ZERO, "{}", method.name);
                    slides += 1;
                }
            }
        }
    }
    assert_eq!(slides, 11 * 2 * 3 * 12);
}

#[test]
fn first_order_methods_err_in_proportion_to_the_step() {
    for method in METHODS.into_iter().filter(|method| method.order == 1) {
        let error = |rate: f64| {
            let slider = Body {
                shape: Some(cube()),
                position: 0.5 * DVec3::Y,
                velocity: 5.0 * DVec3::X,
                restitution: 0.0,
                ..Body::default()
            };
            let mut world = on_floor(method, 0.4, slider);
            set_rate(&mut world, rate);
            step(&mut world, (2.0 * rate) as u64);
            (world.position(1).x - sliding_way(5.0, 0.4)).abs()
        };
        let ratio = error(60.0) / error(240.0);
        assert!((3.8..4.2).contains(&ratio), "{}: {ratio}", method.name);
    }
}

#[test]
fn a_slope_holds_below_its_threshold_and_not_above() {
    let slope: f64 = 0.5;
    let (normal, down) = slope_of(slope);
    for (excess, holds) in [(1e-9, true), (1e-6, true), (-1e-9, false), (-1e-2, false)] {
        for turned in 0..3 {
            let turn = sim_core::DQuat::from_rotation_y(f64::from(turned) * 1.1);
            let friction = slope + excess;
            let mut world = world(rk4());
            let ramp = Body {
                friction,
                ..ground(turn * normal, DVec3::ZERO)
            };
            world.add(ramp).expect("a slope");
            let start = 0.5 * (turn * normal);
            let stone = Body {
                shape: Some(ball(0.5)),
                position: start,
                friction,
                restitution: 0.0,
                ..Body::default()
            };
            world.add(stone).expect("a stone");
            step(&mut world, 1);
            let first = world.position(1);
            step(&mut world, 599);
            if holds {
                assert_eq!(world.velocity(1), DVec3::ZERO, "{excess} {turned}");
                assert_eq!(world.position(1), first, "{excess} {turned}");
            } else {
                let way = 0.5 * GRAVITY * normal.y * (slope - friction) * 100.0;
                let error = (world.position(1) - start - way * (turn * down)).length();
                assert!(error <= 1e-12 + 1e-6 * way, "{excess} {turned}: {error:e}");
            }
        }
    }
}

#[test]
fn sliding_across_a_slope_converges_to_second_order() {
    // It turns downhill all the time. There is no closed form, so it is compared with itself.
    let end = |rate: f64| {
        let (normal, _) = slope_of(0.5);
        let mut world = world(rk4());
        set_rate(&mut world, rate);
        let ramp = Body {
            friction: 0.3,
            ..ground(normal, DVec3::ZERO)
        };
        world.add(ramp).expect("a slope");
        let stone = Body {
            shape: Some(ball(0.5)),
            position: 0.5 * normal,
            velocity: 3.0 * DVec3::Z,
            friction: 0.3,
            restitution: 0.0,
            ..Body::default()
        };
        world.add(stone).expect("a stone");
        step(&mut world, rate as u64);
        world.position(1)
    };
    let exact = end(3840.0);
    let errors = [60.0, 120.0, 240.0].map(|rate| (end(rate) - exact).length());
    assert!(errors[0] < 1e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 3.5, "{errors:?}");
    }
}

#[test]
fn belts_and_lifts_carry_what_lies_on_them() {
    let (friction, belt) = (0.2, 2.0);
    for shape in [ball(0.5), cube()] {
        let cargo = Body {
            shape: Some(shape),
            position: 0.5 * DVec3::Y,
            restitution: 0.0,
            ..Body::default()
        };
        let mut carried = on_floor(rk4(), friction, cargo.clone());
        carried.set_velocity(0, belt * DVec3::X).expect("a belt");
        step(&mut carried, 240);
        let slipping = belt / (friction * GRAVITY);
        let at = belt * 4.0 - 0.5 * belt * slipping;
        assert!((carried.position(1).x - at).abs() < 1e-12);
        assert!((carried.velocity(1).x - belt).abs() < 1e-12);
        // Up, to the side, and down again: it stays where it lies.
        let mut lifted = on_floor(rk4(), friction, cargo);
        for (up, steps) in [(1.0, 60), (0.0, 60), (-1.0, 60), (0.0, 600)] {
            lifted
                .set_velocity(0, DVec3::new(0.0, up, 0.0))
                .expect("a lift");
            step(&mut lifted, steps);
        }
        let offset = lifted.position(1) - lifted.position(0);
        assert!(
            offset.x.abs() < 1e-12 && (offset.y - 0.5).abs() < 1e-9,
            "{offset}"
        );
    }
}

#[test]
fn a_pile_on_a_belt_speeds_up_as_one() {
    let mut world = world(rk4());
    let belt = Body {
        friction: 0.2,
        velocity: DVec3::X,
        ..ground(DVec3::Y, DVec3::ZERO)
    };
    world.add(belt).expect("a belt");
    for level in 0..5 {
        let brick = Body {
            shape: Some(cube()),
            position: DVec3::new(0.0, 0.5 + f64::from(level), 0.0),
            friction: 0.3,
            restitution: 0.0,
            ..Body::default()
        };
        world.add(brick).expect("a brick");
    }
    // The coefficient of belt and brick: the geometric mean.
    let friction = (0.2_f64 * 0.3).sqrt();
    step(&mut world, 120);
    let at = 2.0 - 0.5 / (friction * GRAVITY);
    for brick in 1..6 {
        assert!((world.velocity(brick).x - 1.0).abs() < 1e-12, "{brick}");
        let x = world.position(brick).x;
        assert!((x - at).abs() < 1e-11, "{brick}: {x} for {at}");
    }
}

#[test]
fn bounces_rub_in_proportion_to_what_they_press() {
    for (friction, restitution) in [(0.1, 0.5), (0.3, 1.0), (f64::INFINITY, 0.8)] {
        let thrown = Body {
            shape: Some(ball(0.5)),
            position: 0.6 * DVec3::Y,
            velocity: DVec3::new(3.0, -2.0, 4.0),
            restitution,
            ..Body::default()
        };
        let mut world = on_floor(rk4(), friction, thrown);
        world.set_restitution(0, restitution).expect("a floor");
        let mut impacts = Vec::new();
        while impacts.is_empty() {
            world.step_reporting(&mut impacts).expect("a step");
        }
        // Both slide at 5 m/s: the friction impulse is the coefficient times the normal impulse that reverses the fall.
        let lost = (friction * (1.0 + restitution) * impacts[0].speeds.0).min(5.0);
        let sliding = DVec3::new(3.0, 0.0, 4.0) * (1.0 - lost / 5.0);
        let velocity = world.velocity(1);
        let error = (velocity - velocity.y * DVec3::Y - sliding).length();
        assert!(error < 1e-14, "{friction}: {error:e}");
    }
}

#[test]
fn what_is_smooth_or_free_is_not_rubbed() {
    for (floor, slider) in [(0.0, 0.7), (0.7, 0.0)] {
        let body = Body {
            shape: Some(cube()),
            position: 0.5 * DVec3::Y,
            velocity: DVec3::new(1.0, 0.0, 0.25),
            restitution: 0.0,
            ..Body::default()
        };
        let mut world = on_floor(rk4(), 0.0, body.clone());
        world.set_friction(0, floor).expect("a floor");
        world.set_friction(1, slider).expect("a slider");
        step(&mut world, 100);
        assert_eq!(world.velocity(1), body.velocity);
    }
}

/// Pushed, at any scale and rate: it stays at rest up to the limit of friction, and is accelerated by the excess
/// beyond.
#[test]
fn what_is_pushed_moves_by_what_friction_leaves() {
    let mut pushes = 0;
    for scale in [1e-6, 1.0, 1e6] {
        for rate in [10.0, 60.0, 1000.0] {
            for (excess, seconds) in [(-1e-6, 2.0), (1e-3, 2.0), (1.0, 2.0)] {
                let friction = 0.25;
                let force = friction * GRAVITY * (1.0 + excess) * DVec3::X;
                let pushed = Body {
                    shape: Some(ball(0.5 * scale)),
                    position: 0.5 * scale * DVec3::Y,
                    force,
                    restitution: 0.0,
                    ..Body::default()
                };
                let mut world = on_floor(rk4(), friction, pushed);
                set_rate(&mut world, rate);
                step(&mut world, (seconds * rate) as u64);
                let way = 0.5 * friction * GRAVITY * excess.max(0.0) * seconds * seconds;
                let error = (world.position(1).x - way).abs();
                assert!(
                    error <= 1e-12 * scale.max(1.0),
                    "{scale} {rate} {excess}: {error:e}"
                );
                if excess < 0.0 {
                    assert_eq!(world.velocity(1), DVec3::ZERO);
                }
                pushes += 1;
            }
        }
    }
    assert_eq!(pushes, 27);
}

/// Off the edge of a table: with the speed that friction has left, and down from where its rear edge leaves.
#[test]
fn what_slides_off_an_edge_falls_from_there() {
    let (friction, speed, way): (f64, f64, f64) = (0.3, 3.0, 1.2);
    for method in METHODS.into_iter().filter(|method| method.order > 1) {
        let mut world = world(method);
        let brick = Body {
            shape: Some(cube()),
            friction,
            restitution: 0.0,
            ..Body::default()
        };
        // Two cubes form a table that is long enough.
        for x in [-1.0, 0.0] {
            let table = Body {
                position: x * DVec3::X,
                kind: BodyKind::Static,
                ..brick.clone()
            };
            world.add(table).expect("a table");
        }
        let slider = Body {
            position: DVec3::new(1.0 - way, 1.0, 0.0),
            velocity: speed * DVec3::X,
            ..brick
        };
        world.add(slider).expect("a slider");
        step(&mut world, 60);
        let slowing = friction * GRAVITY;
        let leaving = (speed * speed - 2.0 * slowing * way).sqrt();
        let falling = 1.0 - (speed - leaving) / slowing;
        let fallen = 0.5 * GRAVITY * falling * falling;
        let at = DVec3::new(1.0 + leaving * falling, 1.0 - fallen, 0.0);
        let error = (world.position(2) - at).length();
        assert!(error < 1e-9, "{}: {error:e}", method.name);
    }
}

/// The listed contacts of a world carry the weight of the bodies on them, even during sleep.
#[test]
fn contacts_carry_what_lies_on_them() {
    let (normal, _) = slope_of(0.3);
    let mut world = world(rk4());
    let ramp = Body {
        friction: 0.5,
        ..ground(normal, DVec3::ZERO)
    };
    world.add(ramp).expect("a slope");
    let stone = Body {
        shape: Some(ball(0.5)),
        mass: 3.0,
        position: 0.5 * normal,
        friction: 0.5,
        restitution: 0.0,
        ..Body::default()
    };
    world.add(stone).expect("a stone");
    assert_eq!((world.contacts().count(), world.contact_steps()), (0, 0));
    for steps in 1..50 {
        step(&mut world, 1);
        let contacts: Vec<_> = world.contacts().collect();
        assert_eq!((contacts.len(), world.contact_steps()), (1, steps));
        let weight = 3.0 * GRAVITY * DVec3::Y;
        let error = (contacts[0].force - weight).length();
        assert!(error < 1e-9, "{steps}: {error:e}");
        assert_eq!(contacts[0].bodies, (0, 1));
    }
}

/// A landing reduces the sliding momentum by the coefficient times its impulse, and the rest is a normal slide: a
/// single body that has landed once is no heap.
#[test]
fn what_lands_slides_to_its_exact_end() {
    let (friction, speed) = (0.4, 3.0);
    for shape in [ball(0.5), cube()] {
        for height in [1e-12_f64, 1e-6, 1e-3, 0.1] {
            let slider = Body {
                shape: Some(shape.clone()),
                position: (0.5 + height) * DVec3::Y,
                velocity: speed * DVec3::X,
                restitution: 0.0,
                ..Body::default()
            };
            let mut world = on_floor(rk4(), friction, slider);
            for _ in 0..90 {
                step(&mut world, 1);
                assert_eq!(world.bundled().bodies, 0, "dropped by {height} m");
            }
            let way = landing_way(height, speed, friction);
            let off = world.position(1).x - way;
            assert!(off.abs() < 1e-9, "dropped by {height} m: off by {off:e} m");
            assert_eq!(world.velocity(1), DVec3::ZERO);
        }
    }
}
