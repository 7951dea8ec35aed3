//! Which of several pairs of triangles are apart, at a glance.

use core::cmp::Ordering;
use glam::{DVec3, Vec3};

use super::{pairs::BATCH, plane::Plane};
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
#[inline(always)]
fn one_side(s: &Columns, t: &Columns, pair: usize) -> bool {
    let corners = |columns: &Columns| {
        [0, 3, 6].map(|k| DVec3::new(columns[k][pair], columns[k + 1][pair], columns[k + 2][pair]))
    };
    let plane = Plane::of(corners(s));
    let sides = corners(t).map(|p| plane.side(p));
    let all = |side| (sides[0] == side) & (sides[1] == side) & (sides[2] == side);
    all(Ordering::Less) | all(Ordering::Greater)
}
