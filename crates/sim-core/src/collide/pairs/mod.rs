//! The descent through two hierarchies at once.
//!
//! A *tile* is a pair of nodes: the four boxes of one against the four of the other, sixteen
//! pairs at once. A tile leaves the pairs that may meet, nearest first; each is a tile again,
//! or two triangles. The descent goes depth first and keeps, for each tile on its way, only the
//! pairs still to come, so that its stack is small whatever the meshes.

mod overlap;
mod ranked;
#[cfg(target_arch = "x86_64")]
mod simd;

use core::ops::ControlFlow;

use crate::bvh::{Bvh, Child, MAX_DEPTH, Node};
pub use overlap::Level;
pub(super) use overlap::{Reach, each_pair};
pub(super) use ranked::{Ranked, TILE, key};

/// What a descent does with nodes and triangles.
pub(super) trait Tiles {
    /// Pairs of lanes that are worth a look, nearest first.
    fn rank(&mut self, first: &Node, second: &Node) -> Ranked;

    /// Takes two triangles, by their places in leaf order.
    fn triangles(&mut self, first: u32, second: u32) -> ControlFlow<()>;
}

/// A tile on the way, with the pairs of it that are still to come.
#[derive(Clone, Copy)]
struct Tile {
    first: Child,
    second: Child,
    ranked: Ranked,
}

/// Visits the pairs of triangles that `tiles` leaves, until told to stop.
#[inline(always)]
pub(super) fn descend(first: &Bvh, second: &Bvh, tiles: &mut impl Tiles) -> ControlFlow<()> {
    let roots = Tile {
        first: Child::Node(0),
        second: Child::Node(0),
        ranked: tiles.rank(first.node(0), second.node(0)),
    };
    // Each tile lies at least one level below the one before it in one of the trees.
    let mut way = [roots; 2 * MAX_DEPTH];
    let mut top = 0;
    loop {
        let tile = &mut way[top];
        let Some((i, j)) = tile.ranked.pop() else {
            if top == 0 {
                return ControlFlow::Continue(());
            }
            top -= 1;
            continue;
        };
        let a = below(first, tile.first, i);
        let b = below(second, tile.second, j);
        let ranked = match (a, b) {
            (Child::Node(a), Child::Node(b)) => tiles.rank(first.node(a), second.node(b)),
            (Child::Triangle(s), Child::Node(b)) => {
                tiles.rank(&Node::of_triangle(s, first.corners(s)), second.node(b))
            }
            (Child::Node(a), Child::Triangle(t)) => {
                tiles.rank(first.node(a), &Node::of_triangle(t, second.corners(t)))
            }
            (Child::Triangle(s), Child::Triangle(t)) => {
                tiles.triangles(s, t)?;
                continue;
            }
        };
        if !ranked.is_empty() {
            // A tile with nothing to come makes room for the next one.
            top += usize::from(!way[top].ranked.is_empty());
            way[top] = Tile {
                first: a,
                second: b,
                ranked,
            };
        }
    }
}

/// What a lane of a tile holds; a triangle that waits for the other side stays itself.
#[inline(always)]
fn below(bvh: &Bvh, at: Child, lane: usize) -> Child {
    match at {
        Child::Node(node) => bvh.node(node).child(lane).unwrap_or(at),
        Child::Triangle(_) => at,
    }
}
