//! Ray casts.

use glam::DVec3;

use super::{Hit, Part, Placed, QueryError, error::check_vector};
use crate::collide::Form;

/// The first hit of a ray from `origin` (m) along `direction` (of any length but 0) on a shape, at any distance: at
/// `origin + time · direction`. The normal opposes the direction.
///
/// Surfaces are hit from either side: a ray from inside a sphere or a mesh hits it where it leaves. No ray passes
/// between two adjacent triangles ([`Bvh::ray`](crate::Bvh::ray)). Times are rounded like any quotient.
///
/// # Errors
///
/// [`QueryError::Vector`] if a component of either is not a number within ±1e100, [`QueryError::Direction`] if the
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

/// The first hit of a ray on a shape, before a given time.
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
    // For a ray parallel to a plane the time is NaN.
    (time >= 0.0 && time < within).then_some(Hit {
        time,
        distance: 0.0,
        points: [ray.origin + time * direction; 2],
        normal: against,
        parts: [face, None],
    })
}

/// The unit vector; zero for a vector without a direction.
fn unit(normal: DVec3) -> DVec3 {
    let scaled = normal / normal.abs().max_element();
    scaled.normalize_or_zero()
}

/// The first time at which a ray meets the surface of a ball about the origin, in lengths of its direction, and the
/// normal there.
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
    // From the point nearest to the centre, and not by b² - 4ac, which cancels at a distance.
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
