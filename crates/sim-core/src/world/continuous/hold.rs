//! What rests from the start of a step.
//!
//! A method that keeps the velocity of half a step later, forward Euler, lets a body that lies still
//! start upward, by as much as it falls in half a step. What lies on something and does not part from
//! it by then has to be held before it hops: its way is that under the forces and what holds it.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::{World, stepping::Cause};
use super::{
    Event,
    respond::{Answer, Rest, SLIGHTEST},
    seek::TOUCHING,
};
use crate::collide::{first_contact, snap};

impl World {
    /// Holds bodies of pairs that came near, and tells whether there are any.
    pub(super) fn hold(&mut self) -> Result<bool, (usize, Cause)> {
        let (mut group, mut rooms): (Vec<Event>, Vec<f64>) = Default::default();
        let mut bodies: Vec<usize> = Vec::new();
        let mut left = self.continuous.near.clone();
        // What lies on what is held is pressed once that is.
        loop {
            let before = group.len();
            left.retain(|&(i, j)| {
                let held = self.held(i, j);
                let is_held = held.is_some();
                if let Some((event, room)) = held {
                    group.push(event);
                    rooms.push(room);
                }
                !is_held
            });
            if group.len() == before {
                break;
            }
            let new = group[before..].iter().map(|event| event.bodies);
            bodies.extend(new.flat_map(|(i, j)| [i, j]));
            bodies.sort_unstable();
            bodies.dedup();
            bodies.retain(|&body| self.is_moved(body));
            for &body in &bodies {
                self.continuous.start.velocity[body] = self.previous.velocity[body];
            }
            self.continuous.resting = group.iter().map(Rest::from).collect();
            self.rest(&group, 0.0, &mut Vec::new())?;
        }
        for &body in &bodies {
            let ways = &mut self.continuous;
            ways.start.velocity[body] += ways.lag * ways.acceleration[body];
        }
        for (event, room) in group.iter().zip(rooms) {
            self.move_apart(event.bodies, room * event.contact.normal);
        }
        // Under a method of first order each body goes its own way.
        for &body in &bodies {
            self.finish_way(body..body + 1)?;
        }
        Ok(!group.is_empty())
    }

    /// The contact of two bodies that touch, that forces press together, and that do not part; and by how
    /// much to move them apart, m, to leave room for roundings as before an impact.
    fn held(&self, i: usize, j: usize) -> Option<(Event, f64)> {
        let (first, second) = (self.form(i)?, self.form(j)?);
        let at = |of: &[DVec3]| of[j] - of[i];
        let (start, dt) = (&self.continuous.start, self.settings.dt);
        let push = dt * at(&self.continuous.acceleration);
        let contact = first_contact(first, second, snap(at(&start.position)), snap(dt * push))?;
        let pressure = -push.dot(contact.normal);
        let (gap, grain) = (contact.time * dt * pressure, self.grain(i, j));
        if gap > TOUCHING * grain {
            return None;
        }
        let kept = &self.previous.velocity;
        let parting = at(kept).dot(contact.normal);
        let slow =
            SLIGHTEST * pressure + 16.0 * f64::EPSILON * (kept[i].length() + kept[j].length());
        let event = Event {
            time: 0.0,
            bodies: (i, j),
            versions: (0, 0),
            contact,
            answer: Answer::Rest,
            pressure,
        };
        (parting.abs() <= slow).then_some((event, (grain - gap).max(0.0)))
    }
}
