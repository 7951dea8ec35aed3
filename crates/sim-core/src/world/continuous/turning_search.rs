//! When two bodies of which one turns have their next impact.
//!
//! [`turning::first_contact`] proves when, on parabolas. Where a method makes another trajectory, it is
//! cut into parts that are parabolas but for rounding, or as short as it gets.

use glam::{DQuat, DVec3};

use super::super::stepping::Cause;
use super::{
    event::{Event, EventKind},
    trajectory::Probe,
    view::View,
};
use crate::{
    collide::{
        Contact,
        turning::{self, Care, Moving, Turning, TurningTouch},
    },
    rotation::Flight,
};

/// Halvings of a step in search of parts that are parabolas.
const MAX_HALVINGS: u32 = 6;

/// Position, velocity and acceleration at the start of a part.
type Parabola = (DVec3, DVec3, DVec3);

impl View<'_> {
    /// The next impact within the step of two bodies of which one turns. The trees over their meshes must be
    /// there.
    pub(super) fn find_turning_impact(
        &self,
        (i, j): (usize, usize),
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        if self.stands(i) && self.stands(j) {
            return Ok(None);
        }
        let start = self.paths.since[i].max(self.paths.since[j]);
        let end = self.motion().horizon(i).min(self.motion().horizon(j));
        let halvings = match self.is_bent(i) || self.is_bent(j) {
            true => MAX_HALVINGS,
            false => 0,
        };
        self.find_on_part((i, j), (start, end), halvings, probe)
    }

    /// Whether a body stays where and as it is.
    fn stands(&self, body: usize) -> bool {
        let slot = self.scene.bodies.turners.slot(body);
        self.paths.start.velocity[body] == DVec3::ZERO
            && self.paths.acceleration[body] == DVec3::ZERO
            && !self.is_bent(body)
            && slot.is_none_or(|slot| {
                let torque = self.scene.bodies.turners.torque[slot];
                self.paths.start.turned[slot].momentum == DVec3::ZERO
                    && self.paths.pressed[slot].unwrap_or(torque) == DVec3::ZERO
            })
    }

    /// Whether the trajectory of a body is no parabola.
    fn is_bent(&self, body: usize) -> bool {
        self.motion().coupled_group(body).is_some()
    }

    fn find_on_part(
        &self,
        (i, j): (usize, usize),
        (from, to): (f64, f64),
        halvings: u32,
        probe: &mut Probe,
    ) -> Result<Option<Event>, (usize, Cause)> {
        let first = self.parabola_of(i, (from, to), probe)?;
        let second = self.parabola_of(j, (from, to), probe)?;
        if halvings > 0 {
            let half = 0.5 * (from + to);
            let at = |(x, v, a): Parabola, t: f64| x + t * (v + 0.5 * t * a);
            let off = |body: usize, parabola: Parabola, there: DVec3| {
                let most = 4.0 * f64::EPSILON * there.abs().max_element();
                self.is_bent(body) && (at(parabola, half - from) - there).abs().max_element() > most
            };
            let there = self.motion().motion_at(i, half, probe)?.0;
            let here = self.motion().motion_at(j, half, probe)?.0;
            if off(i, first, there) || off(j, second, here) {
                let found = self.find_on_part((i, j), (from, half), halvings - 1, probe)?;
                return match found {
                    Some(event) => Ok(Some(event)),
                    None => self.find_on_part((i, j), (half, to), halvings - 1, probe),
                };
            }
        }
        let bodies = self.scene.bodies;
        let still =
            |body: usize, first| bodies.moving(body, first, Turning::Still(DQuat::IDENTITY));
        let Some((a, b)) = still(i, first).zip(still(j, second)) else {
            return Ok(None);
        };
        if turning::stay_apart(&a, &b, to - from) {
            return Ok(None);
        }
        let flights = (
            self.flight_on(i, (from, to))?,
            self.flight_on(j, (from, to))?,
        );
        let a = Moving {
            turning: bodies.turning_of(i, flights.0.as_ref()),
            ..a
        };
        let b = Moving {
            turning: bodies.turning_of(j, flights.1.as_ref()),
            ..b
        };
        let (found, effort) = turning::first_contact_with(&a, &b, to - from, Care::TO_GO_ON);
        probe.work.certified += u64::from(effort.boxes) + u64::from(effort.pieces);
        let Some(touch) = found else {
            return Ok(None);
        };
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
        // What is taken for a contact at the very end of the step is one of the next step's start.
        let time = (from + at).min(self.scene.settings.dt.next_down());
        let event = Event::impact(time, (i, j), contact, near, &self.paths.version);
        // What has been looked at for long enough goes on from there.
        let kind = match distance <= near {
            true => EventKind::Impact,
            false => EventKind::Horizon,
        };
        Ok(Some(Event { kind, ..event }))
    }

    /// The parabola that a body is on, or one that leads to where it is at the end of a part of the step.
    fn parabola_of(
        &self,
        body: usize,
        (from, to): (f64, f64),
        probe: &mut Probe,
    ) -> Result<Parabola, (usize, Cause)> {
        let (x, v) = self.motion().motion_at(body, from, probe)?;
        if !self.is_bent(body) {
            return Ok((x, v, self.paths.acceleration[body]));
        }
        let h = to - from;
        let there = self.motion().motion_at(body, to, probe)?.0;
        let bend = match h > 0.0 {
            true => 2.0 / (h * h) * ((there - x) - h * v),
            false => DVec3::ZERO,
        };
        Ok((x, v, bend))
    }

    /// How a body turns on a part of the step, if it shows.
    fn flight_on(
        &self,
        body: usize,
        (from, to): (f64, f64),
    ) -> Result<Option<Flight>, (usize, Cause)> {
        if !self.scene.bodies.tumbles(body) {
            return Ok(None);
        }
        let Some(slot) = self.scene.bodies.turners.slot(body) else {
            return Ok(None);
        };
        let turned = self.motion().turned_at(slot, body, from);
        let flight = self.paths.flight_from(self.scene, slot, turned, to - from);
        flight
            .map(Some)
            .map_err(|error| (body, Cause::Turning(error)))
    }
}

impl super::super::bodies::Bodies {
    /// How a body turns by its flight, or stays as its shape is.
    pub(super) fn turning_of<'a>(&self, body: usize, flight: Option<&'a Flight>) -> Turning<'a> {
        match (flight, self.turners.slot(body)) {
            (Some(flight), Some(slot)) => {
                Turning::Flight(flight, self.turners.inertia[slot].axes())
            }
            _ => Turning::Still(DQuat::IDENTITY),
        }
    }
}
