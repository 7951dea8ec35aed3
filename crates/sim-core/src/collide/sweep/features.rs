//! Contacts of the vertices, edges and faces of two triangles.

use core::cmp::Ordering;
use glam::{DVec3, Vec3};

use super::{
    Kind, Search,
    candidate::{Candidate, Spot},
};
use crate::bvh::{Bvh, Node};
use crate::collide::{
    moving::{line_passes, point_slides_into_triangle},
    plane::{Cross, Estimate},
    touch::Feature,
    triple::{Difference, Time, sign},
};
use crate::mesh::Topology;

/// The projection of the meshes along the motion onto a plane of two axes, with quick tests in f64.
///
/// A bound on the rounding: let `S` be above all coordinates and `u = 2^-53`. Ratios of the motion are at most one. A
/// projected point errs by `4 u S` and is at most `2 S` from the origin. Differences of projected points err by
/// `12 u S`, and a cross product of these by `2 (2 · 4 S · 12 u S + 16 S² u) + 32 S² u = 256 u S²`. The bound has room
/// for products of errors.
pub(super) struct View {
    /// The two axes of the projection, and the axis with the largest component of the motion.
    axes: [usize; 3],
    /// The other components of the motion, divided by the largest one.
    slope: [f64; 2],
    motion: DVec3,
    /// A bound on the errors of sides.
    side_error: f64,
}

impl View {
    pub(super) fn new(first: &Bvh, second: &Bvh, offset: DVec3, motion: DVec3) -> View {
        let size = |bvh: &Bvh| {
            let bounds = bvh.bounds();
            bounds.min.abs().max(bounds.max.abs()).as_dvec3()
        };
        let farthest = size(first).max(size(second) + offset.abs()).max_element();
        let most = motion.abs().max_element();
        let of = motion.to_array();
        let k = (0..3).find(|&k| of[k].abs() == most).unwrap_or(2);
        // A left turn stays a left turn for either sign of the motion.
        let (i, j) = match of[k] > 0.0 {
            true => ((k + 1) % 3, (k + 2) % 3),
            false => ((k + 2) % 3, (k + 1) % 3),
        };
        View {
            axes: [i, j, k],
            slope: [of[i] / of[k], of[j] / of[k]],
            motion,
            side_error: 150.0 * f64::EPSILON * (farthest * farthest),
        }
    }

    #[inline(always)]
    fn seen(&self, p: DVec3) -> [f64; 2] {
        let (p, [i, j, k]) = (p.to_array(), self.axes);
        [p[i] - p[k] * self.slope[0], p[j] - p[k] * self.slope[1]]
    }

    #[inline(always)]
    fn triangle(&self, corners: [DVec3; 3]) -> Triangle {
        let [a, b, c] = corners;
        Triangle {
            corners,
            seen: [self.seen(a), self.seen(b), self.seen(c)],
        }
    }

    /// The sign of a number with the error of a side; 0 in doubt.
    #[inline(always)]
    fn tell(&self, side: f64) -> i8 {
        i8::from(side > self.side_error) - i8::from(side < -self.side_error)
    }

    /// The sides of one triangle's edges on which the corners of another triangle are: `[i][j]` is the sign of
    /// `det(edge i, motion, its start - corner j)`, 0 in doubt. `None` if an edge separates the two triangles.
    #[inline(always)]
    fn sides(&self, of: &Triangle, others: &Triangle) -> Option<[[i8; 3]; 3]> {
        let [a, b, c] = of.seen;
        let inside = self.tell(left(a, b, c));
        let side = |from: [f64; 2], to: [f64; 2]| {
            let [p, q, r] = others.seen;
            [
                self.tell(left(from, to, p)),
                self.tell(left(from, to, q)),
                self.tell(left(from, to, r)),
            ]
        };
        let outside = [-inside; 3];
        let mut sides = [[0; 3]; 3];
        for (side_of, (from, to)) in sides.iter_mut().zip([(a, b), (b, c), (c, a)]) {
            *side_of = side(from, to);
            if inside != 0 && *side_of == outside {
                return None;
            }
        }
        Some(sides)
    }

