//! Bodies.

use std::sync::Arc;

use sim_core::{Body, BodyKind, DVec3, Mesh, Shape};

use crate::shapes::{self, half_space};

/// A body of a shape at a place.
pub fn at(shape: &Shape, position: DVec3) -> Body {
    body(shape, position, DVec3::ZERO)
}

/// A body of a shape at a place, on its way.
pub fn body(shape: &Shape, position: DVec3, velocity: DVec3) -> Body {
    Body {
        shape: Some(shape.clone()),
        position,
        velocity,
        ..Body::default()
    }
}

/// A ball, or a point, on its way.
pub fn ball(radius: f64, position: DVec3, velocity: DVec3) -> Body {
    body(&shapes::ball(radius), position, velocity)
}

/// A body of a mesh, on its way.
pub fn mesh_body(mesh: &Arc<Mesh>, position: DVec3, velocity: DVec3) -> Body {
    body(&Shape::Mesh(mesh.clone()), position, velocity)
}

/// The same body, which nothing moves.
pub fn immovable(body: Body) -> Body {
    Body {
        kind: BodyKind::Kinematic,
        ..body
    }
}

/// A half-space that nothing moves, below a plane through a place, perhaps with a velocity of its own.
pub fn wall(normal: DVec3, position: DVec3, velocity: DVec3) -> Body {
    immovable(body(&half_space(normal), position, velocity))
}
