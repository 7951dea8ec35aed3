//! The search for the first contact of two trees, one of which moves.

use core::cmp::Ordering;
use core::ops::ControlFlow;
use glam::{DVec3, Vec3};

use super::{
    moving::{edge_sides, line_passes, line_sides, point_slides_into_triangle},
    pairs::{Lanes, Portable, Reach, TILE, Tiles, descend},
    plane::{Cross, Estimate},
    solid::each_in_box,
    touch::{Feature, Touch},
    triple::{Difference, Time, direction, sign},
};
use crate::bvh::{Boxes, Bvh, Slabs, WIDTH};
use crate::mesh::Topology;

/// Moving boxes in f32.
struct Swift {
    offset: [f32; 3],
    /// One over the motion; zero where there is so little that it counts as width.
    inverse: [f32; 3],
    /// More than all roundings of distances, and than the motion that does not count.
    margin: [f32; 3],
}

impl Swift {
    /// `None` if f32 does not reach so far.
    fn new(first: &Bvh, second: &Bvh, offset: DVec3, motion: DVec3) -> Option<Swift> {
        let reach = Reach::new(first, second, &offset.into())?;
        let margin = reach.margin();
        if motion.abs().max_element() > 1e30 {
            return None;
        }
        // Distances are below 2^127, so with a motion above 2^-100 quotients that are times from 0
        // to 1 neither overflow nor underflow to what matters.
        let counts = motion
            .to_array()
            .map(|m| m.abs() > f64::from(margin).max(1e-30));
        let of = |axis: usize| (counts[axis], motion[axis]);
        Some(Swift {
            offset: reach.offset(),
            inverse: [0, 1, 2].map(|axis| match of(axis) {
                (true, m) => (1.0 / m) as f32,
                (false, _) => 0.0,
            }),
            margin: [0, 1, 2].map(|axis| match of(axis) {
                (true, _) => margin,
                (false, m) => margin + (m.abs() * 1.001) as f32,
            }),
        })
    }

    /// A bit for each pair of boxes that meet before the horizon, and when they begin to.
    ///
    /// Distances are known to within the margin ([`Reach::new`]), whose roundings here are a small
    /// part of it. Quotients are rounded three times, by `2^-24` each.
    #[inline(always)]
    fn meet(&self, first: &Boxes, second: &Boxes, horizon: f64) -> (u32, Portable) {
        const DOWN: f32 = 1.0 - 4.0 * f32::EPSILON;
        const UP: f32 = 1.0 + 4.0 * f32::EPSILON;
        let (mut enter, mut leave) = (Portable::splat(0.0), Portable::splat(1.0));
        let mut meet = u32::MAX;
        for axis in 0..3 {
            let (c, h) = (&first.centre[axis], &first.half[axis]);
            let (d, k) = (&second.centre[axis], &second.half[axis]);
            let moved = Portable::columns(d).add(Portable::splat(self.offset[axis]));
            let between = Portable::rows(c).sub(moved);
            let reach = Portable::rows(h).add(Portable::columns(k));
            let reach = reach.add(Portable::splat(self.margin[axis]));
            // Not so where a lane holds nothing.
            meet &= Portable::splat(0.0).at_most(reach);
            if self.inverse[axis] == 0.0 {
                meet &= between.abs().at_most(reach);
                continue;
            }
            let inverse = Portable::splat(self.inverse[axis]);
            let middle = between.mul(inverse);
            let around = reach.mul(inverse.abs());
            // Both roundings are relative to the parts, not to what is left of them.
            let slack = middle
                .abs()
                .add(around.abs())
                .mul(Portable::splat(4.0 * f32::EPSILON));
            enter = enter.max(middle.sub(around).sub(slack));
            leave = leave.min(middle.add(around).add(slack));
        }
        let enter = enter.mul(Portable::splat(DOWN));
        // More than what quotients lose below the normal numbers.
        let least = Portable::splat(f32::MIN_POSITIVE);
        let latest = leave.min(Portable::splat(horizon as f32));
        let latest = latest.mul_add(Portable::splat(UP), least);
        (meet & enter.at_most(latest) & 0xffff, enter)
    }
}

