//! Turning bodies that rest, slide, stack, tip and fall: the first scenes that a user tries.

use kit::{bodies, random::Random, shapes, worlds};
use sim_core::{
    Body, BodyKind, DQuat, DVec3, Force, Inertia, Settings, Shape, Turn, World, WorldError,
};

const G: f64 = 9.81;

fn cube(side: f64, position: DVec3, restitution: f64) -> Body {
    Body {
        turn: Some(Turn::default()),
        force: -G * DVec3::Y,
        restitution,
        ..bodies::at(&shapes::cuboid([0.5 * side as f32; 3]), position)
    }
}

fn floor(restitution: f64) -> Body {
    Body {
        restitution,
        ..bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO)
    }
}

fn table(restitution: f64) -> Body {
    let shape = shapes::cuboid([1.0, 0.5, 1.0]);
    Body {
        restitution,
        ..bodies::immovable(bodies::at(&shape, -0.5 * DVec3::Y))
    }
}

/// Kinetic and potential energy, J.
fn energy(world: &World) -> f64 {
    let bodies = (0..world.len()).filter(|&body| world.kind(body).is_movable());
    world.kinetic_energy()
        + bodies
            .map(|body| world.mass(body) * G * world.position(body).y)
            .sum::<f64>()
}

/// Makes steps, and checks that none adds energy or lets bodies meet.
fn watch(world: &mut World, steps: u64) {
    for step in 0..steps {
        let before = energy(world);
        worlds::step(world, 1);
        let gained = energy(world) - before;
        let size = world.kinetic_energy() + world.len() as f64 * G;
        // Once, touching bodies are moved to the gap at which they are kept.
        assert!(gained < 1e-12 * size, "step {step}: {gained:e} J");
        assert_eq!(world.meeting(), [], "step {step}");
    }
}

#[test]
fn what_is_dropped_comes_to_lie_on_a_face() {
    for restitution in [0.0, 0.5] {
        for angle in [0.0, 0.1, 0.6] {
            for ground in [floor(restitution), table(restitution)] {
                let axis = DVec3::new(1.0, 0.3, 0.7).normalize();
                let mut body = cube(1.0, 1.2 * DVec3::Y, restitution);
                let turn = body.turn.as_mut().unwrap();
                turn.rotation = DQuat::from_axis_angle(axis, angle);
                let mut world = worlds::world([ground, body]);
                watch(&mut world, 360);
                let (height, speed) = (world.position(1).y, world.velocity(1).length());
                assert!(
                    (height - 0.5).abs() < 1e-9,
                    "{restitution} {angle}: {height}"
                );
                assert!(speed < 1e-8 && world.spin(1).length() < 1e-8);
            }
        }
    }
}

#[test]
fn what_is_dropped_spinning_tips_over_and_spins_on_where_it_lies() {
    // On a smooth floor no torque acts about the vertical: that component of the spin stays constant.
    for (spin, restitution) in [
        (DVec3::new(3.0, 4.0, 0.0), 0.0),
        (DVec3::new(3.0, 4.0, 0.0), 0.3),
        (DVec3::new(-2.0, -1.0, 5.0), 0.3),
    ] {
        let mut body = cube(1.0, 5.0 * DVec3::Y, restitution);
        body.turn.as_mut().unwrap().spin = spin;
        let mut world = worlds::world([floor(restitution), body]);
        let start = energy(&world);
        for step in 0..720 {
            let before = energy(&world);
            worlds::step(&mut world, 1);
            let gained = energy(&world) - before;
            assert!(gained < 1e-8 * start, "{spin} step {step}: {gained:e} J");
            assert_eq!(world.meeting(), [], "step {step}");
        }
        let height = world.position(1).y;
        assert!((height - 0.5).abs() < 1e-4, "{spin}: {height}");
        assert!((world.spin(1).y - spin.y).abs() < 1e-3, "{}", world.spin(1));
        let lost = start - energy(&world);
        assert!(lost > 0.8 * start, "{lost} J of {start}");
    }
}

