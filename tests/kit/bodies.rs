//! Bodies.

use std::sync::Arc;

use sim_core::{Body, BodyKind, DVec3, Mesh, Shape};

use crate::shapes::{self, half_space};

/// A body of a shape at a position.
pub fn at(shape: &Shape, position: DVec3) -> Body {
    body(shape, position, DVec3::ZERO)
}

/// A moving body of a shape at a position.
pub fn body(shape: &Shape, position: DVec3, velocity: DVec3) -> Body {
    Body {
        shape: Some(shape.clone()),
        position,
        velocity,
        ..Body::default()
    }
}

/// A moving ball, or a point.
pub fn ball(radius: f64, position: DVec3, velocity: DVec3) -> Body {
    body(&shapes::ball(radius), position, velocity)
}

/// A moving body with a mesh.
pub fn mesh_body(mesh: &Arc<Mesh>, position: DVec3, velocity: DVec3) -> Body {
    body(&Shape::Mesh(mesh.clone()), position, velocity)
}

/// The same body, immovable.
pub fn immovable(body: Body) -> Body {
    Body {
        kind: BodyKind::Kinematic,
        ..body
    }
}

/// An immovable half-space below a plane through a point, possibly with a velocity.
pub fn wall(normal: DVec3, position: DVec3, velocity: DVec3) -> Body {
    immovable(body(&half_space(normal), position, velocity))
}
