//! Impacts at the time at which they happen, and contacts that last.
//!
//! A step goes through these phases, a file each:
//!
//! 1. [`trajectory`]: each body has a trajectory through the step, as its method makes it, or as far as
//!    contact lets the method be asked ([`horizon`]).
//! 2. [`initial_contacts`]: of bodies that have just been placed it is found out who touches.
//! 3. [`contact_motion`]: the contacts that the last step has left are measured;
//!    [`constraint_solve`]: the bodies of each island get the velocities and accelerations with which
//!    none of its contacts closes.
//! 4. [`impact_search`]: for each pair whose swept boxes meet, the next impact is found and waits in a
//!    queue, and so does the end of each contact that is left behind.
//! 5. [`resolve`]: the earliest event is resolved, with all of its instant: impulses are exchanged, or a
//!    contact begins or ends and its island is solved; new trajectories start, and their events
//!    are found. [`progress`] and [`crush`] stop a step that would have no end.
//! 6. [`position_correction`]: an exact test makes sure that no two bodies meet.
//!
//! [`held_overlaps`]: where bodies that were placed in overlap would get deeper, all of it is done again
//! with the two held.
//!
//! A step costs a box test for each pair that comes near, a search for each whose swept boxes meet, and
//! two searches or so for each event.

mod constraint_solve;
mod contact_motion;
mod contact_set;
mod crush;
mod friction;
mod hand_over;
mod held_overlaps;
mod horizon;
mod impact_search;
mod initial_contacts;
mod ledge;
mod position_correction;
mod progress;
mod resolve;
mod sleep;
#[cfg(test)]
mod tests;
mod trajectory;

use alloc::{
    collections::{BTreeMap, BinaryHeap},
    vec::Vec,
};
use core::{cmp::Ordering, mem};
use glam::DVec3;

use super::{
    Bundled, StepError, World, order::ordinal, profile::Phase, state::State, stepping::Cause,
};
use crate::{
    Extent, Shape,
    collide::{Broad, Contact, Front, Swept},
};
use constraint_solve::Visited;
pub(super) use contact_set::ContactSet;
use crush::CrushDetector;
use progress::Progress;
use trajectory::Probe;

/// What a step with continuous collision needs beside the state; empty while there is none.
#[derive(Clone, Debug, Default)]
pub(super) struct Continuous {
    /// Motion of each body where its trajectory starts, and when that is, s from the step's start.
    pub(super) start: State,
    since: Vec<f64>,
    /// Until when each trajectory is known, s from the step's start ([`horizon`]); empty where all are to the
    /// step's end.
    horizon: Vec<f64>,
    /// How often a body's trajectory has changed in this step; an event of an older one is void.
    version: Vec<u32>,
    /// What forces do to each body all along its trajectory, m/s²: constant ones, or under a method of
    /// first order all of them.
    applied_acceleration: Vec<DVec3>,
    /// The same together with what contacts do.
    acceleration: Vec<DVec3>,
    /// How long before that of its trajectory a body's velocity is the one that the method keeps, s.
    velocity_stagger: f64,
    /// How often each body has come to rest in this step, once one has.
    rests: Vec<u32>,
    /// How often each body has been lifted onto a ledge in this step, once one has.
    climbs: Vec<u32>,
    /// How often each body has been handed over to another one in this step, once one has.
    handed: Vec<u32>,
    /// What impacts each body has had in this step, once one has, where some give back a part only.
    bounces: Vec<Bounces>,
    /// Bodies that are at rest, to which nothing happens until something comes.
    asleep: Vec<bool>,
    events: BinaryHeap<Event>,
    /// Events resolved in this step.
    resolved: u64,
    /// Pairs that have come near in this step.
    candidate_pairs: Vec<(usize, usize)>,
    broad: Broad,
    /// Whether that knows what is near bodies where they are: they have not been placed since.
    knows_near: bool,
    probe: Probe,
    visited: Visited,
    restarted_motion: Vec<(DVec3, DVec3)>,
    /// Bodies whose trajectories are new, and bodies that may come near one of them.
    restarted: Vec<usize>,
    partners: Vec<usize>,
    crush: CrushDetector,
    pub(super) progress: Progress,
    /// What happens at one instant.
    group: Vec<Event>,
    /// Whether every trajectory is a parabola.
    is_free: bool,
    /// Whether bodies have been placed since it was found out who touches.
    pub(super) placed: bool,
    /// The contacts before the step.
    contacts_before: ContactSet,
    /// How deep pairs in overlap were where they were placed, m.
    depth_at_start: BTreeMap<(usize, usize), f64>,
    /// Pairs in overlap that move as one in this step.
    held: Vec<(usize, usize)>,
}

