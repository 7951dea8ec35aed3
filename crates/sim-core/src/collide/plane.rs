//! A quick look at which side of a triangle's plane points are.

use core::cmp::Ordering;
use glam::DVec3;

/// The plane of a triangle, with what bounds the rounding errors of heights above it.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    corner: DVec3,
    normal: DVec3,
    /// The normal with all products taken as positive.
    size: DVec3,
}

impl Plane {
    #[inline(always)]
    pub(super) fn of([a, b, c]: [DVec3; 3]) -> Plane {
        let (u, v) = (b - a, c - a);
        let products = DVec3::new(u.y * v.z, u.z * v.x, u.x * v.y);
        let others = DVec3::new(u.z * v.y, u.x * v.z, u.y * v.x);
        Plane {
            corner: a,
            normal: products - others,
            size: products.abs() + others.abs(),
        }
    }

    /// The side of a point, `Equal` if rounding leaves it open.
    ///
    /// The bound is that of the first stage of Shewchuk's orient3d (1997, sec. 4.3),
    /// `(7 + 56 u) u` times the permanent with `u = 2^-53`; the determinant's rows are the
    /// differences from a corner.
    #[inline(always)]
    pub(super) fn side(&self, p: DVec3) -> Ordering {
        const U: f64 = f64::EPSILON / 2.0;
        const BOUND: f64 = (7.0 + 56.0 * U) * U;
        let w = p - self.corner;
        let height = self.normal.dot(w);
        let error = BOUND * self.size.dot(w.abs());
        if height > error {
            Ordering::Greater
        } else if height < -error {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }
}
