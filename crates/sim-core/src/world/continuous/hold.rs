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
};
use crate::collide::{first_contact, snap};

impl World {
    /// Holds bodies of pairs that came near, and tells whether there are any.
    pub(super) fn hold(&mut self) -> Result<bool, (usize, Cause)> {
        let (mut group, mut gaps): (Vec<Event>, Vec<f64>) = Default::default();
        let mut bodies: Vec<usize> = Vec::new();
        // What lies on what is held is pressed once that is.
        loop {
            let known = |pair: (usize, usize)| group.iter().any(|event| event.bodies == pair);
            let near = self.continuous.near.iter().filter(|&&pair| !known(pair));
            let held = near.filter_map(|&(i, j)| self.held(i, j));
            let (new, of_new): (Vec<Event>, Vec<f64>) = held.unzip();
            if new.is_empty() {
                break;
            }
            bodies.extend(
                new.iter()
                    .flat_map(|event| [event.bodies.0, event.bodies.1]),
            );
            bodies.sort_unstable();
            bodies.dedup();
            bodies.retain(|&body| self.is_moved(body));
            group.extend(new);
            gaps.extend(of_new);
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
        // Room for roundings, as before an impact.
        for (event, gap) in group.iter().zip(gaps) {
            let (i, j) = event.bodies;
            let room = (self.grain(i, j) - gap).max(0.0);
            self.move_apart((i, j), room * event.contact.normal);
        }
        for &body in &bodies {
            let unit = self.unit(body).map_or(body..body + 1, |(unit, _)| unit);
            self.finish_way(unit)?;
        }
        Ok(!group.is_empty())
    }

    /// The contact of two bodies that touch, that forces press together, and that do not part; and how far
    /// apart they are, m.
    fn held(&self, i: usize, j: usize) -> Option<(Event, f64)> {
        let (first, second) = (self.form(i)?, self.form(j)?);
        let at = |of: &[DVec3]| of[j] - of[i];
        let (start, dt) = (&self.continuous.start, self.settings.dt);
        let push = dt * at(&self.continuous.acceleration);
        let contact = first_contact(first, second, snap(at(&start.position)), snap(dt * push))?;
        let pressure = -push.dot(contact.normal);
        let gap = contact.time * dt * pressure;
        if gap > self.touching(i, j) {
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
        (parting.abs() <= slow).then_some((event, gap))
    }
}