/// Which contacts count.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Those with a normal that opposes the motion.
    Entering,
    /// All but two edges in a plane along the motion.
    Any,
}

pub(super) struct Search<'a> {
    first: &'a Bvh,
    second: &'a Bvh,
    offset: DVec3,
    motion: DVec3,
    kind: Kind,
    /// Where f32 is enough for boxes.
    swift: Option<Swift>,
    /// What comes after this time is not the first contact.
    horizon: f64,
    best: Option<Candidate>,
    /// When a vertex first slides into a triangle, rounded down.
    slide: Option<f64>,
}

/// A contact that may be the first.
struct Candidate {
    time: Time,
    course: Ordering,
    /// The time is neither below nor above these.
    bounds: (f64, f64),
    /// The time rounded down, once that was needed.
    rounded: Option<f64>,
    feature: Feature,
    /// Where it is at time 0, and how that moves.
    point: DVec3,
    drift: DVec3,
    /// Whether it is at the end of an edge or at the start of the motion.
    is_on_brink: bool,
    /// Of each mesh the vertex, twice, or the ends of the edge that touches.
    at: [[u32; 2]; 2],
    /// Whether the plane of the contact does not part the meshes near it.
    is_doubtful: bool,
}

impl Candidate {
    fn rounded(&mut self) -> f64 {
        let time = &self.time;
        let rounded = *self.rounded.get_or_insert_with(|| time.rounded_down());
        self.bounds = (rounded, rounded.next_up());
        rounded
    }

    /// Against the motion.
    fn normal(&self) -> DVec3 {
        let normal = direction(self.time.u, self.time.v).normalize();
        if self.course == Ordering::Greater {
            -normal
        } else {
            normal
        }
    }

    fn class(&self) -> (bool, bool) {
        let is_edges = matches!(self.feature, Feature::EdgeEdge { .. });
        (self.is_doubtful, is_edges)
    }

    /// The order of contacts at one time; neither it nor the times depend on which mesh is the first
    /// one, unless features are all that is left.
    fn rank(&self, other: &Candidate) -> Ordering {
        self.class().cmp(&other.class()).then_with(|| {
            let (n, m, motion) = (self.normal(), other.normal(), self.time.motion);
            let along = motion / motion.abs().max_element();
            let toward = along.to_array().into_iter().find(|&x| x != 0.0);
            let flip = toward.unwrap_or(1.0);
            // One zero is as good as the other.
            let cmp = |x: f64, y: f64| (x + 0.0).total_cmp(&(y + 0.0));
            let keys = (0..3).map(|axis| cmp(n[axis] * flip, m[axis] * flip));
            cmp(n.dot(along), m.dot(along))
                .then_with(|| keys.fold(Ordering::Equal, Ordering::then))
                .then_with(|| self.feature.cmp(&other.feature))
        })
    }
}

/// A triangle and what is asked of it again and again.
struct Side {
    corners: [DVec3; 3],
    normal: Cross,
    /// `normal · motion`.
    fall: Estimate,
}

impl Side {
    #[inline(always)]
    fn of(corners: [DVec3; 3], motion: DVec3) -> Side {
        let [a, b, c] = corners;
        let normal = Cross::of(b - a, c - a);
        Side {
            corners,
            normal,
            fall: normal.dot(motion),
        }
    }

    #[inline(always)]
    fn height(&self, p: DVec3) -> Estimate {
        self.normal.dot(p - self.corners[0])
    }

    /// Whether some corners, which move by the motion times `way`, stay on one side of the plane until
    /// a time. Errors are doubled for the roundings here.
    #[inline(always)]
    fn is_passed(&self, corners: &[DVec3; 3], way: f64, until: f64) -> bool {
        let heights = [
            self.height(corners[0]),
            self.height(corners[1]),
            self.height(corners[2]),
        ];
        let stays = |side: f64| {
            let low = |h: Estimate| side * h.value - 2.0 * h.error;
            let lowest = low(heights[0]).min(low(heights[1])).min(low(heights[2]));
            let fall = side * way * self.fall.value - 2.0 * self.fall.error;
            lowest > 0.0 && lowest + until * fall > 0.0
        };
        stays(1.0) || stays(-1.0)
    }

