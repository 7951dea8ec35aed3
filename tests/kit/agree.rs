//! Agreement of naive and BVH, at every SIMD level.

use sim_core::collide::{Level, Placement, naive, tree};
use sim_core::{Bvh, Mesh};

/// Panics unless both ways give the same answer and the same hits, bit for bit. Returns whether the meshes meet.
#[track_caller]
pub fn assert_same(first: &Mesh, second: &Mesh, at: impl Into<Placement>) -> bool {
    let at = at.into();
    let (a, b) = (Bvh::build(first), Bvh::build(second));
    let hits = naive::hits(first, second, at);
    let meet = !hits.is_empty();
    assert_eq!(meet, naive::intersect(first, second, at));
    for level in Level::ALL {
        assert_eq!(hits, tree::hits_at(level, &a, &b, at));
        assert_eq!(meet, tree::intersect_at(level, &a, &b, at));
    }
    meet
}
