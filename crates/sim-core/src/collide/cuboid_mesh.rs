//! Whether the surfaces of a box along the axes and of a mesh meet.
//!
//! The inside of the box is known, so one descent of the mesh's tree is enough. A subtree strictly inside or strictly
//! outside needs no more tests. A triangle with one corner strictly inside and another one not strictly inside meets
//! the surface, whatever its plane; so does a connected part of the mesh with such corners. Only triangles whose
//! corners are all outside are tested against the triangles of the box.

use glam::{DVec3, Vec3A, Vec4};

use super::{Work, pairs::LARGEST, predicates::triangles_meet};
use crate::{
    Aabb,
    bvh::{Boxes, Bvh, Cuboid, LEAF, MAX_DEPTH, WIDTH},
};

/// A box, and a mesh to test against it.
pub(super) struct Pair<'a> {
    /// Low and high corner, m.
    ends: [DVec3; 2],
    mesh: &'a Bvh,
    /// The displacement of the mesh, m.
    offset: DVec3,
    seen: Seen,
}

impl<'a> Pair<'a> {
    /// A box by its low and high corner, and a mesh displaced by `offset`, m; `None` beyond the range of f32.
    #[inline]
    pub(super) fn of(ends: [DVec3; 2], mesh: &'a Bvh, offset: DVec3) -> Option<Pair<'a>> {
        Some(Pair {
            ends,
            mesh,
            offset,
            seen: Seen::of(ends, mesh, offset)?,
        })
    }

    /// The answer, and its cost.
    pub(super) fn meet(&self) -> Work {
        let mut work = Work {
            meet: false,
            boxes: 0,
            tests: 0,
        };
        let is_across = self.is_across();
        // The path of nodes from the root, one for each level, with a bit for each child still to visit.
        let mut waiting = [(0, 0); MAX_DEPTH];
        let mut count = 0;
        let mut code = self.mesh.root();
        loop {
            let node = self.mesh.node(code);
            let Cut {
                bits: mut cut,
                depth,
                is_any_inside,
            } = self.seen.cut(&node.boxes);
            work.boxes += WIDTH as u64;
            if is_across && is_any_inside {
                work.meet = true;
                return work;
            }
            if code & LEAF != 0 {
                let triangles = self.mesh.triangles(node);
                while cut != 0 {
                    let lane = cut.trailing_zeros() as usize;
                    cut &= cut - 1;
                    work.tests += 1;
                    let corners = triangles.corners(lane).map(|v| v.as_dvec3() + self.offset);
                    if self.meets(corners) {
                        work.meet = true;
                        return work;
                    }
                }
            } else if cut != 0 {
                // First the child into which the surface cuts most deeply.
                let next = deepest(depth);
                cut &= !(1 << next);
                waiting[count] = (code, cut);
                count += usize::from(cut != 0);
                code = node.child[next];
                continue;
            }
            let Some(last) = count.checked_sub(1) else {
                return work;
            };
            let (parent, lanes) = &mut waiting[last];
            code = self.mesh.node(*parent).child[lanes.trailing_zeros() as usize % WIDTH];
            *lanes &= *lanes - 1;
            count -= usize::from(*lanes == 0);
        }
    }

    /// Whether the mesh is connected, and not all of it is strictly inside.
    #[inline]
    fn is_across(&self) -> bool {
        let Aabb { min, max } = self.mesh.bounds();
        let [low, high] = self.ends;
        let (min, max) = (min.as_dvec3() + self.offset, max.as_dvec3() + self.offset);
        self.mesh.topology().connected && (min.cmple(low) | max.cmpge(high)).any()
    }

    /// Whether a triangle of the mesh meets the surface of the box.
    #[inline]
    fn meets(&self, corners: [DVec3; 3]) -> bool {
        let [low, high] = self.ends;
        let inside = corners.map(|c| (c.cmpgt(low) & c.cmplt(high)).all());
        match inside {
            [true, true, true] => false,
            [false, false, false] => self.meets_from_outside(corners),
            _ => true,
        }
    }

    /// The same for a triangle without a corner strictly inside.
    #[inline(never)]
    fn meets_from_outside(&self, corners: [DVec3; 3]) -> bool {
        let [low, high] = self.ends;
        if corners.iter().any(|c| (c.cmpge(low) & c.cmple(high)).all()) {
            return true;
        }
        let [p, q, r] = corners;
        let (min, max) = (p.min(q).min(r), p.max(q).max(r));
        let may_meet = (min.cmple(high) & max.cmpge(low)).all() && !self.is_beside_plane(corners);
        may_meet
            && (0..3).any(|axis| {
                let ends = [0, 1].into_iter().filter(|&end| {
                    let level = self.ends[end][axis];
                    min[axis] <= level && level <= max[axis]
                });
                ends.into_iter()
                    .any(|end| self.face_meets(axis, end, corners))
            })
    }

    /// Whether the whole box is on one side of a triangle's plane; a "yes" is a proof.
    ///
    /// Each of the products and sums below has a relative rounding of a few `2^-53`. The normal errs by less than 8
    /// of `e²` in each component, with the longest side `e` in the maximum norm; heights along it err by less than 16
    /// of `e²` times the sum of the distances.
    fn is_beside_plane(&self, [p, q, r]: [DVec3; 3]) -> bool {
        let [low, high] = self.ends;
        let (one, other) = (q - p, r - p);
        let normal = one.cross(other);
        let (to_low, to_high) = (low - p, high - p);
        // The heights of the lowest and the highest corner of the box above the plane.
        let (a, b) = (normal * to_low, normal * to_high);
        let lowest = a.min(b).element_sum();
        let highest = a.max(b).element_sum();
        let distances = to_low.abs().max(to_high.abs()).element_sum();
        let size = one.abs().max_element() * other.abs().max_element();
        let slack = 32.0 * f64::EPSILON * size * distances;
        lowest > slack || highest < -slack
    }

    /// Whether a triangle meets a side of the box.
    fn face_meets(&self, axis: usize, end: usize, corners: [DVec3; 3]) -> bool {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let at = |corner: usize| Cuboid::corner(&self.ends, end << axis | corner);
        let diagonal = [at(0), at(u | v)];
        [u, v].into_iter().any(|side| {
            let [from, to] = diagonal;
            triangles_meet([from, to, at(side)], corners)
        })
    }
}

/// The cut of the surface of the box through the boxes of a node.
struct Cut {
    /// A bit for each box that the surface may cut.
    bits: u32,
    /// The depth of each cut.
    depth: Vec4,
    /// Whether one of the boxes is strictly inside.
    is_any_inside: bool,
}

/// The lane of the greatest number, up to rounding. If the surface does not cut the box of this lane, the only cost
/// is one more test.
#[inline]
fn deepest(depth: Vec4) -> usize {
    // The lowest bits hold the lane; with those of minus infinity the result would be NaN.
    let depth = depth.max(Vec4::splat(f32::MIN)).to_array();
    let [x, y, z, w] = depth.map(|x| x.to_bits() & !3);
    let key = Vec4::from_array([x, y | 1, z | 2, w | 3].map(f32::from_bits));
    (key.max_element().to_bits() & 3) as usize
}

/// The box in the frame of the mesh's tree, in f32.
struct Seen {
    centre: [Vec4; 3],
    half: [Vec4; 3],
    /// A bound on all roundings of a comparison, m.
    margin: f32,
}

impl Seen {
    /// `None` beyond the range of f32.
    ///
    /// Let `S` be the sum of the magnitudes of the mesh, of its displacement and of the box, and `u = 2^-24`. A
    /// comparison `|c - c'| <= h + h'` has roundings of centre and half extent, of the difference, and of both sums,
    /// together below `7 u S`; placed vertices are rounded in f64.
    #[inline]
    fn of(ends: [DVec3; 2], mesh: &Bvh, offset: DVec3) -> Option<Seen> {
        let [low, high] = ends.map(|end| end - offset);
        let centre = (0.5 * (low + high)).as_vec3a();
        let half = (0.5 * (high - low)).as_vec3a();
        let Aabb { min, max } = mesh.bounds();
        let mesh = Vec3A::from(min).abs().max(Vec3A::from(max).abs());
        let size = mesh + offset.as_vec3a().abs() + centre.abs() + half;
        let is_in_reach = size.cmplt(Vec3A::splat(LARGEST as f32)).all();
        let of_axes = |of: Vec3A| of.to_array().map(Vec4::splat);
        is_in_reach.then(|| Seen {
            centre: of_axes(centre),
            half: of_axes(half),
            margin: 8.0 * f32::EPSILON * size.max_element() + 16.0 * f32::MIN_POSITIVE,
        })
    }

