//! Floors, and what lies on them.

use std::sync::Arc;

use sim_core::{Body, DVec3, Force, Mesh, Method, Settings, Shape, Vec3, World};

pub(crate) const GRAVITY: f64 = 9.81;

/// A world under gravity, stepped by a method at 60 Hz.
pub(crate) fn world(method: &'static Method) -> World {
    let settings = Settings {
        method,
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("a world");
    let acceleration = GRAVITY * DVec3::NEG_Y;
    world
        .add_force(Force::Gravity { acceleration })
        .expect("gravity");
    world
}

/// A half-space that nothing moves, below a plane through a place.
pub(crate) fn ground(normal: DVec3, position: DVec3) -> Body {
    Body {
        shape: Some(Shape::HalfSpace { normal }),
        position,
        mass: f64::INFINITY,
        restitution: 0.0,
        ..Body::default()
    }
}

pub(crate) fn ball(radius: f64) -> Shape {
    Shape::Sphere { radius }
}

/// A cube of side 1 m about its origin.
pub(crate) fn cube() -> Shape {
    let corner = |i: i32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5;
    let quads: [[u32; 4]; 6] = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let mesh = Mesh::new((0..8).map(corner).collect(), triangles);
    Shape::Mesh(Arc::new(mesh.expect("a cube")))
}

pub(crate) fn step(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step().expect("a step");
    }
}
