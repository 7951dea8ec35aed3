//! A quick test that separates triangles of two leaves.
//!
//! Two triangles are apart if one lies on one side of the other's plane. The test computes sixteen pairs in f32, with a
//! bound on all rounding errors; exact arithmetic decides the pairs that the bound leaves open. The test finds nearly
//! every pair that is apart. For nearly every other pair it finds which corners lie above which plane, which saves the
//! largest part of the exact arithmetic.
//!
//! The bound. A height `h = n·w` above a plane through corner `a`, with `n = u × v` and `w = p - a`, is a determinant
//! whose rows are differences of corners. Computed from exact corners with `e = 2^-24` it errs by at most
//! `(7 + 56 e) e` times its permanent (Shewchuk 1997, sec. 4.3), here `16 e`. There are three more errors. First, `w`
//! has a placed corner, which f32 misses by `d`; this adds `|n|·d`. Second, `u` and `v` of the second mesh are
//! computed before placing, which moves them by at most `q`; this adds `dn·|w|` with
//! `dn_x = q (|u_y| + |v_y| + |u_z| + |v_z| + 2 q)` and so on. Third, products below the range of f32 vanish; this
//! adds a small constant. The boxes meet, so no component of `w` exceeds twice the sum of the half extents and the
//! margin of their comparison. The bound uses the greatest of these in each leaf, which needs errors of four
//! triangles instead of sixteen pairs. Sizes are limited so that no product overflows ([`Reach::has_planes`]).

use super::pairs::{Lanes, Meshes, Reach, dot0, splat};
use crate::bvh::{Boxes, Triangles, WIDTH};

/// Columns of four triangles.
type Four = [f32; WIDTH];

/// The planes of the four triangles of a leaf, with bounds on the errors of heights above them.
struct Planes {
    normal: [Four; 3],
    error: Four,
}

/// 16 e for products of rounded differences.
const ROUNDING: f32 = 8.0 * f32::EPSILON;
/// More than three products lose by underflow, but a normal number.
const VANISHING: f32 = 16.0 * f32::MIN_POSITIVE;

impl Planes {
    /// For sides moved by at most `shift`, and points that f32 misses by at most `miss` and that lie no farther than
    /// `wide` from the first corner along each axis.
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "lanes of several columns")]
    fn of(triangles: &Triangles, shift: f32, miss: f32, wide: &[f32; 3]) -> Planes {
        let corners = &triangles.corners;
        let mut planes = Planes {
            normal: [[0.0; WIDTH]; 3],
            error: [VANISHING; WIDTH],
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
                let slope = ROUNDING * size + 2.0 * moved + VANISHING;
                planes.error[i] += slope * wide[axis] + miss * (size + moved);
            }
        }
        planes
    }

    /// The component of a motion along each normal.
    #[inline(always)]
    fn along(&self, motion: &[f32; 3]) -> Four {
        let [x, y, z] = &self.normal;
        let mut along = [0.0; WIDTH];
        for i in 0..WIDTH {
            along[i] = x[i] * motion[0] + y[i] * motion[1] + z[i] * motion[2];
        }
        along
    }
}

/// The result of the quick test, a bit for each pair.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Glance {
    /// Pairs that may meet.
    pub(super) maybe: u32,
    /// Pairs of which each triangle certainly crosses the other's plane, with no corner in it.
    pub(super) cross: u32,
    /// For pairs that cross, the corners of the first triangle above the second's plane.
    pub(super) first_above: [u32; 3],
    /// For pairs that cross, the corners of the second triangle above the first's plane.
    pub(super) second_above: [u32; 3],
}

/// The quick test of `pairs` of triangles of two leaves whose boxes are known to meet; the meshes are not rotated.
#[inline(always)]
pub(super) fn glance<L: Lanes>(
    meshes: Meshes<'_>,
    (a, b): (u32, u32),
    pairs: u32,
    reach: &Reach,
) -> Glance {
    let (a, b) = (meshes.first.node(a), meshes.second.node(b));
    let (first, second) = (meshes.first.triangles(a), meshes.second.triangles(b));
    let wide = wide(&a.boxes.half, &b.boxes.half, reach.margin());
    let offset = splat(reach.offset());
    let (u, v) = (&first.corners, &second.corners);
    let a = [rows(u, 0), rows(u, 3), rows(u, 6)];
    let b = [
        placed(v, 0, &offset),
        placed(v, 3, &offset),
        placed(v, 6, &offset),
    ];

    let planes = Planes::of(first, 0.0, reach.miss(), &wide);
    let normal = [
        L::rows(&planes.normal[0]),
        L::rows(&planes.normal[1]),
        L::rows(&planes.normal[2]),
    ];
    let seconds = sides(&normal, L::rows(&planes.error), &a[0], &b);

    let planes = Planes::of(second, reach.shift(), reach.miss(), &wide);
    let normal = [
        L::columns(&planes.normal[0]),
        L::columns(&planes.normal[1]),
        L::columns(&planes.normal[2]),
    ];
    let firsts = sides(&normal, L::columns(&planes.error), &b[0], &a);
    let maybe = pairs & !(firsts.apart() | seconds.apart());
    Glance {
        maybe,
        cross: maybe & firsts.certain() & seconds.certain(),
        first_above: firsts.above,
        second_above: seconds.above,
    }
}