    /// The heights of corners above a triangle's plane, and the rate of these heights by the motion (to be multiplied
    /// by `way`). `None` if the corners stay on one side of the plane until a time.
    #[inline(always)]
    fn heights(
        &self,
        [a, b, c]: [DVec3; 3],
        others: [DVec3; 3],
        way: f64,
        until: f64,
    ) -> Option<Heights> {
        let normal = Cross::of(b - a, c - a);
        let [h, i, j] = others.map(|other| normal.dot(other - a));
        let fall = normal.dot(self.motion);
        let highest = h.value.max(i.value).max(j.value);
        let lowest = h.value.min(i.value).min(j.value);
        let error = 2.0 * h.error.max(i.error).max(j.error);
        let (toward, of_fall) = (way * fall.value, 2.0 * fall.error);
        if stays(lowest - error, toward - of_fall, until)
            || stays(-highest - error, -toward - of_fall, until)
        {
            return None;
        }
        Some(Heights {
            heights: [h, i, j],
            fall,
        })
    }

    /// Whether a box, given by its centre and half extents, stays on one side of a triangle's plane until a time.
    /// `way` is 1 if the box moves, -1 if the triangle does.
    #[inline(always)]
    pub(super) fn parts(
        &self,
        [a, b, c]: [DVec3; 3],
        (centre, half): (DVec3, DVec3),
        way: f64,
        until: f64,
    ) -> bool {
        let normal = Cross::of(b - a, c - a);
        let (height, fall) = (normal.dot(centre - a), normal.dot(self.motion));
        // The placed centre and the placed vertices in the box are rounded.
        let half = half + 2.0 * f64::EPSILON * (centre.abs() + half);
        let reach = normal.most(half) + 2.0 * height.error;
        let stay = |side: f64| {
            let fall = side * way * fall.value - 2.0 * fall.error;
            stays(side * height.value - reach, fall, until)
        };
        stay(1.0) || stay(-1.0)
    }
}

/// Whether a point at least `lowest` above a plane, whose height changes at the rate `fall`, stays above it until a
/// time. Both arguments are below the true ones by twice their errors, for the roundings in this function.
#[inline(always)]
fn stays(lowest: f64, fall: f64, until: f64) -> bool {
    lowest > 0.0 && lowest + until * fall > 0.0
}