#[test]
fn a_heap_of_turning_cubes_comes_to_lie() {
    let walls = [DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z]
        .map(|normal| bodies::wall(normal, -0.8 * normal, DVec3::ZERO));
    let mut random = Random::splitmix(8);
    let cubes = (0..8).map(|k| {
        let place = |bit: u32| if k >> bit & 1 == 0 { -0.4 } else { 0.4 };
        let height = 0.6 + 0.9 * f64::from(k >> 2);
        let mut body = cube(0.5, DVec3::new(place(0), height, place(1)), 0.2);
        let turn = body.turn.as_mut().unwrap();
        turn.rotation = DQuat::from_rotation_x(0.4 * random.signed());
        turn.spin = random.vector();
        body
    });
    let all: Vec<Body> = walls.into_iter().chain([floor(0.2)]).chain(cubes).collect();
    let mut world = worlds::world(&all);
    let start = energy(&world);
    let mut gained = 0.0;
    for step in 0..120 {
        let before = energy(&world);
        worlds::step(&mut world, 1);
        gained += (energy(&world) - before).max(0.0);
        assert_eq!(world.meeting(), [], "step {step}");
    }
    println!("gained {gained:e} J of {start} J in all steps that gain");
    assert!(gained < 1e-4 * start, "{gained:e} J of {start} J");
    // Four on the floor and four on top of them.
    let lowest = 8.0 * G * 0.5;
    assert!(
        (energy(&world) / lowest - 1.0).abs() < 0.02,
        "{}",
        energy(&world)
    );
}

#[test]
fn stacks_that_start_in_touch_stand() {
    for restitution in [0.0, 0.5, 1.0] {
        for ground in [floor(restitution), table(restitution)] {
            let boxes = (0..3).map(|k| {
                let k = f64::from(k);
                cube(1.0, DVec3::new(0.1 * k, 0.5 + k, 0.0), restitution)
            });
            let mut world = worlds::world([ground].into_iter().chain(boxes));
            worlds::step(&mut world, 120);
            assert_eq!(world.overlapping(), []);
            for k in 0..3 {
                let off = world.position(k + 1).y - (0.5 + k as f64);
                assert!(off.abs() < 1e-9, "{restitution}: box {k} is off by {off:e}");
            }
        }
    }
}

#[test]
fn what_slides_down_a_smooth_slope_has_the_speed_that_it_must() {
    for (angle, scale) in [(0.3_f64, 1.0), (0.3, 1e-3), (0.8, 1e3)] {
        let normal = DVec3::new(-angle.sin(), angle.cos(), 0.0);
        let slope = Body {
            restitution: 0.0,
            ..bodies::wall(normal, DVec3::ZERO, DVec3::ZERO)
        };
        let mut body = cube(0.5 * scale, 0.25 * scale * normal, 0.0);
        body.turn.as_mut().unwrap().rotation = DQuat::from_rotation_z(angle);
        let mut world = worlds::world([slope, body]);
        worlds::step(&mut world, 60);
        let speed = world.velocity(1).length();
        let exact = G * angle.sin();
        assert!((speed / exact - 1.0).abs() < 1e-8, "{speed} for {exact}");
        let way = (world.position(1) - 0.25 * scale * normal).length();
        let ahead = way / (0.5 * exact) - 1.0;
        assert!(ahead.abs() < 1e-8, "{ahead}");
        assert!(world.spin(1).length() < 1e-6);
    }
}

#[test]
fn what_is_pushed_over_an_edge_tips_and_falls() {
    let mut body = cube(0.5, 0.25 * DVec3::Y, 0.0);
    body.velocity = DVec3::X;
    let ground = Body {
        position: -DVec3::Y,
        ..floor(0.0)
    };
    let mut world = worlds::world([table(0.0), ground, body]);
    watch(&mut world, 57);
    let before = world.velocity(2);
    assert!((before - DVec3::X).length() < 1e-9 && world.spin(2).length() < 1e-9);
    watch(&mut world, 183);
    let height = world.position(2).y;
    assert!((height + 0.75).abs() < 1e-6, "it lies at {height}");
    assert!(world.position(2).x > 1.25);
}

