//! Which boxes of two nodes meet, sixteen pairs at once, at the widest level of the processor.

use core::ops::ControlFlow;
use glam::DVec3;

#[cfg(target_arch = "x86_64")]
use super::simd;
use super::{Lanes, Portable, Tiles, descend};
use crate::bvh::{Boxes, Bvh, Slabs};

/// Where the second mesh is, as a comparison of boxes in f32 sees it.
#[derive(Clone, Copy, Debug)]
pub(in crate::collide) struct Reach {
    pub(in crate::collide) offset: [f32; 3],
    /// More than all roundings in a comparison of boxes, m.
    pub(in crate::collide) margin: f32,
}

impl Reach {
    /// For the second displaced by `offset`, unless f32 does not reach so far.
    ///
    /// With `S` the sum of the magnitudes of both boxes and of the offset along an axis and
    /// `u = 2^-24`, a comparison `|c - (c' + r)| <= h + h'` sees roundings of `r`, of the sum
    /// `c' + r`, the difference, the sum `h + h'` and the subtraction, together below `7 u S`, and
    /// of centres, half extents and placed vertices in f64, far below `u S`.
    pub(in crate::collide) fn new(first: &Bvh, second: &Bvh, offset: DVec3) -> Option<Reach> {
        let size = |bvh: &Bvh| bvh.bounds().min.abs().max(bvh.bounds().max.abs()).as_dvec3();
        let size = size(first) + size(second) + offset.abs();
        let largest = size.max_element();
        (largest < 1e37).then(|| Reach {
            offset: offset.as_vec3().to_array(),
            margin: (largest * 8.0 * f64::from(f32::EPSILON)) as f32 + 16.0 * f32::MIN_POSITIVE,
        })
    }
}

impl Reach {
    /// What f32 misses placed vertices by at most, m: `2 u S`.
    #[inline(always)]
    pub(in crate::collide) fn miss(&self) -> f32 {
        self.margin * 0.25
    }

    /// What placing changes a difference of two vertices by at most, m: `2^-52 S`.
    #[inline(always)]
    pub(in crate::collide) fn shift(&self) -> f32 {
        self.margin * (1.0 / (1 << 28) as f32)
    }
}

/// Instructions that a descent may use. All give the same answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// What the crate was compiled for: 128-bit vectors on x86-64 and on AArch64.
    Portable,
    /// 256-bit vectors of x86-64.
    Avx2,
    /// 512-bit vectors of x86-64: all of a tile in one.
    Avx512,
}

impl Level {
    /// Every level, narrowest first.
    pub const ALL: [Level; 3] = [Level::Portable, Level::Avx2, Level::Avx512];

    /// Whether this processor has it. Without the feature `std` only what the crate was compiled
    /// for is known.
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        match self {
            Level::Portable => true,
            Level::Avx2 => simd::has_avx2(),
            Level::Avx512 => simd::has_avx512(),
        }
        #[cfg(not(target_arch = "x86_64"))]
        matches!(self, Level::Portable)
    }

    /// The widest level that this processor has.
    #[inline]
    pub fn best() -> Level {
        if Level::Avx512.is_available() {
            Level::Avx512
        } else if Level::Avx2.is_available() {
            Level::Avx2
        } else {
            Level::Portable
        }
    }
}

/// What a question does with pairs of triangles whose boxes meet.
pub(in crate::collide) trait Visit {
    /// Takes pairs of triangles of two leaves, a bit each. To be compiled for the instructions of
    /// each level, it must be inlined.
    fn visit<L: Lanes>(&mut self, first: u32, second: u32, pairs: u32) -> ControlFlow<()>;
}

