//! The places of bodies, and the rounding of these places.

use glam::{DQuat, DVec3};

use super::{
    bodies::Bodies,
    continuous::ContactSet,
    overlap::Overlaps,
    state::{State, Turned},
};
use crate::{Shape, collide};

/// The gap of bodies in contact, in units in the last place of the largest coordinate about.
const HOVER_ULPS: f64 = 1024.0;
/// Rounding of placed vertices, in units in the last place of the largest coordinate about, that
/// two bodies are kept apart by at an impact.
pub(super) const RESOLUTION_ULPS: f64 = 4.0;
/// The same where a sphere meets triangles, whose distance is computed (`collide/ball.rs`): more than
/// its error, so that a point stays on its side of a surface.
const SPHERE_MESH_ULPS: f64 = 64.0;

/// Bodies at their places.
#[derive(Clone, Copy)]
pub(super) struct Layout<'a> {
    pub(super) bodies: &'a Bodies,
    /// Where they are, m.
    pub(super) at: &'a [DVec3],
    /// How those are turned there that turn, by slot.
    pub(super) turned: &'a [Turned],
    /// Their motion where the step began.
    pub(super) before: &'a State,
    pub(super) contacts: &'a ContactSet,
    pub(super) overlaps: &'a Overlaps,
}

impl Layout<'_> {
    /// The gap at which two bodies in contact are kept, m.
    pub(super) fn hover_gap(&self, i: usize, j: usize) -> f64 {
        let far =
            |body: usize| self.at[body].abs().max_element() + self.bodies.extent(body).farthest;
        HOVER_ULPS * f64::EPSILON * (far(i) + far(j))
    }

    /// What the rounding of positions and placed vertices, and of distances from triangles, may be, m.
    pub(super) fn position_resolution(&self, i: usize, j: usize) -> f64 {
        self.resolution_by_axis(i, j).max_element()
    }

    /// The same along a normal: a body that is long along one axis rounds no more along another.
    pub(super) fn resolution_along(&self, i: usize, j: usize, normal: DVec3) -> f64 {
        normal.abs().dot(self.resolution_by_axis(i, j))
    }

    /// The same by component.
    pub(super) fn resolution_by_axis(&self, i: usize, j: usize) -> DVec3 {
        let (from, to) = (&self.before.position, self.at);
        let at = |body: usize| from[body].abs().max(to[body].abs());
        let far = |body: usize| at(body) + self.bodies.extent(body).reach;
        let far = far(i) + far(j);
        match (self.bodies.shape(i), self.bodies.shape(j)) {
            // A distance is a sum over all axes, and told by axis where one of them is long.
            (Some(Shape::Mesh(_)), Some(Shape::Sphere { radius }))
            | (Some(Shape::Sphere { radius }), Some(Shape::Mesh(_))) => {
                let by_axis = SPHERE_MESH_ULPS * f64::EPSILON * far;
                let most = by_axis.max_element();
                match collide::is_told_by_axis(most, *radius) {
                    true => by_axis,
                    false => DVec3::splat(most),
                }
            }
            _ => RESOLUTION_ULPS * f64::EPSILON * far,
        }
    }

    /// Whether two bodies meet as they are turned, the second one at an offset from the first. Trees must be there.
    pub(super) fn meet(&self, i: usize, j: usize, offset: DVec3) -> bool {
        if !self.bodies.pair_tumbles(i, j) {
            return self.bodies.meet_built(i, j, offset);
        }
        let first = (i, (DVec3::ZERO, self.rotation(i)));
        let second = (j, (offset, self.rotation(j)));
        self.bodies.meet_placed(first, second)
    }

    /// How a body's shape is turned: into the world.
    pub(super) fn rotation(&self, body: usize) -> DQuat {
        self.bodies.rotation_among(self.turned, body)
    }

    /// How far a body reaches about its position against a normal, as it is turned, m; the tree over its mesh
    /// must be there.
    pub(super) fn reach_against(&self, body: usize, normal: DVec3) -> Option<f64> {
        let form = self.bodies.form(body)?;
        if !self.bodies.tumbles(body) {
            return Some(collide::reach(form, normal).0);
        }
        let rotation = self.rotation(body);
        let centre = normal.dot(rotation * self.bodies.centre_of(body));
        Some(collide::reach(form, rotation.inverse() * normal).0 + centre)
    }

    /// Where two bodies in overlap should part to: out of a half-space, or along the line of their
    /// centres.
    pub(super) fn apart_along(&self, i: usize, j: usize) -> DVec3 {
        self.bodies.line_apart(self.at, (i, j)).unwrap_or(DVec3::X)
    }
}
