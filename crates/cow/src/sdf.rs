//! Signed distance functions, after the derivations that Inigo Quilez
//! collects at <https://iquilezles.org/articles/distfunctions/> and
//! <https://iquilezles.org/articles/smin/>.
//!
//! Lengths are in metres; a distance is negative inside.

use glam::{Mat3, Vec3};

/// A closed shape with a signed distance, exact or a close bound near its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The convex hull of two balls, squeezed sideways.
    RoundCone {
        /// Centre of the first ball.
        a: Vec3,
        /// Radius of the first ball.
        ra: f32,
        /// Centre of the second ball.
        b: Vec3,
        /// Radius of the second ball.
        rb: f32,
        /// Factor on the widths along z, in (0, 1]; 1 leaves the cone round.
        squeeze: f32,
    },
    /// An ellipsoid turned by a rotation.
    Ellipsoid {
        /// Centre.
        centre: Vec3,
        /// Half-lengths of the axes.
        radii: Vec3,
        /// Takes the model's axes to the ellipsoid's own.
        to_local: Mat3,
    },
    /// Everything below the height `y`.
    Below {
        /// Height of the bounding plane.
        y: f32,
    },
}

impl Shape {
    /// Signed distance from `p` to the shape's surface.
    pub fn distance(&self, p: Vec3) -> f32 {
        match *self {
            Shape::RoundCone {
                a,
                ra,
                b,
                rb,
                squeeze,
            } => {
                // Both ends of a squeezed cone have the same z, so stretching
                // space about that plane undoes the squeeze.
                let stretched = Vec3::new(p.x, p.y, a.z + (p.z - a.z) / squeeze);
                round_cone(stretched, a, ra, b, rb) * squeeze
            }
            Shape::Ellipsoid {
                centre,
                radii,
                to_local,
            } => ellipsoid(to_local * (p - centre), radii),
            Shape::Below { y } => p.y - y,
        }
    }
}

/// Exact distance to the convex hull of two balls. The hull's side is the cone
/// tangent to both, so a point belongs to a ball or to the side by where the
/// perpendicular to that cone through the point meets the axis.
fn round_cone(p: Vec3, a: Vec3, ra: f32, b: Vec3, rb: f32) -> f32 {
    let axis = b - a;
    let length = axis.length();
    let narrowing = ra - rb;
    if length <= narrowing.abs() {
        // One ball holds the other.
        return if ra > rb {
            p.distance(a) - ra
        } else {
            p.distance(b) - rb
        };
    }
    let sine = narrowing / length;
    let cosine = (1.0 - sine * sine).sqrt();
    let along = (p - a).dot(axis) / length;
    let out = ((p - a).length_squared() - along * along).max(0.0).sqrt();
    let foot = along - out * sine / cosine;
    if foot <= 0.0 {
        p.distance(a) - ra
    } else if foot >= length {
        p.distance(b) - rb
    } else {
        along * sine + out * cosine - ra
    }
}

/// Distance to an ellipsoid at the origin to first order: the excess of the
/// scaled radius over one, divided by the length of its gradient.
fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let k0 = (p / radii).length();
    let k1 = (p / (radii * radii)).length();
    if k1 == 0.0 {
        -radii.min_element()
    } else {
        k0 * (k0 - 1.0) / k1
    }
}

/// Union whose seam is rounded where the two distances differ by less than
/// `radius` (the quadratic smooth minimum).
pub fn smooth_union(d1: f32, d2: f32, radius: f32) -> f32 {
    let overlap = (radius - (d1 - d2).abs()).max(0.0);
    d1.min(d2) - overlap * overlap / (4.0 * radius)
}

/// `from` less `tool`, the rim rounded like the seam of [`smooth_union`].
pub fn smooth_difference(from: f32, tool: f32, radius: f32) -> f32 {
    -smooth_union(-from, tool, radius)
}
