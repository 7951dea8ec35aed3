//! Two meshes made from arrays: do they meet, where, and how do they bounce?

use std::sync::Arc;

use sim_core::collide::{self, Placement};
use sim_core::{Body, Bvh, DQuat, DVec3, Mesh, Settings, Vec3, World};

/// A tetrahedron with its corner at the origin.
fn tetrahedron() -> Result<Mesh, sim_core::MeshError> {
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    Mesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = Arc::new(tetrahedron()?);

    // One question about two meshes, the second displaced, in either way.
    let offset = DVec3::new(0.25, 0.25, 0.25);
    let tree = Bvh::build(&mesh);
    println!(
        "meet, naive: {}",
        collide::naive::intersect(&mesh, &mesh, offset)
    );
    println!(
        "meet, BVH:   {}",
        collide::tree::intersect(&tree, &tree, offset)
    );
    for hit in collide::tree::hits(&tree, &tree, offset) {
        println!(
            "  edge {} of the {:?} in face {} at {}",
            hit.edge, hit.edge_of, hit.face, hit.point
        );
    }

    // The second one turned as well; and a point in the first one.
    let turned = Placement::turned(DQuat::from_rotation_y(0.5), offset).ok_or("no rotation")?;
    println!(
        "meet, turned: {}, at the price of {:?}",
        collide::tree::intersect(&tree, &tree, turned),
        collide::tree::work(&tree, &tree, turned)
    );
    println!("{offset} is {:?}", collide::locate(&tree, offset));

    // The same meshes as bodies: one flies at the other, and they exchange an impulse.
    let mut world = World::new(Settings::default())?;
    let at_rest = Body {
        shape: Some(mesh.into()),
        mass: 2.0,
        ..Body::default()
    };
    let moving = Body {
        position: DVec3::new(3.0, 0.2, 0.2),
        velocity: DVec3::new(-2.0, 0.0, 0.0),
        ..at_rest.clone()
    };
    world.add(at_rest)?;
    world.add(moving)?;
    let before = (world.momentum(), world.kinetic_energy());
    while world.time() < 3.0 {
        world.step()?;
    }
    println!("impact: {:?}", world.last_impact());
    println!("momentum {} -> {}", before.0, world.momentum());
    println!("kinetic energy {} -> {}", before.1, world.kinetic_energy());
    Ok(())
}
