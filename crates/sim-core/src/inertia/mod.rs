//! The mass properties of a turning body: centre of mass, principal moments, principal axes.
//!
//! A solid is the sum of the signed tetrahedra between a point and its triangles. Over a
//! tetrahedron from the origin with corners `a, b, c`, `D = a·(b×c)` and `s = a + b + c`,
//!
//! ```text
//! ∫ dV = D/6,   ∫ x dV = D s/24,   ∫ x xᵀ dV = D (a aᵀ + b bᵀ + c cᵀ + s sᵀ)/120
//! ```
//!
//! exactly. Sums are compensated, and second moments are computed about the centre of mass, so that
//! no parallel-axis term is subtracted from them. All results scale with powers of two to the bit, from
//! the least size in f32 to the greatest, because the fifth powers of these are in the range of f64.

mod eigen;

use glam::{DMat3, DQuat, DVec3};

use crate::{Mesh, expansion::two_sum};
use eigen::diagonalised;

/// The mass distribution of a body: its centre of mass, and its moments of inertia about three axes through it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Unchecked")
)]
pub struct Inertia {
    moments: DVec3,
    axes: DQuat,
    centre: DVec3,
}

/// An inertia before its values are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    moments: DVec3,
    axes: DQuat,
    centre: DVec3,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Inertia {
    type Error = InertiaError;

    fn try_from(read: Unchecked) -> Result<Inertia, InertiaError> {
        let inertia = Inertia::new(read.moments, read.axes, read.centre)?;
        // Written axes are read to the bit: to normalise them again would round them.
        let is_unit = (read.axes.length_squared() - 1.0).abs() <= 8.0 * f64::EPSILON;
        let axes = if is_unit { read.axes } else { inertia.axes };
        Ok(Inertia { axes, ..inertia })
    }
}

/// The reason why a mesh or a body has no inertia. Callers put the name of the object in front.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InertiaError {
    /// Some edge does not have two triangles, so the mesh has no inside.
    #[error("the mesh is open: close it, or give its inertia")]
    Open,
    /// Adjacent triangles have opposite winding.
    #[error("triangles of the mesh are wound both ways: make them one, or give its inertia")]
    NotOriented,
    /// Triangles are wound inward.
    #[error("the mesh is inside out, its volume {volume:e} m³: reverse its triangles")]
    InsideOut {
        /// The negative volume, m³.
        volume: f64,
    },
    /// The volume is no more than the rounding of the terms of its sum.
    #[error("the mesh encloses no volume: give it some thickness, or give its inertia")]
    NoVolume,
    /// Parts that are wound inward, or overlap, give moments that no mass distribution has.
    #[error("parts of the mesh are inside out: reverse their triangles, or give its inertia")]
    NotSolid,
    /// A moment is not a positive number.
    #[error(
        "moments of inertia [{:e}, {:e}, {:e}] kg m² must be positive and finite", moments.x, moments.y, moments.z
    )]
    NotPositive {
        /// The moments, kg m².
        moments: DVec3,
    },
    /// One moment is greater than the sum of the two others.
    #[error(
        "moments of inertia [{:e}, {:e}, {:e}] kg m² are those of no body: none may be more than \
         the two others together", moments.x, moments.y, moments.z
    )]
    Triangle {
        /// The moments, kg m².
        moments: DVec3,
    },
    /// The axes are not a rotation.
    #[error("the principal axes are not a unit quaternion")]
    Axes,
    /// The centre of mass is not finite.
    #[error("the centre of mass must be finite")]
    Centre,
    /// The mass is not positive and finite.
    #[error("the mass {mass:e} kg of what turns must be positive and finite")]
    Mass {
        /// The mass, kg.
        mass: f64,
    },
    /// The body has no shape with an inside.
    #[error("a body without a mesh or a ball has no moments of inertia: give its inertia")]
    Shapeless,
    /// A ball of this radius has no moment of inertia.
    #[error("a ball of radius {radius:e} m has no moment of inertia: give one")]
    Radius {
        /// The radius, m.
        radius: f64,
    },
}

impl Inertia {
    /// The inertia with principal moments (kg m²) about axes through a centre of mass (m). Axes and centre are in the
    /// frame of the body's shape: `axes` is the rotation from the coordinate axes to the principal axes.
    ///
    /// Moments must be positive, and none greater than the sum of the two others, up to rounding.
    pub fn new(moments: DVec3, axes: DQuat, centre: DVec3) -> Result<Inertia, InertiaError> {
        if !(moments.is_finite() && moments.cmpgt(DVec3::ZERO).all()) {
            return Err(InertiaError::NotPositive { moments });
        }
        // Each of the two others was rounded, and so was the moment compared with them.
        let rest = moments.element_sum() - moments.max_element();
        if moments.max_element() > rest * (1.0 + 4.0 * f64::EPSILON) {
            return Err(InertiaError::Triangle { moments });
        }
        if !axes.is_normalized() {
            return Err(InertiaError::Axes);
        }
        if !centre.is_finite() {
            return Err(InertiaError::Centre);
        }
        Ok(Inertia {
            moments,
            axes: axes.normalize(),
            centre,
        })
    }

    /// The inertia of a solid ball about its centre: radius in m, mass in kg.
    pub fn ball(radius: f64, mass: f64) -> Result<Inertia, InertiaError> {
        let mass = checked(mass)?;
        let moment = 0.4 * mass * radius * radius;
        if !(radius > 0.0 && moment.is_finite() && moment > 0.0) {
            return Err(InertiaError::Radius { radius });
        }
        Inertia::new(DVec3::splat(moment), DQuat::IDENTITY, DVec3::ZERO)
    }

