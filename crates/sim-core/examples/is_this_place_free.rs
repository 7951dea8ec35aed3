//! Is there room for a shape? Who is in a place, and what is nearest to a point.

use std::sync::Arc;

use sim_core::query::Placed;
use sim_core::{Body, Bvh, DVec3, Mesh, Settings, Shape, Vec3, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let tetrahedron = Arc::new(Mesh::new(vertices, faces)?);

    let mut world = World::new(Settings::default())?;
    world.add(Body {
        shape: Some(tetrahedron.clone().into()),
        ..Body::default()
    })?;
    world.add(Body {
        shape: Some(Shape::Sphere { radius: 1.0 }),
        position: DVec3::new(4.0, 0.0, 0.0),
        ..Body::default()
    })?;

    // The tree of a shape that is in no world yet is made once, and placed as often as one likes.
    let tree = Bvh::build(&tetrahedron);
    for x in [0.25, 1.5, 2.5, 6.0] {
        let shape = Placed::mesh(&tree, DVec3::new(x, 0.1, 0.1))?;
        match &world.bodies_meeting(shape)[..] {
            [] => println!("x = {x}: free"),
            bodies => println!("x = {x}: taken by {bodies:?}"),
        }
    }
    if let Some((body, hit)) = world.nearest(DVec3::new(1.9, 0.0, 0.0), |_| true)? {
        println!("nearest: body {body}, {} m away", hit.distance);
    }
    Ok(())
}
