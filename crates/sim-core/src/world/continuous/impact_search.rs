//! When two bodies on their trajectories have their next impact.
//!
//! The exact search knows straight motion only. A trajectory that bends is cut into chords that depart from it
//! by at most [`FLATNESS`] of the smaller body. Where a chord has an impact, the trajectory is cut closely before and
//! after it and searched again: the departure falls with the square of the length, so that after a
//! few rounds it is lost in the rounding, and the impact is one of the trajectory itself. Grazes between chords,
//! shallower than their departure, are found by certificates ([`PairSearch::find_graze`]).
//!
//! No impact is lost between one search and the next, though a sheet has no inside in which it could
//! be found later. Let `r` be more than all that rounding moves a placed vertex by along the normal of
//! a contact, in two places together ([`PairSearch::rounding`]):
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

use super::super::{layout::RESOLUTION_ULPS, stepping::Cause};
use super::{event::Event, trajectory::Probe, view::View};
use crate::collide::{Contact, Form, Parabola, first_contact, first_on_parabola, has_roots, snap};

/// Departure of a chord from its trajectory that is looked past, in largest half extents of the
/// smaller body.
const FLATNESS: f64 = 1e-3;
/// Chords in a trajectory at most.
const MAX_CHORDS: f64 = 4096.0;
/// Halvings after which a time is as good as it gets.
const MAX_DEPTH: u32 = 64;

/// How far a search goes beyond the end of a step, in roundings.
const BEYOND: f64 = 1024.0;

/// How far apart bodies may be that touch but for rounding, in resolutions of their positions.
pub(super) const TOUCHING: f64 = 4.0;

/// An end of chords: its number, the time, s, and the offset there, m.
type Knot = (f64, (f64, DVec3));

/// The search for the next impact of two bodies.
struct PairSearch<'a> {
    view: &'a View<'a>,
    forms: (Form<'a>, Form<'a>),
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

impl View<'_> {
    /// The next impact of two bodies within the step, and where they are just before they touch.
    /// The trees over their meshes must be there. The probe tells what it has cost.
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
        let search = PairSearch {
            view: self,
            forms,
            i,
            j,
            deviation: self.motion().deviation_per_time2(i, j),
            resolution: self.layout().resolution_by_axis(i, j),
            is_in_contact: !self.contacts.is_empty()
                && self.contacts.of_pair(i, j).next().is_some(),
            is_solid: has_roots(forms.0, forms.1),
        };
        let is_parabola = search.deviation != DVec3::ZERO
            && self.motion().coupled_group(i).is_none()
            && self.motion().coupled_group(j).is_none();
        match is_parabola && search.is_solid {
            true => search.find_on_parabola(probe),
            false => {
                let found = search.find_on_chords(probe)?;
                search.find_graze(found, probe)
            }
        }
    }
}

