//! The descent through two hierarchies at once.
//!
//! A *tile* is a pair of nodes: the four boxes of one against the four of the other, sixteen
//! pairs at once. Pairs that may meet go on a stack, to be tiles in their turn, the nearest on
//! top; pairs of triangles are collected and handed over several at a time. A tile is a hundred
//! instructions or less, so what counts is how few branches are guessed wrong.

mod list;
mod overlap;
#[cfg(target_arch = "x86_64")]
mod simd;

use core::ops::ControlFlow;

use crate::bvh::{Bvh, Child, Node, WIDTH};
pub(super) use list::{Leaves, Stack};
pub use overlap::Level;
pub(super) use overlap::{Reach, each_pair};

/// Pairs in a tile.
pub(super) const TILE: usize = WIDTH * WIDTH;

/// How many pairs of triangles are handed over at once.
pub(super) const BATCH: usize = 8;

/// What a descent does with nodes and triangles.
pub(super) trait Tiles {
    /// Lists the pairs of children that are worth a look.
    fn expand(&mut self, first: &Node, second: &Node, stack: &mut Stack, leaves: &mut Leaves);

    /// Takes up to [`BATCH`] pairs of triangles, by their places in leaf order.
    fn triangles(&mut self, pairs: (&[u32], &[u32])) -> ControlFlow<()>;
}

/// What a question does with triangles whose boxes meet.
pub(super) trait Visit {
    /// Takes up to [`BATCH`] pairs of triangles, by their places in leaf order. To be compiled for
    /// the instructions of each level, it must be inlined.
    fn visit(&mut self, pairs: (&[u32], &[u32])) -> ControlFlow<()>;
}

/// Visits the pairs of triangles that `tiles` leaves, until told to stop.
#[inline(always)]
pub(super) fn descend(first: &Bvh, second: &Bvh, tiles: &mut impl Tiles) -> ControlFlow<()> {
    let (mut stack, mut leaves) = (Stack::new(), Leaves::new());
    // Where meshes meet, one of the first pairs does as a rule: these are not kept waiting.
    let mut enough = 1;
    tiles.expand(first.node(0), second.node(0), &mut stack, &mut leaves);
    loop {
        while leaves.len() >= enough {
            tiles.triangles(leaves.take(BATCH))?;
            enough = (2 * enough).min(BATCH);
        }
        let Some((a, b)) = stack.pop() else {
            break;
        };
        match (Child::of(a), Child::of(b)) {
            (Child::Triangle(s), _) => {
                let alone = Node::of_triangle(s, first.corners(s));
                tiles.expand(&alone, second.node(b), &mut stack, &mut leaves);
            }
            (_, Child::Triangle(t)) => {
                let alone = Node::of_triangle(t, second.corners(t));
                tiles.expand(first.node(a), &alone, &mut stack, &mut leaves);
            }
            _ => tiles.expand(first.node(a), second.node(b), &mut stack, &mut leaves),
        }
    }
    while leaves.len() > 0 {
        tiles.triangles(leaves.take(BATCH))?;
    }
    ControlFlow::Continue(())
}
