//! A relative pose in f32, for comparisons of boxes.

use super::Lanes;
use crate::bvh::{Boxes, Bvh, Slabs};
use crate::collide::Placement;

/// The pose of the second mesh in f32, and a bound on its error.
#[derive(Clone, Copy, Debug)]
pub(in crate::collide) struct Reach {
    offset: [f32; 3],
    /// Rows of the rotation.
    turn: [[f32; 3]; 3],
    /// A bound on all roundings in a comparison of boxes, m.
    margin: f32,
    /// Whether heights above planes are in the range of f32; only for meshes that are not rotated.
    planes: bool,
}

/// Beyond this, m, sums of products of coordinates with unit vectors exceed the range of f32.
pub(in crate::collide) const LARGEST: f64 = 1e37;
/// Beyond this, m, products of three coordinates exceed it: with sides and distances up to twice the sizes, a height
/// above a plane stays below `3 · 8 S² · 2 S`.
const LARGEST_FOR_PLANES: f64 = 1e12;

impl Reach {
    /// `None` beyond the range of f32.
    ///
    /// Let `S` be the sum of the magnitudes of both boxes and of the offset (for a rotated mesh, of all its
    /// coordinates), and `u = 2^-24`. A comparison `|c - c'| <= h + h'` of placed boxes has roundings of the offset,
    /// of the sum with it, the difference, the sum `h + h'` and the subtraction, together below `7 u S`. A rotation
    /// adds less than `2 (5 u S)` for entries, products and sums of centre and half extents. Placed vertices are
    /// rounded in f64, far below `u S`.
    pub(in crate::collide) fn new(first: &Bvh, second: &Bvh, at: &Placement) -> Option<Reach> {
        let size = |bvh: &Bvh| {
            bvh.bounds()
                .min
                .abs()
                .max(bvh.bounds().max.abs())
                .as_dvec3()
        };
        let (size, others) = (size(first) + at.offset().abs(), size(second));
        let (largest, units) = match at.turn() {
            None => ((size + others).max_element(), 16.0),
            Some(_) => (size.max_element() + others.element_sum(), 32.0),
        };
        let turn = at.turn().map_or([[0.0; 3]; 3], |turn| {
            turn.transpose()
                .to_cols_array_2d()
                .map(|row| row.map(|x| x as f32))
        });
        let unit = f64::from(f32::EPSILON) / 2.0;
        (largest < LARGEST).then(|| Reach {
            offset: at.offset().as_vec3().to_array(),
            turn,
            planes: at.turn().is_none() && largest < LARGEST_FOR_PLANES,
            margin: (units * unit * largest) as f32 + 16.0 * f32::MIN_POSITIVE,
        })
    }

    #[inline(always)]
    pub(in crate::collide) fn margin(&self) -> f32 {
        self.margin
    }

    #[inline(always)]
    pub(in crate::collide) fn offset(&self) -> [f32; 3] {
        self.offset
    }

    /// Whether planes may be compared in f32 (`apart`).
    #[inline(always)]
    pub(in crate::collide) fn has_planes(&self) -> bool {
        self.planes
    }

    /// The most by which f32 misses placed vertices, m: `2 u S`, without rotation.
    #[inline(always)]
    pub(in crate::collide) fn miss(&self) -> f32 {
        self.margin * (1.0 / 4.0)
    }

    /// The most by which placing changes a difference of two vertices, m: `2^-52 S`, without rotation.
    #[inline(always)]
    pub(in crate::collide) fn shift(&self) -> f32 {
        self.margin * (1.0 / (1 << 28) as f32)
    }
}

/// Boxes of one mesh in the first one's frame, in lanes.
pub(super) struct Placed<L> {
    pub(super) centre: [L; 3],
    pub(super) half: [L; 3],
}

/// Slabs of one mesh in the first one's frame, in lanes.
pub(super) struct PlacedSlabs<L> {
    pub(super) normal: [L; 3],
    pub(super) middle: L,
    pub(super) half: L,
}

