//! The descent through two hierarchies at once.
//!
//! A *tile* is a pair of nodes or leaves: the four boxes of one against the four of the other,
//! sixteen pairs at once. Pairs of children that may meet go on a stack, to be tiles in their turn,
//! the nearest on top. A leaf against a node goes down on the node's side only, and where two
//! leaves have come together the pairs of triangles whose boxes meet are handed over.

mod lanes;
mod overlap;
#[cfg(target_arch = "x86_64")]
mod simd;
mod stack;

use core::ops::ControlFlow;

use crate::bvh::{Boxes, Bvh, LEAF, WIDTH};
pub(super) use lanes::{Lanes, Portable};
pub use overlap::Level;
pub(super) use overlap::{Reach, Visit, each_pair};
pub(super) use stack::Stack;

/// Pairs in a tile.
pub(super) const TILE: usize = WIDTH * WIDTH;

/// What a descent does with boxes and triangles.
pub(super) trait Tiles {
    type Lanes: Lanes;

    /// A bit for each pair of boxes that is worth a look, and how near each is.
    fn boxes(&mut self, first: &Boxes, second: &Boxes) -> (u32, Self::Lanes);

    /// Takes pairs of triangles of two leaves, a bit each.
    fn triangles(&mut self, first: u32, second: u32, pairs: u32) -> ControlFlow<()>;
}

/// Visits the pairs of triangles that `tiles` leaves, until told to stop.
#[inline(always)]
pub(super) fn descend<T: Tiles>(first: &Bvh, second: &Bvh, tiles: &mut T) -> ControlFlow<()> {
    let mut stack = Stack::new();
    stack.push(first.root(), second.root());
    while let Some((a, b)) = stack.pop() {
        let (pairs, distance) = tiles.boxes(first.boxes_in(a), second.boxes_in(b));
        if pairs == 0 {
            continue;
        }
        match (a & LEAF == 0, b & LEAF == 0) {
            (true, true) => {
                let (rows, columns) = (&first.node(a).child, &second.node(b).child);
                T::Lanes::push(&mut stack, pairs, rows, columns);
                let nearest = distance.least(pairs);
                stack.raise((pairs >> nearest).count_ones() as usize - 1);
            }
            (false, true) => {
                let any = (pairs | pairs >> 4 | pairs >> 8 | pairs >> 12) & 0xf;
                let rows = [a; WIDTH];
                T::Lanes::push(&mut stack, any, &rows, &second.node(b).child);
                let nearest = distance.least(pairs) % WIDTH as u32;
                stack.raise((any >> nearest).count_ones() as usize - 1);
            }
            (true, false) => {
                let any = pairs | pairs >> 1 | pairs >> 2 | pairs >> 3;
                let any = any & 0x1111;
                T::Lanes::push(&mut stack, any, &first.node(a).child, &[b; WIDTH]);
                let nearest = distance.least(pairs) & !3;
                stack.raise((any >> nearest).count_ones() as usize - 1);
            }
            (false, false) => tiles.triangles(a, b, pairs)?,
        }
    }
    ControlFlow::Continue(())
}
