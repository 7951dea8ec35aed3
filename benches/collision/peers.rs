//! The methods that test whether two meshes meet, each used in its best documented way.

use parry3d::math::{Pose, Vector};
use parry3d::partitioning::BvhNode;
use parry3d::query;
use sim_core::DVec3;
use sim_core::collide::{Level, naive, predicates::triangles_meet, tree};

use crate::meshes::Solid;

/// A method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    /// Ours, with the instruction set of a level.
    Tree(Level),
    /// Ours without trees.
    Naive,
    /// Parry's trees and pair traversal with our exact test of triangles.
    ParryTree,
    /// Parry's own query.
    ParryQuery,
}

impl Method {
    /// Ours at every level that this processor has, the widest first; then the peers.
    pub(crate) fn with_trees() -> Vec<Method> {
        let levels = Level::ALL.into_iter().rev().filter(|l| l.is_available());
        let peers = [Method::ParryTree, Method::ParryQuery];
        levels.map(Method::Tree).chain(peers).collect()
    }

    pub(crate) fn is_ours(self) -> bool {
        matches!(self, Method::Tree(_) | Method::Naive)
    }

    pub(crate) fn best_tree() -> Method {
        Method::Tree(Level::best())
    }

    pub(crate) fn name(self) -> String {
        match self {
            Method::Tree(level) => format!("ours {level:?}"),
            Method::Naive => "ours naive".into(),
            Method::ParryTree => "parry tree + our predicate".into(),
            Method::ParryQuery => "parry query".into(),
        }
    }

    /// Whether the surfaces meet, the second displaced by `offset`.
    pub(crate) fn meet(self, first: &Solid, second: &Solid, offset: DVec3) -> bool {
        match self {
            Method::Tree(level) => tree::intersect_at(level, &first.bvh, &second.bvh, offset),
            Method::Naive => naive::intersect(&first.mesh, &second.mesh, offset),
            Method::ParryTree => parry_tree(first, second, offset, triangles_meet),
            Method::ParryQuery => parry_query(first, second, offset),
        }
    }
}

/// Parry's trees, traversed with `Bvh::leaf_pairs`; `meet` decides about two triangles.
///
/// Boxes are compared in f32, enlarged by more than the rounding of offset and sum. So this method is exact if `meet`
/// is, and it shares no code for trees and their traversal with ours.
pub(crate) fn parry_tree(
    first: &Solid,
    second: &Solid,
    offset: DVec3,
    meet: impl Fn([DVec3; 3], [DVec3; 3]) -> bool,
) -> bool {
    let bounds = second.mesh.bounds();
    let widest = bounds.min.abs().max(bounds.max.abs()).as_dvec3() + offset.abs();
    let margin = widest * f64::from(f32::EPSILON) * 2.0 + f64::from(f32::MIN_POSITIVE);
    let vector = |v: DVec3| Vector::from_array(v.as_vec3().to_array());
    let (low, high) = (vector(offset - margin), vector(offset + margin));
    let boxes_meet = |a: &BvhNode, b: &BvhNode| {
        a.mins().cmple(b.maxs() + high).all() && (b.mins() + low).cmple(a.maxs()).all()
    };
    first
        .parry
        .bvh()
        .leaf_pairs(second.parry.bvh(), boxes_meet)
        .any(|(s, t)| {
            let s = first.mesh.corners(s as usize).map(|v| v.as_dvec3());
            let t = second
                .mesh
                .corners(t as usize)
                .map(|v| v.as_dvec3() + offset);
            meet(s, t)
        })
}

/// Parry's query for two shapes. It uses f32 throughout, so the offset is rounded.
fn parry_query(first: &Solid, second: &Solid, offset: DVec3) -> bool {
    let pose = Pose::from_translation(Vector::from_array(offset.as_vec3().to_array()));
    query::intersection_test(&Pose::IDENTITY, &first.parry, &pose, &second.parry)
        .expect("parry knows meshes")
        .intersecting
}
