//! When two bodies on their trajectories have their next impact.
//!
//! Geometry knows straight motion. A trajectory that bends is cut where its chord would depart from it
//! by more than [`FLATNESS`] of the smaller body; what is shallower may be missed for the rest of
//! the step, and only that. Where a chord has an impact, the trajectory is cut closely before and
//! after it and searched again: the departure falls with the square of the length, so that after a
//! few rounds it is lost in the rounding, and the impact is one of the trajectory itself.
//!
//! No impact is lost between one search and the next, though a sheet has no inside in which it could
//! be found later. Let `r` be more than all that rounding moves a placed vertex by along the normal of
//! a contact, in two places together ([`World::rounding`]):
//!
//! - An event is put so early that `r` is left between the bodies. Until then, and where they start
//!   again, each is before the contact, whatever is rounded. So is a pair of which a third body has
//!   stopped one before its event.
//! - A search goes on beyond the end of the step. A contact that it meets there with more than `r`
//!   to go is before the bodies in the next step, where they start anew and round anew; one with
//!   less belongs to this step.
//!
//! What slides past a surface by less than its rounding is the exception: a search goes so far beyond
//! the end that it takes an angle of less than 1e-3 to a surface for that not to be seen.

use glam::DVec3;

use super::super::{World, stepping::Cause};
use super::{Event, EventKind, Outcome, Probe};
use crate::{
    Shape,
    collide::{Contact, Form, Parabola, first_contact, first_on_parabola, has_roots, snap},
};

/// Departure of a chord from its trajectory that is looked past, in largest half extents of the
/// smaller body.
const FLATNESS: f64 = 1e-3;
/// Chords in a trajectory at most.
const MAX_CHORDS: f64 = 4096.0;
/// Halvings after which a time is as good as it gets.
const MAX_DEPTH: u32 = 64;
/// Rounding of placed vertices, in units in the last place of the largest coordinate about, that
/// two bodies are kept apart by at an impact.
const RESOLUTION_ULPS: f64 = 4.0;
/// The same where a sphere meets triangles, whose distance is computed (`collide/ball.rs`): more than
/// its error, so that a point stays on its side of a surface.
const SPHERE_MESH_ULPS: f64 = 64.0;

/// How far a search goes beyond the end of a step, in roundings.
const BEYOND: f64 = 1024.0;

/// How far apart bodies may be that touch but for rounding, in resolutions of their positions.
pub(super) const TOUCHING: f64 = 4.0;

/// A pair of bodies in search of its next impact.
#[derive(Clone, Copy)]
struct Pair {
    i: usize,
    j: usize,
    /// Departure of a chord from the trajectory, m, per square of its length, s², by component.
    deviation: DVec3,
    /// What rounding may be, m, by component.
    resolution: DVec3,
    /// Whether a contact constraint keeps them apart already.
    is_in_contact: bool,
    /// Whether both have an inside, in which the exact test sees the other one.
    is_solid: bool,
}

impl World {
    /// The next impact of two bodies within the step, and where they are just before they touch.
    /// The trees over their meshes must be there.
    pub(super) fn find_impact(
        &self,
        i: usize,
        j: usize,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let Some(forms) = self.bodies.forms(i, j) else {
            return Ok(None);
        };
        let pair = Pair {
            i,
            j,
            deviation: self.deviation_per_time2(i, j),
            resolution: self.resolution_by_axis(i, j),
            is_in_contact: !self.contacts.is_empty()
                && self.contacts.of_pair(i, j).next().is_some(),
            is_solid: has_roots(forms.0, forms.1),
        };
        let is_parabola = pair.deviation != DVec3::ZERO
            && self.coupled_group(i).is_none()
            && self.coupled_group(j).is_none();
        match is_parabola && pair.is_solid {
            true => self.find_on_parabola(pair, forms, probe),
            false => self.find_on_chords(pair, forms, probe),
        }
    }

