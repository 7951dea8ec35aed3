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

/// Where the mass of a body is: its centre, and how hard it is to turn about each of three axes
/// through it.
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

/// An inertia as it is read.
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
        // What has been written is read to the bit: to make it of length 1 once more would round it.
        let is_unit = (read.axes.length_squared() - 1.0).abs() <= 8.0 * f64::EPSILON;
        let axes = if is_unit { read.axes } else { inertia.axes };
        Ok(Inertia { axes, ..inertia })
    }
}

/// Why something has no inertia of a body. Whoever knows a name for it puts that in front.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InertiaError {
    /// Some edge has not two triangles, so that no inside is.
    #[error("the mesh is open: close it, or give its inertia")]
    Open,
    /// Neighbouring triangles are wound against each other.
    #[error("triangles of the mesh are wound both ways: make them one, or give its inertia")]
    NotOriented,
    /// Triangles are wound inward.
    #[error("the mesh is inside out, its volume {volume:e} m³: reverse its triangles")]
    InsideOut {
        /// The negative volume, m³.
        volume: f64,
    },
    /// The volume is no more than rounding of the parts it is summed from.
    #[error("the mesh encloses no volume: give it some thickness, or give its inertia")]
    NoVolume,
    /// Parts that are wound inward, or overlap, leave moments that no mass has.
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
    /// One moment is more than the two others together.
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
    /// The centre of mass is no place.
    #[error("the centre of mass must be finite")]
    Centre,
    /// The mass is not one.
    #[error("the mass {mass:e} kg of what turns must be positive and finite")]
    Mass {
        /// It, kg.
        mass: f64,
    },
    /// There is no shape with an inside.
    #[error("a body without a mesh or a ball has no moments of inertia: give its inertia")]
    Shapeless,
    /// The radius is not one of a ball that can turn.
    #[error("a ball of radius {radius:e} m has no moment of inertia: give one")]
    Radius {
        /// It, m.
        radius: f64,
    },
}

impl Inertia {
    /// Of principal moments (kg m²) about axes through a centre of mass (m), the latter two in the
    /// frame of the body's shape: `axes` turns the coordinate axes into the principal ones.
    ///
    /// Moments must be positive, and none more than the two others together, but for rounding.
    pub fn new(moments: DVec3, axes: DQuat, centre: DVec3) -> Result<Inertia, InertiaError> {
        if !(moments.is_finite() && moments.cmpgt(DVec3::ZERO).all()) {
            return Err(InertiaError::NotPositive { moments });
        }
        // Each of the two others was rounded, and so was what they are compared with.
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

    /// Of a solid ball about its middle: radius in m, mass in kg.
    pub fn ball(radius: f64, mass: f64) -> Result<Inertia, InertiaError> {
        let mass = checked(mass)?;
        let moment = 0.4 * mass * radius * radius;
        if !(radius > 0.0 && moment.is_finite() && moment > 0.0) {
            return Err(InertiaError::Radius { radius });
        }
        Inertia::new(DVec3::splat(moment), DQuat::IDENTITY, DVec3::ZERO)
    }

    /// Of a body of the same density everywhere within a closed mesh: mass in kg.
    pub fn solid(mesh: &Mesh, mass: f64) -> Result<Inertia, InertiaError> {
        Solid::of(mesh)?.inertia(mass)
    }

    /// Principal moments, kg m².
    pub fn moments(&self) -> DVec3 {
        self.moments
    }

    /// Turns coordinate axes into principal ones, in the shape's frame.
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

/// The inside of a closed mesh, filled evenly.
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
        // About the middle of the box, so that a mesh far from its origin loses no digits.
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
        // Not more than rounding, or less than any number.
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

    /// Its inertia with so much mass in it, kg.
    pub fn inertia(&self, mass: f64) -> Result<Inertia, InertiaError> {
        let DVec3 { x, y, z } = self.spread;
        // Sums of what is positive: no moment is more than the two others.
        let moments = checked(mass)? * DVec3::new(y + z, z + x, x + y);
        Inertia::new(moments, self.axes, self.centre)
    }
}

/// Bounds what rounding does to a sum of compensated terms, as part of the sum of their greatest
/// values: differences, products and sums of each are below 12 units of 2^-53.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Rows and columns of `xx, yy, zz, xy, yz, zx`.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// Corners of all triangles as seen from a point.
fn tetrahedra(mesh: &Mesh, from: DVec3) -> impl Iterator<Item = [DVec3; 3]> {
    (0..mesh.triangles().len()).map(move |i| mesh.corners(i).map(|v| v.as_dvec3() - from))
}

fn determinant(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    DMat3::from_cols(a, b, c).determinant()
}

/// The same of magnitudes, all added: what its rounding is part of.
fn permanent(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = [a.abs(), b.abs(), c.abs()];
    a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) + a.z * (b.x * c.y + b.y * c.x)
}

/// A sum with what rounding has taken from it.
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