    /// The products of edges and motion, which have the sides of the line of a moving point.
    #[inline(always)]
    fn curtains(&self, motion: DVec3) -> [Cross; 3] {
        let [a, b, c] = self.corners;
        [
            Cross::of(b - a, motion),
            Cross::of(c - b, motion),
            Cross::of(a - c, motion),
        ]
    }
}

/// What the mesh of a triangle knows of it.
struct Names {
    face: u32,
    vertices: [u32; 3],
    edges: [u32; 3],
    /// Of the vertices and of the edges those that are looked at with this triangle and no other.
    owns_vertex: [bool; 3],
    owns_edge: [bool; 3],
}

impl Names {
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
}

impl Tiles for Search<'_> {
    type Lanes = Portable;

    /// Boxes that meet no later than the earliest contact so far.
    #[inline]
    fn boxes(&mut self, first: &Boxes, second: &Boxes) -> (u32, Portable) {
        match &self.swift {
            Some(swift) => swift.meet(first, second, self.horizon),
            None => self.meet_in_f64(first, second),
        }
    }

    /// Slabs know nothing of motion.
    fn slabs(&self, _: (&Boxes, &Slabs), _: (&Boxes, &Slabs), pairs: u32) -> u32 {
        pairs
    }

    fn triangles(&mut self, first: u32, second: u32, mut pairs: u32) -> ControlFlow<()> {
        let (first, second) = (self.first.node(first), self.second.node(second));
        let (first, second) = (self.first.triangles(first), self.second.triangles(second));
        while pairs != 0 {
            let pair = pairs.trailing_zeros() as usize;
            pairs &= pairs - 1;
            let (i, j) = (pair / WIDTH, pair % WIDTH);
            self.try_triangles(
                (first.face[i], first.corners(i)),
                (second.face[j], second.corners(j)),
            );
        }
        ControlFlow::Continue(())
    }
}

