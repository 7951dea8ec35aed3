//! Whether contacts at the borders of faces, at the ends of edges, and at the start block the motion.
//!
//! A contact inside a face, or of crossing edges, blocks the motion. At a border the surfaces may slip past each other:
//! [`slips_past`] decides this for all triangles at the point together. At the start the surfaces may part.
//!
//! Every point at which the surfaces cannot slip past each other has a contact with a normal. Surfaces touch for the
//! first time at a point that is a vertex of one of them or a crossing of edges ([`time_of_impact`]). If
//! they share more than a point and cannot slip past each other, they cannot at a corner of the shared set
//! either. A vertex and a triangle that the motion crosses are a contact, and so are two edges whose common
//! plane the motion crosses. Suppose there is no such contact. Then one surface has a vertex at the point, and
//! the other has only triangles parallel to the motion. The first one has only such triangles too: a triangle
//! that the motion crosses has two edges at the point that are not parallel in the projection along the motion, and
//! one of them would be a contact with an edge of the other surface. So both surfaces project to rays on one
//! line, and slip past each other.
//!
//! [`time_of_impact`]: crate::collide::touch::time_of_impact

use alloc::vec::Vec;
use core::cmp::Ordering;
use core::ops::ControlFlow;
use glam::{DVec3, Vec3};

use super::{
    Search,
    candidate::{Candidate, Spot, opposing_cmp},
    seen::{At, Cone, meet_after, slips_past},
};
use crate::bvh::Bvh;
use crate::collide::{
    Side,
    moving::{line_passes, line_sides},
    predicates::{orient3d, segment_meets_triangle},
    solid::each_in_box,
    touch::Feature,
    tree,
    triple::{Difference, Time, direction, sign},
};

/// A bound on the error of a perpendicular, relative to its length.
const DIGITS: f64 = 1e-6;

/// The surfaces at the two spots that were examined last.
#[derive(Default)]
pub(super) struct Around {
    /// For each spot, the vertex (twice) or the two ends of the edge.
    names: Option<[[u32; 2]; 2]>,
    cones: [Vec<Cone>; 2],
    blocks: bool,
}

impl Around {
    /// Whether the motion leads the two surfaces into each other.
    fn goes_in(&self, motion: DVec3) -> bool {
        meet_after(&self.cones[0], &self.cones[1], motion, false)
    }

    /// Whether the two surfaces were in each other before the contact.
    fn comes_out(&self, motion: DVec3) -> bool {
        meet_after(&self.cones[0], &self.cones[1], -motion, true)
    }
}

