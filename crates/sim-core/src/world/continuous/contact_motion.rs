//! How contacts change: their gaps at the start of a step, and the times at which a sliding body leaves the surface
//! below it.
//!
//! Bodies in contact keep a small gap ([`Layout::hover_gap`](super::super::layout::Layout::hover_gap)). It is more
//! than rounding and an iterative solver move them in a step, so that the impact search does not see the surface that
//! supports them, and sees every other one. The same exact search also measures contacts. It moves the body a short
//! way against the normal: a contact exists if this motion is stopped, and its gap is the length of the motion.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::stepping::Cause;
use super::{
    contact_set::{ContactConstraint, Measure},
    solver::ContactSolver,
    view::View,
};
use crate::{
    Feature, Shape,
    collide::{first_contact, snap},
};

/// Fraction of that gap at which a contact begins.
pub(super) const LEAST_GAP: f64 = 1.0 / 8.0;

/// The number of features of a plane that are followed in a step. A body that slides farther is examined again there.
const MAX_FEATURES: usize = 4096;

/// The surface below a body.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    /// The distance below the body, m.
    pub(super) distance: f64,
    pub(super) normal: DVec3,
    pub(super) touched: Touched,
    /// The contact point, relative to the first body, m.
    pub(super) point: DVec3,
}

impl Surface {
    /// The contact with this surface along a normal, at an offset.
    fn measured(&self, normal: DVec3, offset: DVec3) -> Measure {
        Measure {
            offset,
            gap: self.distance * self.normal.dot(normal),
            normal: self.normal,
            point: self.point,
        }
    }
}

impl Measure {
    /// The same from an offset that differs by no more than `most` in the plane of the contact and along its normal, m.
    fn seen_from(&self, offset: DVec3, normal: DVec3, most: f64) -> Option<Measure> {
        let moved = offset - self.offset;
        let gap = self.gap + moved.dot(normal);
        let is_there = moved.length() <= most && gap >= 0.0;
        is_there.then_some(Measure {
            offset,
            gap,
            ..*self
        })
    }
}

/// The features of two bodies that touch.
#[derive(Clone, Copy)]
pub(super) enum Touched {
    Feature(Feature),
    /// A sphere touches a triangle of the mesh of `body`.
    Face {
        body: usize,
        face: u32,
    },
    Nothing,
}

/// The surface below a body that moves over another one.
enum Below {
    /// The same plane as before.
    Flat(Surface),
    /// A surface that rises above the plane.
    Risen,
    /// Another plane, or nothing.
    Other,
}

/// The times at which `place + time (speed + time push)` is zero.
fn roots(place: f64, speed: f64, push: f64) -> [Option<f64>; 2] {
    let inner = speed * speed - 4.0 * push * place;
    if inner < 0.0 {
        return [None; 2];
    }
    let half = -0.5 * (speed + libm::copysign(libm::sqrt(inner), speed));
    let finite = |time: f64| time.is_finite().then_some(time);
    [finite(half / push), finite(place / half)]
}

/// How a surface continues below a sliding body.
pub(super) enum Course {
    /// It keeps its normal. The contact at the end of the motion, if the body is on the same plane there.
    Flat(Option<Measure>),
    /// It falls away by this acceleration, m/s².
    Receding(f64),
    /// The body leaves it, or it begins to turn, at this time after the start, s.
    EndsAfter(f64),
    /// The body leaves it now.
    Ended,
}