impl<'a> Search<'a> {
    /// Looks for contacts within the motion.
    pub(super) fn run(
        kind: Kind,
        (first, second): (&'a Bvh, &'a Bvh),
        offset: DVec3,
        motion: DVec3,
    ) -> Search<'a> {
        let mut search = Search {
            first,
            second,
            offset,
            motion,
            kind,
            swift: Swift::new(first, second, offset, motion),
            horizon: 1.0,
            best: None,
            slide: None,
        };
        if motion != DVec3::ZERO {
            let _ = descend(first, second, &mut search);
        }
        search
    }

    /// The first contact, by the order of those at one time.
    pub(super) fn best(self) -> Option<Touch> {
        let mut best = self.best?;
        let time = best.rounded();
        Some(Touch {
            time,
            point: best.point + time * best.drift,
            normal: best.normal(),
            feature: best.feature,
        })
    }

    /// The time of the first contact.
    pub(super) fn time(self) -> Option<f64> {
        let crossing = self.best.map(|mut best| best.rounded());
        crossing
            .into_iter()
            .chain(self.slide)
            .min_by(f64::total_cmp)
    }

    /// For meshes so large that f32 is of no use. It need not be fast.
    #[cold]
    fn meet_in_f64(&self, first: &Boxes, second: &Boxes) -> (u32, Portable) {
        let (mut bits, mut times) = (0, [f32::INFINITY; TILE]);
        for (pair, place) in times.iter_mut().enumerate() {
            let time = self.entry(first, pair / WIDTH, second, pair % WIDTH);
            if let Some(time) = time.filter(|&t| t <= self.horizon) {
                bits |= 1 << pair;
                *place = time as f32;
            }
        }
        (bits, Portable::new(times))
    }

    /// When two boxes begin to meet, rounded down; `None` if they do not within the motion.
    fn entry(&self, first: &Boxes, i: usize, second: &Boxes, j: usize) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let wide = |x: &[[f32; WIDTH]; 3], lane: usize| f64::from(x[axis][lane]);
            let (a, b) = (wide(&first.centre, i), wide(&second.centre, j));
            let reach = wide(&first.half, i) + wide(&second.half, j);
            if reach < 0.0 {
                return None;
            }
            let offset = self.offset[axis];
            let between = a - (b + offset);
            let (near, far) = (between - reach, between + reach);
            let slack = 8.0 * f64::EPSILON * (a.abs() + b.abs() + reach + offset.abs());
            let (near, far) = (near - slack, far + slack);
            let motion = self.motion[axis];
            let inverse = 1.0 / motion;
            if inverse.is_finite() {
                let (s, t) = (near * inverse, far * inverse);
                // One more rounding than the slack has seen.
                enter = enter.max(s.min(t) * (1.0 - f64::EPSILON));
                leave = leave.min(s.max(t) * (1.0 + f64::EPSILON));
            } else if near > 0.0 || far < 0.0 {
                return None;
            }
        }
        (enter <= leave).then_some(enter)
    }

    #[inline(always)]
    fn try_triangles(&mut self, (s_face, s): (u32, [Vec3; 3]), (t_face, t): (u32, [Vec3; 3])) {
        let [a, b, c] = s;
        let first = Side::of([a.as_dvec3(), b.as_dvec3(), c.as_dvec3()], self.motion);
        let [a, b, c] = t;
        let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
        let second = [a + self.offset, b + self.offset, c + self.offset];
        if first.is_passed(&second, 1.0, self.horizon) {
            return;
        }
        let second = Side::of(second, self.motion);
        if second.is_passed(&first.corners, -1.0, self.horizon) {
            return;
        }
        self.try_features(&first, s_face, &second, t_face);
    }

    #[inline(never)]
    fn try_features(&mut self, first: &Side, s_face: u32, second: &Side, t_face: u32) {
        let s = Names::of(s_face, self.first.topology());
        let t = Names::of(t_face, self.second.topology());
        let curtains = first.curtains(self.motion);
        for i in (0..3).filter(|&i| t.owns_vertex[i]) {
            let feature = Feature::FaceVertex {
                face: s.face,
                vertex: t.vertices[i],
            };
            self.vertex_face(second, i, first, &curtains, 1.0, (t.vertices[i], feature));
        }
        let curtains_of_first = curtains;
        let curtains = second.curtains(self.motion);
        for i in (0..3).filter(|&i| s.owns_vertex[i]) {
            let feature = Feature::VertexFace {
                vertex: s.vertices[i],
                face: t.face,
            };
            self.vertex_face(first, i, second, &curtains, -1.0, (s.vertices[i], feature));
        }
        for i in (0..3).filter(|&i| s.owns_edge[i]) {
            for j in (0..3).filter(|&j| t.owns_edge[j]) {
                let feature = Feature::EdgeEdge {
                    first: s.edges[i],
                    second: t.edges[j],
                };
                let curtains = (&curtains_of_first[i], &curtains[j]);
                let ends =
                    |names: &Names, i: usize| [names.vertices[i], names.vertices[(i + 1) % 3]];
                let at = [ends(&s, i), ends(&t, j)];
                self.edge_edge((first, i), (second, j), curtains, (at, feature));
            }
        }
    }

    /// A corner of one triangle against another triangle; `way` is 1 where the corner moves, else -1.
    #[inline(always)]
    fn vertex_face(
        &mut self,
        corners: &Side,
        corner: usize,
        face: &Side,
        curtains: &[Cross; 3],
        way: f64,
        (vertex, feature): (u32, Feature),
    ) {
        let [a, b, c] = face.corners;
        let x = corners.corners[corner];
        let height = face.height(x);
        let gap = Estimate {
            value: -way * height.value,
            error: height.error,
        };
        if !self.may_be_first(gap, face.fall) {
            return;
        }
        let sides = [
            curtains[0].dot(a - x).sign(),
            curtains[1].dot(b - x).sign(),
            curtains[2].dot(c - x).sign(),
        ];
        if sides.contains(&Some(Ordering::Less)) && sides.contains(&Some(Ordering::Greater)) {
            return;
        }
        let time = Time {
            u: Difference(b, a),
            v: Difference(c, a),
            gap: if way > 0.0 {
                Difference(a, x)
            } else {
                Difference(x, a)
            },
            motion: self.motion,
        };
        let course = time.course();
        if course == Ordering::Equal {
            if self.kind == Kind::Any {
                self.slide(point_slides_into_triangle(
                    x,
                    way * self.motion,
                    face.corners,
                ));
            }
            return;
        }
        let sides = line_sides(x, self.motion, face.corners);
        if !line_passes(sides) || !time.is_within(course) {
            return;
        }
        self.add(Candidate {
            bounds: time.bounds(),
            course,
            rounded: None,
            feature,
            point: x,
            drift: if way > 0.0 { self.motion } else { DVec3::ZERO },
            is_on_brink: sides.contains(&Ordering::Equal) || time.is_start(),
            at: [[vertex; 2]; 2],
            is_doubtful: false,
            time,
        });
    }

    #[inline(always)]
    fn edge_edge(
        &mut self,
        (first, i): (&Side, usize),
        (second, j): (&Side, usize),
        (of_first, of_second): (&Cross, &Cross),
        (mut at, feature): ([[u32; 2]; 2], Feature),
    ) {
        let (a, b) = (first.corners[i], first.corners[(i + 1) % 3]);
        let (c, d) = (second.corners[j], second.corners[(j + 1) % 3]);
        let cross = Cross::of(b - a, d - c);
        let fall = cross.dot(self.motion);
        if !self.may_be_first(cross.dot(a - c), fall) {
            return;
        }
        // Those of `edges_pass`, with the last two vectors exchanged.
        if let Some(course) = fall.sign() {
            let within = |side: Estimate| side.sign() != Some(course);
            if !(within(of_second.dot(a - c))
                && within(of_second.dot(c - b))
                && within(of_first.dot(a - c))
                && within(of_first.dot(d - a)))
            {
                return;
            }
        }
        let mut time = Time {
            u: Difference(b, a),
            v: Difference(d, c),
            gap: Difference(a, c),
            motion: self.motion,
        };
        let course = time.course();
        if course == Ordering::Equal {
            return;
        }
        let sides = edge_sides([a, b], [c, d], self.motion);
        if sides.contains(&course.reverse()) || !time.is_within(course) {
            return;
        }
        // An end that touches stands for its edge; the gap is as good from there.
        if sides[1] == Ordering::Equal {
            (at[0][0], time.gap.0) = (at[0][1], b);
        } else if sides[0] == Ordering::Equal {
            at[0][1] = at[0][0];
        }
        if sides[3] == Ordering::Equal {
            (at[1][0], time.gap.1) = (at[1][1], d);
        } else if sides[2] == Ordering::Equal {
            at[1][1] = at[1][0];
        }
        let part = -of_second.dot(a - c).value / fall.value;
        let part = if part > 0.0 { part.min(1.0) } else { 0.0 };
        self.add(Candidate {
            bounds: time.bounds(),
            course,
            rounded: None,
            feature,
            point: a + part * (b - a),
            drift: DVec3::ZERO,
            is_on_brink: sides.contains(&Ordering::Equal) || time.is_start(),
            at,
            is_doubtful: false,
            time,
        });
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
        // For the roundings of both sides.
        const UP: f64 = 1.0 + 4.0 * f64::EPSILON;
        let farthest = self.horizon * (fall.value.abs() + fall.error) * UP;
        ahead + gap.error >= 0.0 && ahead - gap.error <= farthest
    }

    fn slide(&mut self, time: Option<f64>) {
        let Some(time) = time else { return };
        self.slide = Some(self.slide.map_or(time, |first| first.min(time)));
        self.horizon = self.horizon.min(time.next_up());
    }

    /// Keeps a contact if it is the first so far.
    fn add(&mut self, mut new: Candidate) {
        let (soonest, latest) = self.best.as_ref().map_or((2.0, 2.0), |old| old.bounds);
        if new.bounds.0 > latest {
            return;
        }
        if self.kind == Kind::Entering && new.is_on_brink {
            if self.comes_from_inside(&new) {
                return;
            }
            new.is_doubtful = !self.parts(&new);
            // Where edges meet at an end, a corner meets the faces there.
            let is_edges = matches!(new.feature, Feature::EdgeEdge { .. });
            if new.is_doubtful && (is_edges || new.time.is_start()) {
                return;
            }
        }
        if let Some(old) = self.best.as_mut().filter(|_| new.bounds.1 >= soonest) {
            let order = new.rounded().total_cmp(&old.rounded());
            if order.then_with(|| new.rank(old)) == Ordering::Greater {
                return;
            }
        }
        self.horizon = self.horizon.min(new.bounds.1);
        self.best = Some(new);
    }

    /// Whether a vertex comes to a face of a closed mesh from its inner side: with the vertex at the
    /// face's border, or there from the start, it may be outside nevertheless.
    fn comes_from_inside(&self, contact: &Candidate) -> bool {
        let (mesh, inside) = match contact.feature {
            Feature::FaceVertex { .. } => (self.first, Ordering::Greater),
            Feature::VertexFace { .. } => (self.second, Ordering::Less),
            Feature::EdgeEdge { .. } => return false,
        };
        let topology = mesh.topology();
        topology.closed && topology.oriented && contact.course == inside
    }

    /// Whether the plane of a contact has the one mesh, near it, on one side and the other one on the
    /// side from which it comes. Then what comes to touch is stopped, and what has touched and
    /// leaves is not.
    #[cold]
    fn parts(&self, contact: &Candidate) -> bool {
        let (first, second) = (contact.course, contact.course.reverse());
        match contact.feature {
            Feature::FaceVertex { .. } => self.second_is_on(second, contact),
            Feature::VertexFace { .. } => self.first_is_on(first, contact),
            Feature::EdgeEdge { .. } => {
                self.first_is_on(first, contact) && self.second_is_on(second, contact)
            }
        }
    }

    fn first_is_on(&self, side: Ordering, contact: &Candidate) -> bool {
        let (at, time) = (contact.at[0], &contact.time);
        star_is_on(self.first, DVec3::ZERO, at, side, (time, time.gap.0))
    }

    fn second_is_on(&self, side: Ordering, contact: &Candidate) -> bool {
        let (at, time) = (contact.at[1], &contact.time);
        star_is_on(self.second, self.offset, at, side, (time, time.gap.1))
    }
}