/// Impacts of a body in a step.
#[derive(Clone, Copy, Debug, Default)]
struct Bounces {
    count: u32,
    /// The greatest speed at which one closed, m/s.
    fastest: f64,
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EventKind {
    Impact,
    /// The surface of a contact ends, or begins to turn.
    ContactEnd,
    /// A trajectory is known no farther.
    Horizon,
}

/// What becomes of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    Bounce,
    /// The bodies stay in contact.
    Rest,
}

/// An event to come.
#[derive(Clone, Debug)]
struct Event {
    /// From the start of the step, s.
    time: f64,
    bodies: (usize, usize),
    versions: (u32, u32),
    kind: EventKind,
    /// Its point is in the world.
    contact: Contact,
    /// What becomes of it, once its time has come.
    outcome: Outcome,
    /// Speed at which forces would close it in a step, m/s.
    load_speed: f64,
    /// How far the bodies are apart where it is taken for a contact before its time, m.
    gap: f64,
}

impl Event {
    fn is_rest(&self) -> bool {
        self.kind == EventKind::Impact && self.outcome == Outcome::Rest
    }

    fn plane(&self) -> ((usize, usize), DVec3) {
        (self.bodies, self.contact.normal)
    }
}

impl Ord for Event {
    /// The earliest is the greatest; at the same time the one of the lowest bodies.
    fn cmp(&self, other: &Event) -> Ordering {
        let time = other.time.total_cmp(&self.time);
        time.then(other.bodies.cmp(&self.bodies))
    }
}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Event) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Event {
    fn eq(&self, other: &Event) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Event {}

/// Pairs for a thread at least: less is faster done than handed over.
#[cfg(feature = "rayon")]
const PAIRS_A_TASK: usize = 32;

/// Pairs that are listed before they are sorted, and named once each.
const MAX_LISTED: usize = 1 << 16;

impl World {
    /// Events in one step after which it is given up. One in which bodies have no room, so that impacts
    /// follow each other in no time, is given up after some thousands.
    pub const MOST_IMPACTS: u64 = 4_000_000;

    /// Lets bodies have their impacts and contacts on the way from the previous state to the current one.
    pub(super) fn collide_continuously(&mut self) -> Result<(), StepError> {
        let before = (self.impacts, self.last_impact.clone());
        self.continuous.contacts_before.copy_from(&self.contacts);
        let placed = self.continuous.placed.then(|| {
            let position = self.previous.position.clone();
            (position, self.overlapping.clone())
        });
        self.bundled = Bundled::default();
        self.continuous.knows_near &= placed.is_none();
        self.separate_placed();
        if let Err((body, cause)) = self.collide_without_deepening() {
            (self.impacts, self.last_impact) = before;
            mem::swap(&mut self.contacts, &mut self.continuous.contacts_before);
            if let Some((position, overlapping)) = placed {
                self.continuous.placed = true;
                self.previous.position = position;
                self.overlapping = overlapping;
            }
            // Who fell asleep in the step has not.
            self.continuous.wake_all();
            return Err(self.failed(body, cause));
        }
        self.forget_parted_overlaps();
        self.bundled.bodies = self.contacts.bundled_bodies();
        self.contacts.end_step();
        self.contact_steps += u64::from(!self.contacts.is_empty());
        Ok(())
    }

    /// Goes through the phases once.
    fn collide_once(&mut self) -> Result<(), (usize, Cause)> {
        self.enter(Phase::Integrate);
        self.begin_trajectories();
        self.enter(Phase::Respond);
        self.keep_contacts()?;
        self.find_all_impacts()?;
        self.enter(Phase::Respond);
        self.resolve_all()?;
        self.enter(Phase::Narrow);
        let outcome = self.separate_meeting();
        self.enter(Phase::Respond);
        outcome
    }

    /// Solves the islands of contacts that the last step has left.
    fn keep_contacts(&mut self) -> Result<(), (usize, Cause)> {
        self.continuous.events.clear();
        self.continuous.resolved = 0;
        self.find_initial_contacts();
        self.keep_overlap_contacts();
        if self.contacts.is_empty() {
            return Ok(());
        }
        self.sleep_on();
        self.measure_contacts()?;
        self.unstagger_velocities();
        self.release_bouncing();
        self.hold_still();
        let mut restarted = mem::take(&mut self.continuous.restarted);
        restarted.clear();
        let all = self.contacts.all().iter();
        let both = all.flat_map(|contact| [contact.bodies.0, contact.bodies.1]);
        let seeds: Vec<usize> = both.filter(|&body| !self.is_asleep(body)).collect();
        self.solve_islands_of(&seeds, 0.0, &mut restarted)?;
        restarted.sort_unstable();
        restarted.dedup();
        self.stagger_velocities(&restarted);
        self.finish_restarted(&restarted)?;
        self.queue_contact_ends(&restarted);
        self.continuous.restarted = restarted;
        Ok(())
    }

    /// Finds the first impact of every pair that may have one.
    fn find_all_impacts(&mut self) -> Result<(), (usize, Cause)> {
        self.enter(Phase::Broad);
        self.find_candidate_pairs();
        self.enter(Phase::Narrow);
        self.queue_horizons(0..self.len());
        self.find_impacts_of_candidates()
    }

    /// Finds the pairs whose swept boxes meet.
    fn find_candidate_pairs(&mut self) {
        let mut broad = mem::take(&mut self.continuous.broad);
        let mut pairs = mem::take(&mut self.continuous.candidate_pairs);
        broad.fill(
            &self.solid,
            |body| self.swept(body),
            |body| self.front(body),
        );
        pairs.clear();
        broad.each_pair(|i, j| pairs.push((i, j)));
        pairs.retain(|&(i, j)| self.may_collide(i, j));
        let count = pairs.len();
        self.continuous.broad = broad;
        self.continuous.knows_near = true;
        self.continuous.candidate_pairs = pairs;
        for place in 0..count {
            let (i, j) = self.continuous.candidate_pairs[place];
            self.need_bvh(i);
            self.need_bvh(j);
        }
    }

    /// Finds the first impact of each pair that comes near.
    #[cfg(not(feature = "rayon"))]
    fn find_impacts_of_candidates(&mut self) -> Result<(), (usize, Cause)> {
        let mut probe = mem::take(&mut self.continuous.probe);
        let mut events = mem::take(&mut self.continuous.events);
        let pairs = self.continuous.candidate_pairs.iter();
        let found = pairs
            .filter(|&&(i, j)| !self.sleep_together(i, j))
            .try_for_each(|&(i, j)| {
                events.extend(self.find_impact(i, j, &mut probe)?);
                Ok(())
            });
        (self.continuous.probe, self.continuous.events) = (probe, events);
        found
    }

    /// The same on many threads. What is found depends on the pair alone, and the queue puts it in
    /// order.
    #[cfg(feature = "rayon")]
    fn find_impacts_of_candidates(&mut self) -> Result<(), (usize, Cause)> {
        use rayon::prelude::*;
        let find = |probe: &mut Probe, &(i, j): &(usize, usize)| match self.sleep_together(i, j) {
            true => None,
            false => self.find_impact(i, j, probe).transpose(),
        };
        let pairs = self.continuous.candidate_pairs.par_iter();
        let pairs = pairs.with_min_len(PAIRS_A_TASK);
        let found = pairs.map_init(Probe::default, find).flatten_iter();
        // The first error in the order of pairs, whatever the threads do.
        let found: Vec<Result<Event, (usize, Cause)>> = found.collect();
        for event in found {
            self.continuous.events.push(event?);
        }
        Ok(())
    }

    /// Resolves events in the order of time until none is left.
    fn resolve_all(&mut self) -> Result<(), (usize, Cause)> {
        let bodies = self.len();
        self.continuous.crush.begin();
        self.continuous.progress.begin(bodies);
        let mut group = mem::take(&mut self.continuous.group);
        while let Some(first) = self.next_event(f64::INFINITY) {
            let time = first.time;
            // The same instant, but for rounding.
            let until = time + 4.0 * f64::EPSILON * time;
            group.clear();
            group.push(first);
            while let Some(event) = self.next_event(until) {
                group.push(event);
            }
            self.sort_events(&mut group);
            self.count_events(&group)?;
            self.watch_crush(&group)?;
            self.resolve(&mut group, time)?;
            self.continuous.progress.note_changes(&group);
            if self.continuous.candidate_pairs.len() > MAX_LISTED {
                self.continuous.candidate_pairs.sort_unstable();
                self.continuous.candidate_pairs.dedup();
            }
        }
        self.continuous.group = group;
        Ok(())
    }

    /// Puts events of one time into an order that is not that of the places of bodies.
    fn sort_events(&self, events: &mut [Event]) {
        if events.len() < 2 {
            return;
        }
        let order = self.in_order(events.iter().map(|event| event.bodies));
        events.sort_by_cached_key(|event| {
            let time = ordinal(event.time);
            (time, order.between(event.bodies, event.contact.normal))
        });
    }

    /// Notes impacts with immovable bodies, and stops where they would go on for ever.
    fn watch_crush(&mut self, group: &[Event]) -> Result<(), (usize, Cause)> {
        let mut crush = mem::take(&mut self.continuous.crush);
        let watched = self.watch(group, &mut crush);
        self.continuous.crush = crush;
        watched
    }

    /// The next event no later than a time, of bodies that are still on the trajectories that led to it.
    fn next_event(&mut self, until: f64) -> Option<Event> {
        while let Some(event) = self.continuous.events.peek() {
            if event.time > until {
                return None;
            }
            let event = self.continuous.events.pop()?;
            if self.is_current(&event) {
                return Some(event);
            }
        }
        None
    }

    /// Whether the bodies of an event are still on the trajectories that lead to it.
    fn is_current(&self, event: &Event) -> bool {
        let ((i, j), version) = (event.bodies, &self.continuous.version);
        event.versions == (version[i], version[j])
    }

    /// Takes what a body sweeps on its new trajectory in the place of what it swept.
    fn update_swept(&mut self, body: usize) {
        if let Some(front) = self.front(body) {
            self.continuous.broad.replace_front(front);
        } else if self.shape[body].is_some() {
            let swept = self.swept(body);
            self.continuous.broad.replace(swept);
        }
    }

    /// Finds the next impacts of a body whose trajectory is new. Of two such, the pair is asked once.
    fn find_impacts_of(&mut self, body: usize, restarted: &[usize]) -> Result<(), (usize, Cause)> {
        if self.shape(body).is_none() {
            return Ok(());
        }
        let phase = self.enter(Phase::Narrow);
        let mut partners = mem::take(&mut self.continuous.partners);
        partners.clear();
        let broad = &self.continuous.broad;
        broad.each_partner(body, |other| partners.push(other));
        for &other in &partners {
            let pair = (body.min(other), body.max(other));
            let is_asked = other < body && restarted.binary_search(&other).is_ok();
            if is_asked || !self.may_collide(pair.0, pair.1) {
                continue;
            }
            self.continuous.candidate_pairs.push(pair);
            self.need_bvh(body);
            self.need_bvh(other);
            let mut probe = mem::take(&mut self.continuous.probe);
            let event = self.find_impact(pair.0, pair.1, &mut probe);
            self.continuous.probe = probe;
            if let Some(event) = event? {
                self.continuous.events.push(event);
            }
        }
        self.continuous.partners = partners;
        self.enter(phase);
        Ok(())
    }

    /// A box around a body all along its trajectory.
    fn swept(&self, body: usize) -> Swept {
        let (from, to) = (
            self.continuous.start.position[body],
            self.current.position[body],
        );
        let Extent {
            low,
            high,
            farthest,
            ..
        } = self.extent(body);
        // More than is lost in rounding, here and where vertices are placed, and than a search goes beyond
        // the end of the step; and as far as bodies may be moved where others that meet are parted.
        let bend = self.chord_deviation(body);
        let size = (from.abs() + to.abs() + 4.0 * bend + 2.0 * farthest).max_element();
        let reach = bend + 8192.0 * f64::EPSILON * size;
        Swept {
            min: from.min(to) + low - reach,
            max: from.max(to) + high + reach,
            body,
        }
    }

    /// The plane of a body at a place, if it is a half-space.
    fn front_at(&self, wall: usize, at: DVec3) -> Option<Front> {
        let &Shape::HalfSpace { normal } = self.shape(wall)? else {
            return None;
        };
        Some(Front {
            normal,
            body: wall,
            level: normal.dot(at),
            slack: 32.0 * f64::EPSILON * at.length(),
        })
    }

    /// The farthest that the plane of a body comes on its trajectory, if it is a half-space.
    fn front(&self, wall: usize) -> Option<Front> {
        let &Shape::HalfSpace { normal } = self.shape(wall)? else {
            return None;
        };
        let (from, to) = (
            self.continuous.start.position[wall],
            self.current.position[wall],
        );
        let deviation = self.chord_deviation(wall).dot(normal.abs());
        Some(Front {
            normal,
            body: wall,
            level: normal.dot(from).max(normal.dot(to)) + deviation,
            // More than is lost in rounding.
            slack: 16.0 * f64::EPSILON * (from.length() + to.length()),
        })
    }
}
