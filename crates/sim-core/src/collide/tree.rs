//! The same answers through two hierarchies: only triangles whose boxes meet are tested.

use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::{DVec3, Vec3};

use super::{
    Hit, Level, Side,
    apart::maybe_meet,
    pairs::{Lanes, Reach, Visit, each_pair},
    place,
    predicates::{segment_meets_triangle, triangles_meet},
    snap,
};
use crate::bvh::{Bvh, Triangles, WIDTH};

/// Whether the surfaces of two meshes meet, the second displaced by `offset` (m). Stops at the
/// first hit and allocates nothing.
pub fn intersect(first: &Bvh, second: &Bvh, offset: DVec3) -> bool {
    intersect_at(Level::best(), first, second, offset)
}

/// [`intersect`] with the instructions of a level, to compare levels.
pub fn intersect_at(level: Level, first: &Bvh, second: &Bvh, offset: DVec3) -> bool {
    let offset = snap(offset);
    if !first.bounds().meets(&second.bounds(), offset) {
        return false;
    }
    let reach = Reach::new(first, second, offset).expect("TODO");
    let mut any = AnyHit {
        first,
        second,
        offset,
        reach,
    };
    each_pair(level, first, second, reach, &mut any).is_break()
}

/// Stops at the first pair of triangles that meet.
struct AnyHit<'a> {
    first: &'a Bvh,
    second: &'a Bvh,
    offset: DVec3,
    reach: Reach,
}

impl Visit for &mut AnyHit<'_> {
    #[inline(always)]
    fn visit<L: Lanes>(&mut self, a: u32, b: u32, pairs: u32) -> ControlFlow<()> {
        let (a, b) = (self.first.node(a), self.second.node(b));
        let (s, t) = (self.first.triangles(a), self.second.triangles(b));
        let mut pairs = maybe_meet::<L>((a, s), (b, t), pairs, &self.reach);
        while pairs != 0 {
            let pair = pairs.trailing_zeros() as usize;
            if self.meet(s, t, pair) {
                return ControlFlow::Break(());
            }
            pairs &= pairs - 1;
        }
        ControlFlow::Continue(())
    }
}

impl AnyHit<'_> {
    #[inline(never)]
    fn meet(&self, s: &Triangles, t: &Triangles, pair: usize) -> bool {
        let s = s.corners(pair / WIDTH).map(|v| v.as_dvec3());
        let t = t.corners(pair % WIDTH).map(|v| place(v, self.offset));
        triangles_meet(s, t)
    }
}

/// Every edge of one mesh in a triangle of the other, in the order of [`super::naive::hits`].
pub fn hits(first: &Bvh, second: &Bvh, offset: DVec3) -> Vec<Hit> {
    hits_at(Level::best(), first, second, offset)
}

/// [`hits`] with the instructions of a level, to compare levels.
pub fn hits_at(level: Level, first: &Bvh, second: &Bvh, offset: DVec3) -> Vec<Hit> {
    let offset = snap(offset);
    let mut hits = Vec::new();
    if first.bounds().meets(&second.bounds(), offset) {
        let reach = Reach::new(first, second, offset).expect("TODO");
        let mut all = AllHits {
            first,
            second,
            offset,
            hits: &mut hits,
        };
        let _ = each_pair(level, first, second, reach, &mut all);
    }
    hits.sort_unstable_by_key(Hit::key);
    hits
}

/// Lists the hits of every pair of triangles.
struct AllHits<'a> {
    first: &'a Bvh,
    second: &'a Bvh,
    offset: DVec3,
    hits: &'a mut Vec<Hit>,
}

impl Visit for &mut AllHits<'_> {
    fn visit<L: Lanes>(&mut self, a: u32, b: u32, mut pairs: u32) -> ControlFlow<()> {
        let (a, b) = (self.first.node(a), self.second.node(b));
        let (s, t) = (self.first.triangles(a), self.second.triangles(b));
        while pairs != 0 {
            let pair = pairs.trailing_zeros() as usize;
            pairs &= pairs - 1;
            let (i, j) = (pair / WIDTH, pair % WIDTH);
            let s = (s.face[i], s.corners(i));
            let t = (t.face[j], t.corners(j));
            self.hits
                .extend(pair_hits(self.first, self.second, s, t, self.offset));
        }
        ControlFlow::Continue(())
    }
}

/// The edges that either of two triangles owns, where they meet the other triangle.
fn pair_hits<'a>(
    first: &'a Bvh,
    second: &'a Bvh,
    (s_face, s_corners): (u32, [Vec3; 3]),
    (t_face, t_corners): (u32, [Vec3; 3]),
    offset: DVec3,
) -> impl Iterator<Item = Hit> + 'a {
    let s_corners = s_corners.map(|v| v.as_dvec3());
    let t_corners = t_corners.map(|v| place(v, offset));
    let (s, t) = (first.origin(s_face), second.origin(t_face));
    let ways = [
        (Side::First, s, s_corners, t_face, t_corners),
        (Side::Second, t, t_corners, s_face, s_corners),
    ];
    ways.into_iter()
        .flat_map(|(side, edges_of, ends, face, corners)| {
            (0..3)
                .filter(|&i| edges_of.owned.edge[i])
                .filter_map(move |i| {
                    // The ends in the mesh's order, so that the point is the naive one to the bit.
                    let (mut p, mut q) = (i, (i + 1) % 3);
                    if edges_of.vertices[p] > edges_of.vertices[q] {
                        core::mem::swap(&mut p, &mut q);
                    }
                    let edge = [ends[p], ends[q]];
                    segment_meets_triangle(edge[0], edge[1], corners)
                        .then(|| Hit::new((side, edges_of.edges[i], edge), (face, corners)))
                })
        })
}
