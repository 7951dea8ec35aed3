//! Through two hierarchies: only triangles whose boxes meet are tested.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::{
    Hit, Level, Placement, Side, Work,
    apart::maybe_meet,
    pairs::{Lanes, Meshes, Question, Reach, TILE, each_pair},
    predicates::{segment_meets_triangle, triangles_meet},
};
use crate::bvh::{Bvh, WIDTH};

/// Whether the surfaces of two meshes meet, the second one placed: displaced by a `DVec3` (m), or
/// turned too ([`Placement::turned`]). Stops at the first hit and allocates nothing.
pub fn intersect(first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> bool {
    intersect_at(Level::best(), first, second, at)
}

/// [`intersect`] with the instructions of a level, to compare levels.
pub fn intersect_at(level: Level, first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> bool {
    let at = &at.into();
    let meshes = Meshes { first, second, at };
    each_pair(level, meshes, &mut AnyHit).is_break()
}

/// Stops at the first pair of triangles that meet.
struct AnyHit;

impl Question for AnyHit {
    #[inline(always)]
    fn triangles<L: Lanes>(
        &mut self,
        meshes: Meshes<'_>,
        (a, b): (u32, u32),
        pairs: u32,
        reach: Option<&Reach>,
    ) -> ControlFlow<()> {
        let maybe = match reach.filter(|reach| reach.has_planes()) {
            Some(reach) => maybe_meet::<L>(meshes, (a, b), pairs, reach),
            None => pairs,
        };
        if any_meets(meshes, (a, b), maybe) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// Not for lanes, and not to take their registers.
#[inline(never)]
fn any_meets(meshes: Meshes<'_>, leaves: (u32, u32), pairs: u32) -> bool {
    triangles(meshes, leaves, pairs).any(|((_, s), (_, t))| {
        let s = s.map(|v| v.as_dvec3());
        triangles_meet(s, t.map(|v| meshes.at.place(v)))
    })
}

/// What [`intersect`] costs here: pairs of boxes compared, and pairs of triangles whose boxes meet.
pub fn work(first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> Work {
    let at = &at.into();
    let meshes = Meshes { first, second, at };
    let mut counted = Counted::default();
    let meet = each_pair(Level::best(), meshes, &mut counted).is_break();
    Work {
        meet,
        boxes: counted.tiles * TILE as u64,
        tests: counted.pairs,
    }
}

/// [`AnyHit`], counted.
#[derive(Default)]
struct Counted {
    tiles: u64,
    pairs: u64,
}

impl Question for Counted {
    #[inline(always)]
    fn triangles<L: Lanes>(
        &mut self,
        meshes: Meshes<'_>,
        leaves: (u32, u32),
        pairs: u32,
        reach: Option<&Reach>,
    ) -> ControlFlow<()> {
        self.pairs += u64::from(pairs.count_ones());
        AnyHit.triangles::<L>(meshes, leaves, pairs, reach)
    }

    #[inline(always)]
    fn tile(&mut self) {
        self.tiles += 1;
    }
}

/// Every edge of one mesh in a triangle of the other, in no order, until `found` stops it.
/// Allocates nothing.
pub fn each_hit(
    first: &Bvh,
    second: &Bvh,
    at: impl Into<Placement>,
    found: impl FnMut(Hit) -> ControlFlow<()>,
) -> ControlFlow<()> {
    each_hit_at(Level::best(), first, second, at, found)
}

/// [`each_hit`] with the instructions of a level, to compare levels.
pub fn each_hit_at(
    level: Level,
    first: &Bvh,
    second: &Bvh,
    at: impl Into<Placement>,
    found: impl FnMut(Hit) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let at = &at.into();
    let meshes = Meshes { first, second, at };
    each_pair(level, meshes, &mut AllHits { found })
}

/// Every edge of one mesh in a triangle of the other, in the order of [`super::naive::hits`].
pub fn hits(first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> Vec<Hit> {
    hits_at(Level::best(), first, second, at)
}

/// [`hits`] with the instructions of a level, to compare levels.
pub fn hits_at(level: Level, first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> Vec<Hit> {
    let mut hits = Vec::new();
    let _ = each_hit_at(level, first, second, at, |hit| {
        hits.push(hit);
        ControlFlow::Continue(())
    });
    hits.sort_unstable_by_key(Hit::key);
    hits
}

struct AllHits<F> {
    found: F,
}

impl<F: FnMut(Hit) -> ControlFlow<()>> Question for AllHits<F> {
    fn triangles<L: Lanes>(
        &mut self,
        meshes: Meshes<'_>,
        leaves: (u32, u32),
        pairs: u32,
        _: Option<&Reach>,
    ) -> ControlFlow<()> {
        for (s, t) in triangles(meshes, leaves, pairs) {
            pair_hits(meshes, s, t).try_for_each(&mut self.found)?;
        }
        ControlFlow::Continue(())
    }
}

/// A triangle of a mesh and its corners, in the mesh's own frame.
type Face = (u32, [glam::Vec3; 3]);

/// The triangles of some pairs of two leaves.
#[inline]
fn triangles(
    meshes: Meshes<'_>,
    (a, b): (u32, u32),
    mut pairs: u32,
) -> impl Iterator<Item = (Face, Face)> {
    let s = meshes.first.triangles(meshes.first.node(a));
    let t = meshes.second.triangles(meshes.second.node(b));
    core::iter::from_fn(move || {
        let pair = (pairs != 0).then(|| pairs.trailing_zeros() as usize)?;
        pairs &= pairs - 1;
        let (i, j) = (pair / WIDTH, pair % WIDTH);
        Some(((s.face[i], s.corners(i)), (t.face[j], t.corners(j))))
    })
}

/// The edges that either of two triangles owns, where they meet the other triangle.
fn pair_hits(
    meshes: Meshes<'_>,
    (s_face, s_corners): Face,
    (t_face, t_corners): Face,
) -> impl Iterator<Item = Hit> {
    let s_corners = s_corners.map(|v| v.as_dvec3());
    let t_corners = t_corners.map(|v| meshes.at.place(v));
    let (first, second) = (meshes.first.topology(), meshes.second.topology());
    let ways = [
        (
            Side::First,
            first,
            s_face as usize,
            s_corners,
            t_face,
            t_corners,
        ),
        (
            Side::Second,
            second,
            t_face as usize,
            t_corners,
            s_face,
            s_corners,
        ),
    ];
    ways.into_iter()
        .flat_map(|(side, edges_of, triangle, ends, face, corners)| {
            (0..3)
                .filter(move |&i| edges_of.owned[triangle].edge[i])
                .filter_map(move |i| {
                    // The ends in the mesh's order, so that the point is the naive one to the bit.
                    let (mut p, mut q) = (i, (i + 1) % 3);
                    let vertices = edges_of.triangles[triangle];
                    if vertices[p] > vertices[q] {
                        core::mem::swap(&mut p, &mut q);
                    }
                    let edge = [ends[p], ends[q]];
                    segment_meets_triangle(edge[0], edge[1], corners).then(|| {
                        Hit::new(
                            (side, edges_of.triangle_edges[triangle][i], edge),
                            (face, corners),
                        )
                    })
                })
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::naive;
    use crate::test_meshes::sphere;
    use glam::DVec3;

    #[test]
    fn work_is_counted_and_far_less_through_trees() {
        let ball = sphere(24);
        let tree = Bvh::build(&ball);
        let (edges, faces) = (ball.edges().len(), ball.triangles().len());
        let miss = DVec3::new(1.5, 1.5, 0.1);
        let (plain, fast) = (naive::work(&ball, &ball, miss), work(&tree, &tree, miss));
        assert!(!plain.meet && !fast.meet);
        assert_eq!(plain.tests, 2 * (edges * faces) as u64);
        assert!(fast.boxes > 16 && fast.boxes + fast.tests < plain.tests / 1000);
        let hit = DVec3::new(1.0, 0.2, 0.1);
        let (plain, fast) = (naive::work(&ball, &ball, hit), work(&tree, &tree, hit));
        assert!(plain.meet && fast.meet && fast.tests > 0);
        // The naive search ends with the first hit of its list.
        let first = naive::hits(&ball, &ball, hit)
            .into_iter()
            .filter(|h| h.edge_of == Side::First)
            .min_by_key(|h| (h.face, h.edge))
            .expect("an edge of the first ball");
        let before = u64::from(first.face) * edges as u64 + u64::from(first.edge) + 1;
        assert_eq!(plain.tests, before);
    }

    #[test]
    fn far_apart_nothing_is_compared() {
        let tree = Bvh::build(&sphere(8));
        let far = work(&tree, &tree, DVec3::X * 3.0);
        assert_eq!((far.meet, far.boxes, far.tests), (false, 0, 0));
    }
}
