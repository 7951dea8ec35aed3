//! Contacts at the borders of faces and at the ends of edges: whether they block the motion.
//!
//! Inside a face, and where edges cross, the plane of contact is the only one that parts what
//! touches. At a border there may be others, and what touches slips past along a plane that holds
//! the motion. So a contact there counts only if there is none: seen along the motion, no line
//! through the point has the one mesh, near it, on one side and the other one on the other. With
//! the directions along which the meshes lead away from the point, those of the first one reversed,
//! that is the question whether they all lie in a half-plane.

use core::cmp::Ordering;
use core::ops::ControlFlow;
use glam::{DVec3, Vec3};

use super::{
    Search,
    candidate::{Candidate, Spot},
};
use crate::bvh::Bvh;
use crate::collide::{
    Side,
    solid::each_in_box,
    touch::Feature,
    triple::{Difference, Time, direction, sign},
};

impl Search<'_> {
    /// Whether an entering contact on the brink is one. Sets whether it is doubtful.
    #[inline(never)]
    pub(super) fn counts(&self, contact: &mut Candidate) -> bool {
        if contact.is_from_inside {
            return false;
        }
        let mut fan = Fan::new(self.motion);
        contact.is_doubtful = !self.parts(contact, &mut fan);
        // Where edges meet at an end, a corner meets the faces there.
        if contact.is_doubtful && (contact.is_edges() || contact.time.is_start()) {
            return false;
        }
        if !contact.is_on_border() {
            return true;
        }
        // What touches a vertex has not been looked at.
        match contact.feature {
            Feature::FaceVertex { .. } => {
                self.visit_around(Side::First, contact, &mut fan, |_| true)
            }
            Feature::VertexFace { .. } => {
                self.visit_around(Side::Second, contact, &mut fan, |_| true)
            }
            Feature::EdgeEdge { .. } => true,
        };
        fan.is_all()
    }

    /// Whether a vertex comes to a face of a closed mesh from its inner side: with the vertex at the
    /// face's border, or there from the start, it may be outside nevertheless.
    pub(super) fn comes_from_inside(&self, contact: &Candidate) -> bool {
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
    fn parts(&self, contact: &Candidate, fan: &mut Fan) -> bool {
        let (first, second) = (contact.course, contact.course.reverse());
        let is_on = |mesh: &Bvh, side: Ordering, spot: Spot| {
            let is_solid = mesh.is_closed() && mesh.topology().oriented;
            let time = &contact.time;
            move |corners: [DVec3; 3]| is_on(side, time, spot, corners, is_solid)
        };
        let of_first = is_on(self.first, first, contact.spots[0]);
        let of_second = is_on(self.second, second, contact.spots[1]);
        match contact.feature {
            Feature::FaceVertex { .. } => self.visit_around(Side::Second, contact, fan, of_second),
            Feature::VertexFace { .. } => self.visit_around(Side::First, contact, fan, of_first),
            Feature::EdgeEdge { .. } => {
                self.visit_around(Side::First, contact, fan, of_first)
                    && self.visit_around(Side::Second, contact, fan, of_second)
            }
        }
    }

    /// Adds the directions along which a mesh leads away from a contact, those of the first one
    /// reversed, and tells whether something holds for all its triangles there.
    fn visit_around(
        &self,
        side: Side,
        contact: &Candidate,
        fan: &mut Fan,
        mut holds: impl FnMut([DVec3; 3]) -> bool,
    ) -> bool {
        let mut all = true;
        let (mesh, offset, spot) = match side {
            Side::First => (self.first, DVec3::ZERO, contact.spots[0]),
            Side::Second => (self.second, self.offset, contact.spots[1]),
        };
        each_at(mesh, offset, spot, |corners, from| {
            all = all && holds(corners);
            away(corners, from).for_each(|(p, q)| {
                fan.add(match side {
                    Side::First => Difference(p, q),
                    Side::Second => Difference(q, p),
                });
            });
        });
        all
    }
}