impl View<'_> {
    /// The height, m, and the initial speed, m/s, of the longest flight that is too short to count as one, under an
    /// acceleration, m/s². The body rises for half of its time and falls for the other half.
    pub(super) fn shortest_hop(
        &self,
        (i, j): (usize, usize),
        acceleration: f64,
        is_bundled: bool,
    ) -> (f64, f64) {
        let rise = 0.5 * self.shortest_flight(is_bundled) * self.scene.settings.dt;
        let height = 0.5 * rise * rise * acceleration;
        let most = self.layout().hover_gap(i, j);
        match height > most && self.are_steep(i, j) {
            true => (most, libm::sqrt(2.0 * acceleration * most)),
            false => (height, rise * acceleration),
        }
    }

    /// The surface within reach of the second body of a pair, against a normal and from an offset. The motion first
    /// leaves the other contacts of the pair, because they would stop it too.
    pub(super) fn surface_below(
        &self,
        constraint: &ContactConstraint,
        offset: DVec3,
        reach: f64,
    ) -> Option<Surface> {
        let ((i, j), normal) = (constraint.bodies, constraint.normal);
        let (first, second) = self.scene.bodies.forms(i, j)?;
        let others = self.contacts.of_pair(i, j);
        let others = others.filter(|other| other.normal != normal);
        let aside: DVec3 = others.map(|other| reach * other.normal).sum();
        let along = normal.dot(aside);
        let lift = self.layout().hover_gap(i, j) + (-along).max(0.0);
        let start = offset + aside + lift * normal;
        let length = reach + along + lift;
        let contact = first_contact(first, second, snap(start), snap(-length * normal))?;
        Some(Surface {
            distance: contact.time * length - (along + lift),
            normal: contact.normal,
            touched: match (contact.feature, contact.face) {
                (Some(feature), _) => Touched::Feature(feature),
                (None, Some(face)) => {
                    let body = if self.scene.bodies.mesh(i).is_some() {
                        i
                    } else {
                        j
                    };
                    Touched::Face { body, face }
                }
                (None, None) => Touched::Nothing,
            },
            point: contact.point,
        })
    }

    /// A contact measured at the starts of the trajectories of its bodies, or `None` if it no longer exists. `left`
    /// is the rest of the step, s.
    pub(super) fn measured(
        &self,
        constraint: ContactConstraint,
        left: f64,
    ) -> Option<ContactConstraint> {
        let ((i, j), normal) = (constraint.bodies, constraint.normal);
        let hover = self.layout().hover_gap(i, j);
        let is_bundled = self.contacts.is_bundled(i) || self.contacts.is_bundled(j);
        let (height, _) = self.shortest_hop((i, j), self.greatest_push(i, j), is_bundled);
        let start = &self.paths.start;
        let closing = (start.velocity[i] - start.velocity[j]).dot(constraint.normal);
        let reach = match is_bundled {
            // The distance that the contact may close in this step.
            true => 4.0 * height + left * closing.max(0.0),
            false => height,
        };
        let offset = start.position[j] - start.position[i];
        // Most bodies are as near as the gap of contacts. A longer motion finds more obstacles.
        let near = 8.0 * hover;
        let foreseen = || {
            constraint
                .ahead
                .and_then(|ahead| ahead.seen_from(offset, normal, hover))
        };
        let below = |reach| self.surface_below(&constraint, offset, reach);
        let found =
            foreseen().or_else(|| below(near).map(|surface| surface.measured(normal, offset)));
        let Measure {
            gap, normal, point, ..
        } = match found {
            // Bodies do not meet. A surface that seems to be above the present position is another one, through which
            // the body was lifted. All that is known of this contact is that the bodies touched.
            Some(found) if found.gap < 0.0 => Measure {
                offset,
                gap: 0.0,
                normal,
                point: constraint.point,
            },
            Some(found) => found,
            None if reach <= near => return None,
            None => {
                let surface = below(reach).filter(|surface| surface.distance >= 0.0)?;
                surface.measured(normal, offset)
            }
        };
        let push = &self.paths.applied_acceleration;
        let pressed = (push[i] - push[j]).dot(normal);
        let load_speed = constraint.load_speed.max(self.scene.settings.dt * pressed);
        Some(ContactConstraint {
            normal,
            point,
            gap,
            ends_at: f64::INFINITY,
            target: self.speed_to_hover(gap, hover, left, load_speed),
            load_speed,
            ahead: None,
            ..constraint
        })
    }

    /// The speed along the normal with which a gap becomes that of bodies in contact, m/s. A wider gap closes within
    /// `time`; a narrower one opens within some steps if forces close it. The speed is zero for a gap of about the
    /// right size.
    pub(super) fn speed_to_hover(&self, gap: f64, hover: f64, time: f64, load_speed: f64) -> f64 {
        if gap > 4.0 * hover {
            -(gap - hover) / time
        } else if gap < 0.5 * hover && load_speed > 0.0 {
            (hover - gap) / (4.0 * self.scene.settings.dt)
        } else {
            0.0
        }
    }

    /// How the surface of a contact continues below a body that moves over it from an offset with a velocity and an
    /// acceleration. `length` is the duration of the motion, s. `is_at_start` says whether it begins at the start of
    /// the step. `load` is the acceleration that presses the body down, m/s².
    pub(super) fn course_below(
        &self,
        constraint: &ContactConstraint,
        (offset, velocity, acceleration): (DVec3, DVec3, DVec3),
        (length, is_at_start): (f64, bool),
        load: f64,
    ) -> Course {
        let ((i, j), normal) = (constraint.bodies, constraint.normal);
        let hover = self.layout().hover_gap(i, j);
        let level = |v: DVec3| v - normal.dot(v) * normal;
        let (velocity, acceleration) = (level(velocity), level(acceleration));
        let moved = |time: f64| time * (velocity + 0.5 * time * acceleration);
        let way = (length * velocity.length()).max(length * length * acceleration.length());
        if way <= 16.0 * hover
            || self.scene.bodies.is_half_space(i)
            || self.scene.bodies.is_half_space(j)
        {
            return Course::Flat(None);
        }
        let near = 16.0 * hover;
        let radius = |body: usize| match self.scene.bodies.shape(body) {
            Some(&Shape::Sphere { radius }) if radius > 0.0 => radius,
            _ => 0.0,
        };
        let radius = radius(i) + radius(j);
        // By how much rounding changes a normal.
        let turn = match radius > 0.0 {
            true => 1e-12 + 16.0 * self.layout().position_resolution(i, j) / radius,
            false => 1e-12,
        };
        // A surface that rises becomes an impact.
        let has_risen = |time: f64| self.scene.bodies.meet_built(i, j, offset + moved(time));
        // The surface below at a time, or the reason why there is none.
        let below = |time: f64| {
            let surface = self.surface_below(constraint, offset + moved(time), near);
            match surface {
                Some(surface) if (surface.normal - normal).length() <= turn => Below::Flat(surface),
                Some(_) => Below::Other,
                None if has_risen(time) => Below::Risen,
                None => Below::Other,
            }
        };
        match below(length) {
            Below::Flat(surface) => {
                return Course::Flat(Some(surface.measured(normal, offset + moved(length))));
            }
            Below::Risen => return Course::Flat(None),
            Below::Other => {}
        }
        // After this time a normal that turns steadily has turned visibly.
        let soon = (4.0 * turn * radius / way).clamp(1e-5, 0.0625) * length;
        // The normal at a round body must turn by more than rounding. After an event, the surface is not examined
        // immediately.
        let next = if radius > 0.0 { soon } else { 1e-6 * soon };
        let first = if is_at_start { next } else { soon };
        let (mut time, mut now) = (first, below(first));
        for _ in 0..MAX_FEATURES {
            let Below::Flat(surface) = now else { break };
            // When the touching features separate, another feature may continue the plane.
            let there = (
                offset + moved(time),
                velocity + time * acceleration,
                acceleration,
            );
            let Some(after) = self.leaves_after(constraint, &surface, there) else {
                break;
            };
            let end = time + after;
            time = end + next;
            if time >= length {
                return Course::Flat(None);
            }
            now = below(time);
            if matches!(now, Below::Other) {
                return Course::EndsAfter(end);
            }
        }
        if matches!(now, Below::Risen) {
            return Course::Flat(None);
        }
        let slack = 8.0 * self.layout().position_resolution(i, j);
        let mut recession = f64::INFINITY;
        for time in [0.0625 * length, 0.25 * length, length] {
            let reach = 0.5 * load * time * time + near;
            if let Some(surface) = self.surface_below(constraint, offset + moved(time), reach) {
                let followed = time * constraint.target.min(0.0);
                let fallen = surface.distance + followed - constraint.gap - slack;
                let fallen = fallen.max(0.0);
                recession = recession.min(2.0 * fallen / (time * time));
            } else if has_risen(time) {
                recession = 0.0;
            }
            // The body leaves a surface that recedes faster than the load can follow, though the surface may come
            // back.
            if recession >= load {
                return Course::Ended;
            }
        }
        Course::Receding(recession)
    }

    /// The time at which the second body leaves the features that touch, s. It moves in the plane of the contact from
    /// an offset with a velocity and an acceleration.
    fn leaves_after(
        &self,
        constraint: &ContactConstraint,
        surface: &Surface,
        (offset, velocity, acceleration): (DVec3, DVec3, DVec3),
    ) -> Option<f64> {
        let ((i, j), normal) = (constraint.bodies, constraint.normal);
        // The lines that bound the feature, each as a direction across it and the position of the offset along this
        // direction.
        let mut lines: [(DVec3, f64); 4] = [(DVec3::ZERO, 0.0); 4];
        let corner = |body: usize, vertex: u32| {
            self.scene
                .bodies
                .mesh(body)
                .map(|mesh| mesh.vertices()[vertex as usize].as_dvec3())
        };
        let face = |body: usize, face: u32| {
            let mesh = self.scene.bodies.mesh(body)?;
            Some(mesh.corners(face as usize).map(|v| v.as_dvec3()))
        };
        let edge = |body: usize, edge: u32| {
            let ends = self.scene.bodies.mesh(body)?.edges()[edge as usize];
            Some((corner(body, ends[0])?, corner(body, ends[1])?))
        };
        // The corners are subtracted before the offset is added, so that rounding does not depend on which of the
        // bodies is the first.
        let mut bound = |k: usize, along: DVec3, place: DVec3| {
            let across = along.cross(normal);
            lines[k] = (across, across.dot(place));
        };
        match surface.touched {
            Touched::Feature(Feature::FaceVertex { face: of, vertex }) => {
                let (triangle, vertex) = (face(i, of)?, corner(j, vertex)?);
                for k in 0..3 {
                    let along = triangle[(k + 1) % 3] - triangle[k];
                    bound(k, along, (vertex - triangle[k]) + offset);
                }
            }
            Touched::Feature(Feature::VertexFace { vertex, face: of }) => {
                let (triangle, vertex) = (face(j, of)?, corner(i, vertex)?);
                for k in 0..3 {
                    let along = triangle[(k + 1) % 3] - triangle[k];
                    bound(k, along, (triangle[k] - vertex) + offset);
                }
            }
            Touched::Feature(Feature::EdgeEdge { first, second }) => {
                let ((a, b), (c, d)) = (edge(i, first)?, edge(j, second)?);
                bound(0, d - c, (c - a) + offset);
                bound(1, d - c, (c - b) + offset);
                bound(2, b - a, (c - a) + offset);
                bound(3, b - a, (d - a) + offset);
            }
            Touched::Face { body, face: of } => {
                // The centre of a sphere over a face, in the frame of the mesh.
                let (triangle, sign) = (face(body, of)?, if body == i { 1.0 } else { -1.0 });
                for k in 0..3 {
                    let along = triangle[(k + 1) % 3] - triangle[k];
                    bound(k, along, offset - sign * triangle[k]);
                }
            }
            Touched::Nothing => return None,
        }
        let first_root = |&(across, place): &(DVec3, f64)| {
            let (speed, push) = (across.dot(velocity), 0.5 * across.dot(acceleration));
            roots(place, speed, push)
                .into_iter()
                .flatten()
                .filter(|&time| time > 0.0)
                .min_by(f64::total_cmp)
        };
        lines.iter().filter_map(first_root).min_by(f64::total_cmp)
    }

    /// The greater of the accelerations by forces alone of two bodies along their trajectories, m/s².
    pub(super) fn greatest_push(&self, i: usize, j: usize) -> f64 {
        let push = &self.paths.applied_acceleration;
        push[i].length().max(push[j].length())
    }
}

