//! Queries through two hierarchies: only triangles whose boxes meet are tested.

use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::DVec3;

use super::{
    Hit, Level, Placement, Side, Work,
    apart::{Glance, glance},
    cuboid_mesh::Pair,
    cuboids,
    pairs::{Lanes, Meshes, Question, Reach, TILE, each_pair},
    predicates::{crossing_meet, crossing_orders, segment_meets_triangle, triangles_meet},
};
use crate::bvh::{Bvh, WIDTH};

/// Whether the surfaces of two meshes meet. The second one is placed: displaced by a `DVec3` (m), or rotated too
/// ([`Placement::turned`]). Stops at the first hit and allocates nothing.
pub fn intersect(first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> bool {
    intersect_at(Level::best(), first, second, at)
}

/// [`intersect`] with the instructions of a level, to compare levels. If a mesh is a box, no wide instructions are
/// used.
pub fn intersect_at(level: Level, first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> bool {
    let at = &at.into();
    let meshes = Meshes { first, second, at };
    match with_cuboid(meshes) {
        Some(work) => work.meet,
        None => each_pair(level, meshes, &mut AnyHit).is_break(),
    }
}

/// The answer and its cost if a mesh is a box, which needs no second tree.
#[inline]
pub(super) fn with_cuboid(Meshes { first, second, at }: Meshes<'_>) -> Option<Work> {
    let offset = at.offset();
    let pair = match (first.cuboid(), second.cuboid()) {
        (None, None) => return None,
        _ if at.turn().is_some() || !at.is_in_range() => return None,
        (Some(first), Some(second)) => {
            return Some(Work {
                meet: cuboids::meet(first, second, offset),
                boxes: 1,
                tests: 0,
            });
        }
        (Some(cuboid), None) => Pair::of(cuboid.ends, second, offset),
        (None, Some(cuboid)) => {
            let ends = cuboid.ends.map(|end| end + offset);
            Pair::of(ends, first, DVec3::ZERO)
        }
    };
    Some(pair?.meet())
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
        let glance = match reach.filter(|reach| reach.has_planes()) {
            Some(reach) => glance::<L>(meshes, (a, b), pairs, reach),
            None => Glance {
                maybe: pairs,
                ..Glance::default()
            },
        };
        if glance.maybe != 0 && any_meets(meshes, (a, b), &glance) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// Without lanes; not inlined, so that it does not use their registers.
#[inline(never)]
fn any_meets(meshes: Meshes<'_>, (a, b): (u32, u32), glance: &Glance) -> bool {
    let first = meshes.first.triangles(meshes.first.node(a));
    let second = meshes.second.triangles(meshes.second.node(b));
    lanes(glance.maybe).any(|(i, j)| {
        let bit = |bits: u32| bits >> (WIDTH * i + j) & 1;
        let s = |k| first.corner(i, k).as_dvec3();
        let t = |k| meshes.at.place(second.corner(j, k));
        if bit(glance.cross) == 1 {
            let above = |[p, q, r]: [u32; 3]| bit(p) | bit(q) << 1 | bit(r) << 2;
            let orders = crossing_orders(above(glance.first_above), above(glance.second_above));
            let ([p, q, r], [u, v, w]) = orders;
            crossing_meet([s(p), s(q), s(r)], [t(u), t(v), t(w)])
        } else {
            triangles_meet([s(0), s(1), s(2)], [t(0), t(1), t(2)])
        }
    })
}

/// The cost of [`intersect`]: pairs of boxes compared, and pairs of triangles whose boxes meet.
pub fn work(first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> Work {
    let at = &at.into();
    let meshes = Meshes { first, second, at };
    with_cuboid(meshes).unwrap_or_else(|| {
        let mut counted = Counted::default();
        let meet = each_pair(Level::best(), meshes, &mut counted).is_break();
        Work {
            meet,
            boxes: counted.tiles * TILE as u64,
            tests: counted.pairs,
        }
    })
}

/// [`AnyHit`], with counts.
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
    pairs: u32,
) -> impl Iterator<Item = (Face, Face)> {
    let s = meshes.first.triangles(meshes.first.node(a));
    let t = meshes.second.triangles(meshes.second.node(b));
    lanes(pairs).map(|(i, j)| ((s.face[i], s.corners(i)), (t.face[j], t.corners(j))))
}

/// The lanes of some pairs. From one pair to the next both lanes change if possible: if a triangle misses, it probably
/// misses its neighbours in the other leaf too.
#[inline]
fn lanes(pairs: u32) -> impl Iterator<Item = (usize, usize)> {
    let (mut pairs, mut turned) = (pairs as u16, 0);
    core::iter::from_fn(move || {
        if pairs == 0 {
            return None;
        }
        let skipped = pairs.trailing_zeros();
        let pair = (turned + skipped) as usize % TILE;
        let on = skipped + WIDTH as u32 + 1;
        pairs = (pairs & (pairs - 1)).rotate_right(on);
        turned += on;
        Some((pair / WIDTH, pair % WIDTH))
    })
}

/// The edges owned by one of two triangles that meet the other triangle.
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
                    // The ends in the mesh's order, so that the point is that of the naive search to the bit.
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
    fn every_pair_has_its_turn_once() {
        for pairs in 0..1 << TILE {
            let seen = lanes(pairs).fold(0, |seen, (i, j)| {
                let bit = 1 << (WIDTH * i + j);
                assert_eq!(seen & bit, 0);
                seen | bit
            });
            assert_eq!(seen, pairs);
        }
        let both_change: Vec<_> = lanes(0xffff).take(WIDTH).collect();
        assert_eq!(both_change, [(0, 0), (1, 1), (2, 2), (3, 3)]);
    }

    #[test]
    fn far_apart_nothing_is_compared() {
        let tree = Bvh::build(&sphere(8));
        let far = work(&tree, &tree, DVec3::X * 3.0);
        assert_eq!((far.meet, far.boxes, far.tests), (false, 0, 0));
    }
}
