//! What is put into a world.

use alloc::sync::Arc;
use glam::DVec3;

use crate::Mesh;

/// A body at the start: where it is, how it moves, what drives it. It translates; a fixed
/// orientation and scale are part of its mesh ([`Mesh::transformed`]).
#[derive(Clone, Debug)]
pub struct Body {
    /// Surface that collides; `None` is a point, which meets nothing.
    pub mesh: Option<Arc<Mesh>>,
    /// Place of the mesh's origin, m.
    pub position: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Mass, kg; positive.
    pub mass: f64,
    /// Constant resultant of all forces, N.
    pub force: DVec3,
}

impl Default for Body {
    /// A point of 1 kg at rest at the origin.
    fn default() -> Body {
        Body {
            mesh: None,
            position: DVec3::ZERO,
            velocity: DVec3::ZERO,
            mass: 1.0,
            force: DVec3::ZERO,
        }
    }
}