/// Visits the pairs of triangles whose boxes meet, nearest first as far as depth-first goes,
/// until told to stop. A level that is not available is `Portable`.
#[inline]
pub(in crate::collide) fn each_pair(
    level: Level,
    first: &Bvh,
    second: &Bvh,
    reach: Reach,
    visit: impl Visit,
) -> ControlFlow<()> {
    #[cfg(target_arch = "x86_64")]
    match level {
        Level::Avx512 if simd::has_avx512() => {
            return simd::each_pair_avx512(first, second, reach, visit);
        }
        Level::Avx2 if simd::has_avx2() => {
            return simd::each_pair_avx2(first, second, reach, visit);
        }
        _ => {}
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = level;
    each_pair_in::<Portable>(first, second, reach, visit)
}

/// [`each_pair`] in lanes of a level.
#[inline(always)]
pub(super) fn each_pair_in<L: Lanes>(
    first: &Bvh,
    second: &Bvh,
    reach: Reach,
    visit: impl Visit,
) -> ControlFlow<()> {
    let mut overlaps = Overlaps {
        reach,
        offset: splat(reach.offset),
        margin: L::splat(reach.margin),
        visit,
    };
    descend(first, second, &mut overlaps)
}

struct Overlaps<L, V> {
    reach: Reach,
    offset: [L; 3],
    margin: L,
    visit: V,
}

impl<L: Lanes, V: Visit> Tiles for Overlaps<L, V> {
    type Lanes = L;

    #[inline(always)]
    fn boxes(&mut self, first: &Boxes, second: &Boxes) -> (u32, L) {
        let x = self.separation(first, second, 0);
        let y = self.separation(first, second, 1);
        let z = self.separation(first, second, 2);
        let separation = x.max(y).max(z);
        (separation.at_most(self.margin), separation)
    }

    #[inline(always)]
    fn slabs(&self, first: (&Boxes, &Slabs), second: (&Boxes, &Slabs), pairs: u32) -> u32 {
        pairs & !slabs_apart::<L>(&self.reach, first, second)
    }

    #[inline(always)]
    fn triangles(&mut self, first: u32, second: u32, pairs: u32) -> ControlFlow<()> {
        self.visit.visit::<L>(first, second, pairs)
    }
}

impl<L: Lanes, V> Overlaps<L, V> {
    /// How far apart boxes are along an axis.
    #[inline(always)]
    fn separation(&self, first: &Boxes, second: &Boxes, axis: usize) -> L {
        let centre = L::columns(&second.centre[axis]).add(self.offset[axis]);
        let between = L::rows(&first.centre[axis]).sub(centre).abs();
        let half = L::rows(&first.half[axis]).add(L::columns(&second.half[axis]));
        between.sub(half)
    }
}

/// Written out, as are all loops over axes here: closures in the standard library's loops would
/// not be compiled for the instructions of a level.
#[inline(always)]
pub(in crate::collide) fn splat<L: Lanes>([x, y, z]: [f32; 3]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}

/// A bit for each pair of children that the slab of one of them keeps apart.
///
/// Along the normal `n` of the one, a point `x` of the other has the height
/// `n·x = k m·x + (n - k m)·x` for any `k`, with the other's normal `m`. For `k = n·m` the second
/// part is small where the normals are alike; the other's slab bounds the first part, its box the
/// second one. Roundings in f32 are below 128 units of the last place of the largest sum of
/// coordinates, and twice that is allowed for.
#[inline(always)]
fn slabs_apart<L: Lanes>(
    reach: &Reach,
    (boxes, slabs): (&Boxes, &Slabs),
    (other_boxes, other_slabs): (&Boxes, &Slabs),
) -> u32 {
    let n = [L::rows(&slabs.normal[0]), L::rows(&slabs.normal[1]), L::rows(&slabs.normal[2])];
    let m = &other_slabs.normal;
    let m = [L::columns(&m[0]), L::columns(&m[1]), L::columns(&m[2])];
    let (s, w) = (L::rows(&slabs.middle), L::rows(&slabs.half));
    let (t, v) = (L::columns(&other_slabs.middle), L::columns(&other_slabs.half));
    let offset = splat::<L>(reach.offset);
    let slack = L::splat(16.0 * reach.margin);
    let k = n[0].mul_add(m[0], n[1].mul_add(m[1], n[2].mul(m[2])));

    let c = &other_boxes.centre;
    let c = [L::columns(&c[0]), L::columns(&c[1]), L::columns(&c[2])];
    let h = &other_boxes.half;
    let h = [L::columns(&h[0]), L::columns(&h[1]), L::columns(&h[2])];
    let far = n[0].mul_add(offset[0], n[1].mul_add(offset[1], n[2].mul(offset[2])));
    let one = slab_apart(&n, &m, k, (s, w.add(slack)), (t, v), far, &c, &h);

    let c = [L::rows(&boxes.centre[0]), L::rows(&boxes.centre[1]), L::rows(&boxes.centre[2])];
    let h = [L::rows(&boxes.half[0]), L::rows(&boxes.half[1]), L::rows(&boxes.half[2])];
    let far = m[0].mul_add(offset[0], m[1].mul_add(offset[1], m[2].mul(offset[2])));
    let far = L::splat(0.0).sub(far);
    one | slab_apart(&m, &n, k, (t, v.add(slack)), (s, w), far, &c, &h)
}

/// Lanes in which a slab of normal `n` holds nothing of another slab and box, `far` along `n`.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "all of them are lanes of one formula")]
fn slab_apart<L: Lanes>(
    n: &[L; 3],
    m: &[L; 3],
    k: L,
    (s, w): (L, L),
    (t, v): (L, L),
    far: L,
    c: &[L; 3],
    h: &[L; 3],
) -> u32 {
    let rest = [n[0].sub(k.mul(m[0])), n[1].sub(k.mul(m[1])), n[2].sub(k.mul(m[2]))];
    let middle = rest[0].mul_add(c[0], rest[1].mul_add(c[1], rest[2].mul_add(c[2], far)));
    let middle = k.mul_add(t, middle);
    let half = rest[0].abs().mul_add(h[0], rest[1].abs().mul_add(h[1], rest[2].abs().mul_add(h[2], w)));
    let half = k.abs().mul_add(v, half);
    middle.sub(s).abs().above(half)
}