/// Twice the area of a triangle; positive if it turns left.
#[inline(always)]
fn left(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// A triangle, and the projection of its corners along the motion.
struct Triangle {
    corners: [DVec3; 3],
    seen: [[f64; 2]; 3],
}

/// The heights of three corners above a plane, and the rate at which the motion changes them.
struct Heights {
    heights: [Estimate; 3],
    fall: Estimate,
}

/// The features of a triangle in its mesh.
struct Names {
    face: u32,
    vertices: [u32; 3],
    edges: [u32; 3],
    /// The vertices and edges that are tested with this triangle and no other.
    owns_vertex: [bool; 3],
    owns_edge: [bool; 3],
}

impl Names {
    #[inline(always)]
    fn of(face: u32, topology: &Topology) -> Names {
        let i = face as usize;
        Names {
            face,
            vertices: topology.triangles[i],
            edges: topology.triangle_edges[i],
            owns_vertex: topology.owned[i].vertex,
            owns_edge: topology.owned[i].edge,
        }
    }

    fn edge(&self, i: usize) -> [u32; 2] {
        [self.vertices[i], self.vertices[(i + 1) % 3]]
    }
}

/// A vertex that may touch a triangle.
struct Corner {
    point: DVec3,
    /// The index of the vertex, and the features of the contact.
    vertex: u32,
    feature: Feature,
    /// Its sides of the triangle's edges, as in [`View::sides`].
    sides: [i8; 3],
    /// 1 if the vertex moves, -1 if the triangle does.
    way: f64,
}

impl Search<'_> {
    /// Tests a triangle of a leaf of each mesh.
    #[inline(never)]
    pub(super) fn try_triangles(&mut self, (leaf, i): (&Node, usize), (other, j): (&Node, usize)) {
        let wide = |[a, b, c]: [Vec3; 3]| [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
        let (s, t) = (self.first.triangles(leaf), self.second.triangles(other));
        let corners = wide(s.corners(i));
        let [a, b, c] = wide(t.corners(j));
        let placed = [a + self.offset, b + self.offset, c + self.offset];
        let Some(above_first) = self.view.heights(corners, placed, 1.0, self.horizon) else {
            return;
        };
        let Some(above_second) = self.view.heights(placed, corners, -1.0, self.horizon) else {
            return;
        };
        // Most pairs have been proven apart before this point.
        let (first, second) = (self.view.triangle(corners), self.view.triangle(placed));
        let Some(of_first) = self.view.sides(&first, &second) else {
            return;
        };
        let Some(of_second) = self.view.sides(&second, &first) else {
            return;
        };
        let s = Names::of(s.face[i], self.first.topology());
        let t = Names::of(t.face[j], self.second.topology());
        self.try_vertices((&first, &s), (&second, &t), &above_first, &of_first, 1.0);
        self.try_vertices((&second, &t), (&first, &s), &above_second, &of_second, -1.0);
        self.try_edges((&first, &s, &of_first), (&second, &t, &of_second));
    }

    /// Tests the corners of one triangle against another one. `way` is 1 if the corners move, else -1.
    #[inline(always)]
    fn try_vertices(
        &mut self,
        (face, face_names): (&Triangle, &Names),
        (corners, names): (&Triangle, &Names),
        above: &Heights,
        sides: &[[i8; 3]; 3],
        way: f64,
    ) {
        for k in (0..3).filter(|&k| names.owns_vertex[k]) {
            let sides = [sides[0][k], sides[1][k], sides[2][k]];
            if sides.contains(&1) && sides.contains(&-1) {
                continue;
            }
            let height = above.heights[k];
            let gap = Estimate {
                value: -way * height.value,
                ..height
            };
            if !self.may_be_first(gap, above.fall) {
                continue;
            }
            let (vertex, of) = (names.vertices[k], face_names.face);
            let feature = if way > 0.0 {
                Feature::FaceVertex { face: of, vertex }
            } else {
                Feature::VertexFace { vertex, face: of }
            };
            let corner = Corner {
                point: corners.corners[k],
                vertex,
                feature,
                sides,
                way,
            };
            self.vertex_face(&corner, face, face_names);
        }
    }

    #[inline(never)]
    fn vertex_face(&mut self, corner: &Corner, face: &Triangle, names: &Names) {
        let [a, b, c] = face.corners;
        let (x, way) = (corner.point, corner.way);
        let gap = if way > 0.0 {
            Difference(a, x)
        } else {
            Difference(x, a)
        };
        let time = Time::new(Difference(b, a), Difference(c, a), gap, self.motion);
        let course = time.course();
        if course == Ordering::Equal {
            if self.kind == Kind::Any {
                let motion = way * self.motion;
                self.slide(point_slides_into_triangle(x, motion, face.corners));
            }
            return;
        }
        let motion = Difference::from(self.motion);
        let side = |i: usize| {
            let (from, to) = (face.corners[i], face.corners[(i + 1) % 3]);
            known(corner.sides[i], || {
                [Difference(to, from), motion, Difference(from, x)]
            })
        };
        let sides = [side(0), side(1), side(2)];
        if !line_passes(sides) || !time.is_within(course) {
            return;
        }
        let on = |i: usize| sides[i] == Ordering::Equal;
        let spot = match [on(0), on(1), on(2)] {
            [false, false, false] => Spot::Face,
            [true, false, false] => Spot::Edge(names.edge(0), [a, b]),
            [false, true, false] => Spot::Edge(names.edge(1), [b, c]),
            [false, false, true] => Spot::Edge(names.edge(2), [c, a]),
            [_, true, true] => Spot::Vertex(names.vertices[2], c),
            [true, false, true] => Spot::Vertex(names.vertices[0], a),
            [true, true, false] => Spot::Vertex(names.vertices[1], b),
        };
        let vertex = Spot::Vertex(corner.vertex, x);
        let (spots, drift) = if way > 0.0 {
            ([spot, vertex], self.motion)
        } else {
            ([vertex, spot], DVec3::ZERO)
        };
        let at = (x, drift);
        self.add(Candidate::new((time, course), corner.feature, at, spots));
    }

    #[inline(always)]
    fn try_edges(
        &mut self,
        (first, s, of_first): (&Triangle, &Names, &[[i8; 3]; 3]),
        (second, t, of_second): (&Triangle, &Names, &[[i8; 3]; 3]),
    ) {
        for i in (0..3).filter(|&i| s.owns_edge[i]) {
            let i_end = (i + 1) % 3;
            for j in (0..3).filter(|&j| t.owns_edge[j]) {
                let j_end = (j + 1) % 3;
                // The sides of the second edge's ends relative to the first edge, and the other way round.
                let of_first = [of_first[i][j], of_first[i][j_end]];
                let of_second = [of_second[j][i], of_second[j][i_end]];
                let is_apart = |sides: [i8; 2]| sides[0] * sides[1] > 0;
                if is_apart(of_first) || is_apart(of_second) {
                    continue;
                }
                let (a, b) = (first.corners[i], first.corners[i_end]);
                let (c, d) = (second.corners[j], second.corners[j_end]);
                let cross = Cross::of(b - a, d - c);
                let fall = cross.dot(self.motion);
                if !self.may_be_first(cross.dot(a - c), fall) {
                    continue;
                }
                let feature = Feature::EdgeEdge {
                    first: s.edges[i],
                    second: t.edges[j],
                };
                let sides = [of_second[0], -of_second[1], -of_first[0], of_first[1]];
                let ends = (s.edge(i), t.edge(j));
                self.edge_edge(feature, [a, b, c, d], sides, ends);
            }
        }
    }

    /// Tests an edge `ab` against an edge `cd`, with the signs of [`edge_sides`] as far as they are known.
    ///
    /// [`edge_sides`]: crate::collide::moving::edge_sides
    #[inline(never)]
    fn edge_edge(
        &mut self,
        feature: Feature,
        [a, b, c, d]: [DVec3; 4],
        sides: [i8; 4],
        (first, second): ([u32; 2], [u32; 2]),
    ) {
        let (u, w) = (Difference(b, a), Difference(d, c));
        let time = Time::new(u, w, Difference(a, c), self.motion);
        let course = time.course();
        if course == Ordering::Equal {
            return;
        }
        let motion = Difference::from(self.motion);
        let side = |i: usize, along: Difference, apart: Difference| {
            known(sides[i], || [along, apart, motion])
        };
        let away = course.reverse();
        let sides = [
            side(0, w, Difference(a, c)),
            side(1, w, Difference(c, b)),
            side(2, u, Difference(a, c)),
            side(3, u, Difference(d, a)),
        ];
        if sides.contains(&away) || !time.is_within(course) {
            return;
        }
        let spot = |[from, to]: [(u32, DVec3); 2], at_from: Ordering, at_to: Ordering| {
            if at_to == Ordering::Equal {
                Spot::Vertex(to.0, to.1)
            } else if at_from == Ordering::Equal {
                Spot::Vertex(from.0, from.1)
            } else {
                Spot::Edge([from.0, to.0], [from.1, to.1])
            }
        };
        let spots = [
            spot([(first[0], a), (first[1], b)], sides[0], sides[1]),
            spot([(second[0], c), (second[1], d)], sides[2], sides[3]),
        ];
        let along = Cross::of(d - c, self.motion);
        let part = -along.dot(a - c).value / Cross::of(b - a, d - c).dot(self.motion).value;
        let part = if part > 0.0 { part.min(1.0) } else { 0.0 };
        let at = (a + part * (b - a), DVec3::ZERO);
        self.add(Candidate::new((time, course), feature, at, spots));
    }

    /// Whether `gap / fall` may be a time from 0 to the horizon.
    #[inline(always)]
    fn may_be_first(&self, gap: Estimate, fall: Estimate) -> bool {
        if fall.error == 0.0 {
            return self.kind == Kind::Any && gap.value.abs() <= gap.error;
        }
        if fall.value.abs() <= fall.error {
            return true;
        }
        let ahead = if fall.value < 0.0 {
            -gap.value
        } else {
            gap.value
        };
        // Covers the roundings of both sides.
        const UP: f64 = 1.0 + 4.0 * f64::EPSILON;
        let farthest = self.horizon * (fall.value.abs() + fall.error) * UP;
        ahead + gap.error >= 0.0 && ahead - gap.error <= farthest
    }
}

/// A sign, computed exactly if it is not known yet.
#[inline(always)]
fn known(side: i8, rows: impl FnOnce() -> [Difference; 3]) -> Ordering {
    match side {
        1 => Ordering::Greater,
        -1 => Ordering::Less,
        _ => sign(rows()),
    }
}
