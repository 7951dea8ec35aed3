//! Impacts of turning bodies in a world, against closed forms and what they conserve.

use kit::{bodies, random::Random, shapes, worlds};
use sim_core::{Body, DQuat, DVec3, Settings, Shape, Turn, World};

/// A turning body, initially without spin or rotation.
fn turning(shape: &Shape, position: DVec3, velocity: DVec3) -> Body {
    Body {
        turn: Some(Turn::default()),
        ..bodies::body(shape, position, velocity)
    }
}

fn turned(body: Body, rotation: DQuat, spin: DVec3) -> Body {
    let turn = Some(Turn {
        rotation,
        spin,
        ..Turn::default()
    });
    Body { turn, ..body }
}

fn long_steps(bodies: &[Body]) -> World {
    let settings = Settings {
        dt: 0.1,
        ..Settings::default()
    };
    worlds::world_of(settings, bodies)
}

fn close(found: f64, exact: f64, ulps: f64) {
    let error = (found - exact).abs();
    assert!(
        error <= ulps * f64::EPSILON * exact.abs(),
        "{found} for {exact}: {error:e}"
    );
}

#[test]
fn a_box_hit_off_its_middle_turns_as_the_closed_form_says() {
    // A box 2 × ¼ × ¼ of 1 kg, hit by a ball of 1 kg at 3 m/s, 7/8 m from its middle: with the moment of
    // inertia (4 + 1/16)/12 the impulse is 390/277.
    let rod = turning(
        &shapes::cuboid([1.0, 0.125, 0.125]),
        DVec3::ZERO,
        DVec3::ZERO,
    );
    let place = DVec3::new(0.875, 0.5, 0.0);
    let ball = bodies::body(&shapes::ball(0.125), place, -3.0 * DVec3::Y);
    let mut world = long_steps(&[rod, ball]);
    worlds::step(&mut world, 5);
    assert_eq!(world.impacts(), 1);
    close(world.velocity(1).y, -441.0 / 277.0, 4.0);
    close(world.velocity(0).y, -390.0 / 277.0, 4.0);
    close(world.spin(0).z, -1008.0 / 277.0, 4.0);
    close(world.last_impact().unwrap().impulse, 390.0 / 277.0, 4.0);
}

#[test]
fn a_box_hit_at_both_ends_at_once_does_not_turn() {
    let rod = turning(
        &shapes::cuboid([1.0, 0.125, 0.125]),
        DVec3::ZERO,
        DVec3::ZERO,
    );
    let ball = |x: f64| {
        let place = DVec3::new(x, 0.5, 0.0);
        bodies::body(&shapes::ball(0.125), place, -3.0 * DVec3::Y)
    };
    let mut world = long_steps(&[rod, ball(0.875), ball(-0.875)]);
    worlds::step(&mut world, 5);
    assert_eq!(world.spin(0), DVec3::ZERO);
    close(world.velocity(0).y, -4.0, 4.0);
    close(world.velocity(1).y, -1.0, 4.0);
    assert_eq!(world.velocity(1), world.velocity(2));
}

#[test]
fn a_cube_that_falls_on_an_edge_turns_as_the_closed_form_says() {
    // V and ω of a cube of edge 1 m and 1 kg that falls at 2 m/s, its centre so many degrees off the vertical over its
    // edge: with the arm r = sin θ/√2 the impulse is (1 + e) 2/(1 + 6 r²).
    for (degrees, restitution) in [(15.0_f64, 1.0), (15.0, 0.5), (30.0, 1.0), (1.0, 0.25)] {
        let theta = degrees.to_radians();
        let mut floor = bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO);
        let rotation = DQuat::from_rotation_z(45_f64.to_radians() - theta);
        let cube = turning(&shapes::cuboid([0.5; 3]), DVec3::Y, -2.0 * DVec3::Y);
        let mut cube = turned(cube, rotation, DVec3::ZERO);
        (floor.restitution, cube.restitution) = (restitution, restitution);
        let mut world = long_steps(&[floor, cube]);
        while world.impacts() == 0 {
            worlds::step(&mut world, 1);
        }
        let arm = theta.sin() / 2_f64.sqrt();
        let impulse = 2.0 * (1.0 + restitution) / (1.0 + 6.0 * arm * arm);
        let first = world.last_impact().unwrap();
        assert!((first.impulse - impulse).abs() < 1e-14);
        // Only if the opposite corner does not hit within the step.
        if world.impacts() == 1 {
            assert!((world.velocity(1).y - (impulse - 2.0)).abs() < 1e-13);
            assert!((world.spin(1).z.abs() - 6.0 * arm * impulse).abs() < 1e-13);
        }
    }
}