impl Search<'_> {
    /// Whether an entering contact at a border or at the start blocks the motion. Sets whether it is doubtful.
    #[inline(never)]
    pub(super) fn counts(&mut self, contact: &mut Candidate) -> bool {
        contact.is_doubtful = !self.parts(contact);
        let is_unclear = contact.is_doubtful || contact.is_from_inside;
        if !contact.is_on_border() {
            return !is_unclear;
        }
        self.look_around(contact);
        if !is_unclear || !self.around.blocks {
            return self.around.blocks;
        }
        let is_start = contact.time.is_start();
        // Meshes that are apart at the start can only leave each other after an earlier contact.
        if !is_start && !self.meet_at_start() {
            return true;
        }
        let (around, motion) = (&self.around, self.motion);
        (!is_start || around.goes_in(motion)) && !around.comes_out(motion)
    }

    fn meet_at_start(&mut self) -> bool {
        let (first, second, offset) = (self.first, self.second, self.offset);
        let meet = || tree::intersect(first, second, offset);
        *self.meet_at_start.get_or_insert_with(meet)
    }

    /// Collects the triangles around a contact at a border.
    fn look_around(&mut self, contact: &mut Candidate) {
        let names = contact.spots.map(|spot| match spot {
            Spot::Vertex(v, _) => [v; 2],
            Spot::Edge(ends, _) => ends,
            Spot::Face => [u32::MAX; 2],
        });
        if self.around.names == Some(names) {
            return;
        }
        let time = contact.rounded();
        let mut cones = core::mem::take(&mut self.around.cones);
        for (side, cones) in [Side::First, Side::Second].into_iter().zip(&mut cones) {
            cones.clear();
            self.each_cone(side, &contact.spots, time, |cone| cones.push(cone));
        }
        self.around = Around {
            names: Some(names),
            blocks: !slips_past(&cones[0], &cones[1], self.motion),
            cones,
        };
    }

    /// Whether a vertex comes to a face of a closed mesh from its inner side. The vertex may be outside the mesh
    /// nevertheless, if it is at the border of the face or there from the start.
    pub(super) fn comes_from_inside(&self, contact: &Candidate) -> bool {
        let (mesh, inside) = match contact.feature {
            Feature::FaceVertex { .. } => (self.first, Ordering::Greater),
            Feature::VertexFace { .. } => (self.second, Ordering::Less),
            Feature::EdgeEdge { .. } => return false,
        };
        let topology = mesh.topology();
        topology.closed && topology.oriented && contact.course == inside
    }

    /// Whether the contact plane separates the meshes near the contact: each is on the side from which it comes. If
    /// so, the contact stops a mesh that begins to touch, and does not stop one that has touched and leaves.
    fn parts(&self, contact: &Candidate) -> bool {
        let (first, second) = (contact.course, contact.course.reverse());
        let is_on = |side: Side, above: Ordering| {
            let (mesh, offset) = self.placed(side);
            let spot = contact.spots[side as usize];
            let is_solid = mesh.is_closed() && mesh.topology().oriented;
            let mut all = true;
            each_at(mesh, offset, spot, |corners| {
                all = all && is_on(above, &contact.time, spot, corners, is_solid);
            });
            all
        };
        match contact.feature {
            Feature::FaceVertex { .. } => is_on(Side::Second, second),
            Feature::VertexFace { .. } => is_on(Side::First, first),
            Feature::EdgeEdge { .. } => is_on(Side::First, first) && is_on(Side::Second, second),
        }
    }

    /// The normal of two edges whose perpendicular has fewer digits than [`DIGITS`]. Such edges are parallel except
    /// for the rounding of placed vertices. The normal is that of the adjacent face which opposes the motion most.
    pub(super) fn normal_beside(&self, contact: &Candidate) -> Option<DVec3> {
        if !contact.is_edges() {
            return None;
        }
        let (u, v) = (contact.time.u, contact.time.v);
        let farthest = [u.0, u.1, v.0, v.1].map(|p| p.abs().max_element());
        let farthest = farthest.into_iter().fold(0.0, f64::max);
        let (u, v) = (u.rounded(), v.rounded());
        let rounding = f64::EPSILON * farthest * (u.length() + v.length());
        if u.cross(v).length() * DIGITS > rounding {
            return None;
        }
        let mut best: Option<DVec3> = None;
        for side in [Side::First, Side::Second] {
            let (mesh, offset) = self.placed(side);
            each_at(mesh, offset, contact.spots[side as usize], |[a, b, c]| {
                let Some(normal) = (b - a).cross(c - a).try_normalize() else {
                    return;
                };
                let along = normal.dot(self.motion);
                let normal = if along > 0.0 { -normal } else { normal };
                let is_first = best
                    .is_none_or(|best| opposing_cmp(normal, best, self.motion) == Ordering::Less);
                if along != 0.0 && is_first {
                    best = Some(normal);
                }
            });
        }
        best
    }

    fn placed(&self, side: Side) -> (&Bvh, DVec3) {
        match side {
            Side::First => (self.first, DVec3::ZERO),
            Side::Second => (self.second, self.offset),
        }
    }

    /// Visits the triangles of a mesh at a contact at a border; one of the spots is a vertex.
    fn each_cone(&self, side: Side, spots: &[Spot; 2], time: f64, mut visit: impl FnMut(Cone)) {
        let (mesh, offset) = self.placed(side);
        let (spot, other, way) = match side {
            Side::First => (spots[0], spots[1], time * self.motion),
            Side::Second => (spots[1], spots[0], -time * self.motion),
        };
        match (spot, other) {
            (Spot::Vertex(v, at), _) => {
                each_near(mesh, offset, at, DVec3::ZERO, |names, corners| {
                    let place = match names.iter().position(|&name| name == v) {
                        Some(corner) => Some(At::Corner(corner)),
                        None => self.place_at(at, corners),
                    };
                    if let Some(place) = place {
                        let ways = corners.map(|corner| Difference(corner, at));
                        visit(Cone::new(corners, ways, self.motion, place));
                    }
                });
            }
            (Spot::Edge(ends, edge), Spot::Vertex(_, at)) => {
                let near = at + way;
                each_near(mesh, offset, near, way, |names, corners| {
                    let is_named =
                        |i: usize| ends.contains(&names[i]) && ends.contains(&names[(i + 1) % 3]);
                    let place = match (0..3).find(|&i| is_named(i)) {
                        Some(side) => Some(At::Side(side)),
                        None => self.place_beside(edge, at, corners),
                    };
                    if let Some(place) = place {
                        let ways = place.ways(corners);
                        visit(Cone::new(corners, ways, self.motion, place));
                    }
                });
            }
            (Spot::Edge(..) | Spot::Face, _) => {}
        }
    }

    /// The place of a vertex in a triangle that does not have it as a corner; `None` if it is not in the triangle.
    fn place_at(&self, vertex: DVec3, corners: [DVec3; 3]) -> Option<At> {
        let sides = line_sides(vertex, self.motion, corners);
        let is_in = line_passes(sides) && segment_meets_triangle(vertex, vertex, corners);
        is_in.then(|| At::line(sides))
    }

    /// The place, in a triangle of other vertices, of the point where a line along the motion through `p` meets an
    /// edge. `None` if the point is not in the triangle. Also `None` if the edge crosses an edge of the triangle
    /// there, not on one line: the surface then intersects itself.
    fn place_beside(&self, [a, b]: [DVec3; 2], p: DVec3, corners: [DVec3; 3]) -> Option<At> {
        let sides = line_sides(p, self.motion, corners);
        let [u, v, w] = corners;
        let is_beside = |end: &DVec3| orient3d(u, v, w, *end) == 0.0;
        if !(line_passes(sides) && [a, b].iter().all(is_beside)) {
            return None;
        }
        let motion = Difference::from(self.motion);
        if sign([Difference(v, u), Difference(w, u), motion]) != Ordering::Equal {
            return Some(At::line(sides));
        }
        // A triangle parallel to the motion has the point on its border.
        let along = Difference(b, a);
        let axes = DVec3::AXES.map(Difference::from);
        let axis = axes
            .into_iter()
            .find(|&axis| sign([along, motion, axis]) != Ordering::Equal)?;
        (0..3)
            .map(|i| (i, corners[i], corners[(i + 1) % 3]))
            .find_map(|(i, from, to)| {
                let is_on = |end: DVec3| {
                    let off = |axis| sign([along, Difference(end, a), axis]);
                    axes.into_iter().all(|axis| off(axis) == Ordering::Equal)
                };
                let [back, ahead] = [from, to].map(|end| sign([Difference(end, p), motion, axis]));
                let is_between = back != ahead || back == Ordering::Equal;
                (is_between && is_on(from) && is_on(to)).then_some(At::Side(i))
            })
    }
}

