//! The first contact of two boxes, one of which translates.
//!
//! Along each axis two boxes begin to overlap at one time and cease at another. They touch when the last axis begins
//! to overlap, if no other axis has ceased by then. This takes a few hundred instructions. For the search over their
//! triangles, face against face is the worst case, because most features touch at once. The answers are those of
//! [`super::sweep`] to the last bit, except if the times of two axes round to the same number: here the first of
//! these axes counts.

use core::cmp::Ordering::{self, Equal, Greater, Less};
use glam::DVec3;

use super::{
    sweep::opposing_cmp,
    touch::{Feature, Touch},
    triple::{Difference, floor_of_quotient, sign},
};
use crate::{
    bvh::Cuboid,
    expansion::{Expansion, two_sum},
};

/// The boxes alone do not decide; the triangles must.
#[derive(Debug)]
pub(super) struct Untold;

/// The first entering contact of two boxes ([`super::touch::first_touch`]); an error if they overlap at the start, or
/// no corner touches a face.
pub(super) fn first_touch(
    first: &Cuboid,
    second: &Cuboid,
    offset: DVec3,
    motion: DVec3,
) -> Result<Option<Touch>, Untold> {
    let pair = Pair {
        first: Placed {
            cuboid: first,
            ends: first.ends,
        },
        second: Placed {
            cuboid: second,
            ends: second.ends.map(|end| end + offset),
        },
        motion,
    };
    let [low, high] = pair.second.ends;
    // Far away, rounding may flatten a placed box to a sheet.
    if !low.cmplt(high).all() || (0..3).all(|axis| pair.overlaps(axis)) {
        return Err(Untold);
    }
    let entries = (0..3).filter_map(|axis| pair.entry(axis));
    let Some(entry) = entries.min_by(|a, b| opposing_cmp(a.normal(), b.normal(), motion)) else {
        return Ok(None);
    };
    let time = entry.time();
    let of_first = pair.first_of_first(&entry);
    let of_second = || pair.first_of_second(&entry);
    let (feature, at) = of_first.or_else(of_second).ok_or(Untold)?;
    let drift = match feature {
        Feature::FaceVertex { .. } => motion,
        _ => DVec3::ZERO,
    };
    Ok(Some(Touch {
        time,
        point: at + time * drift,
        normal: entry.normal(),
        feature,
    }))
}

/// Whether the surfaces of two boxes share a point; the second one is displaced by `offset`, m.
pub(super) fn meet(first: &Cuboid, second: &Cuboid, offset: DVec3) -> bool {
    let [low, high] = first.ends;
    let [others_low, others_high] = second.ends.map(|end| end + offset);
    let is_inside = |[low, high]: [DVec3; 2], [others_low, others_high]: [DVec3; 2]| {
        others_low.cmplt(low).all() && high.cmplt(others_high).all()
    };
    low.cmple(others_high).all()
        && others_low.cmple(high).all()
        && !is_inside([low, high], [others_low, others_high])
        && !is_inside([others_low, others_high], [low, high])
}

/// A box, and the positions of its low and its high corner.
struct Placed<'a> {
    cuboid: &'a Cuboid,
    ends: [DVec3; 2],
}

struct Pair<'a> {
    first: Placed<'a>,
    second: Placed<'a>,
    /// The motion of the second box.
    motion: DVec3,
}

/// The beginning of the overlap of two boxes along an axis.
struct Entry {
    axis: usize,
    /// The distance until then, m, rounded, and its rounding error.
    gap: (f64, f64),
    /// Motion along the axis, m.
    motion: f64,
    /// The ends that touch, of the first box and of the second; 0 for the low one.
    ends: (usize, usize),
}

impl Entry {
    /// The time, rounded down.
    fn time(&self) -> f64 {
        let mut terms = Expansion::<2>::ZERO;
        terms.add(self.gap.1);
        terms.add(self.gap.0);
        floor_of_quotient(terms.terms(), &[self.motion.abs()])
    }

    fn normal(&self) -> DVec3 {
        -self.motion.signum() * DVec3::AXES[self.axis]
    }
}

