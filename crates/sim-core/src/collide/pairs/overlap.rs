//! Tests whether boxes and slabs of two nodes meet, sixteen pairs at once.

use core::ops::ControlFlow;

use super::reach::{Placed, PlacedSlabs, abs, dot, dot0};
use super::{InLanes, Lanes, Level, Portable, Reach, TILE, Tiles, descend};
use crate::bvh::{Boxes, Bvh, Slabs, WIDTH};
use crate::collide::Placement;

/// Two meshes, the second one placed.
#[derive(Clone, Copy)]
pub(in crate::collide) struct Meshes<'a> {
    pub(in crate::collide) first: &'a Bvh,
    pub(in crate::collide) second: &'a Bvh,
    pub(in crate::collide) at: &'a Placement,
}

/// A question about two meshes, triangle by triangle.
pub(in crate::collide) trait Question {
    /// Receives pairs of triangles of two leaves whose boxes meet, a bit each; `reach` is present if f32 is used. It
    /// must be inlined to be compiled for the instructions of each level.
    fn triangles<L: Lanes>(
        &mut self,
        meshes: Meshes<'_>,
        leaves: (u32, u32),
        pairs: u32,
        reach: Option<&Reach>,
    ) -> ControlFlow<()>;

    /// Called for each tile whose boxes are compared.
    fn tile(&mut self) {}
}

/// Passes the pairs of triangles whose boxes meet to a question, the most promising first as far as depth-first order
/// allows, until told to stop.
#[inline]
pub(in crate::collide) fn each_pair<Q: Question>(
    level: Level,
    meshes: Meshes<'_>,
    question: &mut Q,
) -> ControlFlow<()> {
    let Meshes { first, second, at } = meshes;
    if !at.is_in_range() || !at.boxes_meet(&first.bounds(), &second.bounds()) {
        return ControlFlow::Continue(());
    }
    if at.turn().is_some() {
        level.run(Ask::<Q, true> { meshes, question })
    } else {
        level.run(Ask::<Q, false> { meshes, question })
    }
}

/// [`each_pair`] in the lanes of a level.
struct Ask<'a, Q, const TURNED: bool> {
    meshes: Meshes<'a>,
    question: &'a mut Q,
}

impl<Q: Question, const TURNED: bool> InLanes for Ask<'_, Q, TURNED> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> ControlFlow<()> {
        let Ask { meshes, question } = self;
        let Meshes { first, second, at } = meshes;
        match Reach::new(first, second, at) {
            Some(reach) => {
                let mut overlaps = Overlaps::<L, Q, TURNED> {
                    meshes,
                    margin: L::splat(reach.margin()),
                    slack: L::splat(SLACK * reach.margin()),
                    reach,
                    question,
                };
                descend(first, second, &mut overlaps)
            }
            None => descend(first, second, &mut Wide { meshes, question }),
        }
    }
}

/// Heights above slabs are sums of more products than boxes need. Their roundings stay below 128 units `2^-24 S`,
/// while the margin of boxes is sixteen. This factor allows for twice that.
const SLACK: f32 = 16.0;

struct Overlaps<'a, L, Q, const TURNED: bool> {
    meshes: Meshes<'a>,
    reach: Reach,
    margin: L,
    slack: L,
    question: &'a mut Q,
}

impl<L: Lanes, Q: Question, const TURNED: bool> Tiles for Overlaps<'_, L, Q, TURNED> {
    type Lanes = L;

    #[inline(always)]
    fn boxes(&mut self, first: &Boxes, second: &Boxes) -> (u32, L) {
        self.question.tile();
        let a = Placed::<L>::first(first);
        let b = Placed::<L>::second::<TURNED>(second, &self.reach);
        let (x, y, z) = (between(&a, &b, 0), between(&a, &b, 1), between(&a, &b, 2));
        let sum = |axis: usize| a.half[axis].add(b.half[axis]);
        let larger = |axis: usize| a.half[axis].max(b.half[axis]);
        let separation = x.sub(sum(0)).max(y.sub(sum(1))).max(z.sub(sum(2)));
        let outside = x.sub(larger(0)).max(y.sub(larger(1))).max(z.sub(larger(2)));
        (separation.at_most(self.margin), outside)
    }

    #[inline(always)]
    fn slabs(&self, first: (&Boxes, &Slabs), second: (&Boxes, &Slabs), pairs: u32) -> u32 {
        let a = Placed::<L>::first(first.0);
        let b = Placed::<L>::second::<TURNED>(second.0, &self.reach);
        let s = PlacedSlabs::<L>::first(first.1);
        let t = PlacedSlabs::<L>::second::<TURNED>(second.1, &self.reach);
        let along = dot0(&s.normal, &t.normal);
        let one = slab_misses(&s, &t, along, &b, self.slack);
        pairs & !(one | slab_misses(&t, &s, along, &a, self.slack))
    }

    #[inline(always)]
    fn triangles(&mut self, first: u32, second: u32, pairs: u32) -> ControlFlow<()> {
        let reach = Some(&self.reach);
        self.question
            .triangles::<L>(self.meshes, (first, second), pairs, reach)
    }
}

/// The distance of the centres of boxes along an axis.
#[inline(always)]
fn between<L: Lanes>(a: &Placed<L>, b: &Placed<L>, axis: usize) -> L {
    a.centre[axis].sub(b.centre[axis]).abs()
}

/// A bit for each pair in which the contents of one slab and box are outside the other slab.
///
/// Let `n` be the normal of the one slab and `m` that of the other. A point `x` of the other has the height
/// `n·x = k m·x + (n - k m)·x` for any `k`. For `k = n·m` the second part is small if the normals are similar. The
/// other's slab bounds the first part, its box the second one.
#[inline(always)]
fn slab_misses<L: Lanes>(
    slab: &PlacedSlabs<L>,
    other: &PlacedSlabs<L>,
    k: L,
    boxes: &Placed<L>,
    slack: L,
) -> u32 {
    let (n, m) = (&slab.normal, &other.normal);
    let rest = [
        n[0].sub(k.mul(m[0])),
        n[1].sub(k.mul(m[1])),
        n[2].sub(k.mul(m[2])),
    ];
    let middle = dot(&rest, &boxes.centre, k.mul(other.middle).sub(slab.middle));
    let reach = k.abs().mul_add(other.half, slab.half.add(slack));
    middle.abs().above(dot(&abs(&rest), &boxes.half, reach))
}

/// Boxes in f64, for meshes too large for f32. Its speed does not matter.
struct Wide<'a, Q> {
    meshes: Meshes<'a>,
    question: &'a mut Q,
}

impl<Q: Question> Tiles for Wide<'_, Q> {
    type Lanes = Portable;

    fn boxes(&mut self, first: &Boxes, second: &Boxes) -> (u32, Portable) {
        self.question.tile();
        let at = self.meshes.at;
        let meet = |pair: &usize| {
            let (i, j) = (pair / WIDTH, pair % WIDTH);
            let used = first.half[0][i] >= 0.0 && second.half[0][j] >= 0.0;
            used && at.boxes_meet(&first.bounds(i), &second.bounds(j))
        };
        let bits = (0..TILE)
            .filter(meet)
            .fold(0, |bits, pair| bits | 1 << pair);
        (bits, Portable::splat(0.0))
    }

    fn slabs(&self, _: (&Boxes, &Slabs), _: (&Boxes, &Slabs), pairs: u32) -> u32 {
        pairs
    }

    fn triangles(&mut self, first: u32, second: u32, pairs: u32) -> ControlFlow<()> {
        self.question
            .triangles::<Portable>(self.meshes, (first, second), pairs, None)
    }
}
