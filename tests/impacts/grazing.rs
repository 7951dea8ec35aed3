//! A body that just touches a floor of several, beside the case of grazing.

use kit::bodies::mesh_body;
use kit::meshes::cube;
use sim_core::{Body, BodyKind, DVec3};

use crate::worlds::{DT, run, world};

/// A cube slides along a floor of four cubes, a hair above it, and is not stopped where they join.
#[test]
fn joints_of_a_floor_stop_nothing() {
    let tile = cube(0.5);
    for height in [1.0 + 1e-12, 1.0 + 1e-9] {
        let mut bodies: Vec<Body> = (0..4)
            .map(|i| Body {
                kind: BodyKind::Static,
                ..mesh_body(&tile, DVec3::X * f64::from(i), DVec3::ZERO)
            })
            .collect();
        let velocity = DVec3::new(2.0, 0.0, 0.5);
        bodies.push(mesh_body(&tile, DVec3::new(-2.0, height, -0.25), velocity));
        let mut world = world(DT, &bodies);
        assert!(run(&mut world, 200).is_empty(), "height {height}");
        assert_eq!(world.velocity(4), velocity);
    }
}
