//! Two bodies beside each other, in addition to the cases of two head on.

use kit::bodies::mesh_body;
use kit::meshes::cube;
use sim_core::{Body, DVec3};

use crate::worlds::{DT, bits, run, world};

#[test]
fn bodies_that_nothing_meets_move_as_points_do() {
    let cube = cube(0.5);
    let cubes = [0.0, 3.0, 7.0].map(|y| mesh_body(&cube, DVec3::Y * y, DVec3::new(50.0, 0.0, 1.0)));
    let points = cubes.clone().map(|body| Body {
        shape: None,
        ..body
    });
    let [mut cubes, mut points] = [world(DT, &cubes), world(DT, &points)];
    assert!(run(&mut cubes, 100).is_empty());
    run(&mut points, 100);
    assert_eq!(bits(&cubes), bits(&points));
}
