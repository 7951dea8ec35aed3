//! The search for the next impact of two bodies on their trajectories.
//!
//! The exact search handles straight motion only. A curved trajectory is cut into chords that depart from it by at
//! most [`FLATNESS`] of the smaller body. If a chord has an impact, the search cuts the trajectory closely before and
//! after that impact and searches again. The departure falls with the square of the length, so that after a few
//! rounds it is less than rounding, and the impact is one of the trajectory itself. Grazes between chords, shallower
//! than their departure, are found by certificates ([`PairSearch::find_graze`]). Before both, a quick search proves most
//! pairs of meshes apart on their parabola ([`PairSearch::stays_apart`]).
//!
//! No impact is lost between one search and the next, though a sheet has no inside in which a later search could find
//! it. Let `r` be more than all that rounding moves a placed vertex along the normal of a contact, at two positions
//! together ([`PairSearch::rounding`]):
//!
//! - An event is put so early that a distance `r` is left between the bodies. Until then, and when their trajectories
//!   start again, the bodies are before the contact, whatever is rounded. The same holds for a pair of which a third
//!   body has stopped one before its event.
//! - A search goes on beyond the end of the step. A contact found there at a distance of more than `r` is ahead of
//!   the bodies in the next step too, in which they start again with other roundings. A contact at a distance of less
//!   than `r` belongs to this step.
//!
//! The exception is a body that slides past a surface by less than its rounding. The search goes so far beyond the
//! end that it misses such a surface only at an angle of less than 1e-3.

use glam::DVec3;

use super::super::{layout::RESOLUTION_ULPS, stepping::Cause};
use super::{
    event::{Event, EventKind},
    trajectory::Probe,
    view::View,
};
use crate::collide::{
    Contact, Curve, Form, Parabola, first_contact, first_on_parabola, has_roots, snap, stay_apart,
};

/// The departure of a chord from its trajectory that is neglected in the first search, in largest half extents of the
/// smaller body.
const FLATNESS: f64 = 1e-3;
/// The greatest number of chords in a trajectory.
const MAX_CHORDS: f64 = 4096.0;
/// The number of halvings after which a time cannot get more exact.
const MAX_DEPTH: u32 = 64;

/// How far a search goes beyond the end of a step, in roundings.
const BEYOND: f64 = 1024.0;

/// The greatest distance of bodies that touch except for rounding, in resolutions of their positions.
pub(super) const TOUCHING: f64 = 4.0;

/// An end of a chord: its number, the time, s, and the offset then, m.
type Knot = (f64, (f64, DVec3));

/// The search for the next impact of two bodies.
struct PairSearch<'a> {
    view: &'a View<'a>,
    forms: (Form<'a>, Form<'a>),
    i: usize,
    j: usize,
    /// The departure of a chord from the trajectory, m, divided by the square of the chord's duration, s², by
    /// component.
    deviation: DVec3,
    /// Whether the trajectory is a parabola.
    is_parabola: bool,
    /// The rounding of positions, m, by component.
    resolution: DVec3,
    /// Whether a contact constraint already keeps the bodies apart.
    is_in_contact: bool,
    /// Whether both shapes have an inside in which the exact test detects the other one.
    is_solid: bool,
}

impl View<'_> {
    /// The next impact of two bodies within the step, with their positions just before they touch. The trees over
    /// their meshes must be built. The probe counts the work.
    pub(super) fn find_impact(
        &self,
        i: usize,
        j: usize,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        if self.scene.bodies.pair_tumbles(i, j) {
            return self.find_turning_impact((i, j), probe);
        }
        let Some(forms) = self.scene.bodies.forms(i, j) else {
            return Ok(None);
        };
        let deviation = self.motion().deviation_per_time2(i, j);
        let search = PairSearch {
            view: self,
            forms,
            i,
            j,
            deviation,
            is_parabola: deviation != DVec3::ZERO
                && self.motion().coupled_group(i).is_none()
                && self.motion().coupled_group(j).is_none(),
            resolution: self.layout().resolution_by_axis(i, j),
            is_in_contact: !self.contacts.is_empty()
                && self.contacts.of_pair(i, j).next().is_some(),
            is_solid: has_roots(forms.0, forms.1),
        };
        match search.is_parabola && search.is_solid {
            true => search.find_on_parabola(probe),
            false if search.stays_apart(search.end(), search.rounding().length(), probe)? => {
                Ok(None)
            }
            false => {
                let found = search.find_on_chords(probe)?;
                search.find_graze(found, probe)
            }
        }
    }
}