    /// The inertia of a body of uniform density within a closed mesh: mass in kg.
    pub fn solid(mesh: &Mesh, mass: f64) -> Result<Inertia, InertiaError> {
        Solid::of(mesh)?.inertia(mass)
    }

    /// Principal moments, kg m².
    pub fn moments(&self) -> DVec3 {
        self.moments
    }

    /// The rotation from the coordinate axes to the principal axes, in the shape's frame.
    pub fn axes(&self) -> DQuat {
        self.axes
    }

    /// The centre of mass in the shape's frame, m.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }
}

fn checked(mass: f64) -> Result<f64, InertiaError> {
    match mass > 0.0 && mass.is_finite() {
        true => Ok(mass),
        false => Err(InertiaError::Mass { mass }),
    }
}

/// The inside of a closed mesh, with uniform density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    volume: f64,
    centre: DVec3,
    axes: DQuat,
    /// Mean squares of the coordinates along the principal axes, m².
    spread: DVec3,
}

impl Solid {
    /// Measures a mesh; an error unless it is closed, wound outward and has a volume.
    pub fn of(mesh: &Mesh) -> Result<Solid, InertiaError> {
        if !mesh.is_closed() {
            return Err(InertiaError::Open);
        }
        if !mesh.is_oriented() {
            return Err(InertiaError::NotOriented);
        }
        // About the centre of the box, so that a mesh far from its origin loses no digits.
        let middle = mesh.bounds().centre();
        let [mut volume, mut size] = [Sum::ZERO; 2];
        let mut first = [Sum::ZERO; 3];
        for [a, b, c] in tetrahedra(mesh, middle) {
            let part = determinant(a, b, c);
            volume.add(part);
            size.add(permanent(a, b, c));
            for (axis, first) in first.iter_mut().enumerate() {
                first.add(part * (a + b + c)[axis]);
            }
        }
        let (six, noise) = (volume.value(), ROUNDING * size.value());
        if six < -noise {
            return Err(InertiaError::InsideOut { volume: six / 6.0 });
        }
        // No more than rounding, or below the normal numbers.
        if six <= noise || !six.is_normal() {
            return Err(InertiaError::NoVolume);
        }
        let shift = DVec3::from_array(first.map(|sum| sum.value())) / (4.0 * six);

        let mut second = [Sum::ZERO; 6];
        let mut greatest = Sum::ZERO;
        for [a, b, c] in tetrahedra(mesh, middle + shift) {
            let (part, s) = (determinant(a, b, c), a + b + c);
            for (entry, (i, j)) in second.iter_mut().zip(ENTRIES) {
                entry.add(part * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]));
            }
            let lengths = a.length_squared() + b.length_squared() + c.length_squared();
            greatest.add(permanent(a, b, c) * (lengths + s.length_squared()));
        }
        let [xx, yy, zz, xy, yz, zx] = second.map(|sum| sum.value() / (20.0 * six));
        let noise = ROUNDING * greatest.value() / (20.0 * six);
        let (spread, axes) = diagonalised([xx, yy, zz], [yz, zx, xy], noise);
        if spread.min_element() <= noise {
            // A solid body has some extent along every axis.
            return Err(match spread.min_element() < -noise {
                true => InertiaError::NotSolid,
                false => InertiaError::NoVolume,
            });
        }
        Ok(Solid {
            volume: six / 6.0,
            centre: middle + shift,
            axes,
            spread,
        })
    }

    /// Volume, m³.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Centre of volume, m, in the mesh's frame.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The inertia with a given mass, kg.
    pub fn inertia(&self, mass: f64) -> Result<Inertia, InertiaError> {
        let DVec3 { x, y, z } = self.spread;
        // Sums of positive numbers: no moment is greater than the sum of the two others.
        let moments = checked(mass)? * DVec3::new(y + z, z + x, x + y);
        Inertia::new(moments, self.axes, self.centre)
    }
}

/// Bounds the rounding of a sum of compensated terms, relative to the sum of their greatest values: the error of the
/// differences, products and sums of each is below 12 units of 2^-53.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Rows and columns of the entries `xx, yy, zz, xy, yz, zx`.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// The corners of all triangles relative to a point.
fn tetrahedra(mesh: &Mesh, from: DVec3) -> impl Iterator<Item = [DVec3; 3]> {
    (0..mesh.triangles().len()).map(move |i| mesh.corners(i).map(|v| v.as_dvec3() - from))
}

fn determinant(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    DMat3::from_cols(a, b, c).determinant()
}

/// The same with absolute values, all added: a bound on the scale of its rounding.
fn permanent(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = [a.abs(), b.abs(), c.abs()];
    a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) + a.z * (b.x * c.y + b.y * c.x)
}

/// A sum, and its rounding errors.
#[derive(Clone, Copy)]
struct Sum(f64, f64);

impl Sum {
    const ZERO: Sum = Sum(0.0, 0.0);

    fn add(&mut self, x: f64) {
        let (sum, lost) = two_sum(self.0, x);
        *self = Sum(sum, self.1 + lost);
    }

    fn value(self) -> f64 {
        self.0 + self.1
    }
}

#[cfg(test)]
mod tests;