impl PairSearch<'_> {
    /// The first impact on trajectories of any kind.
    fn find_on_chords(&self, probe: &mut Probe) -> Result<Option<Event>, (usize, Cause)> {
        let (start, end) = (self.start(), self.end());
        let bodies = self.view.scene.bodies;
        let size = bodies.extent(self.i).half.min(bodies.extent(self.j).half);
        let length = end - start;
        let from = (start, self.offset_at(start, probe)?);
        // A point has no extent: its trajectory must do.
        let size = match size > 0.0 {
            true => size,
            false => (self.offset_at(end, probe)? - from.1).length(),
        };
        let ratio = libm::sqrt(self.deviation.length() / (FLATNESS * size)) * length;
        // 0/0 where nothing moves.
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

    /// The first impact, of which chords have found one or none: before it there may be one into which the
    /// trajectory dips between two ends of chords.
    ///
    /// Certificates tell until when bodies are apart for sure. From there on chords are so short at first that they
    /// do not depart from the trajectory by more than rounding, and then twice as long each: one of them
    /// ends where the bodies are in each other.
    fn find_graze(
        &self,
        found: Option<Event>,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let until = found.as_ref().map_or(self.end(), |event| event.time);
        let length = until - self.start();
        let is_straight = (self.deviation * length * length).cmple(self.resolution);
        if is_straight.all() || self.is_in_contact {
            return Ok(found);
        }
        let near = self
            .view
            .find_certified_impact((self.i, self.j), 1.0, probe)?;
        let Some(near) = near.filter(|near| near.time < until) else {
            return Ok(found);
        };
        let mut from = (near.time, self.offset_at(near.time, probe)?);
        let mut length = libm::sqrt(self.resolution.length() / self.deviation.length());
        while from.0 < until {
            let time = (from.0 + length).min(until);
            let to = (time, self.offset_at(time, probe)?);
            if let Some(event) = self.find_on_chord((from, to), 0, probe)? {
                return Ok(Some(event));
            }
            from = to;
            length *= 2.0;
        }
        Ok(found)
    }

    /// The first impact on a run of chords, between two knots by number, from whose straight line the
    /// trajectory departs by so much, m.
    ///
    /// Where bodies are so far apart on the line that they are not near on the trajectory, no chord is
    /// looked at. So chords cost the logarithm of their number, and those that are near.
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
        // On a parabola a quarter is left; where the method makes another way, what is seen of it.
        let part = (time - from.1.0) / (to.1.0 - from.1.0);
        let seen = (middle.1.1 - (from.1.1 + part * motion)).length();
        let departure = seen.max(0.25 * departure);
        match self.find_on_run((from, middle), departure, time_of, probe)? {
            Some(event) => Ok(Some(event)),
            None => self.find_on_run((middle, to), departure, time_of, probe),
        }
    }

    /// Whether two bodies come nowhere near each other within a departure, m, of a chord.
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
        // Twice, for what is rounded, and as far as a search goes beyond the end of the step.
        apart > 2.0 * reach + departure + BEYOND * self.rounding().length()
    }

    /// How much longer than a motion to the end of the step is one that goes on beyond it.
    fn stretch(&self, motion: DVec3) -> f64 {
        let way = motion.abs().max_element();
        let beyond = BEYOND * self.rounding().max_element();
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

    /// The first impact on trajectories that are parabolas, of shapes with closed forms.
    fn find_on_parabola(&self, probe: &mut Probe) -> Result<Option<Event>, (usize, Cause)> {
        let start = self.start();
        let (x1, v1) = self.view.motion().motion_at(self.i, start, probe)?;
        let (x2, v2) = self.view.motion().motion_at(self.j, start, probe)?;
        let still = 8.0 * f64::EPSILON * (v1.length() + v2.length());
        // What is in contact has its gap, and need not be brought to touch.
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
            acceleration: self.view.motion().acceleration_there(self.j)
                - self.view.motion().acceleration_there(self.i),
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

    /// The first impact on a part of the trajectory, given as times and offsets of its ends.
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
        // Less than that of what is moved is rounding as well.
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
                false => (end, self.offset_at(end, probe)?),
            };
            if let Some(event) = self.find_on_chord((from, part), depth + 1, probe)? {
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
        (start, touching): (f64, f64),
        (closing, room): (f64, f64),
        contact: Contact,
        probe: &mut Probe,
    ) -> Result<Event, (usize, Cause)> {
        let (i, j) = (self.i, self.j);
        // By their speed, or where there is hardly any by the trajectory's bend.
        let back = (room / closing).min(libm::sqrt(
            room / (4.0 * along(self.deviation, contact.normal)),
        ));
        let mut back = back.max(f64::MIN_POSITIVE);
        let bodies = self.view.scene.bodies;
        if bodies.extent(i).half.max(bodies.extent(j).half) == 0.0 {
            // Points that have passed each other by a rounding of the time do not meet.
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

    /// How far from a contact bodies are kept at their impact, m.
    fn room(&self, normal: DVec3) -> f64 {
        // Bodies that nothing presses together part at once, and need no room to stay in.
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

    /// More than rounding moves a placed vertex of a pair against the other body by, in two places
    /// together, by component, m.
    ///
    /// With `u = 2^-53`, positions of up to `x`, motions of up to `d` since the start of a trajectory
    /// and vertices of up to `s`, each body has errors of `u (x + 4 d)` where its position is summed
    /// up, the pair of `u (x + x)` in its offset, of `u (x + x + s)` in the vertex, and of
    /// `u (3 d + 3 d)` in the chord, the time and the part of it. The second place is the one in
    /// which the search has placed the vertices, without errors of motion.
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

    /// Whether forces may change the speed at which two bodies come together.
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

    /// Until when the trajectories of both are known, s from the step's start.
    fn end(&self) -> f64 {
        self.view
            .motion()
            .horizon(self.i)
            .min(self.view.motion().horizon(self.j))
    }

    /// Whether two bodies at the start of their common trajectory do not part along a normal.
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

/// How near the origin a chord comes.
pub(super) fn nearest_on_chord(from: DVec3, motion: DVec3) -> f64 {
    let way = motion.length_squared();
    let part = match way > 0.0 {
        true => (-from.dot(motion) / way).clamp(0.0, 1.0),
        false => 0.0,
    };
    (from + part * motion).length()
}

/// The most that components of some sizes are together along a normal.
fn along(sizes: DVec3, normal: DVec3) -> f64 {
    normal.abs().dot(sizes)
}
