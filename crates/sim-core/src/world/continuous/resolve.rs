//! What becomes of bodies at an impact.
//!
//! They part with their restitution. Where forces press them together and they would be back
//! within a small part of a step, they stay in contact instead: from then on a constraint keeps
//! them apart ([`super::contact_set`]), for the rest of the step and in the next ones, until they
//! move apart. So a ball comes to rest after finitely many bounces.
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
use super::constraint_solve::{Island, Places, SLIGHTEST};
use super::contact_motion::LEAST_GAP;
use super::contact_set::ContactConstraint;
use super::{Bounces, Event, EventKind, Outcome};
use crate::{
    collide::Contact,
    impulse::{ALL_SWEEPS, Joined, drag, greatest, limit, reflect},
    pieces::Pieces,
};

/// A flight of less than this part of a step is none.
const SHORTEST_FLIGHT: f64 = 1.0 / 16.0;

/// Impacts of a body in a step after which it may be caught among others.
const MANY_BOUNCES: u32 = 8;

/// Tops of a hop that are looked at, each where the force on the one before puts it.
const HOPS: u32 = 16;

/// Part of the greatest speed at which a body has had an impact in a step that is nothing beside it.
const SPENT: f64 = 1e-6;

/// How often a body may come to rest in a step, at the time of each, before all that it and what lies
/// with it would come to rest on in the step is bundled: taken for in contact at once, with its gap.
const MANY_RESTS: u32 = 4;

impl World {
    /// Resolves events that happen at the same time.
    pub(super) fn resolve(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
    ) -> Result<(), (usize, Cause)> {
        let mut restarted = mem::take(&mut self.continuous.restarted);
        restarted.clear();
        for event in group.iter() {
            self.restart(event.bodies.0, time, &mut restarted)?;
            self.restart(event.bodies.1, time, &mut restarted)?;
        }
        for event in group.iter() {
            let (i, j) = event.bodies;
            let normal = event.contact.normal;
            let ended = self.contacts.of_pair(i, j);
            let ended = ended.copied().find(|known| known.normal == normal);
            if let Some(ended) = ended.filter(|_| event.kind == EventKind::ContactEnd) {
                self.hand_over(&ended)?;
            }
        }
        for event in group.iter_mut() {
            if self.climb(event, time, &mut restarted)? {
                // It goes on, on another surface.
                event.kind = EventKind::ContactEnd;
                event.outcome = Outcome::Rest;
            }
            if event.kind == EventKind::Impact {
                self.classify(event);
            }
        }
        if group.iter().any(Event::is_rest) {
            self.join_resting(group, time, &mut restarted)?;
        }
        self.count(group);
        // Whose constraints have to be solved.
        let mut seeds: Vec<usize> = Vec::new();
        let bouncing = group
            .iter()
            .filter(|event| event.outcome == Outcome::Bounce);
        self.bounce_all_of(bouncing.clone(), time);
        seeds.extend(bouncing.flat_map(|event| [event.bodies.0, event.bodies.1]));
        self.bounce_contacts(&mut seeds, time, &mut restarted)?;
        for event in group.iter().filter(|event| event.is_rest()) {
            self.begin_contact(event, time)?;
        }
        let others = group
            .iter()
            .filter(|event| event.outcome != Outcome::Bounce);
        seeds.extend(others.flat_map(|event| [event.bodies.0, event.bodies.1]));
        let before: Vec<f64> = group.iter().map(|event| self.closing(event)).collect();
        if !self.contacts.is_empty() {
            self.solve_islands_of(&seeds, time, &mut restarted)?;
        }
        for (event, closing) in group.iter().zip(before) {
            self.report_rest(event, closing, time);
        }
        restarted.sort_unstable();
        restarted.dedup();
        self.finish_restarted(&restarted)?;
        for &body in &restarted {
            self.update_swept(body);
        }
        for &body in &restarted {
            self.find_impacts_of(body, &restarted)?;
        }
        self.queue_contact_ends(&restarted);
        self.queue_horizons(restarted.iter().copied());
        self.continuous.restarted = restarted;
        Ok(())
    }

    /// Lets the trajectory of a body, and of those coupled to it, start again. What nothing moves stays
    /// on its own.
    pub(super) fn restart(
        &mut self,
        body: usize,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        if self.is_movable(body) {
            restarted.extend(self.restart_at(body, time)?);
        }
        Ok(())
    }

