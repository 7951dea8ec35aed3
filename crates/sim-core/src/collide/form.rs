//! Two shapes of any kind: whether they meet, and their first contact.
//!
//! Meshes against meshes are exact ([`tree`], [`touch`]). Spheres and half-spaces have closed forms, whose times are
//! rounded like any quotient. If the second shape is at `r` and moves by `t d` from there:
//!
//! ```text
//! half-space, unit normal n:   n·(r + t d) = reach,   reach the most that the shape extends along -n
//! spheres of radii that sum R: |r + t d| = R,         t = (r² - R²) / (-r·d + √(R² d² - |r×d|²))
//! ```

use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::DVec3;

use super::{
    Feature, Touch,
    ball::{BallTouch, ball_meets, ball_touch},
    touch, tree,
};
use crate::bvh::Bvh;

/// A shape about its origin.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form<'a> {
    Mesh(&'a Bvh),
    /// Of this radius, m.
    Sphere(f64),
    /// With this unit normal.
    HalfSpace(DVec3),
}

/// The first contact of two shapes within a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    /// The part of the motion before the contact.
    pub(crate) time: f64,
    /// The contact point relative to the first shape's origin, m.
    pub(crate) point: DVec3,
    /// Unit normal, from the first shape to the second.
    pub(crate) normal: DVec3,
    /// The features that touch, if both shapes are meshes.
    pub(crate) feature: Option<Feature>,
    /// The triangle that a sphere touches.
    pub(crate) face: Option<u32>,
}

impl Contact {
    /// The same contact with the shapes in the other order; the second one is displaced by `offset` and then moves by
    /// `motion`, m.
    fn turned(self, offset: DVec3, motion: DVec3) -> Contact {
        Contact {
            point: self.point + (offset + self.time * motion),
            normal: -self.normal,
            feature: self.feature.map(Feature::turned),
            ..self
        }
    }
}

impl From<Touch> for Contact {
    fn from(touch: Touch) -> Contact {
        Contact {
            time: touch.time,
            point: touch.point,
            normal: touch.normal,
            feature: Some(touch.feature),
            face: None,
        }
    }
}

impl From<BallTouch> for Contact {
    fn from(touch: BallTouch) -> Contact {
        Contact {
            time: touch.time,
            point: touch.point,
            normal: touch.normal,
            feature: None,
            face: Some(touch.face),
        }
    }
}

/// Whether a test of two meshes exchanges them, by the position of the second one. The vertices of one mesh are
/// placed in the frame of the other, which rounds. With a fixed order the same pair gets the same answer, whichever
/// of the two is called the first.
pub(crate) fn is_turned(offset: DVec3) -> bool {
    let [x, y, z] = offset.to_array();
    (x, y, z) < (0.0, 0.0, 0.0)
}

/// Whether two shapes share a point; the second one is displaced by `offset`, m.
pub(crate) fn meet(first: Form<'_>, second: Form<'_>, offset: DVec3) -> bool {
    match (first, second) {
        (Form::Mesh(first), Form::Mesh(second)) if is_turned(offset) => {
            tree::intersect(second, first, -offset)
        }
        (Form::Mesh(first), Form::Mesh(second)) => tree::intersect(first, second, offset),
        (Form::Mesh(mesh), Form::Sphere(radius)) => ball_meets(mesh, offset, radius),
        (Form::Sphere(first), Form::Sphere(second)) => {
            offset.dot(offset) <= (first + second) * (first + second)
        }
        (Form::HalfSpace(_), Form::HalfSpace(_)) => false,
        (Form::HalfSpace(normal), other) => normal.dot(offset) - reach(other, normal).0 <= 0.0,
        (Form::Sphere(_), Form::Mesh(_))
        | (Form::Mesh(_) | Form::Sphere(_), Form::HalfSpace(_)) => meet(second, first, -offset),
    }
}

/// The first contact of two shapes that are apart. The second one is displaced by `offset` and then moves by
/// `motion`, m. Motion along the surfaces is no contact.
pub(crate) fn first_contact(
    first: Form<'_>,
    second: Form<'_>,
    offset: DVec3,
    motion: DVec3,
) -> Option<Contact> {
    match (first, second) {
        (Form::Mesh(first), Form::Mesh(second)) if !is_turned(offset) => {
            touch::first_touch(first, second, offset, motion).map(Contact::from)
        }
        (Form::Mesh(mesh), Form::Sphere(radius)) => {
            ball_touch(mesh, offset, radius, motion).map(Contact::from)
        }
        (Form::Sphere(first), Form::Sphere(second)) => spheres(first, second, offset, motion),
        (Form::HalfSpace(_), Form::HalfSpace(_)) => None,
        (Form::HalfSpace(normal), other) => plane(normal, other, offset, motion),
        (Form::Mesh(first), Form::Mesh(second)) => {
            let touch = touch::first_touch(second, first, -offset, -motion)?;
            Some(Contact::from(touch).turned(offset, motion))
        }
        (Form::Sphere(_), Form::Mesh(_))
        | (Form::Mesh(_) | Form::Sphere(_), Form::HalfSpace(_)) => {
            let contact = first_contact(second, first, -offset, -motion)?;
            Some(contact.turned(offset, motion))
        }
    }
}

