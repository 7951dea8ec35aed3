//! What becomes of bodies at an impact.
//!
//! They part with their restitution. Where forces press them together and they would be back
//! within a small part of a step, they stay together instead: the contact *rests* for what is left
//! of the step, and forces do not move one into the other. So a ball comes to rest after finitely
//! many bounces, and a body on a floor stays where it is; the limit follows from the step and the
//! forces. In the next step contact is found anew, or it is not.
//!
//! Bodies that keep a part of their speed only come to rest as well where what is left moves them by
//! no more than a rounding in a step; and where they are caught among others, so that impacts follow
//! each other faster and faster though nothing presses these two together (inelastic collapse;
//! McNamara, Young 1994, "Inelastic collapse in two dimensions"): by a small part of the speed
//! at which it began, or of what forces give to each of them if they lie on something.

use alloc::{vec, vec::Vec};
use core::mem;
use glam::DVec3;

use super::super::{World, stepping::Cause};
use super::{Bounces, Event};
use crate::{
    impulse::{Joined, project, reflect},
    pieces::Pieces,
};

/// A flight of less than this part of a step is none.
const SHORTEST_FLIGHT: f64 = 1.0 / 16.0;

/// Impacts of a body in a step after which it may be caught among others.
const MANY_BOUNCES: u32 = 8;

/// Part of the greatest speed at which a body has had an impact in a step that is nothing beside it.
const SPENT: f64 = 1e-6;

/// Part of a step within which bodies that lie together may come to touch.
const SOON: f64 = 1.0 / 4.0;

/// Part of the speed that forces give in a step below which bodies that come to rest on each other
/// have rested before, and it is no impact.
pub(super) const SLIGHTEST: f64 = 1e-6;

/// Cosine of the angle to which the normals of two contacts of the same bodies are one: 0.8 degrees.
const SAME_NORMAL: f64 = 0.9999;

/// Two bodies that stay together, and the normal between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    pub(super) bodies: (usize, usize),
    pub(super) normal: DVec3,
    /// Speed at which forces would close it in a step, m/s.
    pressure: f64,
}

impl From<&Event> for Rest {
    fn from(event: &Event) -> Rest {
        Rest {
            bodies: event.bodies,
            normal: event.contact.normal,
            pressure: event.pressure,
        }
    }
}

/// What a contact does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    Bounce,
    Rest,
    /// It neither closes nor is pressed: rounding has found it.
    Part,
}

impl World {
    /// Answers impacts that happen at the same time.
    pub(super) fn answer(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
    ) -> Result<(), (usize, Cause)> {
        let mut renewed = mem::take(&mut self.continuous.renewed);
        renewed.clear();
        for event in group.iter() {
            self.renew(event.bodies, time, &mut renewed)?;
        }
        for event in group.iter_mut() {
            self.choose(event);
        }
        if group.iter().any(|event| event.answer == Answer::Rest) {
            self.join_touching(group, time, &mut renewed)?;
        }
        self.count(group);
        let chosen = |answer| group.iter().filter(move |event| event.answer == answer);
        self.bounce_all_of(chosen(Answer::Bounce), time);
        for event in chosen(Answer::Part) {
            let grain = self.grain(event.bodies.0, event.bodies.1);
            self.move_apart(event.bodies, 2.0 * grain * event.contact.normal);
        }
        for rest in chosen(Answer::Rest).map(Rest::from) {
            // In the place of one that it continues.
            let is_other = |known: &Rest| {
                known.bodies != rest.bodies || known.normal.dot(rest.normal) < SAME_NORMAL
            };
            self.continuous.resting.retain(is_other);
            self.continuous.resting.push(rest);
        }
        if !self.continuous.resting.is_empty() {
            self.rest(group, time, &mut renewed)?;
        }
        renewed.sort_unstable();
        renewed.dedup();
        for &body in &renewed {
            if let Some((bodies, _)) = self.unit(body)
                && bodies.start != body
            {
                continue;
            }
            let bodies = self.unit(body).map_or(body..body + 1, |(bodies, _)| bodies);
            self.finish_way(bodies)?;
        }
        for &body in &renewed {
            self.replace(body);
        }
        for &body in &renewed {
            self.seek_from(body, &renewed)?;
        }
        self.continuous.renewed = renewed;
        Ok(())
    }

