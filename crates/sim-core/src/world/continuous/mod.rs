//! Impacts at the time at which they happen.
//!
//! Each body has a *way* through the step ([`way`]). For each pair whose swept boxes meet, the next
//! impact on their ways is sought ([`seek`]) and waits in a queue. The earliest one is answered
//! ([`respond`]): the bodies' ways end there, an impulse is exchanged, and new ways start, with new
//! impacts to be sought. What happens at the same instant is answered together. At the end of the
//! step an exact test makes sure that no two bodies meet, and moves apart by a rounding those that
//! do ([`part`]).
//!
//! A step costs a box test for each pair that comes near, a search for each whose swept boxes
//! meet, and two searches or so for each impact. Nothing but the motion goes from step to step,
//! beside an order of boxes that saves time.

mod hold;
mod part;
mod respond;
mod seek;
mod squeeze;
#[cfg(test)]
mod tests;
mod way;

use alloc::{collections::BinaryHeap, vec::Vec};
use core::{cmp::Ordering, mem};
use glam::DVec3;

use super::{StepError, World, state::State, stepping::Cause};
use crate::{
    Extent, Shape,
    collide::{Broad, Contact, Front, Swept},
};
use respond::{Answer, Rest};
use squeeze::Squeeze;
use way::Probe;

/// What a step with continuous collision needs beside the state; empty while there is none.
#[derive(Clone, Debug, Default)]
pub(super) struct Continuous {
    /// Motion of each body where its way starts, and when that is, s from the step's start.
    start: State,
    since: Vec<f64>,
    /// How often a body's way has changed in this step; an impact of an older way is void.
    version: Vec<u32>,
    /// What forces do to each body all along its way, m/s²: constant ones, or under a method of
    /// first order all of them.
    given: Vec<DVec3>,
    /// The same together with what resting contacts do.
    acceleration: Vec<DVec3>,
    /// How long before that of its way a body's velocity is the one that the method keeps, s.
    lag: f64,
    /// How often each body has come to rest in this step, once one has; one that has too often stops
    /// for the rest of it.
    rests: Vec<u32>,
    /// What impacts each body has had in this step, once one has, where some give back a part only.
    bounces: Vec<Bounces>,
    /// Contacts whose bodies stay together for the rest of the step.
    resting: Vec<Rest>,
    events: BinaryHeap<Event>,
    /// Pairs that have come near in this step.
    near: Vec<(usize, usize)>,
    broad: Broad,
    probe: Probe,
    renewed_motion: Vec<(DVec3, DVec3)>,
    /// Bodies whose ways are new, and bodies that may come near one of them.
    renewed: Vec<usize>,
    partners: Vec<usize>,
    /// What happens at one instant.
    group: Vec<Event>,
    /// Whether every way is a parabola.
    is_free: bool,
    /// Whether overlapping pairs have been placed since it was seen whether they just touch.
    pub(super) placed: bool,
}

/// Impacts of a body in a step.
#[derive(Clone, Copy, Debug, Default)]
struct Bounces {
    count: u32,
    /// The greatest speed at which one closed, m/s.
    fastest: f64,
}

/// An impact to come.
#[derive(Clone, Debug)]
struct Event {
    /// From the start of the step, s.
    time: f64,
    bodies: (usize, usize),
    versions: (u32, u32),
    /// Its point is in the world.
    contact: Contact,
    /// What becomes of it, once its time has come.
    answer: Answer,
    /// Speed at which forces would close it in a step, m/s.
    pressure: f64,
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

/// A body that comes to rest so often in one step is wedged in, and stops for what is left of it: so
/// a step ends whatever lies on what.
const MOST_RESTS: u32 = 32;

/// Pairs that are listed before they are sorted, and named once each.
const MOST_NEAR: usize = 1 << 16;

impl World {
    /// Impacts in one step after which it is given up, as without end.
    pub const MOST_IMPACTS: u64 = 4_000_000;

    /// Lets bodies have their impacts on the way from the previous state to the current one.
    pub(super) fn collide_continuously(&mut self) -> Result<(), StepError> {
        let before = (self.impacts, self.last_impact.clone());
        self.part_touching();
        self.start_ways();
        let done = self
            .seek_all()
            .and_then(|()| self.answer_all())
            .and_then(|()| self.part_near());
        if let Err((body, cause)) = done {
            (self.impacts, self.last_impact) = before;
            return Err(self.failed(body, cause));
        }
        self.part_overlapping();
        Ok(())
    }

    /// Seeks the first impact of every pair that may have one.
    fn seek_all(&mut self) -> Result<(), (usize, Cause)> {
        self.find_near();
        self.continuous.resting.clear();
        if self.continuous.lag < 0.0 && self.hold()? {
            self.find_near();
        }
        self.continuous.events.clear();
        self.seek_near()
    }

