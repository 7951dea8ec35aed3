//! Which triangles of two leaves are apart, at a glance.
//!
//! Two triangles are apart if one lies on one side of the other's plane. Sixteen pairs are looked
//! at in f32, with a bound of everything that rounding can do; pairs that the bound leaves open
//! are for exact arithmetic. Nearly every pair that is apart is found so.
//!
//! The bound. A height `h = n·w` above a plane through corner `a`, with `n = u × v` and
//! `w = p - a`, is a determinant whose rows are differences of corners. Computed from exact
//! corners with `e = 2^-24` it errs by at most `(7 + 56 e) e` times its permanent (Shewchuk 1997,
//! sec. 4.3), here `16 e`. Three more errors: `w` has a placed corner, which f32 misses by `d`,
//! whence `|n|·d`; `u` and `v` of the second mesh are taken before placing, which moves them by
//! at most `q`, whence `dn·|w|` with `dn_x = q (|u_y| + |v_y| + |u_z| + |v_z| + 2 q)` and so on;
//! and products below the range of f32 vanish, whence a small constant. As boxes meet, no
//! component of `w` exceeds twice the sum of the half extents and the margin of their comparison.

use super::pairs::{Lanes, Reach};
use crate::bvh::{Leaf, WIDTH};

/// Columns of four triangles.
type Four = [f32; WIDTH];

/// Planes of the four triangles of a leaf, with their errors: a height above one errs by
/// `slope·|w| + rest`.
struct Planes {
    normal: [Four; 3],
    slope: [Four; 3],
    rest: Four,
}

/// 16 e for products of rounded differences.
const ROUNDING: f32 = 8.0 * f32::EPSILON;
/// Above what underflow takes from three products, but no subnormal number.
const VANISHING: f32 = 16.0 * f32::MIN_POSITIVE;

impl Planes {
    /// For sides moved by at most `shift`, and points that f32 misses by at most `miss`.
    #[inline(always)]
    fn of(leaf: &Leaf, shift: f32, miss: f32) -> Planes {
        let corners = &leaf.corners;
        let mut planes = Planes {
            normal: [[0.0; WIDTH]; 3],
            slope: [[0.0; WIDTH]; 3],
            rest: [VANISHING; WIDTH],
        };
        for axis in 0..3 {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            for i in 0..WIDTH {
                let (uy, uz) = (corners[3 + y][i] - corners[y][i], corners[3 + z][i] - corners[z][i]);
                let (vy, vz) = (corners[6 + y][i] - corners[y][i], corners[6 + z][i] - corners[z][i]);
                let (one, other) = (uy * vz, uz * vy);
                let size = one.abs() + other.abs();
                let moved = shift * ((uy.abs() + vy.abs()) + (uz.abs() + vz.abs()) + 2.0 * shift);
                planes.normal[axis][i] = one - other;
                planes.slope[axis][i] = ROUNDING * size + 2.0 * moved + VANISHING;
                planes.rest[i] += miss * (size + moved);
            }
        }
        planes
    }
}

/// A bit for each of the `pairs` that may meet: of two leaves whose boxes are known to meet there.
#[inline(always)]
pub(super) fn maybe_meet<L: Lanes>(first: &Leaf, second: &Leaf, pairs: u32, reach: &Reach) -> u32 {
    let offset = reach.offset.map(L::splat);
    let widest: [L; 3] = core::array::from_fn(|axis| {
        let half = L::rows(&first.boxes.half[axis]).add(L::columns(&second.boxes.half[axis]));
        half.add(half).add(L::splat(reach.margin))
    });
    let corner = |k: usize| -> [L; 3] {
        core::array::from_fn(|axis| L::rows(&first.corners[3 * k + axis]))
    };
    let placed = |k: usize| -> [L; 3] {
        core::array::from_fn(|axis| L::columns(&second.corners[3 * k + axis]).add(offset[axis]))
    };
    let (a, b) = ([0, 1, 2].map(corner), [0, 1, 2].map(placed));

    let planes = Planes::of(first, 0.0, reach.miss());
    let (normal, slope) = (planes.normal.each_ref(), planes.slope.each_ref());
    let one = one_side(normal.map(L::rows), slope.map(L::rows), L::rows(&planes.rest), &widest, a[0], b);
    let planes = Planes::of(second, reach.shift(), reach.miss());
    let (normal, slope) = (planes.normal.each_ref(), planes.slope.each_ref());
    let columns = L::columns(&planes.rest);
    let other = one_side(normal.map(L::columns), slope.map(L::columns), columns, &widest, b[0], a);
    pairs & !(one | other)
}

/// Lanes in which three points lie on one side of a plane for certain.
#[inline(always)]
fn one_side<L: Lanes>(
    normal: [L; 3],
    slope: [L; 3],
    rest: L,
    widest: &[L; 3],
    corner: [L; 3],
    points: [[L; 3]; 3],
) -> u32 {
    let dot = |x: &[L; 3], y: &[L; 3], rest: L| x[0].mul_add(y[0], x[1].mul_add(y[1], x[2].mul_add(y[2], rest)));
    let error = dot(&slope, widest, rest);
    let [p, q, r] = points.map(|point| {
        let w: [L; 3] = core::array::from_fn(|axis| point[axis].sub(corner[axis]));
        normal[0].mul_add(w[0], normal[1].mul_add(w[1], normal[2].mul(w[2])))
    });
    let (low, high) = (p.min(q).min(r), p.max(q).max(r));
    low.above(error) | L::splat(0.0).sub(high).above(error)
}