    #[inline]
    fn cut(&self, boxes: &Boxes) -> Cut {
        let (mut within, mut without) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
        for axis in 0..3 {
            let away = (Vec4::from_array(boxes.centre[axis]) - self.centre[axis]).abs();
            let outside = away - self.half[axis];
            let half = Vec4::from_array(boxes.half[axis]);
            within = within.min(half - outside);
            without = without.max(half + outside);
        }
        // Minus infinity in empty lanes.
        let depth = within.min(without);
        let margin = Vec4::splat(-self.margin);
        let inside = without.cmplt(margin) & within.cmpgt(Vec4::ZERO);
        Cut {
            bits: depth.cmpge(margin).bitmask(),
            depth,
            is_any_inside: inside.any(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::{naive, pairs::Meshes, tree};
    use crate::{
        Mesh,
        test_meshes::{cube, sphere},
        test_random::Random,
    };
    use alloc::{vec, vec::Vec};
    use glam::{DQuat, Vec3};

    fn cuboid(size: DVec3) -> Mesh {
        cube().transformed(DQuat::IDENTITY, size).unwrap()
    }

    /// Random triangles on a lattice, some without area; they may be connected.
    fn soup(random: &mut Random, scale: f64) -> Mesh {
        let count = 1 + random.up_to(30).unsigned_abs() as u32;
        let apart = random.up_to(1).unsigned_abs() as u32;
        let corner = |_| (scale * random.vector(6)).as_vec3();
        let corners: Vec<Vec3> = (0..(2 + apart) * count + 1 - apart).map(corner).collect();
        let triangles = (0..count).map(|i| [0, 1, 2].map(|k| (2 + apart) * i + k));
        Mesh::new(corners, triangles.collect()).unwrap()
    }

    fn agree(one: &Mesh, other: &Mesh, offset: DVec3) -> Work {
        let (first, second) = (&Bvh::build(one), &Bvh::build(other));
        let at = &offset.into();
        let work = tree::with_cuboid(Meshes { first, second, at }).expect("a box and a mesh");
        assert_eq!(work.meet, naive::intersect(one, other, offset), "{offset}");
        work
    }

    #[test]
    fn a_box_meets_what_its_triangles_meet() {
        let mut random = Random(0x2545_f491_4f6c_dd1d);
        let (mut meet, mut apart) = (0, 0);
        for round in 0..20_000 {
            let scale = libm::ldexp(1.0, [0, -100, 60, -140][round % 4]);
            let cuboid = cuboid(scale * (random.vector(3).abs() + 1.0));
            let soup = soup(&mut random, 0.5 * scale);
            let noise = [0.0, 1e-15, 1e-7, 0.1][round / 4 % 4];
            let away =
                0.25 * random.vector(24) + noise * random.vector(1 << 20) / f64::from(1 << 20);
            let far = [0.0, 1e8][round / 16 % 2] * random.vector(1);
            let offset = scale * (away + far);
            let work = match round % 3 {
                0 => agree(&soup, &cuboid, offset),
                _ => agree(&cuboid, &soup, offset),
            };
            meet += u32::from(work.meet);
            apart += u32::from(!work.meet);
        }
        assert!(meet > 2_000 && apart > 2_000, "{meet} {apart}");
    }

    #[test]
    fn what_is_no_place_leaves_meshes_apart() {
        let (unit, ball) = (Bvh::build(&cube()), Bvh::build(&sphere(8)));
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e101, -1e101] {
            for offset in DVec3::AXES
                .map(|axis| DVec3::select(axis.cmpeq(DVec3::ONE), axis * value, DVec3::ZERO))
            {
                for (first, second) in [(&unit, &ball), (&ball, &unit), (&unit, &unit)] {
                    assert!(!tree::intersect(first, second, offset), "{offset}");
                    assert!(!tree::work(first, second, offset).meet, "{offset}");
                }
            }
        }
    }

    #[test]
    fn pieces_within_and_without_meet_where_one_joins_them() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.1);
        let small = |x: f32| [corner(x, 0.0), corner(x + 0.1, 0.0), corner(x, 0.1)];
        let vertices: Vec<Vec3> = [0.0, 2.0, -2.0].into_iter().flat_map(small).collect();
        let mut triangles = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        let apart = Mesh::new(vertices.clone(), triangles.clone()).unwrap();
        triangles.extend([[1, 3, 4], [0, 6, 7]]);
        let joined = Mesh::new(vertices, triangles).unwrap();
        for (one, other) in [(&cube(), &apart), (&apart, &cube())] {
            assert!(!agree(one, other, DVec3::ZERO).meet);
        }
        for (one, other) in [(&cube(), &joined), (&joined, &cube())] {
            assert!(agree(one, other, DVec3::ZERO).meet);
        }
    }

    #[test]
    fn around_a_surface_and_within_it() {
        let ball = sphere(24);
        let (around, within) = (cuboid(DVec3::splat(2.5)), cuboid(DVec3::splat(0.9)));
        assert!(!agree(&ball, &within, DVec3::ZERO).meet);
        assert!(agree(&around, &ball, DVec3::X * 0.3).meet);
        assert!(agree(&ball, &within, DVec3::X * 0.7).meet);
        // A mesh wholly inside the box is decided at the root.
        let work = agree(&around, &ball, DVec3::ZERO);
        assert_eq!(
            (work.meet, work.boxes, work.tests),
            (false, WIDTH as u64, 0)
        );
        // Near the place where they touch at a pole, which f32 does not resolve.
        for k in -40..=40 {
            let offset = DVec3::Y * (1.5 + 1e-8 * f64::from(k));
            assert_eq!(agree(&ball, &cube(), offset).meet, k <= 0, "{k}");
            assert_eq!(agree(&cube(), &ball, offset).meet, k <= 0, "{k}");
        }
    }
}
