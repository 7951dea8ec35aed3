//! Shapes at their positions.

use core::cmp::Ordering;
use glam::DVec3;

use super::{
    Place, QueryError,
    error::{check_direction, check_radius, check_vector},
};
use crate::{
    Bvh, Shape,
    collide::{self, Form, snap},
    expansion::Expansion,
};

/// A shape at a position, for queries. It borrows the tree of a mesh, and is cheap to copy.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    pub(crate) form: Form<'a>,
    pub(crate) position: DVec3,
}

impl<'a> Placed<'a> {
    /// A mesh, open or closed, with its origin at `position`, m.
    ///
    /// # Errors
    ///
    /// [`QueryError::Vector`] if a component of the position is not a number within ±1e100 m.
    pub fn mesh(tree: &'a Bvh, position: DVec3) -> Result<Placed<'a>, QueryError> {
        check_vector("position", position)?;
        Ok(Placed {
            form: Form::Mesh(tree),
            position,
        })
    }

    /// A solid ball of a radius about `position`, both m; with radius 0 it is a point.
    ///
    /// # Errors
    ///
    /// [`QueryError::Radius`] unless the radius is from 0 to 1e100 m; [`QueryError::Vector`] as for
    /// [`Placed::mesh`].
    pub fn sphere(radius: f64, position: DVec3) -> Result<Placed<'a>, QueryError> {
        check_radius(radius)?;
        check_vector("position", position)?;
        Ok(Placed {
            form: Form::Sphere(radius),
            position,
        })
    }

    /// The half-space behind a plane through `position`, m. The normal points out of it, and has any length but 0.
    ///
    /// # Errors
    ///
    /// [`QueryError::Direction`] if the normal is zero; [`QueryError::Vector`] if a component of normal or position
    /// is not a number within ±1e100.
    pub fn half_space(normal: DVec3, position: DVec3) -> Result<Placed<'a>, QueryError> {
        let normal = check_direction("normal", normal)?;
        check_vector("position", position)?;
        Ok(Placed {
            form: Form::HalfSpace(normal),
            position,
        })
    }

    /// The position of the shape's origin, m.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The same shape at another position, m.
    ///
    /// # Errors
    ///
    /// [`QueryError::Vector`] as for [`Placed::mesh`].
    pub fn at(self, position: DVec3) -> Result<Placed<'a>, QueryError> {
        check_vector("position", position)?;
        Ok(Placed { position, ..self })
    }

    /// Low and high corner of the least box around the shape, relative to its position, m; `None` for a half-space.
    pub(crate) fn bounds(&self) -> Option<[DVec3; 2]> {
        match self.form {
            Form::Mesh(tree) => {
                let bounds = tree.bounds();
                Some([bounds.min, bounds.max].map(|corner| corner.as_dvec3()))
            }
            Form::Sphere(radius) => Shape::Sphere { radius }.bounds(),
            Form::HalfSpace(_) => None,
        }
    }

    /// The position of the other shape relative to this one, m.
    pub(super) fn offset_to(&self, other: Placed<'_>) -> DVec3 {
        snap(other.position - self.position)
    }

    /// The place of a point in the shape's frame, m; `None` if the shape is an open mesh.
    pub(super) fn locate(&self, point: DVec3) -> Option<Place> {
        let order = match self.form {
            Form::Mesh(tree) => return collide::locate(tree, point),
            Form::HalfSpace(normal) => normal.dot(point).total_cmp(&0.0),
            Form::Sphere(radius) => outside(point, radius),
        };
        Some(match order {
            Ordering::Less => Place::Inside,
            Ordering::Equal => Place::On,
            Ordering::Greater => Place::Outside,
        })
    }
}

/// The sign of the square of a point's distance from the origin less the square of a radius. It is exact, except for
/// components whose squares are out of range.
fn outside(point: DVec3, radius: f64) -> Ordering {
    let largest = point.abs().max_element().max(radius);
    if largest == 0.0 {
        return Ordering::Equal;
    }
    // Scaled by a power of two, so that no square that matters over- or underflows.
    let exponent = libm::ilogb(largest);
    let scaled = |x: f64| libm::scalbn(x, -exponent);
    let mut sum = Expansion::<8>::ZERO;
    for x in point.to_array().map(scaled) {
        sum.add_product(x, x);
    }
    sum.add_product(scaled(radius), -scaled(radius));
    sum.sign()
}
