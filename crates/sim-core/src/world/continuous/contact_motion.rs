//! How contacts go on: their gaps where a step starts, and where what slides leaves what it slides on.
//!
//! Bodies in contact hover a little above each other ([`Layout::hover_gap`](super::super::layout::Layout::hover_gap)), farther than rounding and
//! an iterative solver move them in a step, so that the search for impacts does not see the surface
//! they lie on and sees every other one. All is asked of the same exact search: a contact is there
//! where a short motion against its normal is stopped, and its gap is the length of that motion.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::stepping::Cause;
use super::{contact_set::ContactConstraint, solver::ContactSolver, view::View};
use crate::{
    Feature, Shape,
    collide::{first_contact, snap},
};

/// Part of that gap at which a contact begins.
pub(super) const LEAST_GAP: f64 = 1.0 / 8.0;

/// Features of a plane that are followed in a step; what slides farther is asked again there.
const MAX_FEATURES: usize = 4096;

/// What is asked of a surface again and again.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    /// How far below, m.
    pub(super) distance: f64,
    pub(super) normal: DVec3,
    pub(super) touched: Touched,
    /// Where it was touched, from the first body, m.
    pub(super) point: DVec3,
}

impl Surface {
    /// The gap to the plane that is met there along a normal, m, that plane's normal and the point.
    fn along(&self, normal: DVec3) -> (f64, DVec3, DVec3) {
        let gap = self.distance * self.normal.dot(normal);
        (gap, self.normal, self.point)
    }
}

/// What of two bodies touches.
#[derive(Clone, Copy)]
pub(super) enum Touched {
    Feature(Feature),
    /// A sphere a triangle of the mesh of a body.
    Face {
        body: usize,
        face: u32,
    },
    Nothing,
}

/// What is below a body that moves over another one.
enum Below {
    /// The same plane.
    Flat(Surface),
    /// What rises above the plane.
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

/// How a surface goes on below what slides over it.
pub(super) enum Course {
    /// It keeps its normal.
    Flat,
    /// It falls away by this acceleration, m/s².
    Receding(f64),
    /// It is left behind, or begins to turn, at this time after the start, s.
    EndsAfter(f64),
    /// It is left behind now.
    Ended,
}

impl View<'_> {
    /// The height of a flight that is too short to be one, m, and its speed, m/s, under an
    /// acceleration, m/s²: up for half of the time, and down for the other.
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

    /// What is within reach of the second body of a pair against a normal, from an offset on. Other
    /// contacts of the pair are lifted off first, as they would stop it too.
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

    /// A contact as it is where the trajectories of its bodies start, if it still is one, with so much of
    /// the step left, s.
    pub(super) fn measured(
        &self,
        constraint: ContactConstraint,
        left: f64,
    ) -> Option<ContactConstraint> {
        let (i, j) = constraint.bodies;
        let hover = self.layout().hover_gap(i, j);
        let is_bundled = self.contacts.is_bundled(i) || self.contacts.is_bundled(j);
        let (height, _) = self.shortest_hop((i, j), self.greatest_push(i, j), is_bundled);
        let start = &self.paths.start;
        let closing = (start.velocity[i] - start.velocity[j]).dot(constraint.normal);
        let reach = match is_bundled {
            // As far as it may come in this step.
            true => 4.0 * height + left * closing.max(0.0),
            false => height,
        };
        let offset = start.position[j] - start.position[i];
        // Most are as near as contacts are kept, and the farther one looks, the more else is in the way.
        let near = 8.0 * hover;
        let (gap, normal, point) = match self.surface_below(&constraint, offset, near) {
            // Bodies do not meet. What seems to be above where they are is another surface, through which
            // they have been lifted, and nothing is known of this one but that they touched.
            Some(below) if below.distance < 0.0 => (0.0, constraint.normal, constraint.point),
            Some(below) => below.along(constraint.normal),
            None if reach <= near => return None,
            None => {
                let below = self.surface_below(&constraint, offset, reach)?;
                if below.distance < 0.0 {
                    return None;
                }
                below.along(constraint.normal)
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
            ..constraint
        })
    }

