//! A stack of pairs that the descent has still to visit.
//!
//! This is the only `unsafe` of the crate besides that of vector instructions. The stack has thirty-two kilobytes,
//! enough for the deepest trees, of which a query uses a few hundred bytes. To set all of them to zero for each query
//! would cost more than the query. So they stay uninitialised until written.
#![allow(unsafe_code)]

use core::mem::MaybeUninit;

use super::{ABREAST, TILE};
use crate::bvh::MAX_DEPTH;

/// The pairs pushed in one round, at most sixteen from each pair that it takes, form a group. A round takes pairs
/// from the top, and pushes pairs that come from them. So of two groups on the stack the upper one comes from pairs
/// that lay above, or in, the lower one: the sum of both depths grows by at least one from group to group. So there
/// are no more groups than this sum can have values. The sixteen pairs of a tile are written together, however few
/// count.
const CAPACITY: usize = TILE * ABREAST * 2 * MAX_DEPTH + TILE;

/// A stack of pairs, in two columns.
///
/// Invariant: the first `len` elements of both columns have been written.
pub(in crate::collide) struct Stack {
    first: [MaybeUninit<u32>; CAPACITY],
    second: [MaybeUninit<u32>; CAPACITY],
    len: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Stack {
        Stack {
            first: [const { MaybeUninit::uninit() }; CAPACITY],
            second: [const { MaybeUninit::uninit() }; CAPACITY],
            len: 0,
        }
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<(u32, u32)> {
        self.len = self.len.checked_sub(1)?;
        let (first, second) = (self.first[self.len], self.second[self.len]);
        // SAFETY: `len` was one more, so by the invariant both have been written.
        Some(unsafe { (first.assume_init(), second.assume_init()) })
    }

    /// Takes pairs from the top, the lowest first, and returns their number.
    #[inline(always)]
    pub(super) fn take(&mut self, pairs: &mut [(u32, u32); ABREAST]) -> usize {
        let count = self.len.min(ABREAST);
        self.len -= count;
        for (i, pair) in pairs.iter_mut().enumerate().take(count) {
            let place = self.len + i;
            // SAFETY: it is below what `len` was, so by the invariant both have been written.
            *pair = unsafe {
                (
                    self.first[place].assume_init(),
                    self.second[place].assume_init(),
                )
            };
        }
        count
    }

    #[inline(always)]
    pub(in crate::collide) fn push(&mut self, first: u32, second: u32) {
        self.first[self.len].write(first);
        self.second[self.len].write(second);
        self.len += 1;
    }

    /// Adds the first `count` of sixteen pairs.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn push_tile(&mut self, first: [u32; TILE], second: [u32; TILE], count: usize) {
        assert!(count <= TILE);
        let range = self.len..self.len + TILE;
        self.first[range.clone()].copy_from_slice(&first.map(MaybeUninit::new));
        self.second[range].copy_from_slice(&second.map(MaybeUninit::new));
        self.len += count;
    }
}
