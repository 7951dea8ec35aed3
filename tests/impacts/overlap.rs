//! A body that hits two overlapping ones, in addition to the case of the two alone.

use kit::bodies::mesh_body;
use kit::meshes::cube;
use sim_core::DVec3;

use crate::worlds::{DT, run, world};

/// A third body bounces off an overlapping pair as off any other body.
#[test]
fn others_are_not_disturbed_by_a_pair_in_overlap() {
    let cube = cube(0.5);
    let pair = [0.0, 0.9].map(|x| mesh_body(&cube, DVec3::X * x, DVec3::ZERO));
    let [first, second] = pair;
    let third = mesh_body(&cube, DVec3::new(-3.0, 0.0, 0.0), 4.0 * DVec3::X);
    let mut world = world(DT, &[first, second, third]);
    let energy = world.kinetic_energy();
    let impacts = run(&mut world, 120);
    assert!(impacts.iter().any(|i| i.bodies == (0, 2)), "{impacts:?}");
    let momentum = world.momentum() - 4.0 * DVec3::X;
    assert!(momentum.length() <= 1e-14 * 4.0, "{momentum}");
    let error = (world.kinetic_energy() / energy - 1.0).abs();
    assert!(error <= 1e-14, "energy off by {error:e}");
    let distances = world.position(0) - world.position(2);
    assert!(distances.x >= 1.0, "{distances}");
}
