//! What the probe does: some bodies under every method in every collision mode, and the hash of it all.

use alloc::sync::Arc;
use sim_core::{
    Body, BodyKind, Collision, DVec3, Force, METHODS, Mesh, Settings, Shape, Vec3, World,
};

/// The hash on every machine, with the standard library and without.
pub(crate) const EXPECTED: u64 = 0x14f7_2d41_703f_0217;

const STEPS: u32 = 150;

/// The hash of the states in which all runs end; `None` where one of them fails.
pub(crate) fn hash() -> Option<u64> {
    let tetrahedron = Arc::new(tetrahedron()?);
    let mut hash = 0_u64;
    for method in METHODS {
        for collision in [Collision::Continuous, Collision::Bvh, Collision::Naive] {
            let settings = Settings {
                method,
                collision,
                ..Settings::default()
            };
            let mut world = world(settings, &tetrahedron)?;
            for _ in 0..STEPS {
                world.step().ok()?;
            }
            hash = hash.rotate_left(7) ^ world.state_hash();
        }
    }
    Some(hash)
}

fn tetrahedron() -> Option<Mesh> {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let corners = corners.map(|corner| corner - Vec3::splat(0.25));
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    Mesh::new(corners.into(), faces.into()).ok()
}

/// Two tetrahedra and a ball above a floor, under gravity and drag.
fn world(settings: Settings, mesh: &Arc<Mesh>) -> Option<World> {
    let mut world = World::new(settings).ok()?;
    let floor = Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Static,
        ..Body::default()
    };
    let ball = Body {
        shape: Some(Shape::Sphere { radius: 0.5 }),
        position: DVec3::new(0.1, 3.0, 0.2),
        restitution: 0.7,
        ..Body::default()
    };
    let solid = |x: f64, speed: f64| Body {
        shape: Some(Shape::Mesh(mesh.clone())),
        position: DVec3::new(x, 1.0, 0.0),
        velocity: DVec3::new(speed, 0.5, 0.0),
        mass: 2.0,
        ..Body::default()
    };
    for body in [floor, ball, solid(-2.0, 3.0), solid(2.0, -2.0)] {
        world.add(body).ok()?;
    }
    let forces = [
        Force::Gravity {
            acceleration: -9.81 * DVec3::Y,
        },
        Force::LinearDrag {
            body: Some(1),
            coefficient: 0.1,
        },
    ];
    for force in forces {
        world.add_force(force).ok()?;
    }
    Some(world)
}