    /// Finds the pairs whose swept boxes meet.
    fn find_near(&mut self) {
        let mut broad = mem::take(&mut self.continuous.broad);
        let mut near = mem::take(&mut self.continuous.near);
        broad.fill(
            &self.solid,
            |body| self.swept(body),
            |body| self.front(body),
        );
        near.clear();
        broad.each_pair(|i, j| near.push((i, j)));
        near.retain(|&(i, j)| self.may_collide(i, j));
        let count = near.len();
        self.continuous.broad = broad;
        self.continuous.near = near;
        for place in 0..count {
            let (i, j) = self.continuous.near[place];
            self.need_bvh(i);
            self.need_bvh(j);
        }
    }

    /// Seeks the first impact of each pair that comes near.
    #[cfg(not(feature = "rayon"))]
    fn seek_near(&mut self) -> Result<(), (usize, Cause)> {
        let mut probe = mem::take(&mut self.continuous.probe);
        let mut events = mem::take(&mut self.continuous.events);
        let found = self.continuous.near.iter().try_for_each(|&(i, j)| {
            events.extend(self.seek(i, j, &mut probe)?);
            Ok(())
        });
        (self.continuous.probe, self.continuous.events) = (probe, events);
        found
    }

    /// The same on many threads. What is found depends on the pair alone, and the queue puts it in
    /// order.
    #[cfg(feature = "rayon")]
    fn seek_near(&mut self) -> Result<(), (usize, Cause)> {
        use rayon::prelude::*;
        let seek = |probe: &mut Probe, &(i, j): &(usize, usize)| self.seek(i, j, probe).transpose();
        let pairs = self.continuous.near.par_iter().with_min_len(PAIRS_A_TASK);
        let found = pairs.map_init(Probe::default, seek).flatten_iter();
        // The first error in the order of pairs, whatever the threads do.
        let found: Vec<Result<Event, (usize, Cause)>> = found.collect();
        for event in found {
            self.continuous.events.push(event?);
        }
        Ok(())
    }

    /// Answers impacts in the order of time until none is left.
    fn answer_all(&mut self) -> Result<(), (usize, Cause)> {
        let mut answered = 0;
        let mut squeeze = Squeeze::default();
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
            answered += group.len() as u64;
            if answered > World::MOST_IMPACTS {
                return Err((group[0].bodies.1, Cause::Impacts));
            }
            self.watch(&group, &mut squeeze)?;
            self.answer(&mut group, time)?;
            if self.continuous.near.len() > MOST_NEAR {
                self.continuous.near.sort_unstable();
                self.continuous.near.dedup();
            }
        }
        self.continuous.group = group;
        Ok(())
    }

    /// The next impact no later than a time, of bodies that are still on the ways that led to it.
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

    /// Whether the bodies of an impact are still on the ways that lead to it.
    fn is_current(&self, event: &Event) -> bool {
        let ((i, j), version) = (event.bodies, &self.continuous.version);
        event.versions == (version[i], version[j])
    }

    /// Takes what a body sweeps on its new way in the place of what it swept.
    fn replace(&mut self, body: usize) {
        if let Some(front) = self.front(body) {
            self.continuous.broad.replace_front(front);
        } else if self.shape[body].is_some() {
            let swept = self.swept(body);
            self.continuous.broad.replace(swept);
        }
    }

    /// Seeks the next impacts of a body whose way is new. Of two such, the pair is sought once.
    fn seek_from(&mut self, body: usize, renewed: &[usize]) -> Result<(), (usize, Cause)> {
        if self.shape(body).is_none() {
            return Ok(());
        }
        let mut partners = mem::take(&mut self.continuous.partners);
        partners.clear();
        let broad = &self.continuous.broad;
        broad.each_partner(body, |other| partners.push(other));
        for &other in &partners {
            if !self.may_collide(body, other) || (other < body && renewed.contains(&other)) {
                continue;
            }
            let pair = (body.min(other), body.max(other));
            self.continuous.near.push(pair);
            self.need_bvh(body);
            self.need_bvh(other);
            let mut probe = mem::take(&mut self.continuous.probe);
            let event = self.seek(pair.0, pair.1, &mut probe);
            self.continuous.probe = probe;
            if let Some(event) = event? {
                self.continuous.events.push(event);
            }
        }
        self.continuous.partners = partners;
        Ok(())
    }

    /// A box around a body all along its way.
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
        // More than is lost in rounding, here and where vertices are placed.
        let size = from.abs() + to.abs() + 2.0 * farthest;
        let reach = self.bulge(body) + 8.0 * f64::EPSILON * size;
        Swept {
            min: from.min(to) + low - reach,
            max: from.max(to) + high + reach,
            body,
        }
    }

    /// The farthest that the plane of a body comes on its way, if it is a half-space.
    fn front(&self, wall: usize) -> Option<Front> {
        let &Shape::HalfSpace { normal } = self.shape(wall)? else {
            return None;
        };
        let (from, to) = (
            self.continuous.start.position[wall],
            self.current.position[wall],
        );
        let bulge = self.bulge(wall).dot(normal.abs());
        Some(Front {
            normal,
            body: wall,
            level: normal.dot(from).max(normal.dot(to)) + bulge,
            // More than is lost in rounding.
            slack: 16.0 * f64::EPSILON * (from.length() + to.length()),
        })
    }
}