#[test]
fn a_lift_carries_what_lies_on_it() {
    let platform = Body {
        restitution: 0.0,
        velocity: DVec3::Y,
        ..bodies::immovable(bodies::at(&shapes::cuboid([2.0, 0.1, 2.0]), DVec3::ZERO))
    };
    let mut world = worlds::world([platform, cube(1.0, 0.7 * DVec3::Y, 0.0)]);
    worlds::step(&mut world, 120);
    let above = world.position(1).y - world.position(0).y;
    assert!((above - 0.6).abs() < 1e-6, "{above}");
    assert!((world.velocity(1).y - 1.0).abs() < 1e-6);
}

/// Regression: constant forces also acted where a contact opens by rotation. They added up to a tenth of all energy in
/// a step, and a multiple of it for bodies that rotate by radians in a step. Now a time is sought in which they add
/// none.
#[test]
fn what_tips_over_another_gains_no_energy() {
    // In the 36th run at 20 Hz a box leaves the edge on which it lay.
    let runs =
        std::env::var("COWBELL_TURNING_RUNS").map_or(40, |runs| runs.parse().expect("a number"));
    let mut stepped = 0_u32;
    for (spin, rate, bound) in [
        (5.0, 60.0, 1e-6),
        (5.0, 240.0, 1e-6),
        (30.0, 20.0, 1e-4),
        (30.0, 60.0, 1e-6),
        (300.0, 60.0, 1e-6),
        (1000.0, 60.0, 1e-6),
    ] {
        let (mut random, mut most) = (Random::splitmix(11), 0.0_f64);
        for _ in 0..runs {
            let size = DVec3::splat(0.6) + 0.5 * random.vector();
            let mut body = cube(1.0, 2.0 * DVec3::Y, 0.5 * random.below(2) as f64);
            body.shape = Some(shapes::cuboid(size.as_vec3().to_array()));
            body.turn = Some(Turn {
                spin: spin * random.vector(),
                ..Turn::default()
            });
            let mut other = cube(1.0, 4.0 * DVec3::Y, 0.0);
            other.velocity = -5.0 * DVec3::Y;
            let settings = Settings {
                dt: 1.0 / rate,
                ..Settings::default()
            };
            let mut world = worlds::world_of(settings, [floor(0.0), body, other]);
            for _ in 0..(1.5 * rate) as u32 {
                let before = energy(&world);
                worlds::step(&mut world, 1);
                most = most.max((energy(&world) - before) / before);
                stepped += 1;
            }
            assert_eq!(world.meeting(), []);
        }
        println!("{spin} rad/s, {rate} Hz: at most {most:.1e} of the energy in a step");
        assert!(most < bound, "{most:e}");
    }
    assert_eq!(stepped, 750 * runs);
}

/// A box that falls over its edge without friction, until its next edge comes down: the loss of energy on the way
/// shrinks with the step.
#[test]
fn what_falls_over_loses_little_energy() {
    let lost = [60.0, 240.0, 960.0].map(|rate| {
        let half = DVec3::new(0.3, 0.5, 0.4);
        let axis = DVec3::new(0.3, 0.2, 1.0).normalize();
        let tilt = DQuat::from_axis_angle(axis, 0.6);
        let lowest = (tilt.inverse() * DVec3::Y).abs().dot(half);
        let mut body = bodies::at(
            &shapes::cuboid(half.as_vec3().to_array()),
            (lowest + 1e-9) * DVec3::Y,
        );
        (body.force, body.restitution) = (-G * DVec3::Y, 0.0);
        body.turn = Some(Turn {
            rotation: tilt,
            spin: DVec3::new(1.0, 2.0, -1.0),
            ..Turn::default()
        });
        let settings = Settings {
            dt: 1.0 / rate,
            ..Settings::default()
        };
        let mut world = worlds::world_of(settings, [floor(0.0), body]);
        worlds::step(&mut world, 1);
        let first = energy(&world);
        worlds::step(&mut world, (0.15 * rate) as u64);
        let lost = (first - energy(&world)) / first;
        println!("{rate} Hz: {lost:.1e} of its energy is lost");
        lost
    });
    assert!(lost[0] < 3e-4 && lost[1] < 0.3 * lost[0] && lost[2] < 0.3 * lost[1]);
    assert!(lost[2] >= 0.0, "{lost:?}");
}