    /// Whether impacts change the trajectory of a body.
    pub(in crate::world) fn is_movable(&self, body: usize) -> bool {
        self.mass[body].is_finite()
    }

    /// Adds to impacts that come to rest those that their bodies and what lies with these come to soon:
    /// no farther away than the shortest flight is high, and where a body comes to rest again and
    /// again in a step all of them. In a heap nearly all are so, and one by one each would move all
    /// others.
    fn join_resting(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        loop {
            let mut visited = mem::take(&mut self.continuous.visited);
            visited.begin(self.len());
            let mut is_bundled = false;
            for body in group
                .iter()
                .flat_map(|event| [event.bodies.0, event.bodies.1])
            {
                if let Some(island) = self.island_around(body, &mut visited) {
                    is_bundled |= island.bodies.iter().any(|&body| self.is_bundled(body));
                }
            }
            let is_tied = |event: &&Event| {
                let (i, j) = event.bodies;
                event.kind == EventKind::Impact
                    && self.is_current(event)
                    && (visited.has(i) || visited.has(j))
                    && group.iter().all(|known| known.bodies != event.bodies)
            };
            let soon = self.continuous.events.iter().filter(is_tied);
            let mut soon: Vec<Event> = soon.cloned().collect();
            self.continuous.visited = visited;
            self.sort_events(&mut soon);
            let before = group.len();
            for mut event in soon {
                let (gap, opening) = self.gap_before(&event, time)?;
                let push = self.greatest_push(event.bodies.0, event.bodies.1);
                let (height, speed) = self.shortest_hop(push, is_bundled);
                let is_hop = gap <= height && opening <= speed;
                if is_hop || is_bundled {
                    self.classify_at_its_time(&mut event)?;
                    if event.is_rest() {
                        self.restart(event.bodies.0, time, restarted)?;
                        self.restart(event.bodies.1, time, restarted)?;
                        event.gap = gap.max(0.0);
                        group.push(event);
                    }
                }
            }
            if group.len() == before {
                return Ok(());
            }
        }
    }

    /// How far two bodies are apart at a time before their impact, m, and the speed at which they part,
    /// m/s, both along its normal.
    fn gap_before(&mut self, event: &Event, from: f64) -> Result<(f64, f64), (usize, Cause)> {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let mut probe = mem::take(&mut self.continuous.probe);
        let start = from
            .max(self.continuous.since[i])
            .max(self.continuous.since[j]);
        let mut apart = |time: f64| {
            let (x1, v1) = self.motion_at(i, time, &mut probe)?;
            let (x2, v2) = self.motion_at(j, time, &mut probe)?;
            Ok(((x2 - x1).dot(normal), (v2 - v1).dot(normal)))
        };
        let motion = apart(start).and_then(|start| Ok((start, apart(event.time)?)));
        self.continuous.probe = probe;
        let ((gap, opening), (end, _)) = motion?;
        Ok((gap - end, opening))
    }

    /// Counts how often bodies have come to rest, and where some do not keep their speed what impacts
    /// they have had.
    fn count(&mut self, group: &[Event]) {
        for event in group {
            let is_counted = event.outcome != Outcome::Bounce || !self.restitution.is_empty();
            let closing = self.closing(event);
            for body in [event.bodies.0, event.bodies.1] {
                if !is_counted || !self.is_movable(body) || event.kind != EventKind::Impact {
                    continue;
                }
                let (bodies, continuous) = (self.mass.len(), &mut self.continuous);
                if event.outcome == Outcome::Bounce {
                    continuous.bounces.resize(bodies, Bounces::default());
                    let bounces = &mut continuous.bounces[body];
                    bounces.count += 1;
                    bounces.fastest = bounces.fastest.max(closing);
                } else {
                    continuous.rests.resize(bodies, 0);
                    continuous.rests[body] += 1;
                    self.contacts.keep_bundled(&[body]);
                }
            }
        }
    }

    /// The speed at which two bodies close at their impact, m/s.
    fn closing(&self, event: &Event) -> f64 {
        let (i, j) = event.bodies;
        let velocity = &self.continuous.start.velocity;
        (velocity[i] - velocity[j]).dot(event.contact.normal)
    }

    /// Whether two bodies bounce or come to rest, from their motion where their trajectories start.
    fn classify(&self, event: &mut Event) {
        let closing = self.closing(event);
        self.classify_by(event, closing, self.pressed_on_hop(event, closing));
    }

