//! The positions of bodies, and the rounding of these positions.

use glam::{DQuat, DVec3};

use super::{
    bodies::Bodies,
    continuous::ContactSet,
    overlap::Overlaps,
    state::{State, Turned},
};
use crate::{Shape, collide};

/// The gap of bodies in contact, in units in the last place of their largest coordinate.
const HOVER_ULPS: f64 = 1024.0;
/// The distance at which two bodies are kept at an impact, because placed vertices round, in units in the last place of
/// their largest coordinate.
pub(super) const RESOLUTION_ULPS: f64 = 4.0;
/// The same for a sphere and a mesh, whose distance is computed (`collide/ball.rs`): more than the error of this
/// distance, so that a point stays on its side of a surface.
const SPHERE_MESH_ULPS: f64 = 64.0;

/// Bodies at their positions.
#[derive(Clone, Copy)]
pub(super) struct Layout<'a> {
    pub(super) bodies: &'a Bodies,
    /// Their positions, m.
    pub(super) at: &'a [DVec3],
    /// The rotations of turning bodies there, by slot.
    pub(super) turned: &'a [Turned],
    /// Their motion at the start of the step.
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

    /// A bound on the rounding of positions, of placed vertices, and of distances from triangles, m.
    pub(super) fn position_resolution(&self, i: usize, j: usize) -> f64 {
        self.resolution_by_axis(i, j).max_element()
    }

    /// The same along a normal: a body that is long on one axis rounds no more along another.
    pub(super) fn resolution_along(&self, i: usize, j: usize, normal: DVec3) -> f64 {
        normal.abs().dot(self.resolution_by_axis(i, j))
    }

    /// The same for each component.
    pub(super) fn resolution_by_axis(&self, i: usize, j: usize) -> DVec3 {
        let (from, to) = (&self.before.position, self.at);
        let at = |body: usize| from[body].abs().max(to[body].abs());
        let far = |body: usize| at(body) + self.bodies.extent(body).reach;
        let far = far(i) + far(j);
        match (self.bodies.shape(i), self.bodies.shape(j)) {
            // A distance is a sum over all axes; it is bounded axis by axis if the body is long on one of them.
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

    /// Whether two bodies meet at their rotations, the second one at an offset from the first. Their trees must be
    /// built.
    pub(super) fn meet(&self, i: usize, j: usize, offset: DVec3) -> bool {
        if !self.bodies.pair_tumbles(i, j) {
            return self.bodies.meet_built(i, j, offset);
        }
        let first = (i, (DVec3::ZERO, self.rotation(i)));
        let second = (j, (offset, self.rotation(j)));
        self.bodies.meet_placed(first, second)
    }

    /// The rotation from a body's shape into the world.
    pub(super) fn rotation(&self, body: usize) -> DQuat {
        self.bodies.rotation_among(self.turned, body)
    }

    /// The extent of a body about its position against a normal, at its rotation, m. The tree over its mesh must be
    /// built.
    pub(super) fn reach_against(&self, body: usize, normal: DVec3) -> Option<f64> {
        let form = self.bodies.form(body)?;
        if !self.bodies.tumbles(body) {
            return Some(collide::reach(form, normal).0);
        }
        let rotation = self.rotation(body);
        let centre = normal.dot(rotation * self.bodies.centre_of(body));
        Some(collide::reach(form, rotation.inverse() * normal).0 + centre)
    }

    /// The direction in which two overlapping bodies should part: out of a half-space, or along the line of their
    /// centres.
    pub(super) fn apart_along(&self, i: usize, j: usize) -> DVec3 {
        self.bodies.line_apart(self.at, (i, j)).unwrap_or(DVec3::X)
    }
}
