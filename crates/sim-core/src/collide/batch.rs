//! Which of several pairs of triangles are apart, at a glance.

use glam::{DVec3, Vec3};

use super::pairs::BATCH;
use crate::bvh::Bvh;

/// Corners of up to eight triangles, by coordinate and pair, so that one instruction takes all.
type Columns = [[f64; BATCH]; 9];

/// Finds pairs in which one triangle lies on one side of the other's plane, for certain, and
/// returns a bit for each of the others. Nearly every pair that is apart is found so.
#[inline(always)]
pub(super) fn maybe_meet(first: &Bvh, second: &Bvh, pairs: (&[u32], &[u32]), offset: DVec3) -> u32 {
    let count = pairs.0.len().min(pairs.1.len()).min(BATCH);
    let s = columns(pairs.0.iter().map(|&s| first.corners(s)), DVec3::ZERO);
    let t = columns(pairs.1.iter().map(|&t| second.corners(t)), offset);
    let mut apart = [false; BATCH];
    for (pair, apart) in apart.iter_mut().enumerate() {
        *apart = one_side(&s, &t, pair) | one_side(&t, &s, pair);
    }
    let bits = apart
        .iter()
        .rev()
        .fold(0, |bits, &apart| bits << 1 | u32::from(!apart));
    bits & ((1 << count) - 1)
}

/// Corners placed as everywhere, `fl64(f64(v) + offset)`.
#[inline(always)]
fn columns(triangles: impl Iterator<Item = [Vec3; 3]>, offset: DVec3) -> Columns {
    let mut narrow = [[0.0f32; BATCH]; 9];
    for (pair, [a, b, c]) in triangles.take(BATCH).enumerate() {
        let coordinates = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z];
        for (column, x) in narrow.iter_mut().zip(coordinates) {
            column[pair] = x;
        }
    }
    let mut columns = [[0.0; BATCH]; 9];
    for k in 0..9 {
        let offset = offset[k % 3];
        for pair in 0..BATCH {
            columns[k][pair] = f64::from(narrow[k][pair]) + offset;
        }
    }
    columns
}

/// Whether all of `t` lies on one side of the plane of `s`, for certain: a "no" says nothing.
///
/// The bound is that of the first stage of Shewchuk's orient3d, `(7 + 56 u) u` times the
/// permanent with `u = 2^-53`; the determinant's rows are the differences from a corner of `s`.
#[inline(always)]
fn one_side(s: &Columns, t: &Columns, pair: usize) -> bool {
    const U: f64 = f64::EPSILON / 2.0;
    const BOUND: f64 = (7.0 + 56.0 * U) * U;
    let at = |columns: &Columns, corner: usize| [0, 1, 2].map(|k| columns[3 * corner + k][pair]);
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let a = at(s, 0);
    let (u, v) = (sub(at(s, 1), a), sub(at(s, 2), a));
    let products = [u[1] * v[2], u[2] * v[0], u[0] * v[1]];
    let others = [u[2] * v[1], u[0] * v[2], u[1] * v[0]];
    let normal = sub(products, others);
    let size = [0, 1, 2].map(|k| products[k].abs() + others[k].abs());
    let (mut above, mut below) = (true, true);
    for corner in 0..3 {
        let w = sub(at(t, corner), a);
        let height = normal[0] * w[0] + normal[1] * w[1] + normal[2] * w[2];
        let error = BOUND * (size[0] * w[0].abs() + size[1] * w[1].abs() + size[2] * w[2].abs());
        above &= height > error;
        below &= height < -error;
    }
    above | below
}
