//! A hit: an edge of one mesh meets a triangle of the other.

use glam::DVec3;

use super::predicates::orient3d;

/// One of two meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// The mesh in whose frame the other is placed.
    First,
    /// The mesh that is displaced.
    Second,
}

/// An edge that meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The mesh of the edge; the face belongs to the other mesh.
    pub edge_of: Side,
    /// Index of the edge in [`crate::Mesh::edges`].
    pub edge: u32,
    /// Index of the triangle.
    pub face: u32,
    /// A point that both share, in the first mesh's frame, m (rounded).
    pub point: DVec3,
    /// Unit normal of the triangle by its winding; zero for a triangle without area.
    pub normal: DVec3,
}

impl Hit {
    /// The data of a hit that [`super::predicates::segment_meets_triangle`] has found.
    pub(super) fn new(
        (edge_of, edge, [p, q]): (Side, u32, [DVec3; 2]),
        (face, [a, b, c]): (u32, [DVec3; 3]),
    ) -> Hit {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let (sp, sq) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
        let point = if sp == sq {
            in_plane_point([p, q], [a, b, c], normal)
        } else {
            p.lerp(q, (sp / (sp - sq)).clamp(0.0, 1.0))
        };
        Hit {
            edge_of,
            edge,
            face,
            point,
            normal,
        }
    }

    /// The order in which hits are listed.
    pub(super) fn key(&self) -> (Side, u32, u32) {
        (self.edge_of, self.edge, self.face)
    }
}

/// The middle of the part of `pq` inside the triangle; both are in one plane.
fn in_plane_point([p, q]: [DVec3; 2], corners: [DVec3; 3], normal: DVec3) -> DVec3 {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let inward = normal.cross(b - a);
        let (dp, dq) = (inward.dot(p - a), inward.dot(q - a));
        if dp < 0.0 && dq > 0.0 {
            enter = enter.max(dp / (dp - dq));
        } else if dp > 0.0 && dq < 0.0 {
            leave = leave.min(dp / (dp - dq));
        }
    }
    p.lerp(q, (0.5 * (enter + leave)).clamp(0.0, 1.0))
}
