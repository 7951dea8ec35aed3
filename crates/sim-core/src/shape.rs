//! What a body is, to others that it meets.

use alloc::sync::Arc;
use glam::DVec3;

use crate::Mesh;

/// The shape of a body about its position.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A surface of triangles, open or closed.
    Mesh(Arc<Mesh>),
    /// A solid ball about the position.
    Sphere {
        /// Its radius, m, from 0 (a point that collides) to 1e100.
        radius: f64,
    },
    /// Everything on one side of a plane through the position: a floor or a wall. Two of them
    /// never collide.
    HalfSpace {
        /// Points out of it; of any length but 0.
        normal: DVec3,
    },
}

impl Shape {
    /// The mesh, if it is one.
    pub fn mesh(&self) -> Option<&Arc<Mesh>> {
        match self {
            Shape::Mesh(mesh) => Some(mesh),
            Shape::Sphere { .. } | Shape::HalfSpace { .. } => None,
        }
    }
}

impl Shape {
    /// Whether a box can hold it.
    pub(crate) fn is_bounded(&self) -> bool {
        !matches!(self, Shape::HalfSpace { .. })
    }
}

impl From<Arc<Mesh>> for Shape {
    fn from(mesh: Arc<Mesh>) -> Shape {
        Shape::Mesh(mesh)
    }
}
