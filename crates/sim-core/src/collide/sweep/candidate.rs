//! Candidates for the first contact, and their order at equal times.

use core::cmp::Ordering;
use glam::DVec3;

use crate::collide::{
    touch::Feature,
    triple::{Time, direction},
};

/// A contact that may be the first.
pub(super) struct Candidate {
    pub(super) time: Time,
    /// The side of the contact plane to which the motion leads.
    pub(super) course: Ordering,
    /// Lower and upper bound on the time.
    pub(super) bounds: (f64, f64),
    /// The time rounded down, once that was needed.
    rounded: Option<f64>,
    /// The normal, once that was needed.
    normal: Option<DVec3>,
    pub(super) feature: Feature,
    /// The contact point at time 0, and its velocity.
    pub(super) point: DVec3,
    pub(super) drift: DVec3,
    /// Whether the contact is at the border of a face, at the end of an edge, or at the start of the motion.
    pub(super) is_on_brink: bool,
    /// The feature of each mesh that touches.
    pub(super) spots: [Spot; 2],
    /// Whether the contact plane does not separate the meshes near the contact.
    pub(super) is_doubtful: bool,
    /// Whether a vertex comes to a face of a closed mesh from the inner side of the face.
    pub(super) is_from_inside: bool,
}

/// The feature of a mesh that touches, and the positions of its vertices at the start.
#[derive(Clone, Copy, Debug)]
pub(super) enum Spot {
    Vertex(u32, DVec3),
    /// An edge, touched between its ends.
    Edge([u32; 2], [DVec3; 2]),
    /// A face, touched inside its border.
    Face,
}

impl Candidate {
    pub(super) fn new(
        (time, course): (Time, Ordering),
        feature: Feature,
        (point, drift): (DVec3, DVec3),
        spots: [Spot; 2],
    ) -> Candidate {
        let mut candidate = Candidate {
            bounds: time.bounds(),
            course,
            rounded: None,
            normal: None,
            feature,
            point,
            drift,
            is_on_brink: false,
            spots,
            is_doubtful: false,
            is_from_inside: false,
            time,
        };
        candidate.is_on_brink = candidate.is_on_border() || candidate.time.is_start();
        candidate
    }

    /// Whether a vertex touches an edge or a vertex.
    pub(super) fn is_on_border(&self) -> bool {
        matches!(
            self.spots,
            [Spot::Vertex(..), Spot::Vertex(..) | Spot::Edge(..)]
                | [Spot::Edge(..), Spot::Vertex(..)]
        )
    }

    pub(super) fn is_edges(&self) -> bool {
        matches!(self.feature, Feature::EdgeEdge { .. })
    }

    pub(super) fn rounded(&mut self) -> f64 {
        let time = &self.time;
        let rounded = *self.rounded.get_or_insert_with(|| time.rounded_down());
        self.bounds = (rounded, rounded.next_up());
        rounded
    }

    /// The unit normal, which opposes the motion.
    pub(super) fn normal(&mut self) -> DVec3 {
        let (time, course) = (&self.time, self.course);
        *self.normal.get_or_insert_with(|| {
            let normal = direction(time.u, time.v).normalize();
            if course == Ordering::Greater {
                -normal
            } else {
                normal
            }
        })
    }

    /// The order of contacts at the same time. Neither the order nor the times depend on which mesh is the first,
    /// unless the contacts differ only in their features.
    pub(super) fn is_before(&mut self, other: &mut Candidate) -> bool {
        let class = |c: &Candidate| (c.is_doubtful, c.is_from_inside, c.is_edges());
        let order = class(self).cmp(&class(other));
        let order = order.then_with(|| self.normal_cmp(other));
        order.then_with(|| self.feature.cmp(&other.feature)) == Ordering::Less
    }

    fn normal_cmp(&mut self, other: &mut Candidate) -> Ordering {
        let face = |feature: Feature| match feature {
            Feature::FaceVertex { face, .. } => Some((true, face)),
            Feature::VertexFace { face, .. } => Some((false, face)),
            Feature::EdgeEdge { .. } => None,
        };
        let (one, two) = (face(self.feature), face(other.feature));
        if one.is_some() && one == two {
            return Ordering::Equal;
        }
        opposing_cmp(self.normal(), other.normal(), self.time.motion)
    }
}

/// The order of two normals: first the one that opposes the motion most.
pub(in crate::collide) fn opposing_cmp(n: DVec3, m: DVec3, motion: DVec3) -> Ordering {
    if n == m {
        return Ordering::Equal;
    }
    let along = motion / motion.abs().max_element();
    let toward = along.to_array().into_iter().find(|&x| x != 0.0);
    let flip = toward.unwrap_or(1.0);
    // Treats the two zeros as equal.
    let cmp = |x: f64, y: f64| (x + 0.0).total_cmp(&(y + 0.0));
    let keys = (0..3).map(|axis| cmp(n[axis] * flip, m[axis] * flip));
    cmp(n.dot(along), m.dot(along)).then_with(|| keys.fold(Ordering::Equal, Ordering::then))
}