impl Pair<'_> {
    /// Whether the interiors overlap along an axis at the start.
    fn overlaps(&self, axis: usize) -> bool {
        let ends = |placed: &Placed<'_>| placed.ends.map(|end| end[axis]);
        let ([low, high], [others_low, others_high]) = (ends(&self.first), ends(&self.second));
        low < others_high && others_low < high
    }

    /// The contact of the boxes along an axis within the motion, if they enter each other there.
    fn entry(&self, axis: usize) -> Option<Entry> {
        let motion = self.motion[axis];
        let [first, second] = [&self.first, &self.second].map(|placed| placed.ends);
        let (ends, gap) = match motion > 0.0 {
            true => ((0, 1), two_sum(first[0][axis], -second[1][axis])),
            false => ((1, 0), two_sum(second[0][axis], -first[1][axis])),
        };
        let way = motion.abs();
        if way == 0.0 || gap.0 < 0.0 || gap.0 > way || (gap.0 == way && gap.1 > 0.0) {
            return None;
        }
        let entry = Entry {
            axis,
            gap,
            motion,
            ends,
        };
        let enters = (0..3).filter(|&along| along != axis).all(|along| {
            let motion = self.motion[along];
            let below = self.height(&entry, along, 0, 1);
            let above = self.height(&entry, along, 1, 0);
            (below == Less || below == Equal && motion > 0.0)
                && (above == Greater || above == Equal && motion < 0.0)
        });
        enters.then_some(entry)
    }

    /// Compares an end of the first box with an end of the second one along an axis, when the boxes touch.
    fn height(&self, entry: &Entry, along: usize, end: usize, others_end: usize) -> Ordering {
        let end = self.first.ends[end][along];
        let apart = two_sum(end, -self.second.ends[others_end][along]);
        // The time is the gap over the motion.
        compare((apart, entry.motion.abs()), (entry.gap, self.motion[along]))
    }

    /// Of the first box's corners that come into the other's face, the first one, as a feature and with its position
    /// at the start.
    fn first_of_first(&self, entry: &Entry) -> Option<(Feature, DVec3)> {
        let (own, other) = (&self.first, &self.second);
        let corners = corners_within(entry.axis, entry.ends.0, |along, end| {
            self.height(entry, along, end, 0) != Less
                && self.height(entry, along, end, 1) != Greater
        });
        let corner = corners.min_by_key(|&corner| own.cuboid.vertices[corner])?;
        let at = Cuboid::corner(&own.ends, corner);
        let vertex = own.cuboid.vertices[corner];
        let face = other.triangle_met(entry.axis, entry.ends.1, at, self.motion);
        Some((Feature::VertexFace { vertex, face }, at))
    }

    /// The same for the second box's corners.
    fn first_of_second(&self, entry: &Entry) -> Option<(Feature, DVec3)> {
        let (own, other) = (&self.second, &self.first);
        let corners = corners_within(entry.axis, entry.ends.1, |along, end| {
            self.height(entry, along, 0, end) != Greater
                && self.height(entry, along, 1, end) != Less
        });
        let features = corners.map(|corner| {
            let at = Cuboid::corner(&own.ends, corner);
            let vertex = own.cuboid.vertices[corner];
            let face = other.triangle_met(entry.axis, entry.ends.0, at, self.motion);
            (Feature::FaceVertex { face, vertex }, at)
        });
        features.min_by_key(|&(feature, _)| feature)
    }
}

/// The corners at one end of an axis whose ends along the other axes are within a range.
fn corners_within(
    axis: usize,
    end: usize,
    is_within: impl Fn(usize, usize) -> bool,
) -> impl Iterator<Item = usize> {
    let ends = [0, 1, 2].map(|along| {
        [0, 1].map(|of| match along == axis {
            true => of == end,
            false => is_within(along, of),
        })
    });
    (0..8).filter(move |&corner| (0..3).all(|along| ends[along][corner >> along & 1]))
}

impl Placed<'_> {
    /// The triangle of a face that a point reaches as it moves into the face; on the diagonal, the triangle of lower
    /// index.
    fn triangle_met(&self, axis: usize, end: usize, point: DVec3, motion: DVec3) -> u32 {
        let face = &self.cuboid.faces[axis][end];
        let at = |corner: usize| Cuboid::corner(&self.ends, corner);
        // The ends of the diagonal are the corners adjacent to that of the first triangle.
        let from = at(face.corner ^ 1 << ((axis + 1) % 3));
        let diagonal = Difference(at(face.corner ^ 1 << ((axis + 2) % 3)), from);
        let side = |x: DVec3| sign([diagonal, motion.into(), Difference(from, x)]);
        match side(point) {
            Equal => face.triangles[0].min(face.triangles[1]),
            side_of_it if side_of_it == side(at(face.corner)) => face.triangles[0],
            _ => face.triangles[1],
        }
    }
}

