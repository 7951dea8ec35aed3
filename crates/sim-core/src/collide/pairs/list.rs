//! Pairs of children, in two columns.

use super::{BATCH, TILE};
use crate::bvh::MAX_DEPTH;

/// Pairs that are still to come, at least one of each a node. Each is a level lower in one of the
/// trees than the pair it comes from, which leaves fifteen beside it.
pub(in crate::collide) type Stack = Pairs<{ (TILE - 1) * 2 * MAX_DEPTH + 2 * TILE }>;

/// Pairs of triangles that wait for others: fewer than a batch, and a tile's.
pub(in crate::collide) type Leaves = Pairs<{ BATCH + 2 * TILE }>;

/// Up to `N - 16` pairs; a tile's sixteen are written in one piece, however few count.
pub(in crate::collide) struct Pairs<const N: usize> {
    first: [u32; N],
    second: [u32; N],
    len: usize,
}

impl<const N: usize> Pairs<N> {
    #[inline(always)]
    pub(super) fn new() -> Pairs<N> {
        Pairs {
            first: [0; N],
            second: [0; N],
            len: 0,
        }
    }

    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<(u32, u32)> {
        self.len = self.len.checked_sub(1)?;
        Some((self.first[self.len], self.second[self.len]))
    }

    #[inline(always)]
    pub(in crate::collide) fn push(&mut self, first: u32, second: u32) {
        self.first[self.len] = first;
        self.second[self.len] = second;
        self.len += 1;
    }

    /// Adds the first `count` of sixteen pairs.
    #[inline(always)]
    pub(super) fn push_tile(&mut self, first: [u32; TILE], second: [u32; TILE], count: usize) {
        self.first[self.len..self.len + TILE].copy_from_slice(&first);
        self.second[self.len..self.len + TILE].copy_from_slice(&second);
        self.len += count;
    }

    /// Brings a pair to the top, counted from the top.
    #[inline(always)]
    pub(in crate::collide) fn raise(&mut self, below_top: usize) {
        let top = self.len - 1;
        self.first.swap(top - below_top, top);
        self.second.swap(top - below_top, top);
    }

    /// Takes the last pairs, `most` at most.
    #[inline(always)]
    pub(super) fn take(&mut self, most: usize) -> (&[u32], &[u32]) {
        let end = self.len;
        self.len -= most.min(end);
        (&self.first[self.len..end], &self.second[self.len..end])
    }
}
