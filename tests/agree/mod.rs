//! Naive and BVH, at every level of vectors, agree.

use proptest::prelude::*;
use sim_core::collide::{Level, Placement, naive, tree};
use sim_core::{Bvh, Mesh};

/// Fails unless both ways give the same answer and the same hits, to the bit; tells whether meshes
/// meet.
pub(crate) fn assert_same(
    first: &Mesh,
    second: &Mesh,
    at: impl Into<Placement>,
) -> Result<bool, TestCaseError> {
    let at = at.into();
    let (a, b) = (Bvh::build(first), Bvh::build(second));
    let hits = naive::hits(first, second, at);
    prop_assert_eq!(!hits.is_empty(), naive::intersect(first, second, at));
    for level in Level::ALL {
        prop_assert_eq!(&hits, &tree::hits_at(level, &a, &b, at));
        prop_assert_eq!(!hits.is_empty(), tree::intersect_at(level, &a, &b, at));
    }
    Ok(!hits.is_empty())
}