    /// Speed along its normal with which a gap becomes the one of contacts, m/s: a wider one within a
    /// time, a narrower one within some steps if forces close it, none where it is about that.
    pub(super) fn speed_to_hover(&self, gap: f64, hover: f64, time: f64, load_speed: f64) -> f64 {
        if gap > 4.0 * hover {
            -(gap - hover) / time
        } else if gap < 0.5 * hover && load_speed > 0.0 {
            (hover - gap) / (4.0 * self.scene.settings.dt)
        } else {
            0.0
        }
    }

    /// How the surface of a contact goes on below a body that moves over it from an offset on with a
    /// velocity and an acceleration, for a time, from the start of the step or not, while a load presses it down.
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
            return Course::Flat;
        }
        let near = 16.0 * hover;
        let radius = |body: usize| match self.scene.bodies.shape(body) {
            Some(&Shape::Sphere { radius }) if radius > 0.0 => radius,
            _ => 0.0,
        };
        let radius = radius(i) + radius(j);
        // What rounding turns a normal by.
        let turn = match radius > 0.0 {
            true => 1e-12 + 16.0 * self.layout().position_resolution(i, j) / radius,
            false => 1e-12,
        };
        // A surface that rises is an impact to come.
        let has_risen = |time: f64| self.scene.bodies.meet_built(i, j, offset + moved(time));
        // The feature that touches at a time, or why there is none.
        let below = |time: f64| {
            let surface = self.surface_below(constraint, offset + moved(time), near);
            match surface {
                Some(surface) if (surface.normal - normal).length() <= turn => Below::Flat(surface),
                Some(_) => Below::Other,
                None if has_risen(time) => Below::Risen,
                None => Below::Other,
            }
        };
        if !matches!(below(length), Below::Other) {
            return Course::Flat;
        }
        // What turns all the time is seen to have turned after this.
        let soon = (4.0 * turn * radius / way).clamp(1e-5, 0.0625) * length;
        // What is round has to turn by more than rounding; what goes on after an event is not asked at once.
        let next = if radius > 0.0 { soon } else { 1e-6 * soon };
        let first = if is_at_start { next } else { soon };
        let (mut time, mut now) = (first, below(first));
        for _ in 0..MAX_FEATURES {
            let Below::Flat(surface) = now else { break };
            // Where what touches leaves what it touches, another feature may go on in the plane.
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
                return Course::Flat;
            }
            now = below(time);
            if matches!(now, Below::Other) {
                return Course::EndsAfter(end);
            }
        }
        if matches!(now, Below::Risen) {
            return Course::Flat;
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
            // What falls away faster than the load follows is left behind, though it may come back.
            if recession >= load {
                return Course::Ended;
            }
        }
        Course::Receding(recession)
    }

    /// When the second of two bodies, which moves in the plane of their contact from an offset on with a
    /// velocity and an acceleration, leaves the feature that they touch with, s.
    fn leaves_after(
        &self,
        constraint: &ContactConstraint,
        surface: &Surface,
        (offset, velocity, acceleration): (DVec3, DVec3, DVec3),
    ) -> Option<f64> {
        let ((i, j), normal) = (constraint.bodies, constraint.normal);
        // Lines that bound the feature, as a direction across and how far the offset is along it.
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
        // Corners come before the offset, so that rounding is the same whichever of the bodies is the first.
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
                // The middle of a sphere over a face, as seen from the mesh.
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

    /// The greater of what forces alone do to two bodies all along their trajectories, m/s².
    pub(super) fn greatest_push(&self, i: usize, j: usize) -> f64 {
        let push = &self.paths.applied_acceleration;
        push[i].length().max(push[j].length())
    }
}

impl ContactSolver<'_> {
    /// Looks at the contacts that the last step has left: their gaps and normals now. Those that have
    /// opened are no more, nor are those that close so fast that they bounce.
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
                // What has turned to the normal of another contact of the pair is that one.
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