/// Whether a triangle lies on one side of a plane of contact. Of one that lies in it, the winding
/// tells on which side a solid is. The plane is laid through a point of the mesh.
fn is_on(side: Ordering, plane: &Time, spot: Spot, corners: [DVec3; 3], is_solid: bool) -> bool {
    let (Spot::Vertex(_, origin) | Spot::Edge(_, origin)) = spot else {
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

/// Visits the triangles at a vertex or an edge: their corners, and for each whether it is what
/// touches.
fn each_at(mesh: &Bvh, offset: DVec3, spot: Spot, mut visit: impl FnMut([DVec3; 3], [bool; 3])) {
    let (at, origin) = match spot {
        Spot::Vertex(v, origin) => ([v; 2], origin),
        Spot::Edge(ends, origin) => (ends, origin),
        Spot::Face => return,
    };
    let topology = mesh.topology();
    // Around where the origin was placed from.
    let slack = DVec3::splat(4.0 * f64::EPSILON) * (origin.abs() + offset.abs());
    let from = origin - offset;
    let _ = each_in_box(
        mesh,
        from - slack,
        from + slack,
        |face, corners: [Vec3; 3]| {
            let names = topology.triangles[face as usize];
            if at.iter().all(|v| names.contains(v)) {
                let corners = corners.map(|v| v.as_dvec3() + offset);
                visit(corners, names.map(|v| at.contains(&v)));
            }
            ControlFlow::Continue(())
        },
    );
}

/// The sides of a triangle that lead away from those of its corners that touch, along an edge that
/// touches both ways: from where, and to where.
fn away(corners: [DVec3; 3], touches: [bool; 3]) -> impl Iterator<Item = (DVec3, DVec3)> {
    let sides = [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)].into_iter();
    sides
        .filter(move |&(from, _)| touches[from])
        .map(move |(from, to)| (corners[from], corners[to]))
}

/// Directions seen along the motion: the least sector that holds all.
struct Fan {
    motion: Difference,
    sector: Sector,
}

#[derive(Clone, Copy)]
enum Sector {
    Nothing,
    Ray(Difference),
    /// Both ways.
    Line(Difference),
    /// Less than a half-plane, counter-clockwise from the one to the other.
    Acute(Difference, Difference),
    /// To the left of a direction.
    Half(Difference),
    All,
}

impl Fan {
    fn new(motion: DVec3) -> Fan {
        Fan {
            motion: motion.into(),
            sector: Sector::Nothing,
        }
    }

    fn is_all(&self) -> bool {
        matches!(self.sector, Sector::All)
    }

    fn add(&mut self, v: Difference) {
        use Ordering::{Equal, Greater, Less};
        let turn = |u: Difference| sign([u, v, self.motion]);
        self.sector = match self.sector {
            Sector::All => return,
            Sector::Nothing => match self.along(v, v) {
                Equal => return,
                _ => Sector::Ray(v),
            },
            Sector::Ray(u) => match turn(u) {
                Greater => Sector::Acute(u, v),
                Less => Sector::Acute(v, u),
                Equal if self.along(u, v) == Less => Sector::Line(u),
                Equal => return,
            },
            Sector::Line(u) => match turn(u) {
                Greater => Sector::Half(u),
                Less => Sector::Half(Difference(u.1, u.0)),
                Equal => return,
            },
            Sector::Acute(right, left) => match (turn(right), turn(left)) {
                (Greater | Equal, Less) | (Greater | Equal, Equal) => return,
                (Greater, Greater) => Sector::Acute(right, v),
                (Less, Less) => Sector::Acute(v, left),
                (Equal, Greater) => Sector::Half(right),
                (Less, Equal) => Sector::Half(v),
                (Less, Greater) => Sector::All,
            },
            Sector::Half(right) => match turn(right) {
                Less => Sector::All,
                _ => return,
            },
        };
    }

    /// Of two directions that are parallel, seen along the motion: whether they lead the same way, or
    /// `Equal` if one of them leads nowhere.
    fn along(&self, u: Difference, v: Difference) -> Ordering {
        for axis in DVec3::AXES.map(Difference::from) {
            let [u, v] = [u, v].map(|way| sign([way, axis, self.motion]));
            if u != Ordering::Equal {
                return match v {
                    Ordering::Equal => v,
                    _ if u == v => Ordering::Greater,
                    _ => Ordering::Less,
                };
            }
        }
        Ordering::Equal
    }
}
