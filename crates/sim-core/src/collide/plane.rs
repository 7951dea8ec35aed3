//! Cross and triple products in f64 with bounds on their errors, and a quick test for the sides of a triangle's plane
//! on which points are.

use core::cmp::Ordering;
use glam::DVec3;

/// A number, and a bound on its error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    pub(super) value: f64,
    pub(super) error: f64,
}

impl Estimate {
    /// The sign, if the error leaves no doubt. Without products there is no error.
    #[inline(always)]
    pub(super) fn sign(self) -> Option<Ordering> {
        if self.value > self.error {
            Some(Ordering::Greater)
        } else if self.value < -self.error {
            Some(Ordering::Less)
        } else if self.error == 0.0 {
            Some(Ordering::Equal)
        } else {
            None
        }
    }

    /// Whether the sign is certainly that of the value.
    #[inline(always)]
    pub(super) fn is_certain(self) -> bool {
        self.value.abs() > self.error
    }

    /// Compares the magnitudes of two numbers, if the errors leave no doubt.
    #[inline(always)]
    pub(super) fn magnitude_cmp(self, other: Estimate) -> Option<Ordering> {
        let between = self.value.abs() - other.value.abs();
        // Doubled for the rounding of the difference and of the sum.
        if between.abs() > 2.0 * (self.error + other.error) {
            between.partial_cmp(&0.0)
        } else {
            None
        }
    }
}

/// A cross product, and a bound on the rounding errors of its products.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cross {
    value: DVec3,
    /// The same with the absolute values of all products.
    size: DVec3,
}

impl Cross {
    /// The cross product of two vectors, each a rounded difference or exact.
    #[inline(always)]
    pub(super) fn of(u: DVec3, v: DVec3) -> Cross {
        let products = DVec3::new(u.y * v.z, u.z * v.x, u.x * v.y);
        let others = DVec3::new(u.z * v.y, u.x * v.z, u.y * v.x);
        Cross {
            value: products - others,
            size: products.abs() + others.abs(),
        }
    }

    /// A bound on the length.
    #[inline(always)]
    pub(super) fn length(&self) -> f64 {
        self.size.length() * (1.0 + 8.0 * f64::EPSILON)
    }

    /// A bound on the dot product with a vector whose components are in absolute value at most those of `half`.
    #[inline(always)]
    pub(super) fn most(&self, half: DVec3) -> f64 {
        (self.value.abs() + 8.0 * f64::EPSILON * self.size).dot(half)
    }

    /// The dot product with a third such vector: the determinant of the three vectors as they are rounded.
    ///
    /// The bound is that of the first stage of Shewchuk's orient3d (1997, sec. 4.3),
    /// `(7 + 56 u) u` times the permanent with `u = 2^-53`; the determinant's rows are rounded
    /// differences.
    #[inline(always)]
    pub(super) fn dot(&self, w: DVec3) -> Estimate {
        const U: f64 = f64::EPSILON / 2.0;
        const BOUND: f64 = (7.0 + 56.0 * U) * U;
        Estimate {
            value: self.value.dot(w),
            error: BOUND * self.size.dot(w.abs()),
        }
    }
}

/// The plane of a triangle.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    corner: DVec3,
    normal: Cross,
}

impl Plane {
    #[inline(always)]
    pub(super) fn of([a, b, c]: [DVec3; 3]) -> Plane {
        Plane {
            corner: a,
            normal: Cross::of(b - a, c - a),
        }
    }

    /// The side of a point, `Equal` if rounding leaves it open.
    #[inline(always)]
    pub(super) fn side(&self, p: DVec3) -> Ordering {
        let Estimate { value, error } = self.normal.dot(p - self.corner);
        if value > error {
            Ordering::Greater
        } else if value < -error {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }
}