    /// The first impact on trajectories of any kind.
    fn find_on_chords(
        &self,
        pair: Pair,
        forms: (Form<'_>, Form<'_>),
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let (start, end) = (self.start_of(pair), self.end_of(pair));
        let size = self
            .bodies
            .extent(pair.i)
            .half
            .min(self.bodies.extent(pair.j).half);
        let length = end - start;
        let mut from = (start, self.offset_at(pair, start, probe)?);
        // A point has no extent: its trajectory must do.
        let size = match size > 0.0 {
            true => size,
            false => (self.offset_at(pair, end, probe)? - from.1).length(),
        };
        let ratio = libm::sqrt(pair.deviation.length() / (FLATNESS * size)) * length;
        // 0/0 where nothing moves.
        let chords = if ratio > 1.0 {
            libm::ceil(ratio).min(MAX_CHORDS)
        } else {
            1.0
        };
        let mut chord = 1.0;
        while chord <= chords {
            let time = if chord == chords {
                end
            } else {
                start + length * (chord / chords)
            };
            let to = (time, self.offset_at(pair, time, probe)?);
            if let Some(event) = self.find_on_chord(pair, forms, (from, to), 0, probe)? {
                return Ok(Some(event));
            }
            (from, chord) = (to, chord + 1.0);
        }
        Ok(None)
    }

    /// How much longer than a motion to the end of the step is one that goes on beyond it.
    fn stretch(&self, pair: Pair, motion: DVec3) -> f64 {
        let way = motion.abs().max_element();
        let beyond = BEYOND * self.rounding(pair).max_element();
        // Not farther than in a step.
        if beyond < way {
            1.0 + beyond / way
        } else {
            2.0
        }
    }

    /// The impact with a contact beyond the end of a chord, if there is only a rounding between.
    fn find_at_end(
        &self,
        pair: Pair,
        (from, to): ((f64, DVec3), (f64, DVec3)),
        contact: Contact,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let length = to.0 - from.0;
        let fall = -contact.normal.dot(to.1 - from.1);
        let left = (contact.time - 1.0) * fall;
        let room = self.room(pair, contact.normal);
        if left > room {
            return Ok(None);
        }
        let times = (from.0, from.0 + contact.time * length);
        self.back_off(pair, times, (fall / length, room), contact, probe)
            .map(Some)
    }

    /// The first impact on trajectories that are parabolas, of shapes with closed forms.
    fn find_on_parabola(
        &self,
        pair: Pair,
        (first, second): (Form<'_>, Form<'_>),
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let start = self.start_of(pair);
        let (x1, v1) = self.motion_at(pair.i, start, probe)?;
        let (x2, v2) = self.motion_at(pair.j, start, probe)?;
        let still = 8.0 * f64::EPSILON * (v1.length() + v2.length());
        // What is in contact has its gap, and need not be brought to touch.
        let touching = match (pair.is_in_contact, first, second) {
            (true, ..) => 0.0,
            (_, Form::HalfSpace(normal), _) | (_, _, Form::HalfSpace(normal)) => {
                along(pair.resolution, normal)
            }
            _ => pair.resolution.max_element(),
        };
        let parabola = Parabola {
            offset: x2 - x1,
            velocity: v2 - v1,
            acceleration: self.acceleration_there(pair.j) - self.acceleration_there(pair.i),
            grain: (touching, still),
        };
        let length = self.end_of(pair) - start;
        let Some(contact) = first_on_parabola(first, second, &parabola, length) else {
            return Ok(None);
        };
        let closing = parabola.closing(contact.time, contact.normal);
        let times = (start, start + contact.time);
        let approach = (closing, self.room(pair, contact.normal));
        self.back_off(pair, times, approach, contact, probe)
            .map(Some)
    }