    /// Lets new ways start for two bodies and those coupled to them. What nothing moves stays on its
    /// own.
    fn renew(
        &mut self,
        (i, j): (usize, usize),
        time: f64,
        renewed: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        for body in [i, j] {
            if self.is_moved(body) {
                renewed.extend(self.restart_at(body, time)?);
            }
        }
        Ok(())
    }

    /// Velocity of a body at the time of an impact. One that has stopped stands as if it were
    /// immovable, and keeps its own for the next step.
    fn velocity_there(&self, body: usize) -> DVec3 {
        match self.is_stopped(body) {
            true => DVec3::ZERO,
            false => self.continuous.start.velocity[body],
        }
    }

    /// Mass of a body in an impact.
    fn mass_there(&self, body: usize) -> f64 {
        match self.is_stopped(body) {
            true => f64::INFINITY,
            false => self.mass[body],
        }
    }

    /// Whether impacts change the way of a body.
    pub(super) fn is_moved(&self, body: usize) -> bool {
        self.mass_there(body).is_finite()
    }

    /// Adds to contacts that come to rest those that their bodies and what lies with these come to
    /// soon, no farther away than a flight that is none is high: in a heap nearly all are so, and
    /// one by one each would move all others.
    fn join_touching(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
        renewed: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let until = time + SOON * self.settings.dt;
        loop {
            let bodies = group.iter().map(|event| event.bodies);
            let tied = self.reached(bodies.clone(), &self.continuous.resting);
            let is_tied = |event: &&Event| {
                let (i, j) = event.bodies;
                event.time <= until && self.is_current(event) && (tied[i] || tied[j])
            };
            let soon = self.continuous.events.iter().filter(is_tied);
            let is_new = |event: &&Event| bodies.clone().all(|known| known != event.bodies);
            let mut soon: Vec<Event> = soon.filter(is_new).cloned().collect();
            soon.sort_unstable_by(|a, b| b.cmp(a));
            let before = group.len();
            for mut event in soon {
                if self.is_hop(&event, time)? {
                    self.renew(event.bodies, time, renewed)?;
                    self.choose(&mut event);
                    if event.answer == Answer::Rest {
                        group.push(event);
                    }
                }
            }
            if group.len() == before {
                return Ok(());
            }
        }
    }

    /// Whether between a time and an impact two bodies are no farther apart, and do not part faster,
    /// than in a flight that is none.
    fn is_hop(&mut self, event: &Event, from: f64) -> Result<bool, (usize, Cause)> {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let mut probe = mem::take(&mut self.continuous.probe);
        let mut along = |body: usize, time: f64| {
            let (x, v) = self.seen_at(body, time, &mut probe)?;
            Ok((x.dot(normal), v.dot(normal)))
        };
        let start = from
            .max(self.continuous.since[i])
            .max(self.continuous.since[j]);
        let mut apart = |time: f64| {
            let ((x1, v1), (x2, v2)) = (along(i, time)?, along(j, time)?);
            Ok((x2 - x1, v2 - v1))
        };
        let motion = apart(start).and_then(|start| Ok((start, apart(event.time)?)));
        self.continuous.probe = probe;
        let ((gap, opening), (end, _)) = motion?;
        let push = self.greatest_push(i, j);
        // Up for half of the time, and down for the other.
        let rise = 0.5 * SHORTEST_FLIGHT * self.settings.dt;
        Ok(gap - end <= 0.5 * rise * rise * push && opening <= rise * push)
    }

