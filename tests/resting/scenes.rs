//! Floors, and what lies on them.

use sim_core::{Body, DVec3, Force, Method, Settings, Shape, World};

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
    Shape::Mesh(scene::mesh_file::builtin("cube.obj").expect("built in"))
}

pub(crate) fn step(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step().expect("a step");
    }
}
