//! The search for the next impact of two bodies of which one turns.
//!
//! [`turning::first_contact`] proves the time of impact on parabolas. If a method makes another trajectory, it is cut
//! into parts that are parabolas up to rounding, or as short as the number of halvings allows. Each part goes through
//! the positions and rotations of its bodies at its ends and in its middle, whatever velocities the method gives. So
//! the parts join without a gap, and no impact is missed where they join.

use glam::{DQuat, DVec3};

use super::super::stepping::Cause;
use super::{
    event::{Event, EventKind},
    levered::{Pose, flight_over},
    trajectory::Probe,
    turning_response::REACH,
    view::View,
};
use crate::{
    collide::{
        Contact,
        turning::{self, Care, Moving, Turning, TurningTouch},
    },
    rotation::Flight,
};

/// The number of halvings of a step in search of parts that are parabolas.
const MAX_HALVINGS: i32 = 5;

/// The number of further halvings in search of parts on which two bodies touch.
const TO_TOUCH: i32 = 16;

/// Position, velocity and acceleration at the start of a part.
type Parabola = (DVec3, DVec3, DVec3);

/// The poses of two bodies at a time, s from the step's start.
#[derive(Clone, Copy)]
struct Knot {
    time: f64,
    poses: [Pose; 2],
}

/// A part of the step.
#[derive(Clone, Copy)]
struct Part<'a> {
    from: &'a Knot,
    /// Its middle and its end, if a trajectory is not a parabola.
    later: Option<[&'a Knot; 2]>,
    length: f64,
}

