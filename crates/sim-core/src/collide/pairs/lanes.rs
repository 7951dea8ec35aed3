//! Sixteen floats at once: a lane for each pair of a tile.

use super::{Stack, TILE};
use crate::bvh::WIDTH;

/// Sixteen floats; lane `4 i + j` is for the pair of the first mesh's lane `i` and the second mesh's lane `j`. Levels
/// may round sums of products differently, so only bounds are computed with these.
pub(in crate::collide) trait Lanes: Copy {
    fn splat(x: f32) -> Self;
    /// Lane `4 i + j` is `x[i]`.
    fn rows(x: &[f32; WIDTH]) -> Self;
    /// Lane `4 i + j` is `x[j]`.
    fn columns(x: &[f32; WIDTH]) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    /// `self * factor + sum`, rounded once or twice.
    fn mul_add(self, factor: Self, sum: Self) -> Self;
    fn mul(self, factor: Self) -> Self;
    fn abs(self) -> Self;
    /// Either number if one is NaN.
    fn min(self, other: Self) -> Self;
    /// Either number if one is NaN.
    fn max(self, other: Self) -> Self;
    /// A bit for each lane that is at most `other`'s; none if one is NaN.
    fn at_most(self, other: Self) -> u32;
    /// A bit for each lane that is above `other`'s; none if one is NaN.
    fn above(self, other: Self) -> u32;
    /// The lane of the least float, roughly, among the lanes of some bits, and whether this float is negative.
    fn least(self, among: u32) -> (u32, bool);
    fn store(self, to: &mut [f32; TILE]);
    /// Pushes the pairs of `rows[i]` and `columns[j]` for some bits onto the stack, lowest first.
    fn push(stack: &mut Stack, bits: u32, rows: &[u32; WIDTH], columns: &[u32; WIDTH]);
}

/// Work in the lanes of any level. It must be inlined to be compiled for the instructions of each level.
pub(in crate::collide) trait InLanes {
    type Output;

    fn run<L: Lanes>(self) -> Self::Output;
}

/// Lanes for the instructions of the compiler's target.
#[derive(Clone, Copy)]
pub(in crate::collide) struct Portable([f32; TILE]);

impl Portable {
    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Portable {
        Portable(self.0.map(f))
    }

    #[inline(always)]
    fn zip(self, other: Portable, f: impl Fn(f32, f32) -> f32) -> Portable {
        Portable(core::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn bits(self, other: Portable, holds: impl Fn(f32, f32) -> bool) -> u32 {
        let bit = |i| u32::from(holds(self.0[i], other.0[i])) << i;
        (0..TILE).fold(0, |bits, i| bits | bit(i))
    }
}

impl Lanes for Portable {
    #[inline(always)]
    fn store(self, to: &mut [f32; TILE]) {
        *to = self.0;
    }

    #[inline(always)]
    fn splat(x: f32) -> Portable {
        Portable([x; TILE])
    }

    #[inline(always)]
    fn rows(x: &[f32; WIDTH]) -> Portable {
        Portable(core::array::from_fn(|lane| x[lane / WIDTH]))
    }

    #[inline(always)]
    fn columns(x: &[f32; WIDTH]) -> Portable {
        Portable(core::array::from_fn(|lane| x[lane % WIDTH]))
    }

    #[inline(always)]
    fn add(self, other: Portable) -> Portable {
        self.zip(other, |x, y| x + y)
    }

    #[inline(always)]
    fn sub(self, other: Portable) -> Portable {
        self.zip(other, |x, y| x - y)
    }

    #[inline(always)]
    fn mul_add(self, factor: Portable, sum: Portable) -> Portable {
        self.mul(factor).add(sum)
    }

    #[inline(always)]
    fn mul(self, factor: Portable) -> Portable {
        self.zip(factor, |x, y| x * y)
    }

    #[inline(always)]
    fn abs(self) -> Portable {
        self.map(f32::abs)
    }

    #[inline(always)]
    fn min(self, other: Portable) -> Portable {
        self.zip(other, |x, y| if x < y { x } else { y })
    }

    #[inline(always)]
    fn max(self, other: Portable) -> Portable {
        self.zip(other, |x, y| if x > y { x } else { y })
    }

    #[inline(always)]
    fn at_most(self, other: Portable) -> u32 {
        self.bits(other, |x, y| x <= y)
    }

    #[inline(always)]
    fn above(self, other: Portable) -> u32 {
        self.bits(other, |x, y| x > y)
    }

    #[inline(always)]
    fn least(self, mut among: u32) -> (u32, bool) {
        let (mut best, mut least) = (0, f32::INFINITY);
        while among != 0 {
            let lane = among.trailing_zeros();
            among &= among - 1;
            if self.0[lane as usize] < least {
                (best, least) = (lane, self.0[lane as usize]);
            }
        }
        (best, least < 0.0)
    }

    #[inline(always)]
    fn push(stack: &mut Stack, bits: u32, rows: &[u32; WIDTH], columns: &[u32; WIDTH]) {
        push_each(stack, bits, rows, columns);
    }
}

/// [`Lanes::push`] one by one.
#[inline(always)]
pub(super) fn push_each(
    stack: &mut Stack,
    mut bits: u32,
    rows: &[u32; WIDTH],
    columns: &[u32; WIDTH],
) {
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        stack.push(rows[lane / WIDTH], columns[lane % WIDTH]);
    }
}
