//! Forces at points of turning bodies: tops and pendulums against closed forms, with every method.

use kit::{bodies, shapes, worlds};
use sim_core::{
    Body, DQuat, DVec3, Force, Inertia, METHODS, Method, Settings, StepError, Turn, World,
};

/// Moments of symmetric tops about the axis (the third one) and across it, kg m².
const ALONG: f64 = 0.5;
const ACROSS: f64 = 1.0;

/// The rotation of the third axis to the vertical.
fn upright() -> DQuat {
    DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2)
}

/// A top without a pivot: a force of 2 N acts downwards at half a metre from its centre of mass along its axis. The
/// axis is tilted towards x by an angle, rad; the angular velocity is in the body frame, rad/s.
fn top(method: &'static Method, dt: f64, tilt: f64, spin: DVec3) -> World {
    let settings = Settings {
        method,
        dt,
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("settings");
    let rotation = DQuat::from_rotation_z(-tilt) * upright();
    let moments = DVec3::new(ACROSS, ACROSS, ALONG);
    let body = Body {
        mass: 3.0,
        // It balances the force at the point; otherwise the top would fly off.
        force: 2.0 * DVec3::Y,
        turn: Some(Turn {
            rotation,
            spin: rotation * spin,
            inertia: Some(Inertia::new(moments, DQuat::IDENTITY, DVec3::ZERO).expect("moments")),
            ..Turn::default()
        }),
        ..Body::default()
    };
    world.add(body).expect("a body");
    let push = Force::Push {
        body: 0,
        point: 0.5 * DVec3::Z,
        force: -2.0 * DVec3::Y,
    };
    world.add_force(push).expect("a force");
    world
}

/// The direction of a top's axis.
fn axis(world: &World) -> DVec3 {
    world.rotation(0) * DVec3::Z
}

/// Kinetic and potential energy, J.
fn energy(world: &World) -> f64 {
    world.kinetic_energy() + world.potential_energy()
}

/// The period of the nodding top, from one highest position to the next, s, and the angle of precession in that time.
const NOD: f64 = 2.278_301_997_688_738;
const PRECESSION: f64 = 0.786_521_243_768_659;

/// The top after a time, in some steps.
fn after(method: &'static Method, time: f64, steps: u64) -> World {
    let mut world = top(
        method,
        time / steps as f64,
        60_f64.to_radians(),
        6.0 * DVec3::Z,
    );
    worlds::step(&mut world, steps);
    world
}

#[test]
fn a_top_nods_and_goes_about_as_lagrange_says() {
    let (sin, cos) = 60_f64.to_radians().sin_cos();
    let exact = DVec3::new(sin * PRECESSION.cos(), cos, -sin * PRECESSION.sin());
    for (name, steps, most) in [
        ("forward-euler", 6400, 4e-4),
        ("backward-euler", 6400, 4e-4),
        ("symplectic-euler", 6400, 1e-8),
        ("velocity-verlet", 6400, 1e-8),
        ("implicit-midpoint", 6400, 1e-6),
        ("rk4", 1600, 1e-10),
        ("symplectic-4", 800, 1e-12),
        ("symplectic-8", 200, 1e-13),
        ("radau5", 400, 1e-12),
        ("dopri5", 20, 1e-8),
        ("dop853", 20, 1e-8),
    ] {
        let method = Method::named(name).expect("a method");
        let world = after(method, NOD, steps);
        let off = (axis(&world) - exact).length();
        println!("{name}: {off:e}");
        assert!(off < most, "{name}: {off:e}");
    }
}

#[test]
fn every_method_turns_at_its_order() {
    let time = 1.3;
    let reference = after(Method::named("symplectic-8").expect("a method"), time, 2000);
    let off = |world: &World| {
        let turned = reference.rotation(0).inverse() * world.rotation(0);
        turned.xyz().length() + (world.spin(0) - reference.spin(0)).length()
    };
    for method in METHODS.into_iter().filter(|method| !method.adaptive) {
        let steps = match method.order {
            1 => 800,
            2 => 200,
            4 => 60,
            5 => 60,
            _ => 4,
        };
        let errors = [steps, 2 * steps].map(|steps| off(&after(method, time, steps)));
        let order = (errors[0] / errors[1]).log2();
        println!("{}: {errors:?} order {order}", method.name);
        let claimed = f64::from(method.order);
        assert!(
            (order - claimed).abs() < 0.05 * claimed,
            "{}: order {order}",
            method.name
        );
    }
}

#[test]
fn what_is_symplectic_keeps_the_energy_of_a_top() {
    for method in METHODS.into_iter().filter(|method| method.symplectic) {
        let mut world = top(method, 1.0 / 60.0, 60_f64.to_radians(), 6.0 * DVec3::Z);
        let start = energy(&world);
        // The energy oscillates about its initial value without drift: as much in the first minute as in the tenth.
        let most = |world: &mut World| {
            let mut most = 0.0_f64;
            for _ in 0..3600 {
                worlds::step(world, 1);
                most = most.max((energy(world) - start).abs());
            }
            most
        };
        let first = most(&mut world);
        worlds::step(&mut world, 8 * 3600);
        let last = most(&mut world);
        println!("{}: {first:e} J, after ten minutes {last:e} J", method.name);
        assert!(
            last < 1.5 * first + 1e-10,
            "{}: {first:e}, {last:e}",
            method.name
        );
    }
}

#[test]
fn what_is_reversible_goes_back_on_a_top() {
    for method in METHODS.into_iter().filter(|method| method.reversible) {
        let mut world = top(method, 1.0 / 60.0, 60_f64.to_radians(), 6.0 * DVec3::Z);
        let start = axis(&world);
        worlds::step(&mut world, 600);
        world.set_spin(0, -world.spin(0)).expect("it turns");
        world.set_velocity(0, -world.velocity(0)).expect("a body");
        worlds::step(&mut world, 600);
        let off = (axis(&world) - start).length();
        println!("{}: {off:e}", method.name);
        assert!(off < 1e-10, "{}: {off:e}", method.name);
    }
}

/// A zero push causes no rotation, but makes the method step the rotation.
#[test]
fn what_flies_freely_keeps_its_angular_momentum_under_kicks_and_the_midpoint_rule() {
    for method in METHODS.into_iter().filter(|method| method.symplectic) {
        let mut world = tied(method, 1.0 / 60.0);
        while !world.forces().is_empty() {
            world.remove_force(0).expect("a force");
        }
        for body in 0..2 {
            let force = Force::Push {
                body,
                point: DVec3::X,
                force: DVec3::ZERO,
            };
            world.add_force(force).expect("a force");
        }
        let (energy, momentum) = (world.turning_energy(), world.angular_momentum(0));
        worlds::step(&mut world, 6000);
        let gained = (world.turning_energy() / energy - 1.0).abs();
        let turned = (world.angular_momentum(0) - momentum).length() / momentum.length();
        println!("{}: energy {gained:e}, momentum {turned:e}", method.name);
        assert!(
            gained < 1e-10 && turned < 1e-10,
            "{}: {gained:e} {turned:e}",
            method.name
        );
    }
}

/// Without spin the top is a pendulum about its centre of mass: periods from the elliptic integral, 17 digits.
#[test]
fn a_pendulum_swings_with_its_period() {
    let method = Method::named("symplectic-8").expect("a method");
    for (angle, period) in [
        (30.0, 6.392_568_008_450_16),
        (90.0, 7.416_298_709_205_487_7),
        (170.0, 15.326_967_999_136_585),
    ] {
        // From the lowest position, which is the direction of the force.
        let tilt = 180_f64.to_radians() - f64::to_radians(angle);
        for steps in [400, 1000] {
            let mut world = top(method, period / steps as f64, tilt, DVec3::ZERO);
            let start = axis(&world);
            worlds::step(&mut world, steps);
            let off = (axis(&world) - start).length();
            assert!(off < 2e-11, "{angle} degrees, {steps} steps: {off:e}");
            assert!(world.spin(0).length() < 2e-11);
        }
    }
}

#[test]
fn a_top_at_the_right_spin_goes_about_evenly() {
    // At 60 degrees it precesses steadily at either of two speeds (Lagrange): A Ω² cos - C n Ω + F r = 0.
    let tilt = 60_f64.to_radians();
    for rate in [0.354_248_688_935_409_4, 5.645_751_311_064_591] {
        // With C n = 3: a spin of 6 rad/s along the axis, including that of the precession.
        let across = rate * tilt.sin();
        let spin = DVec3::new(-across, 0.0, 6.0);
        let method = Method::named("symplectic-8").expect("a method");
        let mut world = top(method, 0.01, tilt, spin);
        for _ in 0..10 {
            worlds::step(&mut world, 1000);
            let up = axis(&world).y;
            assert!((up - 0.5).abs() < 1e-10, "{rate}: {:e}", up - 0.5);
        }
        let angle = -axis(&world).z.atan2(axis(&world).x);
        let exact = (100.0 * rate).rem_euclid(std::f64::consts::TAU);
        let off = (angle - exact).rem_euclid(std::f64::consts::TAU);
        let off = off.min(std::f64::consts::TAU - off);
        assert!(off < 1e-9, "{rate}: {off:e}");
    }
}

#[test]
fn an_upright_top_sleeps_above_a_spin_and_falls_below() {
    // 2 √(A F r) / C = 4.
    for (spin, falls) in [(3.9, true), (4.1, false)] {
        let method = Method::named("symplectic-4").expect("a method");
        let mut world = top(method, 0.02, 1e-6, spin * DVec3::Z);
        let mut lowest = 1.0_f64;
        for _ in 0..5000 {
            worlds::step(&mut world, 1);
            lowest = lowest.min(axis(&world).y);
        }
        assert_eq!(lowest < 0.99, falls, "{spin}: {lowest}");
        assert!(falls || lowest > 1.0 - 1e-9, "{lowest}");
    }
}

#[test]
fn a_step_of_half_a_turn_is_refused_or_flown() {
    for method in METHODS {
        let mut world = top(method, 1.0, 1.0, 5.0 * DVec3::Z);
        let is_split = method.symplectic;
        match world.step() {
            Ok(()) => assert!(is_split, "{}", method.name),
            Err(error) => {
                assert!(!is_split && world.steps() == 0, "{}", method.name);
                let names_it = matches!(
                    error,
                    StepError::Turning { .. }
                        | StepError::NotConverged { .. }
                        | StepError::TooManySteps { .. }
                );
                assert!(names_it, "{}: {error}", method.name);
            }
        }
    }
}

/// Two bricks connected by springs at their corners, thrown and spinning.
fn tied(method: &'static Method, dt: f64) -> World {
    let settings = Settings {
        method,
        dt,
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("settings");
    for side in [-1.0, 1.0] {
        let inertia = Inertia::new(DVec3::new(0.4, 0.9, 1.1), DQuat::IDENTITY, 0.1 * DVec3::X);
        let body = Body {
            mass: 2.0 + side,
            position: side * DVec3::new(1.0, 0.2, 0.0),
            velocity: DVec3::new(0.3, side, 0.1),
            turn: Some(Turn {
                spin: DVec3::new(1.0, side, -2.0),
                inertia: Some(inertia.expect("moments")),
                ..Turn::default()
            }),
            ..Body::default()
        };
        world.add(body).expect("a body");
    }
    for y in [-0.5, 0.5] {
        let spring = Force::Spring {
            bodies: [0, 1],
            points: Some([DVec3::new(0.6, y, 0.3), DVec3::new(-0.4, y, 0.0)]),
            rest_length: 0.5,
            stiffness: 30.0,
            damping: 0.0,
        };
        world.add_force(spring).expect("a force");
    }
    world
}

#[test]
fn springs_at_points_exchange_momentum_and_energy_only() {
    for method in METHODS {
        let mut world = tied(method, 1e-3);
        let (momentum, angular) = (world.momentum(), world.angular_momentum_about(DVec3::ZERO));
        let start = energy(&world);
        worlds::step(&mut world, 3000);
        let moved = (world.momentum() - momentum).length();
        assert!(moved < 1e-11, "{}: {moved:e} kg m/s", method.name);
        // Drifts and kicks conserve it to rounding; other methods have an error of their order.
        let turned = (world.angular_momentum_about(DVec3::ZERO) - angular).length();
        let gained = (energy(&world) - start).abs();
        let (most_turned, most_gained) = match method.name {
            "symplectic-euler" => (1e-10, 0.1),
            "velocity-verlet" => (1e-10, 1e-3),
            "symplectic-4" | "symplectic-8" => (1e-10, 1e-8),
            "forward-euler" | "backward-euler" => (1.0, 10.0),
            "implicit-midpoint" => (1e-3, 1e-3),
            _ => (1e-7, 1e-7),
        };
        println!("{}: {turned:e} kg m²/s, {gained:e} J", method.name);
        assert!(turned < most_turned, "{}: {turned:e} kg m²/s", method.name);
        assert!(gained < most_gained, "{}: {gained:e} J", method.name);
    }
}

#[test]
fn dampers_at_points_take_energy_and_no_momentum() {
    for method in METHODS {
        let mut world = tied(method, 1e-3);
        let damper = Force::Spring {
            bodies: [0, 1],
            points: Some([DVec3::Y, DVec3::NEG_Y]),
            rest_length: 0.5,
            stiffness: 0.0,
            damping: 3.0,
        };
        world.add_force(damper).expect("a force");
        let (start, momentum) = (energy(&world), world.momentum());
        worlds::step(&mut world, 3000);
        assert!(energy(&world) < 0.9 * start, "{}", method.name);
        assert!(
            (world.momentum() - momentum).length() < 1e-11,
            "{}",
            method.name
        );
    }
}

#[test]
fn a_point_of_a_body_that_does_not_turn_is_beside_its_position() {
    for method in METHODS {
        // The same oscillation, attached at the position or beside it.
        let swing = |point: Option<DVec3>| {
            let settings = Settings {
                method,
                ..Settings::default()
            };
            let mut world = World::new(settings).expect("settings");
            world
                .add(Body {
                    velocity: DVec3::Y,
                    ..Body::default()
                })
                .expect("a body");
            let anchor = Force::Anchor {
                body: 0,
                point,
                anchor: DVec3::X + point.unwrap_or_default(),
                rest_length: 0.5,
                stiffness: 4.0,
                damping: 0.1,
            };
            world.add_force(anchor).expect("a force");
            worlds::step(&mut world, 200);
            world.position(0)
        };
        let off = (swing(Some(DVec3::new(2.0, -1.0, 4.0))) - swing(None)).length();
        assert!(off < 1e-9, "{}: {off:e}", method.name);
    }
}

#[test]
fn forces_and_torques_are_told_as_they_act() {
    let world = tied(Method::named("rk4").expect("a method"), 1e-6);
    let mut after = world.clone();
    worlds::step(&mut after, 1);
    for body in 0..2 {
        let force = world.mass(body) / 1e-6 * (after.velocity(body) - world.velocity(body));
        let told = world.applied_force(body);
        assert!(
            (force - told).length() < 1e-3 * told.length(),
            "{force} {told}"
        );
        let torque = (after.angular_momentum(body) - world.angular_momentum(body)) / 1e-6;
        let told = world.applied_torque(body);
        assert!(
            (torque - told).length() < 1e-3 * told.length(),
            "{torque} {told}"
        );
    }
}

/// A spinning immovable body carries the body attached to its rim.
#[test]
fn a_turntable_carries_what_is_tied_to_its_rim() {
    for method in METHODS {
        let settings = Settings {
            method,
            dt: 1e-3,
            ..Settings::default()
        };
        let mut world = World::new(settings).expect("settings");
        let table = Body {
            kind: sim_core::BodyKind::Static,
            turn: Some(Turn {
                spin: DVec3::Y,
                ..Turn::default()
            }),
            ..Body::default()
        };
        world.add(table).expect("a body");
        world
            .add(Body {
                position: DVec3::X,
                velocity: DVec3::NEG_Z,
                ..Body::default()
            })
            .expect("a body");
        let spring = Force::Spring {
            bodies: [0, 1],
            points: Some([DVec3::X, DVec3::ZERO]),
            rest_length: 0.0,
            stiffness: 100.0,
            damping: 0.0,
        };
        world.add_force(spring).expect("a force");
        worlds::step(&mut world, 2000);
        let rim = world.point_of(0, DVec3::X);
        let angle = (-rim.z).atan2(rim.x);
        assert!((angle - 2.0).abs() < 1e-9, "{}: {angle}", method.name);
        // The spring holds it on its circle.
        assert!((world.position(1) - rim).length() < 5e-2, "{}", method.name);
    }
}

/// Makes steps, and checks that none adds energy or lets bodies meet.
fn watch(world: &mut World, steps: u64, most: f64) -> f64 {
    let mut gained = 0.0_f64;
    for step in 0..steps {
        let before = energy(world);
        worlds::step(world, 1);
        gained = gained.max(energy(world) - before);
        assert!(gained < most, "step {step}: {gained:e} J");
        assert_eq!(world.meeting(), [], "step {step}");
    }
    gained
}

/// A brick that hangs by a corner from a stiff spring, and swings against a wall.
#[test]
fn a_pendulum_bounces_off_a_wall() {
    for method in METHODS.into_iter().filter(|method| method.order > 1) {
        let settings = Settings {
            method,
            dt: 1.0 / 240.0,
            ..Settings::default()
        };
        let mut world = World::new(settings).expect("settings");
        let brick = Body {
            turn: Some(Turn {
                rotation: DQuat::from_rotation_z(0.3),
                ..Turn::default()
            }),
            force: -9.81 * DVec3::Y,
            ..bodies::at(&shapes::cuboid([0.1, 0.5, 0.2]), -0.5 * DVec3::Y)
        };
        world
            .add(bodies::wall(DVec3::X, -0.6 * DVec3::X, DVec3::ZERO))
            .expect("a wall");
        world.add(brick).expect("a brick");
        let point = DVec3::new(0.0, 0.5, 0.0);
        let spring = Force::Anchor {
            body: 1,
            point: Some(point),
            anchor: world.point_of(1, point),
            rest_length: 0.0,
            stiffness: 500.0,
            damping: 0.0,
        };
        world.add_force(spring).expect("a force");
        world
            .set_velocity(1, DVec3::new(-2.0, 0.0, 0.0))
            .expect("a body");
        let start = energy(&world);
        let gained = watch(&mut world, 480, 2e-2);
        assert!(world.impacts() > 1, "{}: {}", method.name, world.impacts());
        let off = (energy(&world) - start).abs();
        println!(
            "{}: {} impacts, at most {gained:e} J in a step, {off:e} J in all",
            method.name,
            world.impacts()
        );
        let most = match method.name {
            "velocity-verlet" | "implicit-midpoint" => 0.2,
            "rk4" => 2e-3,
            _ => 1e-4,
        };
        assert!(off < most, "{}: {off:e} J", method.name);
    }
}

/// A brick on the floor that a spring at its corner pulls up and along: it tips, drags and swings, with every method.
#[test]
fn a_brick_is_dragged_over_the_floor_by_its_corner() {
    for method in METHODS {
        let settings = Settings {
            method,
            ..Settings::default()
        };
        let mut world = World::new(settings).expect("settings");
        let brick = Body {
            turn: Some(Turn::default()),
            force: -9.81 * DVec3::Y,
            restitution: 0.3,
            ..bodies::at(&shapes::cuboid([0.5, 0.25, 0.25]), 0.25 * DVec3::Y)
        };
        world
            .add(bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO))
            .expect("a floor");
        world.add(brick).expect("a brick");
        let spring = Force::Anchor {
            body: 1,
            point: Some(DVec3::new(0.5, 0.25, 0.25)),
            anchor: DVec3::new(1.5, 1.0, 0.5),
            rest_length: 0.5,
            stiffness: 20.0,
            damping: 0.5,
        };
        world.add_force(spring).expect("a force");
        let start = energy(&world);
        let most = if method.order == 1 { 0.5 } else { 0.05 };
        let gained = watch(&mut world, 300, most);
        let lost = start - energy(&world);
        println!(
            "{}: at most {gained:e} J in a step, {lost} J lost, {:?}",
            method.name,
            world.position(1)
        );
        assert!(lost > 0.0, "{}: {lost} J", method.name);
        assert!(world.position(1).x > 0.1, "{}", method.name);
    }
}

/// Two bricks on a smooth floor attract each other by springs at their corners: their momenta along the floor are
/// opposite.
#[test]
fn bricks_on_the_floor_pull_each_other_by_their_corners() {
    for method in METHODS {
        let settings = Settings {
            method,
            dt: 1.0 / 240.0,
            ..Settings::default()
        };
        let mut world = World::new(settings).expect("settings");
        world
            .add(bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO))
            .expect("a floor");
        for side in [-1.0, 1.0] {
            let brick = Body {
                turn: Some(Turn::default()),
                mass: 2.0 + side,
                force: -9.81 * (2.0 + side) * DVec3::Y,
                restitution: 0.3,
                ..bodies::at(
                    &shapes::cuboid([0.5, 0.25, 0.25]),
                    DVec3::new(side, 0.25, 0.1 * side),
                )
            };
            world.add(brick).expect("a brick");
        }
        let spring = Force::Spring {
            bodies: [1, 2],
            points: Some([DVec3::new(0.5, 0.25, 0.25), DVec3::new(-0.5, 0.25, -0.25)]),
            rest_length: 0.2,
            stiffness: 30.0,
            damping: 0.2,
        };
        world.add_force(spring).expect("a force");
        let most = if method.order == 1 { 0.5 } else { 0.05 };
        let gained = watch(&mut world, 100, most);
        let momentum = world.momentum();
        let along = DVec3::new(momentum.x, 0.0, momentum.z).length();
        println!(
            "{}: {along:e} kg m/s, at most {gained:e} J in a step, {} impacts",
            method.name,
            world.impacts()
        );
        assert!(world.impacts() > 0, "{}", method.name);
        assert!(along < 1e-11, "{}: {along:e} kg m/s", method.name);
    }
}