    /// The first impact on a part of the trajectory, given as times and offsets of its ends.
    fn find_on_chord(
        &self,
        pair: Pair,
        forms: (Form<'_>, Form<'_>),
        (from, to): ((f64, DVec3), (f64, DVec3)),
        depth: u32,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let motion = to.1 - from.1;
        let goes_on = to.0 == self.end_of(pair) && !pair.is_solid;
        let stretch = if goes_on {
            self.stretch(pair, motion)
        } else {
            1.0
        };
        let found = first_contact(forms.0, forms.1, snap(from.1), snap(stretch * motion));
        let Some(mut contact) = found else {
            return Ok(None);
        };
        contact.time *= stretch;
        if contact.time > 1.0 {
            return self.find_at_end(pair, (from, to), contact, probe);
        }
        let length = to.0 - from.0;
        let fall = -contact.normal.dot(motion);
        let departure = pair.deviation * length * length;
        // Less than that of what is moved is rounding as well.
        let unseen = pair.resolution + RESOLUTION_ULPS * f64::EPSILON * motion.abs();
        let is_straight = departure.cmple(unseen).all() || depth == MAX_DEPTH;
        let departure = departure.length();
        let is_there = contact.time * fall <= TOUCHING * along(pair.resolution, contact.normal)
            && from.0 == self.start_of(pair)
            && self.is_closing(pair, contact.normal, probe);
        if is_straight || is_there {
            let part = if is_there { 0.0 } else { contact.time };
            let times = (from.0, from.0 + part * length);
            let approach = (fall / length, self.room(pair, contact.normal));
            return self
                .back_off(pair, times, approach, contact, probe)
                .map(Some);
        }
        // Within this of the chord's impact lies the trajectory's, unless it slips past.
        let time = from.0 + contact.time * length;
        let about = 2.0 * departure * length / fall;
        let (mut before, mut after) = (time - about, time + about);
        if about >= 0.25 * length {
            (before, after) = (from.0, from.0 + 0.5 * length);
        }
        let mut from = from;
        for end in [before.max(from.0), after.min(to.0), to.0] {
            if end <= from.0 {
                continue;
            }
            let part = match end == to.0 {
                true => to,
                false => (end, self.offset_at(pair, end, probe)?),
            };
            if let Some(event) = self.find_on_chord(pair, forms, (from, part), depth + 1, probe)? {
                return Ok(Some(event));
            }
            from = part;
        }
        Ok(None)
    }

    /// The last time before a contact, but for rounding, at which there is room between two bodies: not
    /// before a start, and from a time on at which they touch and close at a speed.
    fn back_off(
        &self,
        pair: Pair,
        (start, touching): (f64, f64),
        (closing, room): (f64, f64),
        contact: Contact,
        probe: &mut Probe,
    ) -> Result<Event, (usize, Cause)> {
        let Pair { i, j, .. } = pair;
        // By their speed, or where there is hardly any by the trajectory's bend.
        let back = (room / closing).min(libm::sqrt(
            room / (4.0 * along(pair.deviation, contact.normal)),
        ));
        let mut back = back.max(f64::MIN_POSITIVE);
        if self.bodies.extent(i).half.max(self.bodies.extent(j).half) == 0.0 {
            // Points that have passed each other by a rounding of the time do not meet.
            back = back.max(RESOLUTION_ULPS * f64::EPSILON * touching);
        }
        let (last, mut time) = (self.end_of(pair).next_down(), touching);
        while time > start {
            time = (touching - back).min(last).max(start);
            back *= 2.0;
            let offset = self.offset_at(pair, time, probe)?;
            if !self.bodies.meet_built(i, j, offset) {
                break;
            }
        }
        let (place, _) = self.motion_at(i, time, probe)?;
        let version = &self.continuous.version;
        Ok(Event {
            time,
            bodies: (i, j),
            versions: (version[i], version[j]),
            kind: EventKind::Impact,
            outcome: Outcome::Bounce,
            load_speed: 0.0,
            gap: room,
            contact: Contact {
                point: place + contact.point,
                ..contact
            },
        })
    }

    /// How far from a contact bodies are kept at their impact, m.
    fn room(&self, pair: Pair, normal: DVec3) -> f64 {
        // Bodies that nothing presses together part at once, and need no room to stay in.
        let resolution = along(pair.resolution, normal);
        let least = match self.are_pressed(pair.i, pair.j) {
            true => resolution,
            false => 0.0625 * resolution,
        };
        match pair.is_solid {
            true => least,
            false => least.max(along(self.rounding(pair), normal)),
        }
    }