impl<'a> Part<'a> {
    fn over([from, half, to]: [&'a Knot; 3]) -> Part<'a> {
        Part {
            from,
            later: Some([half, to]),
            length: to.time - from.time,
        }
    }
}

/// The most pieces in a search of two bodies that do not turn. Chords follow them farther.
const MOST_IN_FLIGHT: u32 = 1 << 9;

impl View<'_> {
    /// The next impact within the step of two bodies of which one turns. The trees over their meshes must be built.
    pub(super) fn find_turning_impact(
        &self,
        (i, j): (usize, usize),
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        // Bodies in contact at the end of the last step are in contact at the start of this one.
        let is_first = self.paths.version[i] == 0 && self.paths.version[j] == 0;
        let reach = if is_first { REACH } else { 1.0 };
        let start = self.paths.since[i].max(self.paths.since[j]);
        let end = self.motion().horizon(i).min(self.motion().horizon(j));
        self.find_certified_impact((i, j), (start, end), reach, probe)
    }

    /// The next impact of any two bodies between two times, by certificates, which prove that the bodies are apart until
    /// then. Bodies are in contact at the start if they are no farther apart than `reach` times the distance that
    /// counts as a contact.
    pub(super) fn find_certified_impact(
        &self,
        (i, j): (usize, usize),
        (start, end): (f64, f64),
        reach: f64,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        if self.stands(i) && self.stands(j) {
            return Ok(None);
        }
        let first = self.knot((i, j), start, probe)?;
        if !self.is_bent(i) && !self.is_bent(j) {
            let part = Part {
                from: &first,
                later: None,
                length: end - start,
            };
            return self.find_on_part((i, j), &part, (0, reach), probe);
        }
        let half = self.knot((i, j), 0.5 * (start + end), probe)?;
        let last = self.knot((i, j), end, probe)?;
        let part = Part::over([&first, &half, &last]);
        self.find_on_part((i, j), &part, (MAX_HALVINGS, reach), probe)
    }

    /// The poses of both bodies at a time.
    fn knot(
        &self,
        (i, j): (usize, usize),
        time: f64,
        probe: &mut Probe,
    ) -> Result<Knot, (usize, Cause)> {
        let first = self.motion().pose_at(i, time, probe)?;
        let second = self.motion().pose_after(i, j, time, probe)?;
        Ok(Knot {
            time,
            poses: [first, second],
        })
    }

    /// Whether a body neither moves nor turns.
    fn stands(&self, body: usize) -> bool {
        let slot = self.scene.bodies.turners.slot(body);
        self.paths.start.velocity[body] == DVec3::ZERO
            && self.paths.acceleration[body] == DVec3::ZERO
            && !self.is_bent(body)
            && slot.is_none_or(|slot| {
                let torque = self.paths.applied_torque[slot];
                self.paths.start.turned[slot].momentum == DVec3::ZERO
                    && self.paths.pressed[slot].map_or(torque, |press| press.torque) == DVec3::ZERO
            })
    }

    /// Whether the trajectory of a body is not a parabola.
    fn is_bent(&self, body: usize) -> bool {
        self.motion().coupled_group(body).is_some()
    }

    fn find_on_part(
        &self,
        (i, j): (usize, usize),
        part: &Part<'_>,
        (halvings, reach): (i32, f64),
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        if halvings > 0
            && let Some(later) = self.where_bent((i, j), part, probe)?
        {
            return self.find_in_halves((i, j), (part.from, &later), (halvings - 1, reach), probe);
        }
        let length = part.length;
        let [first, second] = [(0, i), (1, j)].map(|(k, body)| self.parabola_of((k, body), part));
        let bodies = self.scene.bodies;
        let still =
            |body: usize, first| bodies.moving(body, first, Turning::Still(DQuat::IDENTITY));
        let Some((a, b)) = still(i, first).zip(still(j, second)) else {
            return Ok(None);
        };
        if turning::stay_apart(&a, &b, length) {
            return Ok(None);
        }
        let (mut made_of_a, mut made_of_b) = (None, None);
        let flight = self.flight_on((0, i), part, &mut made_of_a)?;
        let a = Moving {
            turning: bodies.turning_of(i, flight),
            ..a
        };
        let flight = self.flight_on((1, j), part, &mut made_of_b)?;
        let b = Moving {
            turning: bodies.turning_of(j, flight),
            ..b
        };
        let care = Care {
            reach,
            most: match bodies.pair_tumbles(i, j) {
                true => Care::TO_GO_ON.most,
                false => MOST_IN_FLIGHT,
            },
            ..Care::TO_GO_ON
        };
        let (found, effort) = turning::first_contact_with(&a, &b, length, care);
        // Searches of bodies that do not turn are short, and a body that settles has many.
        if bodies.pair_tumbles(i, j) {
            probe.work.certified += u64::from(effort.boxes) + u64::from(effort.pieces);
        }
        let Some(touch) = found else {
            return Ok(None);
        };
        // At the impact, the trajectories start again at the positions that the method gives then, which must be the
        // same.
        if halvings > -TO_TOUCH
            && let Some(later) = self.where_bent((i, j), part, probe)?
        {
            return self.find_in_halves((i, j), (part.from, &later), (halvings - 1, reach), probe);
        }
        let at = touch.time;
        let place = first.0 + at * (first.1 + 0.5 * at * first.2);
        let contact = Contact {
            time: at,
            point: place + touch.points[0],
            normal: touch.normal,
            feature: None,
            face: None,
        };
        let TurningTouch { near, distance, .. } = touch;
        // A contact at the very end of the step would be one at the start of the next step. So its time is just
        // before the end.
        let time = (part.from.time + at).min(self.scene.settings.dt.next_down());
        let event = Event::impact(time, (i, j), contact, near, &self.paths.version);
        // If the search has stopped early, it continues from there.
        let kind = match distance <= reach * near {
            true => EventKind::Impact,
            false => EventKind::Horizon,
        };
        Ok(Some(Event { kind, ..event }))
    }

    /// The same on the halves of a part, given its start and both bodies after a quarter, a half and all of it.
    fn find_in_halves(
        &self,
        bodies: (usize, usize),
        (from, [quarter, half, to]): (&Knot, &[Knot; 3]),
        depth: (i32, f64),
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let first = Part::over([from, quarter, half]);
        let found = self.find_on_part(bodies, &first, depth, probe)?;
        if found.is_some() {
            return Ok(found);
        }
        let middle = self.knot(bodies, 0.5 * (half.time + to.time), probe)?;
        let second = Part::over([half, &middle, to]);
        self.find_on_part(bodies, &second, depth, probe)
    }

    /// Both bodies after a quarter, a half and all of a part, if one of them does not move on a parabola and a flight
    /// up to rounding: after the quarter its pose is off the curve through its three other poses.
    fn where_bent(
        &self,
        (i, j): (usize, usize),
        part: &Part<'_>,
        probe: &mut Probe,
    ) -> Result<Option<[Knot; 3]>, (usize, Cause)> {
        let (from, Some([half, to])) = (part.from, part.later) else {
            return Ok(None);
        };
        let quarter = self.knot((i, j), 0.5 * (from.time + half.time), probe)?;
        let t = quarter.time - from.time;
        for (k, body) in [(0, i), (1, j)] {
            if !self.is_bent(body) {
                continue;
            }
            let (x, v, a) = self.parabola_of((k, body), part);
            let off = x + t * (v + 0.5 * t * a) - quarter.poses[k].position;
            let farthest = x.abs().max(to.poses[k].position.abs()).max_element();
            if off.abs().max_element() > 4.0 * f64::EPSILON * farthest {
                return Ok(Some([quarter, *half, *to]));
            }
            let Some(there) = quarter.poses[k].turned else {
                continue;
            };
            let mut made = None;
            let flight = self.flight_on((k, body), part, &mut made)?;
            let off = flight.map(|flight| there.rotation.inverse() * flight.rotation_at(t));
            if off.is_some_and(|off| off.xyz().abs().max_element() > 4.0 * f64::EPSILON) {
                return Ok(Some([quarter, *half, *to]));
            }
        }
        Ok(None)
    }

    /// The parabola of one of the bodies, or the parabola through three of its positions.
    fn parabola_of(&self, (k, body): (usize, usize), part: &Part<'_>) -> Parabola {
        let from = &part.from.poses[k];
        let x = from.position;
        let Some(later) = part.later.filter(|_| self.is_bent(body)) else {
            return (x, from.velocity, self.paths.acceleration[body]);
        };
        if part.length <= 0.0 {
            return (x, DVec3::ZERO, DVec3::ZERO);
        }
        let [near, far] = later.map(|knot| knot.poses[k].position - x);
        let bend = 4.0 / (part.length * part.length) * (far - 2.0 * near);
        (x, (4.0 * near - far) / part.length, bend)
    }

    /// The flight of one of the bodies on a part of the step, if its rotation is visible. If the method computes the
    /// rotation, the flight goes through three rotations. `room` stores a flight that is not that of the trajectory.
    fn flight_on<'a>(
        &'a self,
        (k, body): (usize, usize),
        part: &Part<'_>,
        room: &'a mut Option<Flight>,
    ) -> Result<Option<&'a Flight>, (usize, Cause)> {
        let Some(slot) = self.scene.bodies.turners.slot(body) else {
            return Ok(None);
        };
        if !self.scene.bodies.tumbles(body) {
            return Ok(None);
        }
        let length = part.length;
        let from = part.from.poses[k].turned;
        let later = part
            .later
            .map(|later| later.map(|knot| knot.poses[k].turned));
        let flight = match (from, later) {
            (Some(from), Some([Some(half), Some(to)])) if length > 0.0 => {
                let moments = self.scene.bodies.turners.inertia[slot].moments();
                flight_over(moments, [from, half, to], length)
            }
            (None, _) if part.from.time == self.paths.since[body] && part.later.is_none() => {
                return Ok(Some(&self.paths.flights[slot]));
            }
            _ => {
                let there = || self.motion().turned_at(slot, body, part.from.time);
                let turned = from.unwrap_or_else(there);
                self.paths.flight_from(self.scene, slot, turned, length)
            }
        };
        let flight = flight.map_err(|error| (body, Cause::Turning(error)))?;
        Ok(Some(room.insert(flight)))
    }
}

impl super::super::bodies::Bodies {
    /// The rotation of a body by its flight, or the fixed one of its shape.
    pub(super) fn turning_of<'a>(&self, body: usize, flight: Option<&'a Flight>) -> Turning<'a> {
        match (flight, self.turners.slot(body)) {
            (Some(flight), Some(slot)) => {
                Turning::Flight(flight, self.turners.inertia[slot].axes())
            }
            _ => Turning::Still(DQuat::IDENTITY),
        }
    }
}