    /// The acceleration with which forces press two bodies together at their impact, m/s²: as their
    /// contacts with others let them, or as if there were none, since one of those may end here.
    fn pressed(&self, event: &Event) -> f64 {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let there = self.acceleration_there(i) - self.acceleration_there(j);
        let applied = &self.continuous.applied_acceleration;
        let alone = applied[i] - applied[j];
        there.dot(normal).max(alone.dot(normal))
    }

    /// The acceleration with which forces press two bodies together that close at a speed, m/s²: as at
    /// their impact, or as at the top of the hop that follows where it is so much less there that they
    /// are not back soon. Where forces fall off with distance a hop goes farther than it seems from
    /// where it begins.
    fn pressed_on_hop(&self, event: &Event, closing: f64) -> f64 {
        let pressed = self.pressed(event);
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let is_forced = self.coupled_group(i).is_some() || self.coupled_group(j).is_some();
        let leaving = self.pair_restitution(i, j) * closing;
        if !is_forced || leaving <= 0.0 {
            return pressed;
        }
        let is_bundled = self.is_bundled(i) || self.is_bundled(j);
        let flight = self.settings.dt * self.shortest_flight(is_bundled);
        let weight = |body: usize| match self.is_movable(body) {
            true => 1.0 / self.mass[body],
            false => 0.0,
        };
        let (first, second) = (weight(i), weight(j));
        let applied = &self.continuous.applied_acceleration;
        let alone = (applied[i] - applied[j]).dot(normal);
        let mut least = pressed;
        for _ in 0..HOPS {
            if 2.0 * leaving > flight * least {
                return least;
            }
            let height = 0.5 * leaving * leaving / least;
            let by = height / (first + second) * normal;
            let moved = [(i, -first * by), (j, second * by)];
            let there = self.acceleration_beside(i, &moved) - self.acceleration_beside(j, &moved);
            let there = there.dot(normal).max(alone);
            if there >= least {
                break;
            }
            least = there;
        }
        // What is at rest is pressed by what there is.
        pressed
    }

    /// The same from their motion at the time of their impact.
    fn classify_at_its_time(&mut self, event: &mut Event) -> Result<(), (usize, Cause)> {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let mut probe = mem::take(&mut self.continuous.probe);
        let first = self.motion_at(i, event.time, &mut probe);
        let second = self.motion_at(j, event.time, &mut probe);
        self.continuous.probe = probe;
        let closing = (first?.1 - second?.1).dot(normal);
        self.classify_by(event, closing, self.pressed_on_hop(event, closing));
        Ok(())
    }

    fn classify_by(&self, event: &mut Event, closing: f64, pressed: f64) {
        event.load_speed = self.settings.dt * pressed;
        event.outcome = match self.bounces(event.plane(), closing, event.load_speed) {
            true => Outcome::Bounce,
            false => Outcome::Rest,
        };
    }

