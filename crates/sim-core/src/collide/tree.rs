//! The same answers through two hierarchies: only triangles whose boxes meet are tested.

use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::DVec3;

use super::{Hit, Side, place, predicates::segment_meets_triangle};
use crate::bvh::{Bvh, MAX_DEPTH, Node, Triangle};

/// Whether the surfaces of two meshes meet, the second displaced by `offset` (m). Stops at the
/// first hit and allocates nothing.
pub fn intersect(first: &Bvh, second: &Bvh, offset: DVec3) -> bool {
    each_pair(
        first,
        second,
        |a, b| a.bounds.meets(&b.bounds, offset),
        |s, t| each_hit(s, t, offset, &mut |_| ControlFlow::Break(())),
    )
    .is_break()
}

/// Every edge of one mesh in a triangle of the other, in the order of [`super::naive::hits`].
pub fn hits(first: &Bvh, second: &Bvh, offset: DVec3) -> Vec<Hit> {
    let mut hits = Vec::new();
    let _ = each_pair(
        first,
        second,
        |a, b| a.bounds.meets(&b.bounds, offset),
        |s, t| {
            each_hit(s, t, offset, &mut |hit| {
                hits.push(hit());
                ControlFlow::Continue(())
            })
        },
    );
    hits.sort_unstable_by_key(Hit::key);
    hits
}

/// Visits the pairs of triangles in leaves that `may_meet` cannot tell apart, until told to stop.
pub(super) fn each_pair(
    first: &Bvh,
    second: &Bvh,
    may_meet: impl Fn(&Node, &Node) -> bool,
    mut visit: impl FnMut(&Triangle, &Triangle) -> ControlFlow<()>,
) -> ControlFlow<()> {
    // Each level of either tree leaves at most one pair behind.
    let mut stack = [(0, 0); 2 * MAX_DEPTH];
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let (i, j) = stack[top];
        let (a, b) = (first.node(i), second.node(j));
        if !may_meet(a, b) {
            continue;
        }
        if a.is_leaf() && b.is_leaf() {
            for s in first.leaf(a) {
                for t in second.leaf(b) {
                    visit(s, t)?;
                }
            }
            continue;
        }
        // Opens the larger box, so that both stay of a size.
        let open_first =
            b.is_leaf() || !a.is_leaf() && a.bounds.half_area() >= b.bounds.half_area();
        let pairs = if open_first {
            a.children().map(|i| (i, j))
        } else {
            b.children().map(|j| (i, j))
        };
        (stack[top], stack[top + 1]) = (pairs[1], pairs[0]);
        top += 2;
    }
    ControlFlow::Continue(())
}

/// Tests the edges that either triangle owns against the other triangle.
fn each_hit(
    s: &Triangle,
    t: &Triangle,
    offset: DVec3,
    found: &mut impl FnMut(&dyn Fn() -> Hit) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let s_corners = s.corners.map(|v| v.as_dvec3());
    let t_corners = t.corners.map(|v| place(v, offset));
    let ways = [
        (Side::First, s, s_corners, t, t_corners),
        (Side::Second, t, t_corners, s, s_corners),
    ];
    for (side, edges_of, ends, face_of, corners) in ways {
        for i in (0..3).filter(|&i| edges_of.owns_edge[i]) {
            // The ends in the mesh's order, so that the point is the naive one to the bit.
            let (mut p, mut q) = (i, (i + 1) % 3);
            if edges_of.vertices[p] > edges_of.vertices[q] {
                core::mem::swap(&mut p, &mut q);
            }
            let edge = [ends[p], ends[q]];
            if segment_meets_triangle(edge[0], edge[1], corners) {
                found(&|| Hit::new((side, edges_of.edges[i], edge), (face_of.face, corners)))?;
            }
        }
    }
    ControlFlow::Continue(())
}