    /// The greater of what forces alone do to two bodies all along their ways, m/s².
    fn greatest_push(&self, i: usize, j: usize) -> f64 {
        let push = &self.continuous.given;
        push[i].length().max(push[j].length())
    }

    /// Counts how often bodies have come to rest, and where some do not keep their speed what impacts
    /// they have had.
    fn count(&mut self, group: &[Event]) {
        for event in group {
            let is_counted = event.answer != Answer::Bounce || !self.restitution.is_empty();
            let closing = self.closing(event);
            for body in [event.bodies.0, event.bodies.1] {
                if !is_counted || !self.is_moved(body) {
                    continue;
                }
                let (bodies, ways) = (self.mass.len(), &mut self.continuous);
                if event.answer == Answer::Bounce {
                    ways.bounces.resize(bodies, Bounces::default());
                    let bounces = &mut ways.bounces[body];
                    bounces.count += 1;
                    bounces.fastest = bounces.fastest.max(closing);
                } else {
                    ways.rests.resize(bodies, 0);
                    ways.rests[body] += 1;
                }
            }
        }
    }

    /// The speed at which two bodies close at their impact, m/s.
    fn closing(&self, event: &Event) -> f64 {
        let (i, j) = event.bodies;
        (self.velocity_there(i) - self.velocity_there(j)).dot(event.contact.normal)
    }

    fn choose(&self, event: &mut Event) {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let closing = self.closing(event);
        let pressed = (self.acceleration_there(i) - self.acceleration_there(j)).dot(normal);
        let restitution = self.pair_restitution(i, j);
        event.pressure = self.settings.dt * pressed;
        let lasting = restitution * (closing - self.unfelt(event.pressure)).max(0.0);
        // Back after the time 2 v / a.
        let is_short = |speed: f64, push: f64| 2.0 * speed <= SHORTEST_FLIGHT * push;
        let is_resting = pressed > 0.0 && is_short(lasting, event.pressure);
        let leaving = restitution * closing;
        let is_spent = || leaving * self.settings.dt <= self.grain(i, j);
        let is_caught = || {
            let felt = self.settings.dt * self.greatest_push(i, j);
            let (bounces, rests) = (
                self.bounces_of(i, j),
                self.has_rested(i) || self.has_rested(j),
            );
            bounces.count >= MANY_BOUNCES
                && (leaving <= SPENT * bounces.fastest || rests && is_short(leaving, felt))
        };
        let is_lossy = restitution < 1.0 && closing > 0.0;
        event.answer = if is_resting || is_lossy && (is_spent() || is_caught()) {
            Answer::Rest
        } else if closing > 0.0 {
            Answer::Bounce
        } else {
            Answer::Part
        };
    }

    /// The impacts of that one of two bodies that has had more.
    fn bounces_of(&self, i: usize, j: usize) -> Bounces {
        let of = |body: usize| self.continuous.bounces.get(body).copied();
        let (first, second) = (of(i).unwrap_or_default(), of(j).unwrap_or_default());
        match first.count >= second.count {
            true => first,
            false => second,
        }
    }

    fn has_rested(&self, body: usize) -> bool {
        self.continuous
            .rests
            .get(body)
            .is_some_and(|&rests| rests > 0)
    }

    /// The speed at which bodies close that lie on each other, as forces that close them by a speed in
    /// a step make it: none, but for the lag of a method's velocities.
    fn unfelt(&self, pressure: f64) -> f64 {
        pressure * (self.continuous.lag / self.settings.dt).abs()
    }