/// Whether the triangles at a vertex, or at both ends of an edge, lie on one side of a plane of
/// contact. Of those that lie in it, the winding tells on which side the mesh is, if it is closed. The
/// plane is laid through a point of them.
fn star_is_on(
    mesh: &Bvh,
    offset: DVec3,
    at: [u32; 2],
    side: Ordering,
    (plane, origin): (&Time, DVec3),
) -> bool {
    let topology = mesh.topology();
    // Around where the origin was placed from; with an edge it is one of its ends.
    let slack = DVec3::splat(4.0 * f64::EPSILON) * (origin.abs() + offset.abs());
    let from = origin - offset;
    let visit = |face: u32, corners: [Vec3; 3]| {
        let has = |v: &u32| topology.triangles[face as usize].contains(v);
        if !at.iter().all(has) {
            return ControlFlow::Continue(());
        }
        let corners = corners.map(|v| v.as_dvec3() + offset);
        let rise = |p: DVec3| sign([plane.u, plane.v, Difference(p, origin)]);
        let sides = corners.map(rise);
        let is_inside_out = || {
            let [a, b, c] = corners;
            let outward = direction(Difference(b, a), Difference(c, a));
            let up = direction(plane.u, plane.v).dot(outward).partial_cmp(&0.0);
            topology.closed && topology.oriented && up == Some(side)
        };
        if sides.contains(&side.reverse()) || (sides == [Ordering::Equal; 3] && is_inside_out()) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    each_in_box(mesh, from - slack, from + slack, visit).is_continue()
}
