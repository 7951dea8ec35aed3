//! How far apart are two shapes, and where are they closest?

use sim_core::query::{self, Placed};
use sim_core::{Bvh, DVec3, Mesh, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let tree = Bvh::build(&Mesh::new(vertices, faces)?);

    let mesh = Placed::mesh(&tree, DVec3::ZERO)?;
    let shapes = [
        ("another mesh", mesh.at(DVec3::new(0.8, 0.9, 0.7))?),
        ("a ball", Placed::sphere(0.25, DVec3::new(1.0, 1.0, 1.0))?),
        (
            "a floor",
            Placed::half_space(DVec3::Y, DVec3::new(0.0, -2.0, 0.0))?,
        ),
        ("itself, moved a little", mesh.at(DVec3::splat(0.1))?),
    ];
    for (name, shape) in shapes {
        let Some(hit) = query::distance(mesh, shape) else {
            continue;
        };
        let [from, to] = hit.points;
        println!(
            "{name}: {:.6} m, from {from:.3} to {to:.3}, by {:?}",
            hit.distance, hit.parts
        );
    }
    // Inside, on the surface, or outside?
    for point in [DVec3::splat(0.1), DVec3::X, DVec3::ONE] {
        println!("{point} is {:?}", query::locate(mesh, point)?);
    }
    Ok(())
}