// Loops over axes are written out here and in the callers: closures in the standard library's loops would not be
// compiled for the instructions of a level.
impl<L: Lanes> Placed<L> {
    #[inline(always)]
    pub(super) fn first(boxes: &Boxes) -> Placed<L> {
        let (c, h) = (&boxes.centre, &boxes.half);
        Placed {
            centre: [L::rows(&c[0]), L::rows(&c[1]), L::rows(&c[2])],
            half: [L::rows(&h[0]), L::rows(&h[1]), L::rows(&h[2])],
        }
    }

    /// Boxes of the second mesh; `TURNED` tells whether there is a rotation.
    #[inline(always)]
    pub(super) fn second<const TURNED: bool>(boxes: &Boxes, reach: &Reach) -> Placed<L> {
        let (c, h) = (&boxes.centre, &boxes.half);
        let centre = [L::columns(&c[0]), L::columns(&c[1]), L::columns(&c[2])];
        let half = [L::columns(&h[0]), L::columns(&h[1]), L::columns(&h[2])];
        let r = splat::<L>(reach.offset);
        if !TURNED {
            let centre = [
                centre[0].add(r[0]),
                centre[1].add(r[1]),
                centre[2].add(r[2]),
            ];
            return Placed { centre, half };
        }
        let [x, y, z] = reach.turn;
        let (x, y, z) = (splat::<L>(x), splat::<L>(y), splat::<L>(z));
        Placed {
            centre: [
                dot(&x, &centre, r[0]),
                dot(&y, &centre, r[1]),
                dot(&z, &centre, r[2]),
            ],
            half: [
                dot0(&abs(&x), &half),
                dot0(&abs(&y), &half),
                dot0(&abs(&z), &half),
            ],
        }
    }
}

impl<L: Lanes> PlacedSlabs<L> {
    #[inline(always)]
    pub(super) fn first(slabs: &Slabs) -> PlacedSlabs<L> {
        let n = &slabs.normal;
        PlacedSlabs {
            normal: [L::rows(&n[0]), L::rows(&n[1]), L::rows(&n[2])],
            middle: L::rows(&slabs.middle),
            half: L::rows(&slabs.half),
        }
    }

    /// Slabs of the second mesh: along a rotated normal, the heights change by that of the offset.
    #[inline(always)]
    pub(super) fn second<const TURNED: bool>(slabs: &Slabs, reach: &Reach) -> PlacedSlabs<L> {
        let n = &slabs.normal;
        let mut normal = [L::columns(&n[0]), L::columns(&n[1]), L::columns(&n[2])];
        if TURNED {
            let [x, y, z] = reach.turn;
            let (x, y, z) = (splat::<L>(x), splat::<L>(y), splat::<L>(z));
            normal = [dot0(&x, &normal), dot0(&y, &normal), dot0(&z, &normal)];
        }
        PlacedSlabs {
            middle: dot(&normal, &splat(reach.offset), L::columns(&slabs.middle)),
            normal,
            half: L::columns(&slabs.half),
        }
    }
}

#[inline(always)]
pub(in crate::collide) fn splat<L: Lanes>([x, y, z]: [f32; 3]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}

/// `x·y + rest`.
#[inline(always)]
pub(super) fn dot<L: Lanes>(x: &[L; 3], y: &[L; 3], rest: L) -> L {
    x[0].mul_add(y[0], x[1].mul_add(y[1], x[2].mul_add(y[2], rest)))
}

/// `x·y`.
#[inline(always)]
pub(in crate::collide) fn dot0<L: Lanes>(x: &[L; 3], y: &[L; 3]) -> L {
    x[0].mul_add(y[0], x[1].mul_add(y[1], x[2].mul(y[2])))
}

#[inline(always)]
pub(super) fn abs<L: Lanes>(x: &[L; 3]) -> [L; 3] {
    [x[0].abs(), x[1].abs(), x[2].abs()]
}