/// Directions in which the second of two touching shapes might move out of the first.
pub(crate) fn parting_normals(first: Form<'_>, second: Form<'_>, offset: DVec3) -> Vec<DVec3> {
    match (first, second) {
        (Form::Mesh(first), Form::Mesh(second)) if !is_turned(offset) => {
            let mut normals: Vec<DVec3> = Vec::new();
            let _ = tree::each_hit(first, second, offset, |hit| {
                for normal in [hit.normal, -hit.normal] {
                    if normal != DVec3::ZERO && !normals.contains(&normal) {
                        normals.push(normal);
                    }
                }
                match normals.len() < MOST_NORMALS {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(()),
                }
            });
            normals
        }
        (Form::HalfSpace(normal), _) => alloc::vec![normal],
        (Form::Mesh(mesh), Form::Sphere(radius)) => {
            // Out of the nearest face, which is found by motions from outside along the axes.
            let contact = DVec3::AXES
                .iter()
                .flat_map(|&axis| [axis, -axis])
                .filter_map(|way| {
                    let touch = ball_touch(mesh, offset, radius, 1e-9 * radius * way)?;
                    Some(touch.normal)
                });
            contact.collect()
        }
        (Form::Sphere(_), Form::Sphere(_)) => offset.try_normalize().into_iter().collect(),
        (Form::Mesh(_), Form::Mesh(_))
        | (Form::Sphere(_), Form::Mesh(_))
        | (Form::Mesh(_) | Form::Sphere(_), Form::HalfSpace(_)) => {
            let mut normals = parting_normals(second, first, -offset);
            for normal in &mut normals {
                *normal = -*normal;
            }
            normals
        }
    }
}

/// The most normals that are tried to separate two meshes.
pub(crate) const MOST_NORMALS: usize = 32;

/// The extent of a shape against `normal`, and its farthest point.
pub(crate) fn reach(shape: Form<'_>, normal: DVec3) -> (f64, DVec3) {
    match shape {
        Form::Mesh(mesh) => {
            let (least, corner) = mesh.least_along(normal);
            (-least, corner)
        }
        Form::Sphere(radius) => (radius, -radius * normal),
        Form::HalfSpace(_) => (0.0, DVec3::ZERO),
    }
}

fn plane(normal: DVec3, other: Form<'_>, offset: DVec3, motion: DVec3) -> Option<Contact> {
    let approach = -normal.dot(motion);
    let height = normal.dot(offset);
    // Most shapes at most times are farther apart than they move.
    if approach <= 0.0 {
        return None;
    }
    let (reach, corner) = reach(other, normal);
    let gap = height - reach;
    if gap > approach {
        return None;
    }
    let time = (gap / approach).max(0.0);
    let at = offset + time * motion + corner;
    Some(Contact {
        time,
        point: at - normal.dot(at) * normal,
        normal,
        feature: None,
        face: None,
    })
}

fn spheres(first: f64, second: f64, offset: DVec3, motion: DVec3) -> Option<Contact> {
    let sum = first + second;
    let (approach, way) = (-offset.dot(motion), motion.dot(motion));
    if approach <= 0.0 {
        return None;
    }
    let aside = offset.cross(motion);
    let depth = sum * sum * way - aside.dot(aside);
    if depth < 0.0 || !depth.is_finite() {
        return None;
    }
    let distance = libm::sqrt(offset.dot(offset));
    let gap = (distance - sum) * (distance + sum);
    let time = (gap / (approach + libm::sqrt(depth))).max(0.0);
    if time > 1.0 {
        return None;
    }
    let at = offset + time * motion;
    // Two points have no surface that gives a normal.
    let normal = unit(at).filter(|_| sum > 0.0);
    let normal = normal.or_else(|| Some(-unit(motion)?))?;
    (normal.dot(motion) < 0.0).then(|| Contact {
        time,
        point: first * normal,
        normal,
        feature: None,
        face: None,
    })
}

/// The unit vector of `v`: exact along an axis, for any length.
pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    let scaled = v / v.abs().max_element();
    scaled.is_finite().then(|| scaled / scaled.length())
}