impl PairSearch<'_> {
    /// Whether a quick search proves that two meshes do not meet on their curved trajectory until a time, and that a
    /// distance is left then, m.
    fn stays_apart(
        &self,
        until: f64,
        left: f64,
        probe: &mut Probe,
    ) -> Result<bool, (usize, Cause)> {
        if !self.is_parabola || self.is_in_contact || self.is_straight_until(until) {
            return Ok(false);
        }
        let (Form::Mesh(first), Form::Mesh(second)) = self.forms else {
            return Ok(false);
        };
        let length = until - self.start();
        let [(x1, v1), (x2, v2)] = self.motion_at_start(probe)?;
        let curve = Curve {
            offset: x2 - x1,
            motion: length * (v2 - v1),
            bend: 0.5 * length * length * self.acceleration(),
            left,
        };
        Ok(stay_apart((first, second), &curve))
    }

    /// The positions, m, and velocities, m/s, of both bodies at the start.
    fn motion_at_start(&self, probe: &mut Probe) -> Result<[(DVec3, DVec3); 2], (usize, Cause)> {
        let (motion, start) = (self.view.motion(), self.start());
        let first = motion.motion_at(self.i, start, probe)?;
        Ok([first, motion.motion_at(self.j, start, probe)?])
    }

    /// The acceleration of the second body relative to the first one on a parabola, m/s².
    fn acceleration(&self) -> DVec3 {
        let motion = self.view.motion();
        motion.acceleration_there(self.j) - motion.acceleration_there(self.i)
    }

    /// Whether the trajectory departs from its chord until a time by no more than rounding.
    fn is_straight_until(&self, until: f64) -> bool {
        let length = until - self.start();
        let departure = self.deviation * length * length;
        departure.cmple(self.resolution).all()
    }

    /// The first impact, on trajectories of any kind.
    fn find_on_chords(&self, probe: &mut Probe) -> Result<Option<Event>, (usize, Cause)> {
        let (start, end) = (self.start(), self.end());
        let bodies = self.view.scene.bodies;
        let size = bodies.extent(self.i).half.min(bodies.extent(self.j).half);
        let length = end - start;
        let from = (start, self.offset_at(start, probe)?);
        // A point has no extent, so the length of its trajectory is used instead.
        let size = match size > 0.0 {
            true => size,
            false => (self.offset_at(end, probe)? - from.1).length(),
        };
        let ratio = libm::sqrt(self.deviation.length() / (FLATNESS * size)) * length;
        // The ratio is NaN, from 0/0, if nothing moves.
        let chords = if ratio > 1.0 {
            libm::ceil(ratio).min(MAX_CHORDS)
        } else {
            1.0
        };
        let to = (end, self.offset_at(end, probe)?);
        let departure = self.deviation.length() * length * length;
        let time_of = |knot: f64| start + length * (knot / chords);
        self.find_on_run(((0.0, from), (chords, to)), departure, &time_of, probe)
    }

    /// The first impact; `found` is the one that the search on chords has found, if any. Before it, the trajectory
    /// may dip into the other body between two ends of chords.
    ///
    /// Certificates give a time until which the bodies are proven apart. From there on, the first chord is so short
    /// that it does not depart from the trajectory by more than rounding, and each further one is twice as long, until
    /// certificates prove the bodies apart again. Where the trajectory dips into the other body, a chord ends inside.
    /// If certificates take too much work, chords alone go on.
    fn find_graze(
        &self,
        found: Option<Event>,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let until = found.as_ref().map_or(self.end(), |event| event.time);
        if self.is_in_contact || self.is_straight_until(until) {
            return Ok(found);
        }
        // Without an impact, this has been tried.
        if found.is_some() && self.stays_apart(until, 0.0, probe)? {
            return Ok(found);
        }
        let shortest = libm::sqrt(self.resolution.length() / self.deviation.length());
        let (pair, mut from, mut length) = ((self.i, self.j), self.start(), shortest);
        let mut is_certified = true;
        while from < until {
            let mut near = from;
            if is_certified {
                let span = (from, until);
                let found = self.view.find_certified_impact(pair, span, 1.0, probe)?;
                let Some(found) = found.filter(|found| found.time < until) else {
                    break;
                };
                is_certified = found.kind == EventKind::Impact;
                near = found.time;
            }
            // Bodies apart for less than a chord have stayed near each other.
            if near - from > length {
                length = shortest;
            }
            from = (near + length).min(until);
            let start = (near, self.offset_at(near, probe)?);
            let end = (from, self.offset_at(from, probe)?);
            if let Some(event) = self.find_on_chord((start, end), 0, probe)? {
                return Ok(Some(event));
            }
            length *= 2.0;
        }
        Ok(found)
    }

    /// The first impact on a run of chords between two knots, from whose straight line the trajectory departs by
    /// `departure`, m.
    ///
    /// If the bodies are so far apart on the line that they cannot be near on the trajectory, no chord is searched.
    /// So the cost is the logarithm of the number of chords, and the chords on which the bodies are near.
    fn find_on_run(
        &self,
        (from, to): (Knot, Knot),
        departure: f64,
        time_of: &dyn Fn(f64) -> f64,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let chords = to.0 - from.0;
        if chords <= 1.0 {
            return self.find_on_chord((from.1, to.1), 0, probe);
        }
        let motion = to.1.1 - from.1.1;
        if self.is_far_on_chord(from.1.1, motion, departure) {
            return Ok(None);
        }
        let number = from.0 + libm::floor(0.5 * chords);
        let time = time_of(number);
        let middle = (number, (time, self.offset_at(time, probe)?));
        // On a parabola a quarter of the departure remains. For other trajectories, the departure seen at the middle
        // is used if it is greater.
        let part = (time - from.1.0) / (to.1.0 - from.1.0);
        let seen = (middle.1.1 - (from.1.1 + part * motion)).length();
        let departure = seen.max(0.25 * departure);
        match self.find_on_run((from, middle), departure, time_of, probe)? {
            Some(event) => Ok(Some(event)),
            None => self.find_on_run((middle, to), departure, time_of, probe),
        }
    }

    /// Whether two bodies are nowhere near each other within `departure`, m, of a chord.
    fn is_far_on_chord(&self, from: DVec3, motion: DVec3, departure: f64) -> bool {
        let reach = |body: usize| self.view.scene.bodies.extent(body).reach.length();
        let (first, second) = self.forms;
        let (apart, reach) = match (first, second) {
            (Form::HalfSpace(n), _) => (n.dot(from).min(n.dot(from + motion)), reach(self.j)),
            (_, Form::HalfSpace(n)) => (-n.dot(from).max(n.dot(from + motion)), reach(self.i)),
            _ => (
                nearest_on_chord(from, motion),
                reach(self.i) + reach(self.j),
            ),
        };
        // Twice the reach, because of rounding. The last term is how far a search goes beyond the end of the step.
        apart > 2.0 * reach + departure + BEYOND * self.rounding().length()
    }

    /// The factor by which a motion is lengthened that ends at the end of the step, so that the search goes beyond
    /// it.
    fn stretch(&self, motion: DVec3) -> f64 {
        let way = motion.abs().max_element();
        let beyond = BEYOND * self.rounding().max_element();
        // No farther beyond the end than the motion of the step.
        if beyond < way {
            1.0 + beyond / way
        } else {
            2.0
        }
    }

    /// The impact with a contact beyond the end of a chord, if only a rounding is left to it.
    fn find_at_end(
        &self,
        (from, to): ((f64, DVec3), (f64, DVec3)),
        contact: Contact,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let length = to.0 - from.0;
        let fall = -contact.normal.dot(to.1 - from.1);
        let left = (contact.time - 1.0) * fall;
        let room = self.room(contact.normal);
        if left > room {
            return Ok(None);
        }
        let times = (from.0, from.0 + contact.time * length);
        self.back_off(times, (fall / length, room), contact, probe)
            .map(Some)
    }

    /// The first impact on parabolas, of shapes with closed forms.
    fn find_on_parabola(&self, probe: &mut Probe) -> Result<Option<Event>, (usize, Cause)> {
        let start = self.start();
        let [(x1, v1), (x2, v2)] = self.motion_at_start(probe)?;
        let still = 8.0 * f64::EPSILON * (v1.length() + v2.length());
        // Bodies in contact have a gap and do not count as touching.
        let (first, second) = self.forms;
        let touching = match (self.is_in_contact, first, second) {
            (true, ..) => 0.0,
            (_, Form::HalfSpace(normal), _) | (_, _, Form::HalfSpace(normal)) => {
                along(self.resolution, normal)
            }
            _ => self.resolution.max_element(),
        };
        let parabola = Parabola {
            offset: x2 - x1,
            velocity: v2 - v1,
            acceleration: self.acceleration(),
            grain: (touching, still),
        };
        let length = self.end() - start;
        let Some(contact) = first_on_parabola(first, second, &parabola, length) else {
            return Ok(None);
        };
        let closing = parabola.closing(contact.time, contact.normal);
        let times = (start, start + contact.time);
        let approach = (closing, self.room(contact.normal));
        self.back_off(times, approach, contact, probe).map(Some)
    }

    /// The first impact on a part of the trajectory. The part is given by the times and offsets of its ends.
    fn find_on_chord(
        &self,
        (from, to): ((f64, DVec3), (f64, DVec3)),
        depth: u32,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let motion = to.1 - from.1;
        let goes_on = to.0 == self.end() && !self.is_solid;
        let stretch = if goes_on { self.stretch(motion) } else { 1.0 };
        let found = first_contact(
            self.forms.0,
            self.forms.1,
            snap(from.1),
            snap(stretch * motion),
        );
        let Some(mut contact) = found else {
            return Ok(None);
        };
        contact.time *= stretch;
        if contact.time > 1.0 {
            return self.find_at_end((from, to), contact, probe);
        }
        let length = to.0 - from.0;
        let fall = -contact.normal.dot(motion);
        let departure = self.deviation * length * length;
        // A departure of less than the rounding of the motion counts as rounding too.
        let unseen = self.resolution + RESOLUTION_ULPS * f64::EPSILON * motion.abs();
        let is_straight = departure.cmple(unseen).all() || depth == MAX_DEPTH;
        let departure = departure.length();
        let is_there = contact.time * fall <= TOUCHING * along(self.resolution, contact.normal)
            && from.0 == self.start()
            && self.is_closing(contact.normal, probe);
        if is_straight || is_there {
            let part = if is_there { 0.0 } else { contact.time };
            let times = (from.0, from.0 + part * length);
            let approach = (fall / length, self.room(contact.normal));
            return self.back_off(times, approach, contact, probe).map(Some);
        }
        // The impact of the trajectory is within `about` of the impact of the chord, unless the bodies slip past each
        // other.
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
                false => (end, self.offset_at(end, probe)?),
            };
            if let Some(event) = self.find_on_chord((from, part), depth + 1, probe)? {
                return Ok(Some(event));
            }
            from = part;
        }
        Ok(None)
    }

    /// The last time before a contact, up to rounding, at which there is `room` between two bodies. It is not before
    /// `start`. The bodies touch at the time `touching` and close at the speed `closing`.
    fn back_off(
        &self,
        (start, touching): (f64, f64),
        (closing, room): (f64, f64),
        contact: Contact,
        probe: &mut Probe,
    ) -> Result<Event, (usize, Cause)> {
        let (i, j) = (self.i, self.j);
        // By the closing speed or, if that is almost zero, by the curvature of the trajectory.
        let back = (room / closing).min(libm::sqrt(
            room / (4.0 * along(self.deviation, contact.normal)),
        ));
        let mut back = back.max(f64::MIN_POSITIVE);
        let bodies = self.view.scene.bodies;
        if bodies.extent(i).half.max(bodies.extent(j).half) == 0.0 {
            // Points that have passed each other by a rounding of the time are not in overlap.
            back = back.max(RESOLUTION_ULPS * f64::EPSILON * touching);
        }
        let (last, mut time) = (self.end().next_down(), touching);
        while time > start {
            time = (touching - back).min(last).max(start);
            back *= 2.0;
            let offset = self.offset_at(time, probe)?;
            if !self.view.scene.bodies.meet_built(i, j, offset) {
                break;
            }
        }
        let (place, _) = self.view.motion().motion_at(i, time, probe)?;
        let contact = Contact {
            point: place + contact.point,
            ..contact
        };
        let version = &self.view.paths.version;
        Ok(Event::impact(time, (i, j), contact, room, version))
    }

    /// The distance at which bodies are kept from each other at their impact, m.
    fn room(&self, normal: DVec3) -> f64 {
        // Bodies that nothing presses together separate at once, and need less room.
        let resolution = along(self.resolution, normal);
        let least = match self.is_pressed() {
            true => resolution,
            false => 0.0625 * resolution,
        };
        match self.is_solid {
            true => least,
            false => least.max(along(self.rounding(), normal)),
        }
    }

    /// A bound on how far rounding moves a placed vertex of a pair relative to the other body, at two positions
    /// together, by component, m.
    ///
    /// With `u = 2^-53`, positions of up to `x`, motions of up to `d` since the start of a trajectory and vertices of
    /// up to `s`, each body has an error of `u (x + 4 d)` in the sum of its position. The pair has errors of
    /// `u (x + x)` in its offset, of `u (x + x + s)` in the vertex, and of `u (3 d + 3 d)` in the chord, the time and
    /// the part of it. The second position is the one at which the search has placed the vertices, without errors of
    /// motion.
    fn rounding(&self) -> DVec3 {
        let of = |body: usize| {
            let paths = self.view.paths;
            let (from, to) = (paths.start.position[body], paths.end.position[body]);
            let bend = 4.0 * self.view.motion().chord_deviation(body);
            let (place, motion) = (from.abs().max(to.abs()) + bend, (to - from).abs() + bend);
            5.0 * place + 7.0 * motion + 2.0 * self.view.scene.bodies.extent(body).reach
        };
        0.5 * f64::EPSILON * (of(self.i) + of(self.j))
    }

    fn offset_at(&self, time: f64, probe: &mut Probe) -> Result<DVec3, (usize, Cause)> {
        let first = self.view.motion().motion_at(self.i, time, probe)?.0;
        Ok(self.view.motion().motion_at(self.j, time, probe)?.0 - first)
    }

    /// Whether forces may change the speed at which two bodies close.
    fn is_pressed(&self) -> bool {
        let (i, j) = (self.i, self.j);
        let push = &self.view.paths.acceleration;
        self.view.motion().coupled_group(i).is_some()
            || self.view.motion().coupled_group(j).is_some()
            || push[i] != push[j]
    }

    fn start(&self) -> f64 {
        self.view.paths.since[self.i].max(self.view.paths.since[self.j])
    }

    /// The time until which both trajectories are known, s from the step's start.
    fn end(&self) -> f64 {
        self.view
            .motion()
            .horizon(self.i)
            .min(self.view.motion().horizon(self.j))
    }

    /// Whether two bodies do not separate along a normal at the start of their common trajectory.
    fn is_closing(&self, normal: DVec3, probe: &mut Probe) -> bool {
        let start = self.start();
        let mut velocity = |body| {
            self.view
                .motion()
                .motion_at(body, start, probe)
                .map(|(_, v)| v)
        };
        let velocities = velocity(self.i).ok().zip(velocity(self.j).ok());
        velocities.is_some_and(|(v1, v2)| {
            (v2 - v1).dot(normal) <= 8.0 * f64::EPSILON * (v1.length() + v2.length())
        })
    }
}

/// The distance of a chord from the origin.
pub(super) fn nearest_on_chord(from: DVec3, motion: DVec3) -> f64 {
    let way = motion.length_squared();
    let part = match way > 0.0 {
        true => (-from.dot(motion) / way).clamp(0.0, 1.0),
        false => 0.0,
    };
    (from + part * motion).length()
}

/// The greatest length along a normal of a vector whose components are bounded by `sizes`.
fn along(sizes: DVec3, normal: DVec3) -> f64 {
    normal.abs().dot(sizes)
}
