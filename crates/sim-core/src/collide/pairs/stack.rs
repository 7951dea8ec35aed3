//! Pairs that are still to be looked at.
//!
//! The only other `unsafe` of the crate besides that around vector instructions. Setting eight
//! kilobytes to zero before every query costs as much as a dozen tiles; here they stay as they are
//! until written.
#![allow(unsafe_code)]

use core::mem::MaybeUninit;

use super::TILE;
use crate::bvh::MAX_DEPTH;

/// A pair of nodes or leaves that is looked at leaves fifteen beside the next one, on each of the
/// levels of both trees; two pairs are looked at at once.
const CAPACITY: usize = (TILE - 1) * 2 * MAX_DEPTH * 2 + 2 * TILE;

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

    #[inline(always)]
    pub(in crate::collide) fn push(&mut self, first: u32, second: u32) {
        self.first[self.len].write(first);
        self.second[self.len].write(second);
        self.len += 1;
    }

    /// Adds the first `count` of sixteen pairs.
    #[inline(always)]
    pub(super) fn push_tile(&mut self, first: [u32; TILE], second: [u32; TILE], count: usize) {
        assert!(count <= TILE);
        let range = self.len..self.len + TILE;
        self.first[range.clone()].copy_from_slice(&first.map(MaybeUninit::new));
        self.second[range].copy_from_slice(&second.map(MaybeUninit::new));
        self.len += count;
    }

    /// Brings a pair to the top, counted from the top.
    #[inline(always)]
    pub(in crate::collide) fn raise(&mut self, below_top: usize) {
        let top = self.len - 1;
        self.first.swap(top - below_top, top);
        self.second.swap(top - below_top, top);
    }
}