/// Whether a triangle lies on one side of a contact plane. If the triangle lies in the plane, its winding tells on
/// which side the solid is. The plane passes through a point of the mesh.
fn is_on(side: Ordering, plane: &Time, spot: Spot, corners: [DVec3; 3], is_solid: bool) -> bool {
    let (Spot::Vertex(_, origin) | Spot::Edge(_, [origin, _])) = spot else {
        return true;
    };
    let sides = corners.map(|p| sign([plane.u, plane.v, Difference(p, origin)]));
    if sides != [Ordering::Equal; 3] {
        return !sides.contains(&side.reverse());
    }
    let [a, b, c] = corners;
    let outward = direction(Difference(b, a), Difference(c, a));
    let up = direction(plane.u, plane.v).dot(outward).partial_cmp(&0.0);
    !(is_solid && up == Some(side))
}

/// Visits the triangles at a vertex or an edge.
fn each_at(mesh: &Bvh, offset: DVec3, spot: Spot, mut visit: impl FnMut([DVec3; 3])) {
    let (at, origin) = match spot {
        Spot::Vertex(v, origin) => ([v; 2], origin),
        Spot::Edge(ends, [origin, _]) => (ends, origin),
        Spot::Face => return,
    };
    each_near(mesh, offset, origin, DVec3::ZERO, |names, corners| {
        if at.iter().all(|v| names.contains(v)) {
            visit(corners);
        }
    });
}

/// Visits the triangles at a point, and some others, with their vertices and corners. The point has moved by `way` and
/// was rounded afterwards.
fn each_near(
    mesh: &Bvh,
    offset: DVec3,
    point: DVec3,
    way: DVec3,
    mut visit: impl FnMut([u32; 3], [DVec3; 3]),
) {
    let topology = mesh.topology();
    // A box around the place from which the point was moved.
    let size = point.abs() + offset.abs() + way.abs();
    let slack = DVec3::splat(8.0 * f64::EPSILON) * size;
    let from = point - offset;
    let _ = each_in_box(
        mesh,
        from - slack,
        from + slack,
        |face, corners: [Vec3; 3]| {
            let corners = corners.map(|v| v.as_dvec3() + offset);
            visit(topology.triangles[face as usize], corners);
            ControlFlow::Continue(())
        },
    );
}