    /// Whether two bodies that close at a speed, while forces close them by another one in a step, part
    /// again.
    pub(super) fn bounces(
        &self,
        ((i, j), normal): ((usize, usize), DVec3),
        closing: f64,
        load_speed: f64,
    ) -> bool {
        if closing <= 0.0 || self.is_held(i, j) {
            return false;
        }
        let restitution = self.pair_restitution(i, j);
        let lasting = restitution * (closing - self.unfelt(load_speed)).max(0.0);
        // Back after the time 2 v / a.
        let is_bundled = self.is_bundled(i) || self.is_bundled(j);
        let flight = self.shortest_flight(is_bundled);
        let is_short = |speed: f64, push: f64| 2.0 * speed <= flight * push;
        if load_speed > 0.0 && is_short(lasting, load_speed) {
            return false;
        }
        let leaving = restitution * closing;
        // Contacts move bodies by their gap, and no impact has to tell that speed from none.
        let is_touching = [i, j]
            .iter()
            .any(|&body| !self.contacts.of_body(body).is_empty());
        let is_spent = || {
            let unseen = match is_touching {
                true => self.hover_gap(i, j),
                false => self.resolution_along(i, j, normal),
            };
            leaving * self.settings.dt <= unseen
        };
        let is_caught = || {
            let felt = self.settings.dt * self.greatest_push(i, j);
            let bounces = self.bounces_of(i, j);
            let rests = self.rests_of(i) > 0 || self.rests_of(j) > 0;
            let is_many = bounces.count >= MANY_BOUNCES;
            is_many && leaving <= SPENT * bounces.fastest
                || (is_bundled || is_many && rests) && is_short(leaving, felt)
        };
        !(restitution < 1.0 && (is_spent() || is_caught()))
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

    /// Whether a body has come to rest so often in this step, or is in contact with one that has, that
    /// what follows is bundled; or has been in the last step.
    pub(super) fn is_bundled(&self, body: usize) -> bool {
        self.rests_of(body) > MANY_RESTS || self.contacts.is_bundled(body)
    }

    /// Bundles an island of which one body is.
    pub(super) fn spread_bundle(&mut self, island: &Island) -> bool {
        let is_bundled = island.bodies.iter().any(|&body| self.is_bundled(body));
        if is_bundled {
            self.contacts.bundle(&island.bodies);
        }
        is_bundled
    }

    /// A flight of less than this part of a step is none; where the step is bundled, one of less than the
    /// step.
    pub(super) fn shortest_flight(&self, is_bundled: bool) -> f64 {
        match is_bundled {
            true => 1.0,
            false => SHORTEST_FLIGHT,
        }
    }

    fn rests_of(&self, body: usize) -> u32 {
        self.continuous.rests.get(body).copied().unwrap_or(0)
    }

    /// The speed at which bodies close that lie on each other, as forces that close them by a speed in
    /// a step make it: none, but for the velocity stagger of a method.
    fn unfelt(&self, load_speed: f64) -> f64 {
        load_speed * (self.continuous.velocity_stagger / self.settings.dt).abs()
    }

    /// Adds the constraint of an impact that comes to rest.
    fn begin_contact(&mut self, event: &Event, time: f64) -> Result<(), (usize, Cause)> {
        let (i, j) = event.bodies;
        let hover = self.hover_gap(i, j);
        // Where bodies touch they are moved apart by a rounding, for what rounds and solves after that.
        let least = LEAST_GAP * hover;
        let mut gap = event.gap;
        if gap < least {
            let normal = event.contact.normal;
            gap += self.move_apart_in_room(event.bodies, (least - gap) * normal, time)?;
            let seen = self.resolution_along(i, j, normal);
            if gap < seen {
                self.move_apart(event.bodies, (seen - gap) * normal);
                gap = seen;
            }
        }
        let target = self.speed_to_hover(gap, hover, self.settings.dt - time, event.load_speed);
        let point = event.contact.point - self.continuous.start.position[i];
        self.add_contact(ContactConstraint {
            target,
            load_speed: event.load_speed,
            ..ContactConstraint::new(event.bodies, event.contact.normal, gap, point)
        });
        Ok(())
    }

    /// Notes an impact that has come to rest, if it was one.
    fn report_rest(&mut self, event: &Event, closing: f64, time: f64) {
        let load = event.load_speed;
        if !event.is_rest() || closing - self.unfelt(load) <= SLIGHTEST * load {
            return;
        }
        let (i, j) = event.bodies;
        let normal = event.contact.normal;
        let same = |known: &&ContactConstraint| known.normal.dot(normal) > 0.999;
        let impulse = self.contacts.of_pair(i, j).find(same).map(|c| c.impulse);
        let speeds = (closing, -self.closing(event));
        let at = self.time() + time;
        self.note_impact(
            event.bodies,
            &event.contact,
            impulse.unwrap_or(0.0),
            speeds,
            at,
        );
    }

    /// Lets those contacts of some bodies bounce that an impulse has closed, and then those of whom they
    /// have met.
    fn bounce_contacts(
        &mut self,
        seeds: &mut Vec<usize>,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        if self.contacts.is_empty() {
            return Ok(());
        }
        let mut changed = seeds.clone();
        let mut round = 0;
        while !changed.is_empty() {
            round += 1;
            let mut group: Vec<Event> = Vec::new();
            for &body in &changed {
                for &index in self.contacts.of_body(body) {
                    let constraint = self.contacts.all()[index as usize];
                    let is_known = |event: &Event| {
                        event.bodies == constraint.bodies
                            && event.contact.normal == constraint.normal
                    };
                    if !group.iter().any(is_known) {
                        group.push(self.event_of(&constraint, time));
                    }
                }
            }
            self.sort_events(&mut group);
            for event in &group {
                self.restart(event.bodies.0, time, restarted)?;
                self.restart(event.bodies.1, time, restarted)?;
            }
            group.retain_mut(|event| {
                self.classify(event);
                let (i, j) = event.bodies;
                // What gives back a part goes to and fro in a row without end, and comes to rest; so does, at
                // once, what lies in a heap.
                let is_lossy = self.pair_restitution(i, j) < 1.0;
                let is_bundled = self.is_bundled(i) || self.is_bundled(j);
                let ends = is_lossy && (is_bundled || round > MANY_BOUNCES);
                event.outcome == Outcome::Bounce && !ends
            });
            self.count(&group);
            self.watch_crush(&group)?;
            self.count_events(&group)?;
            self.bounce_all_of(group.iter(), time);
            changed.clear();
            changed.extend(
                group
                    .iter()
                    .flat_map(|event| [event.bodies.0, event.bodies.1]),
            );
            changed.retain(|&body| self.is_movable(body));
            seeds.extend(&changed);
        }
        Ok(())
    }

    /// A contact as an impact now.
    pub(super) fn event_of(&self, constraint: &ContactConstraint, time: f64) -> Event {
        let (i, j) = constraint.bodies;
        let version = &self.continuous.version;
        Event {
            time,
            bodies: (i, j),
            versions: (version[i], version[j]),
            kind: EventKind::Impact,
            outcome: Outcome::Bounce,
            load_speed: 0.0,
            gap: 0.0,
            contact: Contact {
                time: 0.0,
                point: self.continuous.start.position[i] + constraint.point,
                normal: constraint.normal,
                feature: None,
                face: None,
            },
        }
    }

    /// Lets bodies bounce: those of one impact, or all that impacts of one instant tie together.
    fn bounce_all_of<'a>(&mut self, events: impl Iterator<Item = &'a Event> + Clone, time: f64) {
        if events.clone().nth(1).is_none() {
            if let Some(event) = events.clone().next() {
                self.exchange_there(event, time);
            }
            return;
        }
        let places = Places::between(self, events.clone().map(Event::plane));
        let is_movable: Vec<bool> = places.inverse_mass.iter().map(|&w| w > 0.0).collect();
        let mut of_events: Vec<(usize, &Event)> = ties(&places.joined, &is_movable)
            .into_iter()
            .zip(events)
            .collect();
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
        let places = Places::between(self, events.clone().map(Event::plane));
        let mut velocity = places.each(|body| self.continuous.start.velocity[body]);
        let before = velocity.clone();
        let given = reflect(
            &places.joined,
            &places.inverse_mass,
            &mut velocity,
            restitution,
        );
        if self.is_rough() {
            let bodies = events.clone().map(|event| event.bodies).zip(&given);
            let most = bodies.map(|((i, j), &given)| limit(self.pair_friction(i, j), given));
            let most: Vec<f64> = most.collect();
            let fastest = greatest(&before);
            let none = vec![DVec3::ZERO; given.len()];
            let mut dragged = none.clone();
            let enough = (16.0 * f64::EPSILON * fastest, ALL_SWEEPS);
            let Places {
                joined,
                inverse_mass,
                ..
            } = &places;
            drag(
                joined,
                inverse_mass,
                &mut velocity,
                &most,
                &none,
                &mut dragged,
                enough,
            );
        }
        places.put(
            &velocity,
            &mut self.continuous.start.velocity,
            &places.inverse_mass,
        );
        for ((event, joined), given) in events.zip(&places.joined).zip(given) {
            let speeds = (-joined.opening(&before), joined.opening(&velocity));
            let time = self.time() + time;
            self.note_impact(event.bodies, &event.contact, given, speeds, time);
        }
    }

    /// Exchanges the impulse of one impact.
    pub(super) fn exchange_there(&mut self, event: &Event, time: f64) {
        let (i, j) = event.bodies;
        let restitution = self.pair_restitution(i, j);
        let velocity = &self.continuous.start.velocity;
        let moving = ((self.mass[i], self.mass[j]), (velocity[i], velocity[j]));
        let time = self.time() + time;
        let after = self.exchange((i, j), &event.contact, moving, restitution, time);
        for (body, velocity) in [(i, after.0), (j, after.1)] {
            if self.is_movable(body) {
                self.continuous.start.velocity[body] = velocity;
            }
        }
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
