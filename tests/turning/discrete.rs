//! The discrete modes with turning bodies: impulses with lever arms, and bodies moved back to their positions and
//! rotations at the start of the step.

use kit::{bodies, random::Random, shapes, worlds};
use sim_core::{
    Body, Collision, DQuat, DVec3, Settings, Shape, Turn, World,
    collide::{Placement, naive},
};

const DISCRETE: [Collision; 2] = [Collision::Bvh, Collision::Naive];

fn settings(collision: Collision, dt: f64) -> Settings {
    Settings {
        dt,
        collision,
        ..Settings::default()
    }
}

fn turning(shape: &Shape, position: DVec3, velocity: DVec3, turn: Turn) -> Body {
    Body {
        turn: Some(turn),
        ..bodies::body(shape, position, velocity)
    }
}

fn channel() -> Shape {
    let mesh = scene::Scene::load("u-channel").expect("a gallery scene");
    let world = mesh.world().expect("a world");
    let mesh = (0..world.len()).find_map(|body| {
        let mesh = world.mesh(body)?;
        (mesh.triangles().len() > 12).then(|| mesh.clone())
    });
    mesh.expect("a channel").into()
}

/// Six walls around a room.
fn room(half: f64) -> Vec<Body> {
    [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|n| [n, -n])
        .map(|n| bodies::wall(n, -half * n, DVec3::ZERO))
        .collect()
}

/// Cows, channels and cubes that rotate in a room, some by far more than half a turn per step, and balls.
fn crowd(seed: u64, collision: Collision, is_closed: bool, first: &Shape) -> World {
    let mut random = Random::splitmix(seed);
    let all = [
        first.clone(),
        channel(),
        shapes::cuboid([0.3, 0.3, 0.3]),
        shapes::cuboid([0.7, 0.1, 0.2]),
        shapes::ball(0.3),
    ];
    let mut bodies = match is_closed {
        true => room(4.5),
        false => Vec::new(),
    };
    for k in 0..12_usize {
        let cell = DVec3::new((k % 3) as f64, (k / 3 % 2) as f64, (k / 6) as f64);
        let place = 3.0 * cell - DVec3::new(3.0, 1.5, 1.5) + 0.1 * random.vector();
        let inwards = match is_closed {
            true => 2.0 * random.vector(),
            false => -0.5 * place,
        };
        let turn = Turn {
            rotation: DQuat::from_axis_angle(random.direction(), random.from(0.0, 3.0)),
            spin: [1.0, 6.0, 300.0][k % 3] * random.vector(),
            ..Turn::default()
        };
        let shape = &all[(k + seed as usize) % all.len()];
        bodies.push(turning(shape, place, inwards, turn));
    }
    worlds::world_of(settings(collision, 1.0 / 60.0), bodies)
}

