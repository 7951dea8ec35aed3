//! Ray casts.

use glam::DVec3;

use super::{Hit, Part, Placed, QueryError, error::check_vector};
use crate::collide::Form;

/// Where a ray from `origin` (m) along `direction` (of any length but 0) first hits a shape, however far away:
/// at `origin + time · direction`. The normal is against the direction.
///
/// Surfaces are hit from either side, so that a ray from within a sphere hits it where it leaves, as it does a mesh.
/// None slips through between two triangles ([`Bvh::ray`](crate::Bvh::ray)). Times are rounded like any quotient.
///
/// # Errors
///
/// [`QueryError::Vector`] if a component of either is no number within ±1e100, [`QueryError::Direction`] if the
/// direction is zero, or too short to be divided by.
pub fn ray(shape: Placed<'_>, origin: DVec3, direction: DVec3) -> Result<Option<Hit>, QueryError> {
    let ray = Ray::new(origin, direction)?;
    Ok(ray_hit(shape, &ray, f64::INFINITY))
}

/// A ray that has been checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl Ray {
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Result<Ray, QueryError> {
        check_vector("origin", origin)?;
        check_vector("direction", direction)?;
        match direction.abs().max_element() >= f64::MIN_POSITIVE {
            true => Ok(Ray { origin, direction }),
            false => Err(QueryError::Direction {
                what: "direction",
                value: direction,
            }),
        }
    }
}

/// Where a ray first hits a shape, before a time.
pub(crate) fn ray_hit(shape: Placed<'_>, ray: &Ray, within: f64) -> Option<Hit> {
    let (origin, direction) = (ray.origin - shape.position, ray.direction);
    let (time, normal, face) = match shape.form {
        Form::Mesh(tree) => {
            let (hit, corners) = tree.ray_before(origin, direction, within)?;
            let [a, b, c] = corners.map(|v| v.as_dvec3());
            (
                hit.t,
                unit((b - a).cross(c - a)),
                Some(Part::Face(hit.face)),
            )
        }
        Form::Sphere(radius) => {
            let (time, normal) = sphere(origin, direction, radius)?;
            (time, normal, None)
        }
        Form::HalfSpace(normal) => {
            let (height, speed) = (normal.dot(origin), normal.dot(direction));
            (-height / speed, normal, None)
        }
    };
    let against = if normal.dot(direction) > 0.0 {
        -normal
    } else {
        normal
    };
    // Beside a plane it is no number.
    (time >= 0.0 && time < within).then_some(Hit {
        time,
        distance: 0.0,
        points: [ray.origin + time * direction; 2],
        normal: against,
        parts: [face, None],
    })
}

/// Of unit length; zero of what has no direction.
fn unit(normal: DVec3) -> DVec3 {
    let scaled = normal / normal.abs().max_element();
    scaled.normalize_or_zero()
}

/// When a ray first meets the surface of a ball about the origin, in lengths of its direction, and the normal
/// there.
fn sphere(origin: DVec3, direction: DVec3, radius: f64) -> Option<(f64, DVec3)> {
    // Scaled first, so that no square over- or underflows.
    let longest = direction.abs().max_element();
    let scaled = direction / longest;
    let length = scaled.length();
    let along = scaled / length;
    let far = origin.abs().max_element().max(radius);
    if far == 0.0 {
        return Some((0.0, -along));
    }
    let (from, radius) = (origin / far, radius / far);
    let before = -from.dot(along);
    // From the point nearest to the centre, rather than by b² - 4ac, which cancels far away.
    let aside = from + before * along;
    let square = (radius - aside.length()) * (radius + aside.length());
    if square < 0.0 {
        return None;
    }
    let half_chord = libm::sqrt(square);
    let first = match before >= half_chord {
        true => -half_chord,
        false => half_chord,
    };
    let time = before + first;
    let normal = (aside + first * along).try_normalize();
    let time = time * far / length / longest;
    (time >= 0.0).then(|| (time, normal.unwrap_or(-along)))
}