impl ContactSolver<'_> {
    /// Measures the gaps and normals of the contacts left from the last step. Contacts that have opened are removed.
    pub(super) fn measure_contacts(&mut self) -> Result<(), (usize, Cause)> {
        let mut gone = Vec::new();
        for index in self.view().contacts_in_order() {
            let constraint = self.contacts.all()[index];
            let (i, j) = constraint.bodies;
            if constraint.is_overlap {
                if self.scene.stood_still(i) && self.scene.stood_still(j) {
                    continue;
                }
                let start = &self.paths.start.position;
                let out = self.view().layout().penetration(i, j, start[j] - start[i]);
                self.contacts.get_mut(index).normal = out.normal;
                continue;
            }
            match self.view().measured(constraint, self.scene.settings.dt) {
                // A contact that has turned to the normal of another contact of the pair is the same as that one.
                Some(measured) if self.contacts.is_known(&measured, (index, &gone)) => {
                    gone.push(index);
                }
                Some(measured) => {
                    let least = LEAST_GAP * self.view().layout().hover_gap(i, j);
                    if measured.gap < 0.5 * least {
                        let by = (least - measured.gap) * measured.normal;
                        self.move_apart_in_room((i, j), by, 0.0)?;
                    }
                    *self.contacts.get_mut(index) = measured;
                }
                None => gone.push(index),
            }
        }
        let ended = self.contacts.remove_all(gone);
        self.hand_over_all(&ended)?;
        Ok(())
    }
}
