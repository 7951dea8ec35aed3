//! Queries about placed shapes: do they meet, how far apart are they, when do they hit each other (a shape cast), where
//! is a point, what does a ray hit?
//!
//! A [`Placed`] is a mesh, sphere or half-space at a position. A mesh is a surface, so a sphere deep inside
//! a closed mesh does not meet it; only [`locate`] knows the inside of a mesh. Spheres and half-spaces are
//! solid. No query allocates. A world answers the same queries about all of its bodies:
//! [`World::cast_ray`](crate::World::cast_ray), [`World::cast_shape`](crate::World::cast_shape),
//! [`World::bodies_meeting`](crate::World::bodies_meeting), [`World::nearest`](crate::World::nearest).
//!
//! ```
//! use sim_core::{DVec3, query::{self, Placed}};
//!
//! let ball = Placed::sphere(0.5, DVec3::new(0.0, 3.0, 0.0))?;
//! let floor = Placed::half_space(DVec3::Y, DVec3::ZERO)?;
//! let apart = query::distance(floor, ball).expect("not two half-spaces");
//! assert_eq!(apart.distance, 2.5);
//! assert_eq!(apart.points, [DVec3::ZERO, DVec3::new(0.0, 2.5, 0.0)]);
//!
//! let fall = DVec3::new(1.0, -5.0, 0.0);
//! let hit = query::time_of_impact(floor, ball, fall)?.expect("it lands");
//! assert_eq!((hit.time, hit.normal), (0.5, DVec3::Y));
//! # Ok::<(), query::QueryError>(())
//! ```

mod distance;
mod error;
mod placed;
mod ray;
#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::collide::{self, Contact, Feature, snap};
pub use crate::collide::{Part, Place};
pub use distance::distance;
pub(crate) use distance::distance_within;
pub use error::QueryError;
use error::check_vector;
pub use placed::Placed;
pub use ray::ray;
pub(crate) use ray::{Ray, ray_hit};

/// The closest points of two shapes, or their contact. For a ray cast the first shape is the one hit, the second one
/// the ray.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Hit {
    /// The time: as a part of the motion, 0 to 1; on a ray in lengths of its direction; 0 if neither shape moves.
    pub time: f64,
    /// The distance of the shapes at that time, m: 0 if they meet.
    pub distance: f64,
    /// The closest points of the first and of the second shape at that time, m; the same if they meet.
    pub points: [DVec3; 2],
    /// Unit normal, from the first shape to the second. Zero if there is none: for shapes that share a point and do
    /// not move into each other.
    pub normal: DVec3,
    /// The closest part of the first and of the second mesh; `None` for other shapes, and if it is not known
    /// (for a mesh against a half-space, and for shapes that share more than a point).
    pub parts: [Option<Part>; 2],
}

impl Hit {
    /// Two shapes that share a point.
    fn meeting(point: DVec3) -> Hit {
        Hit {
            time: 0.0,
            distance: 0.0,
            points: [point; 2],
            normal: DVec3::ZERO,
            parts: [None; 2],
        }
    }

    /// The same with the shapes in the other order, for shapes that do not move.
    fn turned(self) -> Hit {
        let ([one, other], [first, second]) = (self.points, self.parts);
        Hit {
            points: [other, one],
            normal: -self.normal,
            parts: [second, first],
            ..self
        }
    }
}

/// Whether two shapes share a point; always false for two half-spaces.
///
/// Exact for meshes: for the vertices of one mesh placed in the frame of the other, each of which is rounded once
/// ([`collide::Placement`]). For other shapes it is exact up to rounding in sums of products.
pub fn intersects(first: Placed<'_>, second: Placed<'_>) -> bool {
    collide::meet(first.form, second.form, first.offset_to(second))
}

/// The shape cast: the time when the second shape, which moves by `motion` (m), first hits the first shape, which is
/// at rest. `None` if it does not, and for two half-spaces. If both shapes move, `motion` is that of the second
/// relative to the first, and the points are relative to the position of the first.
///
/// - Shapes that share a point at the start hit at time 0. The normal is zero unless the motion leads into the
///   contact.
/// - Otherwise it is the first contact that the motion leads into; sliding along a surface is not a hit. Between
///   meshes it is decided exactly, and its time is the greatest f64 that is not above the exact one
///   ([`collide::touch`]); with a sphere it is early by at most 2^-48 of all lengths at the normal speed
///   ([`collide::ball_touch`]).
///
/// # Errors
///
/// [`QueryError::Vector`] if a component of `motion` is not a number within ±1e100 m.
pub fn time_of_impact(
    first: Placed<'_>,
    second: Placed<'_>,
    motion: DVec3,
) -> Result<Option<Hit>, QueryError> {
    check_motion(motion)?;
    Ok(first_hit(first, second, motion))
}

pub(crate) fn check_motion(motion: DVec3) -> Result<(), QueryError> {
    check_vector("motion", motion)
}

/// The same for a motion that has been checked.
pub(crate) fn first_hit(first: Placed<'_>, second: Placed<'_>, motion: DVec3) -> Option<Hit> {
    let offset = first.offset_to(second);
    let contact = collide::first_contact(first.form, second.form, offset, snap(motion));
    let contact = contact.map(|contact| hit_of(&contact, first.position));
    if contact.is_none_or(|hit| hit.time > 0.0) && intersects(first, second) {
        return distance(first, second);
    }
    contact
}

fn hit_of(contact: &Contact, origin: DVec3) -> Hit {
    let face = contact.face.map(Part::Face);
    let parts = match contact.feature {
        Some(Feature::VertexFace { vertex, face }) => {
            [Some(Part::Vertex(vertex)), Some(Part::Face(face))]
        }
        Some(Feature::FaceVertex { face, vertex }) => {
            [Some(Part::Face(face)), Some(Part::Vertex(vertex))]
        }
        Some(Feature::EdgeEdge { first, second }) => {
            [Some(Part::Edge(first)), Some(Part::Edge(second))]
        }
        None => [face, None],
    };
    Hit {
        time: contact.time,
        distance: 0.0,
        points: [origin + contact.point; 2],
        normal: contact.normal,
        parts,
    }
}

/// The place of a point (m) relative to a shape; `None` if the shape is an open mesh, which has no inside. A point is
/// inside a closed mesh if a path from it to the outside crosses the surface an odd number of times, for any winding
/// of the triangles.
///
/// Exact for the point relative to the shape's position, a difference that rounds once, for a mesh
/// ([`collide::locate`]) and for a sphere. For a half-space it is exact up to rounding in a sum of three products.
///
/// # Errors
///
/// [`QueryError::Vector`] if a component of `point` is not a number within ±1e100 m.
pub fn locate(shape: Placed<'_>, point: DVec3) -> Result<Option<Place>, QueryError> {
    check_vector("point", point)?;
    Ok(shape.locate(point - shape.position))
}