/// Regression: four stacks of two, which slide off each other. One that touched a wall and two others stayed tilted in
/// the air, because it could not be moved apart from all of them.
#[test]
fn cubes_that_slide_off_each_other_in_a_bin_come_to_lie() {
    let wall = |normal: DVec3| Body {
        restitution: 0.2,
        ..bodies::wall(normal, -0.8 * normal, DVec3::ZERO)
    };
    let mut all = vec![floor(0.2)];
    all.extend([DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z].map(wall));
    for k in 0..8_u32 {
        let side = |bit: u32| if k >> bit & 1 == 0 { -0.4 } else { 0.4 };
        let place = DVec3::new(side(0), 0.6 + 0.9 * f64::from(k >> 2), side(1));
        let mut body = cube(0.5, place, 0.2);
        body.turn = Some(Turn {
            spin: DVec3::new(0.5 * side(2), 0.7 * side(1), 0.9 * side(0)),
            ..Turn::default()
        });
        all.push(body);
    }
    let mut world = worlds::world(all);
    for _ in 0..64 {
        worlds::step(&mut world, 10);
        assert_eq!(world.meeting(), []);
    }
    for body in 5..world.len() {
        let height = world.position(body).y;
        let off = (height - 0.25).abs().min((height - 0.75).abs());
        assert!(off < 1e-3, "{body} is at {height}");
    }
}

#[test]
fn what_lies_on_what_does_not_turn_is_borne_by_it() {
    let mut box_below = bodies::at(&shapes::cuboid([1.0, 0.5, 1.0]), 0.5 * DVec3::Y);
    (box_below.force, box_below.restitution) = (-G * DVec3::Y, 0.0);
    let mut body = cube(1.0, 3.0 * DVec3::Y, 0.0);
    let axis = DVec3::new(0.2, 1.0, 0.4).normalize();
    body.turn.as_mut().unwrap().rotation = DQuat::from_axis_angle(axis, 0.9);
    let mut world = worlds::world([floor(0.0), box_below, body]);
    worlds::step(&mut world, 240);
    assert!((world.position(1).y - 0.5).abs() < 1e-9);
    assert!(
        (world.position(2).y - 1.5).abs() < 1e-9,
        "{}",
        world.position(2).y
    );
}

#[test]
fn a_free_body_keeps_what_it_has_in_any_world() {
    let box_of = shapes::cuboid([0.5, 0.3, 0.1]);
    let spin = DVec3::new(1e-3, 5.0, 2e-3);
    let body = Body {
        turn: Some(Turn {
            spin,
            ..Turn::default()
        }),
        velocity: DVec3::X,
        ..bodies::at(&box_of, DVec3::ZERO)
    };
    let mut world = worlds::world([&body]);
    let (momentum, energy) = (world.angular_momentum(0), world.turning_energy());
    assert!((world.spin(0) - spin).length() < 1e-15);
    worlds::step(&mut world, 20_000);
    assert_eq!(world.angular_momentum(0), momentum);
    assert!((world.turning_energy() / energy - 1.0).abs() < 1e-13);
    // A pose is interpolated between those of the last two steps.
    let (place, rotation) = world.interpolated_pose(0, 1.0);
    assert_eq!(place, world.origin(0));
    assert!(rotation.angle_between(world.rotation(0)) < 1e-7);
    assert!(world.interpolated_pose(0, 0.5).1.is_normalized());
    // Rotation and spin are part of the state.
    let mut other = worlds::world([&body]);
    let before = other.state_hash();
    other.set_spin(0, 2.0 * spin).unwrap();
    assert_ne!(other.state_hash(), before);
}

