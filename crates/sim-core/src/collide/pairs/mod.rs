//! The descent through two hierarchies at once.
//!
//! A *tile* is a pair of nodes or leaves: the four boxes of one against the four of the other, sixteen pairs at once.
//! Pairs of children that may meet go on a stack and become tiles later; at first the most promising pair is next. A
//! leaf against a node descends on the node's side only. For two leaves, the descent passes on the pairs of triangles
//! whose boxes meet.

mod lanes;
mod level;
mod overlap;
mod reach;
#[cfg(target_arch = "x86_64")]
mod simd;
mod stack;

use core::ops::ControlFlow;

use crate::bvh::{Boxes, Bvh, LEAF, Slabs, WIDTH};
pub(super) use lanes::{InLanes, Lanes, Portable};
pub use level::Level;
pub(super) use overlap::{Meshes, Question, each_pair};
pub(super) use reach::{LARGEST, Reach, dot0, splat};
pub(super) use stack::Stack;

/// Pairs in a tile.
pub(in crate::collide) const TILE: usize = WIDTH * WIDTH;

/// The tests of a descent for boxes and triangles.
pub(super) trait Tiles {
    type Lanes: Lanes;

    /// A bit for each pair of boxes that may meet; and for each pair the distance of one box's centre outside the
    /// other box, negative inside.
    fn boxes(&mut self, first: &Boxes, second: &Boxes) -> (u32, Self::Lanes);

    /// The pairs that may meet by their slabs too.
    fn slabs(&self, first: (&Boxes, &Slabs), second: (&Boxes, &Slabs), pairs: u32) -> u32;

    /// Receives pairs of triangles of two leaves, a bit each.
    fn triangles(&mut self, first: u32, second: u32, pairs: u32) -> ControlFlow<()>;
}

/// The most tiles that are tested one after the other. The next tile is always the pair in which a centre lies
/// deepest in the other box. If meshes meet deeply, this usually finds a hit.
const GREEDY: usize = 24;
/// The most tiles without promise among these: no pair of boxes may meet, or no box of such a pair contains the other's
/// centre.
const HOPE: usize = 10;
/// The number of further such tiles for two leaves in which boxes of triangles meet.
const MORE_HOPE: usize = 4;
/// After that, this many tiles are tested side by side, in no order: a quick hit is unlikely, and throughput counts.
const ABREAST: usize = 4;

/// Visits the pairs of triangles that `tiles` does not exclude, until told to stop.
#[inline(always)]
pub(super) fn descend<T: Tiles>(first: &Bvh, second: &Bvh, tiles: &mut T) -> ControlFlow<()> {
    let mut stack = Stack::new();
    let mut next = Some((first.root(), second.root()));
    let mut hope = HOPE;
    for _ in 0..GREEDY {
        if hope == 0 {
            break;
        }
        let Some((a, b)) = next.or_else(|| stack.pop()) else {
            return ControlFlow::Continue(());
        };
        let (node, other) = (first.node(a), second.node(b));
        let (pairs, outside) = tiles.boxes(&node.boxes, &other.boxes);
        let bits = below(a, b, pairs);
        next = None;
        if bits != 0 {
            let (deepest, is_inside) = outside.least(pairs);
            hope -= usize::from(!is_inside);
            let (i, j) = (deepest as usize / WIDTH, deepest as usize % WIDTH);
            next = Some((node.child[i], other.child[j]));
            T::Lanes::push(
                &mut stack,
                bits & !(1 << (deepest & kept(a, b))),
                &node.child,
                &other.child,
            );
        } else if pairs != 0 {
            tiles.triangles(a, b, pairs)?;
            hope += MORE_HOPE;
        } else {
            hope -= 1;
        }
    }
    if let Some((a, b)) = next {
        stack.push(a, b);
    }
    loop {
        let mut abreast = [(0, 0); ABREAST];
        let count = stack.take(&mut abreast);
        if count == 0 {
            return ControlFlow::Continue(());
        }
        let (mut leaves, mut waiting) = ([(0, 0, 0); ABREAST], 0);
        for &(a, b) in &abreast[..count] {
            let (node, other) = (first.node(a), second.node(b));
            let (pairs, _) = tiles.boxes(&node.boxes, &other.boxes);
            let slabs = (first.slabs(a), second.slabs(b));
            let pairs = tiles.slabs((&node.boxes, slabs.0), (&other.boxes, slabs.1), pairs);
            let bits = below(a, b, pairs);
            T::Lanes::push(&mut stack, bits, &node.child, &other.child);
            leaves[waiting] = (a, b, pairs);
            waiting += usize::from((bits == 0) & (pairs != 0));
        }
        for &(a, b, pairs) in &leaves[..waiting] {
            tiles.triangles(a, b, pairs)?;
        }
    }
}

/// The lanes that [`below`] distinguishes: for a leaf that stays, the number of the lane does not matter.
#[inline(always)]
fn kept(a: u32, b: u32) -> u32 {
    let of_first = if a & LEAF == 0 { 0b1111 } else { 0b0011 };
    let of_second = if b & LEAF == 0 { 0b1111 } else { 0b1100 };
    of_first & of_second
}

/// The pairs for the next tiles: for two nodes, all pairs. A leaf against a node stays for the node's children, once
/// for all its triangles. For two leaves, none.
#[inline(always)]
fn below(a: u32, b: u32, pairs: u32) -> u32 {
    let columns = (pairs | pairs >> 4 | pairs >> 8 | pairs >> 12) & 0x000f;
    let rows = (pairs | pairs >> 1 | pairs >> 2 | pairs >> 3) & 0x1111;
    let of_first = if a & LEAF == 0 { u32::MAX } else { columns };
    let of_second = if b & LEAF == 0 { u32::MAX } else { rows };
    let both = if a & b & LEAF == 0 { u32::MAX } else { 0 };
    let any = if (a | b) & LEAF == 0 { pairs } else { u32::MAX };
    any & of_first & of_second & both
}
