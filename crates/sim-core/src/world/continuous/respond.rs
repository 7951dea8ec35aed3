//! What becomes of bodies at an impact.
//!
//! They part with their restitution. Where forces press them together and they would be back
//! within a small part of a step, they stay together instead: the contact *rests* for what is left
//! of the step, and forces do not move one into the other. So a ball comes to rest after finitely
//! many bounces, and a body on a floor stays where it is; the limit follows from the step and the
//! forces. In the next step contact is found anew, or it is not.
//!
//! In a heap impacts follow each other faster and faster without any flight being short (inelastic
//! collapse; McNamara, Young 1994, "Inelastic collapse in two dimensions"). A body that gives back a
//! part only and has had several in a step comes to rest on what it closes with by less than what
//! forces give in a step.

use alloc::{vec, vec::Vec};
use core::mem;
use glam::DVec3;

use super::super::{World, stepping::Cause};
use super::Event;
use crate::impulse::{Joined, project, reflect};

/// A flight of less than this part of a step is none.
const SHORTEST_FLIGHT: f64 = 1.0 / 16.0;

/// Impacts of a body in a step after which it counts as one of a heap, and after which none gives
/// anything back any more.
const MANY_BOUNCES: u32 = 8;
const MOST_BOUNCES: u32 = 1024;

/// Part of a step within which bodies that lie together may come to touch.
const SOON: f64 = 1.0 / 4.0;

/// Part of the speed that forces give in a step below which bodies that come to rest on each other
/// have rested before, and it is no impact.
const SLIGHTEST: f64 = 1e-6;

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

    /// Adds to contacts that come to rest those that are to do so soon and are no farther from it than
    /// a flight that is none, as most are in a heap: one by one, each would move all others.
    fn join_touching(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
        renewed: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let mut others = Vec::new();
        while let Some(mut event) = self.next_event(time + SOON * self.settings.dt) {
            let hop = self.hop(event.bodies);
            if self.closes_by(&event, time)? <= hop {
                self.renew(event.bodies, time, renewed)?;
                self.choose(&mut event);
                if event.answer == Answer::Rest {
                    group.push(event);
                    continue;
                }
            }
            others.push(event);
        }
        self.continuous.events.extend(others);
        Ok(())
    }

    /// The height of a flight that is none, m, as forces on two bodies make it.
    fn hop(&self, (i, j): (usize, usize)) -> f64 {
        let push = &self.continuous.given;
        let half = 0.5 * SHORTEST_FLIGHT * self.settings.dt;
        0.5 * half * half * push[i].length().max(push[j].length())
    }

    /// By how much the bodies of an impact come together from a time on until then, m.
    fn closes_by(&mut self, event: &Event, from: f64) -> Result<f64, (usize, Cause)> {
        let mut probe = mem::take(&mut self.continuous.probe);
        let mut moves = |body: usize| {
            let start = from.max(self.continuous.since[body]);
            let before = self.motion_at(body, start, &mut probe)?.0;
            Ok(self.motion_at(body, event.time, &mut probe)?.0 - before)
        };
        let (first, second) = (moves(event.bodies.0), moves(event.bodies.1));
        self.continuous.probe = probe;
        Ok((first? - second?).dot(event.contact.normal))
    }

    /// Counts how often bodies have come to rest, and where some do not keep their speed how often they
    /// have had an impact.
    fn count(&mut self, group: &[Event]) {
        for event in group {
            for body in [event.bodies.0, event.bodies.1] {
                let is_counted = event.answer != Answer::Bounce || !self.restitution.is_empty();
                if !is_counted || !self.is_moved(body) {
                    continue;
                }
                let counts = match event.answer {
                    Answer::Bounce => &mut self.continuous.bounces,
                    Answer::Rest | Answer::Part => &mut self.continuous.rests,
                };
                counts.resize(self.mass.len(), 0);
                counts[body] += 1;
            }
        }
    }

    fn choose(&self, event: &mut Event) {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let closing = (self.velocity_there(i) - self.velocity_there(j)).dot(normal);
        let pushed = (self.acceleration_there(i), self.acceleration_there(j));
        let pressed = (pushed.0 - pushed.1).dot(normal);
        let restitution = self.pair_restitution(i, j);
        event.pressure = self.settings.dt * pressed;
        let lasting = restitution * (closing - self.unfelt(event.pressure)).max(0.0);
        // Back after the time 2 v / a.
        let is_short = pressed > 0.0 && 2.0 * lasting <= SHORTEST_FLIGHT * event.pressure;
        let felt = self.settings.dt * pushed.0.length().max(pushed.1.length());
        event.answer = if is_short || restitution < 1.0 && self.is_caught(event, closing, felt) {
            Answer::Rest
        } else if closing > 0.0 {
            Answer::Bounce
        } else {
            Answer::Part
        };
    }

    /// Whether bodies that keep a part of their speed only, and close, are caught among others, where
    /// they would meet without end: they hardly move any more, or have met others often in this
    /// step and close by no more than what forces give in one, or have so all too often.
    fn is_caught(&self, event: &Event, closing: f64, felt: f64) -> bool {
        if closing <= 0.0 {
            return false;
        }
        let (i, j) = event.bodies;
        let ways = &self.continuous;
        let left = self.settings.dt - ways.since[i].max(ways.since[j]);
        let bounces = |body: usize| ways.bounces.get(body).copied().unwrap_or(0);
        let bounces = bounces(i).max(bounces(j));
        self.pair_restitution(i, j) * closing * left <= self.grain(i, j)
            || bounces >= MANY_BOUNCES && closing <= felt
            || bounces >= MOST_BOUNCES
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
    fn rest(
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

    /// The movable bodies of some pairs, and all that resting contacts tie to them.
    fn reached(&self, pairs: impl Iterator<Item = (usize, usize)>, resting: &[Rest]) -> Vec<bool> {
        let is_movable = |body: usize| self.is_moved(body);
        let mut reached = vec![false; self.len()];
        for body in pairs.flat_map(|(i, j)| [i, j]) {
            reached[body] = is_movable(body);
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
    let mut parent: Vec<usize> = (0..is_movable.len()).collect();
    let root = |parent: &mut Vec<usize>, mut body: usize| {
        while parent[body] != body {
            parent[body] = parent[parent[body]];
            body = parent[body];
        }
        body
    };
    for contact in contacts {
        let (i, j) = contact.bodies;
        if is_movable[i] && is_movable[j] {
            let (i, j) = (root(&mut parent, i), root(&mut parent, j));
            parent[i.max(j)] = i.min(j);
        }
    }
    let movable = |contact: &Joined| match is_movable[contact.bodies.0] {
        true => contact.bodies.0,
        false => contact.bodies.1,
    };
    contacts
        .iter()
        .map(|contact| root(&mut parent, movable(contact)))
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