#[test]
fn what_cannot_turn_is_refused_by_name() {
    let mut world = World::new(Settings::default()).unwrap();
    let with = |shape: Option<Shape>, turn: Turn| Body {
        shape,
        turn: Some(turn),
        ..Body::default()
    };
    let half_space = with(Some(shapes::half_space(DVec3::Y)), Turn::default());
    let refused = world.add(half_space).unwrap_err();
    assert_eq!(refused, WorldError::TurningHalfSpace { body: 0 });
    let point = world.add(with(None, Turn::default())).unwrap_err();
    assert!(
        matches!(point, WorldError::Inertia { body: 0, .. }),
        "{point}"
    );
    let skewed = Turn {
        rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0),
        ..Turn::default()
    };
    let cube = Some(shapes::cube());
    let rotation = world.add(with(cube.clone(), skewed)).unwrap_err();
    assert_eq!(rotation, WorldError::Rotation { body: 0 });
    for spin in [f64::NAN, f64::INFINITY, 1e101] {
        let turn = Turn {
            spin: DVec3::new(0.0, spin, 0.0),
            ..Turn::default()
        };
        assert!(world.add(with(cube.clone(), turn)).is_err());
    }
    assert!(world.is_empty());
    // With an inertia of its own a point can rotate.
    let inertia = Inertia::new(DVec3::ONE, DQuat::IDENTITY, DVec3::ZERO).unwrap();
    let turn = Turn {
        inertia: Some(inertia),
        ..Turn::default()
    };
    world.add(with(None, turn)).unwrap();
    world.add(with(cube, Turn::default())).unwrap();
    world
        .add(bodies::at(&shapes::cube(), 9.0 * DVec3::X))
        .unwrap();
    assert_eq!(
        world.set_spin(2, DVec3::X),
        Err(WorldError::DoesNotTurn { body: 2 })
    );
    // A change of mass scales the inertia.
    world.set_spin(1, DVec3::Y).unwrap();
    let (before, spin) = (world.turning_energy(), world.spin(1));
    world.set_mass(1, 3.0).unwrap();
    assert!((world.turning_energy() / before - 3.0).abs() < 1e-12);
    assert!((world.spin(1) - spin).length() < 1e-15);
    assert_eq!(
        world.set_kind(1, BodyKind::Static),
        Err(WorldError::TurningKind { body: 1 })
    );
}

/// Bricks pulled into each other by springs, or thrown at each other, with steps so long that they have more impacts in
/// each than are followed: those bodies stop, and keep their momentum and that of the bodies that hit them.
#[test]
fn what_meets_too_often_in_a_step_loses_no_momentum() {
    let mut impacts = 0;
    for seed in 0..16 {
        let mut random = Random::splitmix(seed);
        let bricks: Vec<Body> = (0..4)
            .map(|k| {
                let place = DVec3::new(f64::from(k % 2), f64::from(k / 2), 0.0);
                let mut body = cube(0.8, 1.3 * place + 0.1 * random.vector(), 0.5);
                body.force = DVec3::ZERO;
                body.velocity = 3.0 * (DVec3::new(0.6, 0.6, 0.0) - place) + random.vector();
                body.turn.as_mut().unwrap().spin = 3.0 * random.vector();
                body
            })
            .collect();
        let mut world = worlds::world(&bricks);
        if seed % 2 == 0 {
            for (i, j) in [(0, 1), (1, 2), (2, 3), (0, 3)] {
                let spring = Force::Spring {
                    bodies: [i, j],
                    points: Some([0.4 * random.vector(), 0.4 * random.vector()]),
                    rest_length: 0.1,
                    stiffness: 60.0,
                    damping: 0.0,
                };
                world.add_force(spring).expect("a force");
            }
        }
        worlds::set_rate(&mut world, 30.0);
        let momentum = world.momentum();
        for step in 0..40 {
            worlds::step(&mut world, 1);
            let moved = (world.momentum() - momentum).length();
            assert!(moved < 1e-11, "seed {seed} step {step}: {moved:e} kg m/s");
            assert_eq!(world.meeting(), [], "seed {seed} step {step}");
        }
        impacts = impacts.max(world.impacts());
    }
    println!("{impacts} impacts at most");
}
