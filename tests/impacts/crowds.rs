//! A hundred bodies in a closed box, in addition to the long case with cubes; and heaps.

use cases::scenes::{Form, GRAVITY, HALF, continuous, crowd, heap};
use kit::bodies::{ball, immovable, mesh_body};
use kit::meshes::cuboid;
use sim_core::{Body, DVec3, Vec3, World};

use crate::worlds::{DT, bits, run, world};

const HALF_BOX: f64 = 2.5;

/// Six walls.
fn half_spaces() -> Vec<Body> {
    let (scene, _) = crowd(100, &Form::Cube(HALF));
    let world = continuous(&scene);
    (0..6).map(|i| world.body(i).to_body()).collect()
}

/// A hundred moving bodies.
fn movers(form: &Form) -> Vec<Body> {
    let (scene, _) = crowd(100, form);
    let world = continuous(&scene);
    scene.movable().map(|i| world.body(i).to_body()).collect()
}

/// A closed box around all bodies, as one mesh.
fn mesh_box() -> Vec<Body> {
    let half = Vec3::splat(HALF_BOX as f32);
    vec![immovable(mesh_body(
        &cuboid(half),
        DVec3::ZERO,
        DVec3::ZERO,
    ))]
}

/// Runs for 10 s and returns the final world.
fn assert_kept(name: &str, mut bodies: Vec<Body>, movers: Vec<Body>) -> World {
    let walls = bodies.len();
    bodies.extend(movers);
    let mut world = world(DT, &bodies);
    assert!(world.overlapping().is_empty(), "{name}");
    let energy = world.kinetic_energy();
    for _ in 0..600 {
        world.step().expect("a step");
    }
    let impacts = world.impacts();
    assert!(impacts > 1000, "{name}: {impacts}");
    let error = (world.kinetic_energy() / energy - 1.0).abs();
    let tolerance = 4e-15 * (impacts as f64).sqrt();
    assert!(
        error <= tolerance,
        "{name}: energy off by {error:e} after {impacts}"
    );
    for i in walls..world.len() {
        let farthest = world.position(i).abs().max_element();
        assert!(
            farthest <= HALF_BOX - HALF + 1e-12,
            "{name}: {i} is outside"
        );
    }
    world
}

fn cubes() -> Vec<Body> {
    movers(&Form::Cube(HALF))
}

fn balls() -> Vec<Body> {
    movers(&Form::Ball(HALF))
}

#[test]
fn a_hundred_cubes_keep_their_energy_in_their_box() {
    for (name, walls) in [("half-spaces", half_spaces()), ("a mesh", mesh_box())] {
        let first = walls.len();
        let world = assert_kept(name, walls, cubes());
        for j in first + 1..world.len() {
            for i in first..j {
                let apart = (world.position(j) - world.position(i)).abs().max_element();
                assert!(apart > 2.0 * HALF - 1e-12, "{name}: {i} and {j} overlap");
            }
        }
    }
}

#[test]
fn a_hundred_balls_keep_their_energy_in_their_box() {
    for (name, walls) in [("half-spaces", half_spaces()), ("a mesh", mesh_box())] {
        let first = walls.len();
        let world = assert_kept(name, walls, balls());
        for j in first + 1..world.len() {
            for i in first..j {
                let apart = (world.position(j) - world.position(i)).length();
                assert!(apart > 2.0 * HALF - 1e-12, "{name}: {i} and {j} overlap");
            }
        }
    }
}

#[test]
fn a_crowd_has_the_same_bits_twice() {
    let [first, second] = [0, 1].map(|_| {
        let mut world = world(DT, &[half_spaces(), cubes()].concat());
        let impacts = run(&mut world, 300);
        (bits(&world), impacts)
    });
    assert_eq!(first, second);
}

#[test]
fn heaps_settle_without_gain() {
    for restitution in [0.0, 0.3, 0.7] {
        let mut world = continuous(&heap(&Form::Ball(HALF), 12, 2, restitution, 0.0));
        let energy = |world: &World| {
            let heights = (5..world.len()).map(|ball| world.position(ball).y);
            world.kinetic_energy() + GRAVITY * heights.sum::<f64>()
        };
        let mut before = energy(&world);
        for step in 0..100 {
            world
                .step()
                .unwrap_or_else(|error| panic!("{restitution}: {error}"));
            let after = energy(&world);
            assert!(
                after <= before + 1e-6,
                "{restitution}, {step}: {before} {after}"
            );
            before = after;
            for i in 5..world.len() {
                let at = world.position(i);
                assert!(at.y >= 0.25 && at.x.abs().max(at.z.abs()) <= 0.35);
                for j in 5..i {
                    assert!((at - world.position(j)).length_squared() > 0.25);
                }
            }
        }
        assert!(world.kinetic_energy() < 1.0, "{restitution}");
    }
}

/// Two balls collide beside many at rest: the others do not change the number of impacts.
#[test]
fn bodies_at_rest_double_nothing() {
    for others in [0, 20] {
        let way = DVec3::new(0.6, 0.8, 0.0);
        let mut bodies = vec![
            ball(0.5, DVec3::ZERO, DVec3::ZERO),
            ball(0.5, 1.025 * way, -way),
        ];
        let at = |i: usize| DVec3::X * (10 + 3 * i) as f64;
        bodies.extend((0..others).map(|i| ball(0.5, at(i), DVec3::ZERO)));
        let mut world = world(DT, &bodies);
        let impacts = run(&mut world, 4);
        assert_eq!(impacts.len(), 1, "{others}: {impacts:?}");
        assert!((impacts[0].impulse - 1.0).abs() < 1e-14);
    }
}
