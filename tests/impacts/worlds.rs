//! Worlds for the tests, and their common invariants.

use kit::worlds::{self, precise, world_of};
use sim_core::collide::tree;
use sim_core::{Body, Bvh, DVec3, Impact, World};

/// The distance from 1 to the next double.
pub(crate) const ULP: f64 = f64::EPSILON;

pub(crate) const DT: f64 = 1.0 / 60.0;

pub(crate) fn world(dt: f64, bodies: &[Body]) -> World {
    world_of(precise(dt), bodies)
}

/// Makes steps, and returns all their impacts.
pub(crate) fn run(world: &mut World, steps: u64) -> Vec<Impact> {
    worlds::run(world, steps).expect("a step")
}

/// Makes steps, and checks after each one that no two meshes meet.
pub(crate) fn run_apart(world: &mut World, steps: u64) -> Vec<Impact> {
    let trees: Vec<Option<Bvh>> = (0..world.len())
        .map(|i| world.mesh(i).map(|mesh| Bvh::build(mesh)))
        .collect();
    let mut impacts = Vec::new();
    for _ in 0..steps {
        impacts.extend(run(world, 1));
        assert_apart(world, &trees);
    }
    impacts
}

fn assert_apart(world: &World, trees: &[Option<Bvh>]) {
    for j in 1..trees.len() {
        for i in 0..j {
            let Some((first, second)) = trees[i].as_ref().zip(trees[j].as_ref()) else {
                continue;
            };
            let offset = world.position(j) - world.position(i);
            let meet = tree::intersect(first, second, offset);
            assert!(!meet, "step {}: {i} and {j} meet", world.steps());
        }
    }
}

/// Positions and velocities, bit by bit.
pub(crate) fn bits(world: &World) -> Vec<[u64; 6]> {
    (0..world.len())
        .map(|i| {
            let (x, v) = (world.position(i), world.velocity(i));
            [x.x, x.y, x.z, v.x, v.y, v.z].map(f64::to_bits)
        })
        .collect()
}

#[track_caller]
pub(crate) fn assert_close(value: DVec3, exact: DVec3, tolerance: f64, what: &str) {
    let error = (value - exact).abs().max_element();
    assert!(
        error <= tolerance,
        "{what}: {value} is {error:e} from {exact}, which is more than {tolerance:e}"
    );
}