/// The motion of the second mesh in f32.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// The start, and the motion from there.
    pub(super) offset: [f32; 3],
    pub(super) motion: [f32; 3],
    /// More than twice that, and more than the margins of box comparisons, along each axis.
    pub(super) wide: [f32; 3],
    /// The most by which f32 misses placed corners, and by which placing moves sides ([`Reach`]).
    pub(super) miss: f32,
    pub(super) shift: f32,
}

/// A bit for each pair of triangles of two leaves of which one certainly stays on one side of the other's plane for the
/// whole motion. Their boxes are known to meet during the motion.
///
/// The change of a height by the motion is another determinant. Its error bound `16 e` leaves half for the sum of the
/// two and for the rounding of the motion.
#[inline(always)]
pub(super) fn stay_apart<L: Lanes>(
    (boxes, first): (&Boxes, &Triangles),
    (others, second): (&Boxes, &Triangles),
    way: &Way,
) -> u32 {
    let [x, y, z] = wide(&boxes.half, &others.half, 0.0);
    let wide = [x + way.wide[0], y + way.wide[1], z + way.wide[2]];
    let offset = splat(way.offset);
    let (u, v) = (&first.corners, &second.corners);
    let a = [rows(u, 0), rows(u, 3), rows(u, 6)];
    let b = [
        placed(v, 0, &offset),
        placed(v, 3, &offset),
        placed(v, 6, &offset),
    ];

    let planes = Planes::of(first, 0.0, way.miss, &wide);
    let [x, y, z] = &planes.normal;
    let normal = [L::rows(x), L::rows(y), L::rows(z)];
    let (added, error) = (planes.along(&way.motion), L::rows(&planes.error));
    let seconds = stay(&normal, (L::rows(&added), error), &a[0], &b);

    let planes = Planes::of(second, way.shift, way.miss, &wide);
    let [x, y, z] = &planes.normal;
    let normal = [L::columns(x), L::columns(y), L::columns(z)];
    let added = planes.along(&way.motion);
    let added = L::splat(0.0).sub(L::columns(&added));
    let firsts = stay(&normal, (added, L::columns(&planes.error)), &b[0], &a);
    firsts | seconds
}

/// A bit for each lane in which three points certainly stay on one side of a plane while a term is added to their
/// heights.
#[inline(always)]
fn stay<L: Lanes>(
    normal: &[L; 3],
    (added, error): (L, L),
    corner: &[L; 3],
    points: &[[L; 3]; 3],
) -> u32 {
    let p = height(normal, corner, &points[0]);
    let q = height(normal, corner, &points[1]);
    let r = height(normal, corner, &points[2]);
    let none = L::splat(0.0);
    let lowest = p.min(q).min(r).add(added.min(none));
    let highest = p.max(q).max(r).add(added.max(none));
    lowest.above(error) | none.sub(error).above(highest)
}

/// Bounds the difference of two points of two boxes that meet, along each axis, for any two boxes of two leaves.
#[inline(always)]
fn wide(first: &[Four; 3], second: &[Four; 3], margin: f32) -> [f32; 3] {
    let most = |[a, b, c, d]: Four| max(max(a, b), max(c, d));
    let wide = |axis: usize| 2.0 * (most(first[axis]) + most(second[axis])) + margin;
    [wide(0), wide(1), wide(2)]
}

/// The greater of two numbers.
#[inline(always)]
fn max(x: f32, y: f32) -> f32 {
    if x > y { x } else { y }
}

/// One corner of each of the first mesh's triangles.
#[inline(always)]
fn rows<L: Lanes>(corners: &[Four; 9], k: usize) -> [L; 3] {
    [
        L::rows(&corners[k]),
        L::rows(&corners[k + 1]),
        L::rows(&corners[k + 2]),
    ]
}

/// One corner of each of the second mesh's triangles, placed, up to rounding.
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

/// The sides of a plane on which three points certainly lie, a bit for each lane.
struct Sides {
    above: [u32; 3],
    below: [u32; 3],
}

impl Sides {
    /// All on one side.
    #[inline(always)]
    fn apart(&self) -> u32 {
        let [p, q, r] = self.above;
        let [s, t, u] = self.below;
        (p & q & r) | (s & t & u)
    }

    /// Each certainly on one side or the other.
    #[inline(always)]
    fn certain(&self) -> u32 {
        let [p, q, r] = self.above;
        let [s, t, u] = self.below;
        (p | s) & (q | t) & (r | u)
    }
}

#[inline(always)]
fn sides<L: Lanes>(normal: &[L; 3], error: L, corner: &[L; 3], points: &[[L; 3]; 3]) -> Sides {
    let p = height(normal, corner, &points[0]);
    let q = height(normal, corner, &points[1]);
    let r = height(normal, corner, &points[2]);
    let minus = L::splat(0.0).sub(error);
    Sides {
        above: [p.above(error), q.above(error), r.above(error)],
        below: [minus.above(p), minus.above(q), minus.above(r)],
    }
}