/// Compares `p s` with `q r`, exactly; `p` and `q` are sums of two numbers.
fn compare((p, s): ((f64, f64), f64), (q, r): ((f64, f64), f64)) -> Ordering {
    let (one, other) = (p.0 * s, q.0 * r);
    // Two roundings of each product, and one of the difference.
    let slack = 4.0 * f64::EPSILON * (one.abs() + other.abs());
    let difference = one - other;
    if difference.abs() > slack {
        return if difference > 0.0 { Greater } else { Less };
    }
    let mut sum = Expansion::<8>::ZERO;
    for (x, y) in [(p.0, s), (p.1, s), (-q.0, r), (-q.1, r)] {
        sum.add_product(x, y);
    }
    sum.sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mesh;
    use crate::bvh::Bvh;
    use crate::collide::{
        naive,
        sweep::{Kind, Search},
    };
    use crate::{test_meshes::cube, test_random::Random};
    use alloc::format;
    use glam::DQuat;

    /// A box with some diagonals exchanged and its triangles in some order.
    fn cuboid(random: &mut Random, size: DVec3) -> Mesh {
        let unit = cube().transformed(DQuat::IDENTITY, size).unwrap();
        let mut triangles = unit.triangles().to_vec();
        for pair in triangles.chunks_exact_mut(2) {
            if random.up_to(1) > 0 {
                let ([a, b, c], d) = (pair[0], pair[1][2]);
                (pair[0], pair[1]) = ([a, b, d], [b, c, d]);
            }
        }
        for i in 0..triangles.len() {
            let j = random.up_to(11).unsigned_abs() as usize;
            triangles.swap(i, j);
        }
        Mesh::new(unit.vertices().to_vec(), triangles).unwrap()
    }

    #[test]
    fn boxes_touch_as_their_triangles_do() {
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let (mut touches, mut misses, mut untold, mut others) = (0, 0, 0, 0);
        for round in 0..60_000 {
            let sizes = [(); 2].map(|()| random.vector(2).abs() + 1.0);
            // As large as f32 allows, and as small as the products allow.
            let scale = libm::ldexp(1.0, [0, -100, 120][round % 7 % 3]);
            let meshes = sizes.map(|size| cuboid(&mut random, scale * size));
            let [first, second] = meshes.each_ref().map(Bvh::build);
            let offset = 0.5 * random.vector(8);
            let aim = if round % 2 == 0 { -1.5 } else { 0.0 };
            let motion = aim * offset + 0.5 * random.vector(8);
            // A lattice with many ties; near it; and random places.
            let noise = match round % 3 {
                0 => 0.0,
                1 => 1e-15,
                _ => 0.1,
            };
            let offset = offset + noise * random.vector(1 << 20) / f64::from(1 << 20);
            let motion = motion + noise * random.vector(1 << 20) / f64::from(1 << 20);
            let (offset, motion) = (scale * offset, scale * motion);
            let (a, b) = (first.cuboid().unwrap(), second.cuboid().unwrap());
            let [one, other] = &meshes;
            assert_eq!(meet(a, b, offset), naive::intersect(one, other, offset));
            let expected = Search::run(Kind::Entering, (&first, &second), offset, motion).best();
            match first_touch(a, b, offset, motion) {
                Err(Untold) => untold += 1,
                Ok(found) => {
                    let what = || format!("{found:?} {expected:?} {sizes:?} {offset} {motion}");
                    let time = |touch: Option<Touch>| touch.map(|touch| touch.time);
                    assert_eq!(time(found), time(expected), "{}", what());
                    let is_same = found == expected;
                    assert!(is_same || noise == 1e-15, "{}", what());
                    others += u32::from(!is_same);
                    touches += u32::from(found.is_some());
                    misses += u32::from(found.is_none());
                }
            }
        }
        assert!(touches > 20_000 && misses > 20_000 && untold < 10_000 && others < 100);
    }
}