    /// Lets bodies bounce: those of one impact, or all that impacts of one instant tie together.
    fn bounce_all_of<'a>(&mut self, events: impl Iterator<Item = &'a Event> + Clone, time: f64) {
        if events.clone().nth(1).is_none() {
            if let Some(event) = events.clone().next() {
                self.exchange_there(event, time);
            }
            return;
        }
        let (places, joined) = Places::of(events.clone().map(Rest::from));
        let is_movable: Vec<bool> = places.inverse_mass(self).iter().map(|&w| w > 0.0).collect();
        let mut of_events: Vec<(usize, &Event)> =
            ties(&joined, &is_movable).into_iter().zip(events).collect();
        of_events.sort_by_key(|&(tie, _)| tie);
        for tied in of_events.chunk_by(|a, b| a.0 == b.0) {
            match tied {
                [(_, event)] => self.bounce_all_of(core::iter::once(*event), time),
                _ => self.bounce_together(tied.iter().map(|&(_, event)| event), time),
            }
        }
    }

    /// Lets bodies bounce off each other all at once, with the least restitution of all.
    fn bounce_together<'a>(&mut self, events: impl Iterator<Item = &'a Event> + Clone, time: f64) {
        let restitution = events
            .clone()
            .map(|event| self.pair_restitution(event.bodies.0, event.bodies.1))
            .fold(1.0, f64::min);
        let (places, joined) = Places::of(events.clone().map(Rest::from));
        let mut velocity = places.velocities(self);
        let before = velocity.clone();
        let given = reflect(
            &joined,
            &places.inverse_mass(self),
            &mut velocity,
            restitution,
        );
        places.put(&velocity, self);
        for ((event, joined), given) in events.zip(&joined).zip(given) {
            let speeds = (-joined.opening(&before), joined.opening(&velocity));
            let time = self.time() + time;
            self.note_impact(event.bodies, &event.contact, given, speeds, time);
        }
    }

    /// Exchanges the impulse of one impact.
    fn exchange_there(&mut self, event: &Event, time: f64) {
        let (i, j) = event.bodies;
        let restitution = self.pair_restitution(i, j);
        let before = (self.velocity_there(i), self.velocity_there(j));
        let moving = ((self.mass_there(i), self.mass_there(j)), before);
        let time = self.time() + time;
        let after = self.exchange((i, j), &event.contact, moving, restitution, time);
        for (body, velocity) in [(i, after.0), (j, after.1)] {
            if self.is_moved(body) {
                self.continuous.start.velocity[body] = velocity;
            }
        }
    }

    /// Lets bodies in resting contact move on together: those of some impacts, and all that rest on
    /// them or that they rest on.
    pub(super) fn rest(
        &mut self,
        group: &[Event],
        time: f64,
        renewed: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let all = mem::take(&mut self.continuous.resting);
        let reached = self.reached(group.iter().map(|event| event.bodies), &all);
        let touched = |rest: &Rest| reached[rest.bodies.0] || reached[rest.bodies.1];
        let (mut here, elsewhere): (Vec<Rest>, Vec<Rest>) = all.into_iter().partition(touched);
        let bodies = (0..self.len()).filter(|&body| reached[body]);
        for body in bodies.clone() {
            self.renew((body, body), time, renewed)?;
        }

        // No contact closes any more; those that open are contacts no longer.
        let (places, joined) = Places::of(here.iter().copied());
        let inverse_mass = places.inverse_mass(self);
        let mut velocity = places.velocities(self);
        let before = velocity.clone();
        let given = project(&joined, &inverse_mass, &mut velocity);
        places.put(&velocity, self);
        for ((rest, joined), given) in here.iter().zip(&joined).zip(given) {
            let speeds = (-joined.opening(&before), joined.opening(&velocity));
            let event = group.iter().find(|event| event.bodies == rest.bodies);
            let is_impact = |pressure: f64| speeds.0 - self.unfelt(pressure) > SLIGHTEST * pressure;
            if let Some(event) = event.filter(|event| is_impact(event.pressure)) {
                let time = self.time() + time;
                self.note_impact(event.bodies, &event.contact, given, speeds, time);
            }
        }
        let fastest = before.iter().fold(0.0_f64, |most, v| most.max(v.length()));
        let mut joined = joined.into_iter();
        here.retain(|rest| {
            let slow = SLIGHTEST * rest.pressure + 16.0 * f64::EPSILON * fastest;
            joined
                .next()
                .is_some_and(|joined| joined.opening(&velocity) <= slow)
        });

        // Nor do forces close them.
        for body in bodies {
            self.continuous.acceleration[body] = self.continuous.given[body];
        }
        let (places, joined) = Places::of(here.iter().copied());
        let mut acceleration: Vec<DVec3> = Vec::with_capacity(places.bodies.len());
        for &body in &places.bodies {
            acceleration.push(self.acceleration_there(body));
        }
        let free = acceleration.clone();
        project(&joined, &places.inverse_mass(self), &mut acceleration);
        for (&body, (pushed, free)) in places.bodies.iter().zip(acceleration.iter().zip(free)) {
            self.continuous.acceleration[body] += pushed - free;
        }
        here.extend(elsewhere);
        self.continuous.resting = here;
        Ok(())
    }

    /// The movable bodies of some pairs, and all that resting contacts tie to them. What one has pushed
    /// that has stopped is among them, as it is no longer moved along.
    fn reached(&self, pairs: impl Iterator<Item = (usize, usize)>, resting: &[Rest]) -> Vec<bool> {
        let is_movable = |body: usize| self.is_moved(body);
        let mut reached = vec![false; self.len()];
        for body in pairs.flat_map(|(i, j)| [i, j]) {
            reached[body] = is_movable(body);
            if self.is_stopped(body) {
                for &Rest { bodies: (i, j), .. } in resting {
                    if i == body || j == body {
                        let other = i + j - body;
                        reached[other] = is_movable(other);
                    }
                }
            }
        }
        let mut grows = true;
        while grows {
            grows = false;
            for &Rest { bodies: (i, j), .. } in resting {
                if (reached[i] || reached[j]) && is_movable(i) && is_movable(j) {
                    grows |= !(reached[i] && reached[j]);
                    (reached[i], reached[j]) = (true, true);
                }
            }
        }
        reached
    }
}