#[test]
fn a_cube_that_lands_flat_does_not_turn_to_the_bit() {
    let cube = shapes::cuboid([0.5; 3]);
    let floors = [
        bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO),
        bodies::immovable(bodies::at(&shapes::cuboid([3.0, 1.0, 3.0]), DVec3::NEG_Y)),
    ];
    for floor in floors {
        for place in [DVec3::Y, DVec3::new(0.3, 1.25, -0.7)] {
            let body = turning(&cube, place, DVec3::new(0.25, -2.0, 0.0));
            let mut world = long_steps(&[floor.clone(), body]);
            worlds::step(&mut world, 6);
            assert_eq!(world.impacts(), 1);
            assert_eq!(world.velocity(1), DVec3::new(0.25, 2.0, 0.0));
            assert_eq!(world.spin(1), DVec3::ZERO);
        }
    }
}

#[test]
fn elastic_crowds_keep_energy_and_momentum_and_share_it_with_turning() {
    let mut random = Random::splitmix(3);
    let rotation = |random: &mut Random| {
        let axis = random.direction();
        DQuat::from_axis_angle(axis, random.from(0.0, 3.0))
    };
    for (shape, count, room) in [(shapes::cuboid([0.2; 3]), 40, 2.2), (shapes::cow(), 3, 4.2)] {
        let mut all: Vec<Body> = [DVec3::X, DVec3::Y, DVec3::Z]
            .into_iter()
            .flat_map(|n| [n, -n])
            .map(|n| bodies::wall(n, -room * n, DVec3::ZERO))
            .collect();
        let walls = all.len();
        for k in 0..count {
            let place = match count {
                3 => DVec3::new(2.6 * (k as f64 - 1.0), 0.0, 0.0),
                _ => DVec3::new((k % 4) as f64, (k / 4 % 4) as f64, (k / 16) as f64) - 1.5,
            };
            let body = turning(&shape, place, 2.0 * random.vector());
            all.push(turned(body, rotation(&mut random), 4.0 * random.vector()));
        }
        let mut world = worlds::world(&all);
        assert_eq!(world.overlapping(), []);
        let energy = world.kinetic_energy();
        for _ in 0..180 {
            worlds::step(&mut world, 1);
            assert_eq!(world.meeting(), []);
        }
        let drift = world.kinetic_energy() / energy - 1.0;
        assert!(drift.abs() < 1e-13, "{drift:e}");
        assert!(world.impacts() > walls as u64, "{}", world.impacts());
    }
}

#[test]
fn what_is_free_keeps_momentum_and_energy_through_impacts() {
    // Two rotating cows collide in empty space: nothing else can add or remove momentum or energy.
    let cow = shapes::cow();
    let mut random = Random::splitmix(8);
    let mut met = 0;
    for _ in 0..12 {
        let first = turning(&cow, DVec3::ZERO, DVec3::ZERO);
        let second = turning(&cow, DVec3::new(2.2, 0.3, 0.0), DVec3::new(-4.0, 0.0, 0.5));
        let pair = [first, second].map(|body| {
            let rotation = DQuat::from_axis_angle(random.direction(), random.from(0.0, 3.0));
            turned(body, rotation, 3.0 * random.vector())
        });
        let mut world = worlds::world(&pair);
        if !world.overlapping().is_empty() {
            continue;
        }
        let before = (
            world.kinetic_energy(),
            world.momentum(),
            world.angular_momentum_about(DVec3::ZERO),
        );
        worlds::step(&mut world, 60);
        met += world.impacts();
        let energy = world.kinetic_energy() / before.0 - 1.0;
        let momentum = (world.momentum() - before.1).length();
        let turning = (world.angular_momentum_about(DVec3::ZERO) - before.2).length();
        assert!(energy.abs() < 1e-13, "{energy:e}");
        assert!(
            momentum < 1e-13 && turning < 1e-12,
            "{momentum:e} {turning:e}"
        );
    }
    assert!(met >= 8, "{met}");
}
