//! When do two moving shapes hit, where, and with which normal? Then the same against all bodies of a world.

use sim_core::query::{self, Placed};
use sim_core::{Body, BodyKind, Bvh, DVec3, Mesh, Settings, Shape, Vec3, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let tree = Bvh::build(&Mesh::new(vertices, faces)?);

    // Two meshes that move for 2 s: what counts is how the second moves as seen from the first.
    let first = Placed::mesh(&tree, DVec3::ZERO)?;
    let second = Placed::mesh(&tree, DVec3::new(4.0, 0.2, 0.2))?;
    let (velocities, duration) = ([DVec3::X, -DVec3::X], 2.0);
    let motion = (velocities[1] - velocities[0]) * duration;
    match query::time_of_impact(first, second, motion)? {
        Some(hit) => println!(
            "after {} s: {:?}, normal {}",
            hit.time * duration,
            hit.parts,
            hit.normal
        ),
        None => println!("not within {duration} s"),
    }

    // How far can a ball go before it is stopped?
    let mut world = World::new(Settings::default())?;
    world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Static,
        ..Body::default()
    })?;
    let ball = Placed::sphere(0.5, DVec3::new(0.0, 3.0, 0.0))?;
    let way = DVec3::new(4.0, -5.0, 0.0);
    if let Some((body, hit)) = world.cast_shape(ball, way, |_| true)? {
        let stop = ball.position() + hit.time * way;
        println!(
            "stopped by body {body} at {stop}, touching {}",
            hit.points[0]
        );
    }
    Ok(())
}
