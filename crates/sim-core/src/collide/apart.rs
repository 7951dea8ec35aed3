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

use super::pairs::{Lanes, Meshes, Reach, dot, dot0, splat};
use crate::bvh::{Triangles, WIDTH};

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
    fn of(triangles: &Triangles, shift: f32, miss: f32) -> Planes {
        let corners = &triangles.corners;
        let mut planes = Planes {
            normal: [[0.0; WIDTH]; 3],
            slope: [[0.0; WIDTH]; 3],
            rest: [VANISHING; WIDTH],
        };
        for axis in 0..3 {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            for i in 0..WIDTH {
                let (uy, uz) = (
                    corners[3 + y][i] - corners[y][i],
                    corners[3 + z][i] - corners[z][i],
                );
                let (vy, vz) = (
                    corners[6 + y][i] - corners[y][i],
                    corners[6 + z][i] - corners[z][i],
                );
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

/// A bit for each of the `pairs` that may meet: of two leaves whose boxes are known to meet there,
/// of meshes that are not turned.
#[inline(always)]
pub(super) fn maybe_meet<L: Lanes>(
    meshes: Meshes<'_>,
    (a, b): (u32, u32),
    pairs: u32,
    reach: &Reach,
) -> u32 {
    let (a, b) = (meshes.first.node(a), meshes.second.node(b));
    let (first, second) = (meshes.first.triangles(a), meshes.second.triangles(b));
    let (f, s) = (&a.boxes.half, &b.boxes.half);
    let offset = splat(reach.offset());
    let margin = L::splat(reach.spread());
    let widest = [
        wide(f, s, margin, 0),
        wide(f, s, margin, 1),
        wide(f, s, margin, 2),
    ];
    let (u, v) = (&first.corners, &second.corners);
    let a = [rows(u, 0), rows(u, 3), rows(u, 6)];
    let b = [
        placed(v, 0, &offset),
        placed(v, 3, &offset),
        placed(v, 6, &offset),
    ];

    let planes = Planes::of(first, 0.0, reach.miss());
    let normal = [
        L::rows(&planes.normal[0]),
        L::rows(&planes.normal[1]),
        L::rows(&planes.normal[2]),
    ];
    let slope = [
        L::rows(&planes.slope[0]),
        L::rows(&planes.slope[1]),
        L::rows(&planes.slope[2]),
    ];
    let error = dot(&slope, &widest, L::rows(&planes.rest));
    let one = one_side(&normal, error, &a[0], &b);

    let planes = Planes::of(second, reach.shift(), reach.miss());
    let normal = [
        L::columns(&planes.normal[0]),
        L::columns(&planes.normal[1]),
        L::columns(&planes.normal[2]),
    ];
    let slope = [
        L::columns(&planes.slope[0]),
        L::columns(&planes.slope[1]),
        L::columns(&planes.slope[2]),
    ];
    let error = dot(&slope, &widest, L::columns(&planes.rest));
    let other = one_side(&normal, error, &b[0], &a);
    pairs & !(one | other)
}

/// Bounds what lies between two points of two boxes that meet, along an axis.
#[inline(always)]
fn wide<L: Lanes>(first: &[Four; 3], second: &[Four; 3], margin: L, axis: usize) -> L {
    let half = L::rows(&first[axis]).add(L::columns(&second[axis]));
    half.add(half).add(margin)
}

/// A corner of each of the first's triangles.
#[inline(always)]
fn rows<L: Lanes>(corners: &[Four; 9], k: usize) -> [L; 3] {
    [
        L::rows(&corners[k]),
        L::rows(&corners[k + 1]),
        L::rows(&corners[k + 2]),
    ]
}

/// A corner of each of the second's triangles, placed but for rounding.
#[inline(always)]
fn placed<L: Lanes>(corners: &[Four; 9], k: usize, offset: &[L; 3]) -> [L; 3] {
    [
        L::columns(&corners[k]).add(offset[0]),
        L::columns(&corners[k + 1]).add(offset[1]),
        L::columns(&corners[k + 2]).add(offset[2]),
    ]
}

#[inline(always)]
fn height<L: Lanes>(normal: &[L; 3], corner: &[L; 3], p: &[L; 3]) -> L {
    let (x, y, z) = (
        p[0].sub(corner[0]),
        p[1].sub(corner[1]),
        p[2].sub(corner[2]),
    );
    dot0(normal, &[x, y, z])
}

/// Lanes in which three points lie on one side of a plane for certain.
#[inline(always)]
fn one_side<L: Lanes>(normal: &[L; 3], error: L, corner: &[L; 3], points: &[[L; 3]; 3]) -> u32 {
    let p = height(normal, corner, &points[0]);
    let q = height(normal, corner, &points[1]);
    let r = height(normal, corner, &points[2]);
    let (low, high) = (p.min(q).min(r), p.max(q).max(r));
    low.above(error) | L::splat(0.0).sub(high).above(error)
}