/// For each contact a number that those have in common which movable bodies tie together.
fn ties(contacts: &[Joined], is_movable: &[bool]) -> Vec<usize> {
    let mut pieces = Pieces::new(is_movable.len());
    for contact in contacts {
        let (i, j) = contact.bodies;
        if is_movable[i] && is_movable[j] {
            pieces.join(i, j);
        }
    }
    let movable = |contact: &Joined| match is_movable[contact.bodies.0] {
        true => contact.bodies.0,
        false => contact.bodies.1,
    };
    contacts
        .iter()
        .map(|contact| pieces.first(movable(contact)))
        .collect()
}

/// The bodies of some contacts, once each, in order.
struct Places {
    bodies: Vec<usize>,
}

impl Places {
    fn of(contacts: impl Iterator<Item = Rest> + Clone) -> (Places, Vec<Joined>) {
        let mut bodies: Vec<usize> = contacts
            .clone()
            .flat_map(|contact| [contact.bodies.0, contact.bodies.1])
            .collect();
        bodies.sort_unstable();
        bodies.dedup();
        let place = |body: usize| bodies.partition_point(|&other| other < body);
        let joined = contacts.map(|contact| Joined {
            bodies: (place(contact.bodies.0), place(contact.bodies.1)),
            normal: contact.normal,
        });
        let joined = joined.collect();
        (Places { bodies }, joined)
    }

    fn inverse_mass(&self, world: &World) -> Vec<f64> {
        self.bodies
            .iter()
            .map(|&body| 1.0 / world.mass_there(body))
            .collect()
    }

    fn velocities(&self, world: &World) -> Vec<DVec3> {
        let bodies = self.bodies.iter();
        bodies.map(|&body| world.velocity_there(body)).collect()
    }

    fn put(&self, velocities: &[DVec3], world: &mut World) {
        for (&body, &velocity) in self.bodies.iter().zip(velocities) {
            if world.is_moved(body) {
                world.continuous.start.velocity[body] = velocity;
            }
        }
    }
}