    /// More than rounding moves a placed vertex of a pair against the other body by, in two places
    /// together, by component, m.
    ///
    /// With `u = 2^-53`, positions of up to `x`, motions of up to `d` since the start of a trajectory
    /// and vertices of up to `s`, each body has errors of `u (x + 4 d)` where its position is summed
    /// up, the pair of `u (x + x)` in its offset, of `u (x + x + s)` in the vertex, and of
    /// `u (3 d + 3 d)` in the chord, the time and the part of it. The second place is the one in
    /// which the search has placed the vertices, without errors of motion.
    fn rounding(&self, pair: Pair) -> DVec3 {
        let of = |body: usize| {
            let continuous = &self.continuous;
            let (from, to) = (continuous.start.position[body], self.current.position[body]);
            let bend = 4.0 * self.chord_deviation(body);
            let (place, motion) = (from.abs().max(to.abs()) + bend, (to - from).abs() + bend);
            5.0 * place + 7.0 * motion + 2.0 * self.bodies.extent(body).reach
        };
        0.5 * f64::EPSILON * (of(pair.i) + of(pair.j))
    }

    fn offset_at(&self, pair: Pair, time: f64, probe: &mut Probe) -> Result<DVec3, (usize, Cause)> {
        let first = self.motion_at(pair.i, time, probe)?.0;
        Ok(self.motion_at(pair.j, time, probe)?.0 - first)
    }

    /// Whether forces may change the speed at which two bodies come together.
    fn are_pressed(&self, i: usize, j: usize) -> bool {
        let push = &self.continuous.acceleration;
        self.coupled_group(i).is_some() || self.coupled_group(j).is_some() || push[i] != push[j]
    }

    fn start_of(&self, pair: Pair) -> f64 {
        self.continuous.since[pair.i].max(self.continuous.since[pair.j])
    }

    /// Until when the trajectories of both are known, s from the step's start.
    fn end_of(&self, pair: Pair) -> f64 {
        self.horizon(pair.i).min(self.horizon(pair.j))
    }

    /// Whether two bodies at the start of their common trajectory do not part along a normal.
    fn is_closing(&self, pair: Pair, normal: DVec3, probe: &mut Probe) -> bool {
        let start = self.start_of(pair);
        let mut velocity = |body| self.motion_at(body, start, probe).map(|(_, v)| v);
        let velocities = velocity(pair.i).ok().zip(velocity(pair.j).ok());
        velocities.is_some_and(|(v1, v2)| {
            (v2 - v1).dot(normal) <= 8.0 * f64::EPSILON * (v1.length() + v2.length())
        })
    }

    /// What the rounding of positions and placed vertices, and of distances from triangles, may be, m.
    pub(super) fn position_resolution(&self, i: usize, j: usize) -> f64 {
        self.resolution_by_axis(i, j).max_element()
    }

    /// The same along a normal: a body that is long along one axis rounds no more along another.
    pub(super) fn resolution_along(&self, i: usize, j: usize, normal: DVec3) -> f64 {
        along(self.resolution_by_axis(i, j), normal)
    }

    fn resolution_by_axis(&self, i: usize, j: usize) -> DVec3 {
        let (from, to) = (&self.previous.position, &self.current.position);
        let at = |body: usize| from[body].abs().max(to[body].abs());
        let far = |body: usize| at(body) + self.bodies.extent(body).reach;
        let far = far(i) + far(j);
        match (self.bodies.shape(i), self.bodies.shape(j)) {
            // A distance is a sum over all axes.
            (Some(Shape::Mesh(_)), Some(Shape::Sphere { .. }))
            | (Some(Shape::Sphere { .. }), Some(Shape::Mesh(_))) => {
                DVec3::splat(SPHERE_MESH_ULPS * f64::EPSILON * far.max_element())
            }
            _ => RESOLUTION_ULPS * f64::EPSILON * far,
        }
    }
}

/// The most that components of some sizes are together along a normal.
fn along(sizes: DVec3, normal: DVec3) -> f64 {
    normal.abs().dot(sizes)
}
