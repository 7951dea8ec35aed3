//! Which boxes of two nodes meet, sixteen pairs at once, at the widest level of the processor.

use core::ops::ControlFlow;
use glam::{DVec3, Vec3};

#[cfg(target_arch = "x86_64")]
use super::simd;
use super::{Leaves, Stack, TILE, Tiles, Visit, descend};
use crate::bvh::{Bvh, Node, TRIANGLE, WIDTH};

/// Offsets of the second mesh that a comparison of boxes allows for, rounded outward: from one
/// corner of a box to the other, along each axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub(super) low: [f32; 3],
    pub(super) high: [f32; 3],
}

impl Reach {
    /// Allows for the one `offset`.
    ///
    /// A box's corner moved in f32 errs by the rounding of the offset and of the sum, at most
    /// `2^-24 |offset|` and `2^-24 (|corner| + |offset|)`, or half the least float. Moved that
    /// far outward and more, the box holds every placed vertex of it. Beyond the range of f32 every
    /// pair is let through, for the exact tests to decide.
    pub(crate) fn new(second: &Bvh, offset: DVec3) -> Reach {
        let bounds = second.bounds();
        let widest = bounds.min.abs().max(bounds.max.abs()).as_dvec3() + offset.abs();
        let margin =
            widest * f64::from(f32::EPSILON) + f64::from(f32::MIN_POSITIVE * f32::EPSILON) * 4.0;
        let (low, high) = if widest.max_element() < 1e37 {
            ((offset - margin).as_vec3(), (offset + margin).as_vec3())
        } else {
            (Vec3::NEG_INFINITY, Vec3::INFINITY)
        };
        Reach {
            low: low.to_array(),
            high: high.to_array(),
        }
    }
}

/// Instructions that a descent may use. All give the same answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// What the crate was compiled for: 128-bit vectors on x86-64 and on AArch64.
    Portable,
    /// 256-bit vectors of x86-64.
    Avx2,
    /// 512-bit vectors of x86-64: a tile is one comparison for each side of the box.
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

/// Visits the pairs of triangles whose boxes meet somewhere in `reach`, nearest first as far as
/// depth-first goes, until told to stop. A level that is not available is `Portable`.
#[inline]
pub(crate) fn each_pair(
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
    descend(first, second, &mut Boxes { reach, visit })
}

struct Boxes<V> {
    reach: Reach,
    visit: V,
}

impl<V: Visit> Tiles for Boxes<V> {
    #[inline(always)]
    fn expand(&mut self, first: &Node, second: &Node, stack: &mut Stack, leaves: &mut Leaves) {
        let mut apart = [[0u32; WIDTH]; WIDTH];
        let mut distance = [[0.0f32; WIDTH]; WIDTH];
        for axis in 0..3 {
            let min = second.min[axis].map(|x| x + self.reach.low[axis]);
            let max = second.max[axis].map(|x| x + self.reach.high[axis]);
            for i in 0..WIDTH {
                let (a_min, a_max) = (first.min[axis][i], first.max[axis][i]);
                for j in 0..WIDTH {
                    let meet = u32::from(a_min <= max[j]) & u32::from(min[j] <= a_max);
                    apart[i][j] |= meet ^ 1;
                    let d = (a_min + a_max) - (min[j] + max[j]);
                    distance[i][j] += d * d;
                }
            }
        }
        let (mut nearest, mut least, mut count) = (0, f32::INFINITY, 0);
        for pair in 0..TILE {
            let (i, j) = (pair / WIDTH, pair % WIDTH);
            if apart[i][j] != 0 {
                continue;
            }
            let (a, b) = (first.child[i], second.child[j]);
            if a & b & TRIANGLE != 0 {
                leaves.push(a & !TRIANGLE, b & !TRIANGLE);
            } else {
                stack.push(a, b);
                if distance[i][j] < least {
                    (nearest, least) = (count, distance[i][j]);
                }
                count += 1;
            }
        }
        if count > 1 {
            stack.raise(count - 1 - nearest);
        }
    }

    #[inline(always)]
    fn triangles(&mut self, pairs: (&[u32], &[u32])) -> ControlFlow<()> {
        self.visit.visit(pairs)
    }
}
