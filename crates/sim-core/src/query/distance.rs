//! The distance of two shapes, and their closest points.

use core::ops::ControlFlow;
use glam::DVec3;

use super::{Hit, Placed, intersects};
use crate::{
    Bvh,
    collide::{Closest, Form, closest, closest_to_point, is_turned, reach, tree},
};

/// The distance of two shapes, m, and their closest points; `None` for two half-spaces. The distance is 0 if and only
/// if [`intersects`] says that the shapes meet; then both points are one shared point.
///
/// Between meshes the error is at most 16 roundings (2^-53) of the sizes of the two closest triangles and of the
/// distance, also if triangles are needles and edges are nearly parallel. With a sphere or a half-space the error is
/// relative to all coordinates, measured from the first shape.
pub fn distance(first: Placed<'_>, second: Placed<'_>) -> Option<Hit> {
    distance_within(first, second, f64::INFINITY)
}

/// The same, if the shapes are closer than a distance, m.
pub(crate) fn distance_within(first: Placed<'_>, second: Placed<'_>, within: f64) -> Option<Hit> {
    if let (Form::HalfSpace(_), Form::HalfSpace(_)) = (first.form, second.form) {
        return None;
    }
    if intersects(first, second) {
        let point = shared_point(first, second);
        return (within > 0.0).then(|| Hit::meeting(point));
    }
    let hit = apart(first, second, within)?;
    // A distance that rounds to zero is positive nevertheless.
    let distance = hit.distance.max(f64::MIN_POSITIVE);
    (distance < within).then_some(Hit { distance, ..hit })
}

/// The closest points of shapes that do not meet.
fn apart(first: Placed<'_>, second: Placed<'_>, within: f64) -> Option<Hit> {
    let offset = first.offset_to(second);
    let placed = |closest: Closest| Hit {
        time: 0.0,
        distance: closest.distance,
        points: closest.points.map(|point| first.position + point),
        normal: closest.normal,
        parts: closest.parts.map(Some),
    };
    match (first.form, second.form) {
        (Form::Mesh(one), Form::Mesh(other)) => closest(one, other, offset, within).map(placed),
        (Form::Mesh(mesh), Form::Sphere(radius)) => {
            let found = closest_to_point(mesh, offset, within + radius)?;
            let [on_mesh, centre] = found.points;
            let hit = placed(Closest {
                distance: found.distance - radius,
                points: [on_mesh, centre - radius * found.normal],
                ..found
            });
            Some(Hit {
                parts: [hit.parts[0], None],
                ..hit
            })
        }
        (Form::Sphere(one), Form::Sphere(other)) => {
            let length = offset.length();
            let normal = offset / length;
            Some(Hit {
                time: 0.0,
                distance: length - (one + other),
                points: [
                    first.position + one * normal,
                    second.position - other * normal,
                ],
                normal,
                parts: [None; 2],
            })
        }
        (Form::HalfSpace(normal), other) => {
            let (reach, corner) = reach(other, normal);
            let distance = normal.dot(offset) - reach;
            let point = offset + corner;
            let foot = point - normal.dot(point) * normal;
            Some(Hit {
                time: 0.0,
                distance,
                points: [first.position + foot, first.position + point],
                normal,
                parts: [None; 2],
            })
        }
        (Form::Sphere(_), Form::Mesh(_))
        | (Form::Mesh(_) | Form::Sphere(_), Form::HalfSpace(_)) => {
            apart(second, first, within).map(Hit::turned)
        }
    }
}

/// A point that two shapes share, m, rounded.
fn shared_point(first: Placed<'_>, second: Placed<'_>) -> DVec3 {
    let offset = first.offset_to(second);
    match (first.form, second.form) {
        (Form::Mesh(one), Form::Mesh(other)) => match is_turned(offset) {
            true => second.position + shared_by_meshes(other, one, -offset),
            false => first.position + shared_by_meshes(one, other, offset),
        },
        (Form::Mesh(mesh), Form::Sphere(_)) => {
            let found = closest_to_point(mesh, offset, f64::INFINITY);
            first.position + found.map_or(offset, |found| found.points[0])
        }
        // On the line of centres, in the middle of the part that both share.
        (Form::Sphere(one), Form::Sphere(other)) => {
            let length = offset.length();
            let (low, high) = ((length - other).max(-one), (length + other).min(one));
            let along = offset.try_normalize().unwrap_or(DVec3::ZERO);
            first.position + 0.5 * (low + high) * along
        }
        // The point that reaches farthest into the half-space.
        (Form::HalfSpace(normal), other) => second.position + reach(other, normal).1,
        (Form::Sphere(_), Form::Mesh(_))
        | (Form::Mesh(_) | Form::Sphere(_), Form::HalfSpace(_)) => shared_point(second, first),
    }
}

fn shared_by_meshes(first: &Bvh, second: &Bvh, offset: DVec3) -> DVec3 {
    let mut point = offset;
    let _ = tree::each_hit(first, second, offset, |hit| {
        point = hit.point;
        ControlFlow::Break(())
    });
    point
}
