//! Bodies placed in overlap are held together: the overlap gets no deeper, and energy does not rise.

use kit::bodies::{at, immovable};
use kit::random::Random;
use kit::shapes::{ball, cow, cuboid, half_space};
use kit::worlds::{add_gravity, world};
use sim_core::{Body, BodyKind, DVec3, Shape, World};

use crate::{WEIGHT, touching};

/// Makes steps, and checks after each that no overlap is deeper than at the start, that there is no new one, and that
/// the energy has not grown.
fn assert_held(world: &mut World, steps: u64, what: &str) {
    let starts = world.overlaps();
    let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
    let (first, mut moved) = (energy(world), 0.0_f64);
    // Touching bodies that do not overlap are moved apart initially, by no more than rounding, even against gravity.
    let lifted = match starts.is_empty() {
        true => 3.0 * 9.81 * world.flush(0, 1) * movable_mass(world),
        false => 0.0,
    };
    for step in 1..=steps {
        world
            .step()
            .unwrap_or_else(|error| panic!("{what}: {error}"));
        for overlap in world.overlaps() {
            let pair = overlap.bodies;
            let start = starts.iter().find(|start| start.bodies == pair);
            let start = start.unwrap_or_else(|| panic!("{what}: {pair:?} came into each other"));
            let deeper = overlap.depth - start.depth;
            assert!(
                deeper <= 1e-9 * start.depth + 1e-10,
                "{what}, step {step}: {} m, then {} m",
                start.depth,
                overlap.depth
            );
        }
        moved = moved.max(world.kinetic_energy());
        let gain = energy(world) - first;
        assert!(
            gain <= 1e-11 * (moved + first.abs() + 1.0) + lifted,
            "{what}, step {step}: {gain:e} J of {first} J"
        );
    }
}

/// The mass of all movable bodies, kg.
fn movable_mass(world: &World) -> f64 {
    let movable = world.bodies().filter(|body| body.kind.is_movable());
    movable.map(|body| body.mass).sum()
}

/// Two shapes that overlap by some depth along a direction.
fn pair(first: &Shape, second: &Shape, direction: DVec3, depth: f64) -> [Body; 2] {
    let offset = (touching(first, second, direction) - depth) * direction;
    [at(first, DVec3::ZERO), at(second, offset)]
}

#[test]
fn overlaps_of_all_kinds_get_no_deeper_and_gain_no_energy() {
    let shapes = [ball(0.5), cuboid([0.5; 3]), cow(), cuboid([0.2, 0.7, 0.4])];
    let mut held = 0;
    for seed in 1..=100 {
        let mut random = Random::xorshift(seed * 0x9e37_79b9, 33);
        let (first, second) = (&shapes[random.below(4)], &shapes[random.below(4)]);
        let direction = random.direction();
        let depth = [1e-9, 1e-6, 1e-3, 0.03, 0.2, 0.5][random.below(6)];
        let mut bodies = pair(first, second, direction, depth);
        for body in &mut bodies {
            body.mass = [1.0, 0.1, 20.0][random.below(3)];
            body.velocity = [0.0, 0.3, 2.0][random.below(3)] * random.vector();
            body.restitution = [1.0, 0.5, 0.0][random.below(3)];
            body.friction = [0.0, 0.4][random.below(2)];
        }
        if random.below(3) == 0 {
            bodies[0].kind = BodyKind::Static;
            bodies[0].velocity = DVec3::ZERO;
        }
        let mut world = world(bodies);
        if random.below(2) == 0 {
            add_gravity(&mut world, WEIGHT);
        }
        held += world.overlaps().len();
        assert_held(&mut world, 120, &format!("seed {seed}"));
    }
    assert!(held > 50, "{held}");
}

#[test]
fn overlaps_with_half_spaces_get_no_deeper_and_gain_no_energy() {
    let shapes = [ball(0.5), cuboid([0.5; 3]), cow(), ball(0.0)];
    for seed in 1..=60 {
        let mut random = Random::xorshift(seed * 0x9e37_79b9, 33);
        let mut normal = random.direction();
        normal.y = normal.y.abs();
        let floor = immovable(at(&half_space(normal), DVec3::ZERO));
        let shape = &shapes[random.below(4)];
        let along = touching(&half_space(normal), shape, normal);
        let depth = [1e-9, 1e-6, 1e-3, 0.03, 0.2, 0.5][random.below(6)];
        let body = Body {
            velocity: [0.0, 0.3, 2.0][random.below(3)] * random.vector(),
            restitution: [1.0, 0.5, 0.0][random.below(3)],
            friction: [0.0, 0.4][random.below(2)],
            ..at(shape, (along - depth) * normal)
        };
        let mut world = world([floor, body]);
        add_gravity(&mut world, WEIGHT);
        assert_held(&mut world, 120, &format!("seed {seed}"));
    }
}

#[test]
fn what_slides_in_a_floor_does_not_come_through_a_wall_of_the_same_mesh() {
    // A floor and a wall across it, as one mesh.
    let corner = {
        let Shape::Mesh(floor) = cuboid([4.0, 0.5, 4.0]) else {
            unreachable!("it is a mesh");
        };
        let mut vertices: Vec<_> = floor.vertices().to_vec();
        let mut triangles: Vec<_> = floor.triangles().to_vec();
        let count = vertices.len() as u32;
        vertices.extend(
            floor
                .vertices()
                .iter()
                .map(|v| glam::Vec3::new(2.0 + 0.25 * v.x / 4.0, 1.0 + 2.0 * v.y, v.z)),
        );
        triangles.extend(floor.triangles().iter().map(|t| t.map(|v| v + count)));
        Shape::Mesh(std::sync::Arc::new(
            sim_core::Mesh::new(vertices, triangles).expect("a mesh"),
        ))
    };
    for (shape, reach) in [(ball(0.25), 0.25), (cuboid([0.25; 3]), 0.25)] {
        let body = Body {
            velocity: DVec3::new(3.0, 0.0, 0.0),
            ..at(&shape, DVec3::new(0.0, 0.5 + reach - 0.05, 0.1))
        };
        let mut world = world([immovable(at(&corner, DVec3::ZERO)), body]);
        add_gravity(&mut world, WEIGHT);
        assert_held(&mut world, 120, "along the floor");
        assert!(
            world.position(1).x < 1.75 - 0.5 * reach,
            "{}",
            world.position(1)
        );
    }
}