/// Pairs of meshes that meet, each edge against each triangle, with an independent placement.
fn meeting_meshes(world: &World) -> Vec<(usize, usize)> {
    let pairs = (0..world.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    pairs
        .filter(|&(i, j)| {
            let Some((first, second)) = world.mesh(i).zip(world.mesh(j)) else {
                return false;
            };
            let back = world.rotation(i).inverse();
            let turned = (back * world.rotation(j)).normalize();
            let between = back * (world.origin(j) - world.origin(i));
            let reach = |mesh: &sim_core::Mesh| {
                let all = mesh.vertices().iter();
                all.map(|v| v.as_dvec3().length()).fold(0.0, f64::max)
            };
            between.length() <= reach(first) + reach(second)
                && naive::intersect(
                    first,
                    second,
                    Placement::turned(turned, between).expect("a rotation"),
                )
        })
        .collect()
}

fn is_dense(world: &World) -> bool {
    let count = |body| world.mesh(body).map_or(0, |mesh| mesh.triangles().len());
    (0..world.len()).map(count).max() > Some(1000)
}

#[test]
fn no_two_meet_after_a_step_and_energy_and_momentum_stay() {
    let mut impacts = 0;
    let (cow, bar) = (shapes::cow(), shapes::cuboid([0.1, 0.8, 0.1]));
    for (seed, is_closed, first) in [
        (1, true, &cow),
        (2, true, &bar),
        (3, false, &cow),
        (4, false, &bar),
    ] {
        let mut world = crowd(seed, Collision::Bvh, is_closed, first);
        assert_eq!(world.overlapping(), [], "{seed}");
        let (energy, momentum) = (world.kinetic_energy(), world.momentum());
        let mut stuck = vec![0; world.len()];
        for step in 0..240 {
            worlds::step(&mut world, 1);
            assert_eq!(world.meeting(), [], "{seed}, step {step}");
            // The test of all edges and triangles of cows takes seconds.
            if is_dense(&world) == (step % 80 == 79) {
                assert_eq!(meeting_meshes(&world), [], "{seed}, step {step}");
            }
            for (body, stuck) in stuck.iter_mut().enumerate() {
                let stays = world.position(body) == world.previous_position(body);
                *stuck = if stays { *stuck + 1 } else { 0 };
                let is_movable = world.kind(body).is_movable();
                assert!(!is_movable || *stuck < 40, "{seed}: body {body} is stuck");
            }
        }
        let drift = world.kinetic_energy() / energy - 1.0;
        assert!(drift.abs() < 1e-12, "{seed}: {drift:e}");
        if !is_closed {
            let size: f64 = (0..world.len())
                .map(|body| world.mass(body) * world.velocity(body).length())
                .sum();
            let drift = (world.momentum() - momentum).length();
            assert!(drift < 1e-13 * size, "{seed}: {drift:e}");
        }
        impacts += world.impacts();
    }
    assert!(impacts > 200, "{impacts}");
}

#[test]
fn naive_and_bvh_are_the_same_to_the_bit() {
    for seed in [5, 6] {
        let [mut bvh, mut naive] = DISCRETE
            .map(|collision| crowd(seed, collision, true, &shapes::cuboid([0.1, 0.8, 0.1])));
        for step in 0..240 {
            worlds::step(&mut bvh, 1);
            worlds::step(&mut naive, 1);
            let states = |world: &World| {
                let bodies = 0..world.len();
                let of = |body| (world.position(body), world.rotation(body), world.spin(body));
                bodies.map(of).collect::<Vec<_>>()
            };
            assert_eq!(states(&bvh), states(&naive), "{seed}, step {step}");
        }
        assert!(bvh.impacts() > 10);
    }
}

#[test]
fn a_box_hit_off_its_middle_turns_as_the_closed_form_says_and_goes_back() {
    // A box 2 × ¼ × ¼ of 1 kg, hit by a ball of 1 kg at 3 m/s, 7/8 m from its middle: with the moment of
    // inertia (4 + 1/16)/12 the impulse is 195/277 of 1 + e.
    for collision in DISCRETE {
        for restitution in [1.0, 0.5, 0.0] {
            let rod = turning(
                &shapes::cuboid([1.0, 0.125, 0.125]),
                DVec3::ZERO,
                DVec3::ZERO,
                Turn::default(),
            );
            let rod = Body { restitution, ..rod };
            let place = DVec3::new(0.875, 0.5, 0.0);
            let ball = bodies::body(&shapes::ball(0.125), place, -3.0 * DVec3::Y);
            let mut world = worlds::world_of(settings(collision, 0.05), [rod, ball]);
            worlds::step(&mut world, 1);
            let before = (world.position(1), world.rotation(0));
            worlds::step(&mut world, 1);
            assert_eq!(world.impacts(), 1);
            assert_eq!((world.position(1), world.rotation(0)), before);
            let impulse = (1.0 + restitution) * 195.0 / 277.0;
            let first = world.last_impact().expect("an impact").clone();
            let close = |found: f64, exact: f64| {
                assert!((found - exact).abs() < 1e-14, "{found} for {exact}");
            };
            close(first.impulse, impulse);
            close(first.time, 0.25 / 3.0);
            close(world.velocity(1).y, impulse - 3.0);
            close(world.velocity(0).y, -impulse);
            close(world.spin(0).z, -0.875 * impulse * 12.0 / 4.0625);
            close(first.speeds.1, restitution * 3.0);
        }
    }
}

#[test]
fn a_cube_that_falls_on_an_edge_turns_as_the_closed_form_says() {
    // As in the continuous mode: with the arm r = sin θ/√2 the impulse is (1 + e) 2/(1 + 6 r²).
    for collision in DISCRETE {
        for (degrees, restitution) in [(15.0_f64, 1.0), (15.0, 0.5), (30.0, 1.0), (1.0, 0.25)] {
            let theta = degrees.to_radians();
            let mut floor = bodies::wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO);
            let turn = Turn {
                rotation: DQuat::from_rotation_z(45_f64.to_radians() - theta),
                ..Turn::default()
            };
            let mut cube = turning(&shapes::cuboid([0.5; 3]), DVec3::Y, -2.0 * DVec3::Y, turn);
            (floor.restitution, cube.restitution) = (restitution, restitution);
            let mut world = worlds::world_of(settings(collision, 0.01), [floor, cube]);
            while world.impacts() == 0 {
                worlds::step(&mut world, 1);
            }
            let arm = theta.sin() / 2_f64.sqrt();
            let impulse = 2.0 * (1.0 + restitution) / (1.0 + 6.0 * arm * arm);
            let first = world.last_impact().expect("an impact");
            assert!((first.impulse - impulse).abs() < 1e-13, "{degrees}");
            assert!((world.velocity(1).y - (impulse - 2.0)).abs() < 1e-13);
            assert!((world.spin(1).z.abs() - 6.0 * arm * impulse).abs() < 1e-12);
        }
    }
}

#[test]
fn a_cube_that_lands_flat_does_not_turn() {
    for collision in DISCRETE {
        let floor = bodies::immovable(bodies::at(&shapes::cuboid([3.0, 1.0, 3.0]), DVec3::NEG_Y));
        let velocity = DVec3::new(0.25, -2.0, 0.0);
        let cube = turning(
            &shapes::cuboid([0.5; 3]),
            DVec3::Y,
            velocity,
            Turn::default(),
        );
        let mut world = worlds::world_of(settings(collision, 0.1), [floor, cube]);
        worlds::step(&mut world, 6);
        assert!(world.impacts() > 0);
        assert!((world.velocity(1) - DVec3::new(0.25, 2.0, 0.0)).length() < 1e-14);
        assert!(world.spin(1).length() < 1e-14, "{}", world.spin(1));
    }
}
