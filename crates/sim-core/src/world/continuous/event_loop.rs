//! The loop over the events of a step, until none is left.

use alloc::vec::Vec;
use core::mem;

use super::super::{Impact, profile::Phase, record::Record, stepping::Cause};
#[cfg(feature = "rayon")]
use super::trajectory::Probe;
use super::{
    event::{Event, EventKind, EventQueue, Outcome},
    solver::ContactSolver,
    view::View,
    work::Work,
};

/// The least number of pairs for a thread. Fewer pairs are searched faster than they are handed over.
#[cfg(feature = "rayon")]
const PAIRS_A_TASK: usize = 32;

/// The phases of a step from the first event to the last.
pub(super) struct EventLoop<'a> {
    pub(super) solver: ContactSolver<'a>,
    pub(super) queue: &'a mut EventQueue,
    pub(super) record: &'a mut Record,
    /// The bodies whose trajectories are new.
    pub(super) restarted: &'a mut Vec<usize>,
}

impl EventLoop<'_> {
    #[inline]
    pub(super) fn view(&self) -> View<'_> {
        self.solver.view()
    }

    /// Adds an impact to the record and to the progress.
    pub(super) fn note_impact(&mut self, impact: Impact) {
        let mass = &self.solver.scene.bodies.mass;
        let masses = (mass[impact.bodies.0], mass[impact.bodies.1]);
        self.queue
            .progress
            .note_impulse(impact.impulse, impact.speeds.0, masses);
        self.record.note(impact);
    }

    /// Measures the contacts left from the last step and solves their islands.
    pub(super) fn keep_contacts(&mut self, is_placed: bool) -> Result<(), (usize, Cause)> {
        self.queue.waiting.clear();
        self.queue.resolved = 0;
        self.queue.work = Work::default();
        self.solver.paths.probe.work = Work::default();
        if is_placed {
            self.solver.find_initial_contacts();
        }
        self.solver.keep_overlap_contacts();
        if self.solver.contacts.is_empty() {
            return Ok(());
        }
        let first = self.solver.contacts.all()[0].bodies;
        self.solver.sleep_on();
        self.solver.measure_contacts()?;
        self.solver.unstagger_velocities();
        self.release_bouncing();
        self.solver.hold_still();
        let mut restarted = mem::take(self.restarted);
        restarted.clear();
        let all = self.solver.contacts.all().iter();
        let both = all.flat_map(|contact| [contact.bodies.0, contact.bodies.1]);
        let seeds: Vec<usize> = both.filter(|&body| !self.view().is_asleep(body)).collect();
        self.solver.solve_islands_of(&seeds, 0.0, &mut restarted)?;
        restarted.sort_unstable();
        restarted.dedup();
        self.solver.stagger_velocities(&restarted);
        self.solver.finish_restarted(&restarted)?;
        self.queue_contact_ends(&restarted);
        *self.restarted = restarted;
        self.count_work(first)
    }

    /// Counts the work done outside of the searches since the last call.
    pub(super) fn count_work(&mut self, pair: (usize, usize)) -> Result<(), (usize, Cause)> {
        self.queue
            .work
            .add(mem::take(&mut self.solver.paths.probe.work));
        self.queue.work.check(pair, self.solver.scene.bodies)
    }

    /// Finds the first impact of every pair that may have one.
    pub(super) fn find_all_impacts(&mut self) -> Result<(), (usize, Cause)> {
        self.record.enter(Phase::Broad);
        self.find_candidate_pairs();
        self.record.enter(Phase::Narrow);
        self.queue_horizons(0..self.solver.scene.bodies.len());
        self.find_impacts_of_candidates()
    }

    /// Finds the first impact of each pair that comes near.
    #[cfg(not(feature = "rayon"))]
    fn find_impacts_of_candidates(&mut self) -> Result<(), (usize, Cause)> {
        let mut probe = mem::take(&mut self.solver.paths.probe);
        let mut events = mem::take(&mut self.queue.waiting);
        let view = self.view();
        let pairs = self.solver.near.candidate_pairs.iter();
        let mut work = self.queue.work;
        let found = pairs
            .filter(|&&(i, j)| !view.sleep_together(i, j))
            .try_for_each(|&(i, j)| {
                events.extend(view.find_impact(i, j, &mut probe)?);
                work.add(mem::take(&mut probe.work));
                work.check((i, j), view.scene.bodies)
            });
        (self.solver.paths.probe, self.queue.waiting) = (probe, events);
        self.queue.work = work;
        found
    }

    /// The same on many threads. The result for a pair depends on the pair alone, and the queue sorts the events.
    #[cfg(feature = "rayon")]
    fn find_impacts_of_candidates(&mut self) -> Result<(), (usize, Cause)> {
        use rayon::prelude::*;
        let view = self.view();
        let find = |probe: &mut Probe, &(i, j): &(usize, usize)| match view.sleep_together(i, j) {
            true => None,
            false => match view.find_impact(i, j, probe) {
                Ok(None) if probe.work.is_none() => None,
                found => Some((
                    (i, j),
                    found.map(|event| (event, mem::take(&mut probe.work))),
                )),
            },
        };
        let pairs = self.solver.near.candidate_pairs.par_iter();
        let pairs = pairs.with_min_len(PAIRS_A_TASK);
        let found = pairs.map_init(Probe::default, find).flatten_iter();
        // The first error in the order of pairs, whatever the threads do.
        let found: Vec<_> = found.collect();
        let bodies = self.solver.scene.bodies;
        for (pair, found) in found {
            let (event, work) = found?;
            self.queue.waiting.extend(event);
            self.queue.work.add(work);
            self.queue.work.check(pair, bodies)?;
        }
        Ok(())
    }

    /// Resolves events in the order of time until none is left.
    pub(super) fn resolve_all(&mut self) -> Result<(), (usize, Cause)> {
        let bodies = self.solver.scene.bodies.len();
        self.queue.crush.begin();
        self.queue.progress.begin(bodies);
        let mut group = mem::take(&mut self.queue.group);
        while let Some(first) = self.next_event(f64::INFINITY) {
            let (time, pair) = (first.time, first.bodies);
            // The same time, up to rounding.
            let until = time + 4.0 * f64::EPSILON * time;
            group.clear();
            group.push(first);
            while let Some(event) = self.next_event(until) {
                group.push(event);
            }
            self.view().sort_events(&mut group);
            self.count_events(&group)?;
            self.watch_crush(&group)?;
            self.resolve(&mut group, time)?;
            self.count_work(pair)?;
            self.queue.progress.note_changes(&group);
            self.solver.near.shorten();
        }
        self.queue.group = group;
        Ok(())
    }

    /// Counts impacts with immovable bodies, and returns an error if they would go on for ever.
    pub(super) fn watch_crush(&mut self, group: &[Event]) -> Result<(), (usize, Cause)> {
        let mut crush = mem::take(&mut self.queue.crush);
        let watched = self.view().watch(group, &mut crush);
        self.queue.crush = crush;
        watched
    }

    /// The next event no later than `until` whose bodies are still on the trajectories that led to it.
    fn next_event(&mut self, until: f64) -> Option<Event> {
        while let Some(event) = self.queue.waiting.peek() {
            if event.time > until {
                return None;
            }
            let event = self.queue.waiting.pop()?;
            if self.solver.paths.is_current(&event) {
                return Some(event);
            }
        }
        None
    }

    /// Removes contacts that close so fast that they bounce; the impact search then finds them as impacts. Bodies in
    /// overlap bounce at once, because the search ignores them.
    pub(super) fn release_bouncing(&mut self) {
        for index in (0..self.solver.contacts.all().len()).rev() {
            let constraint = self.solver.contacts.all()[index];
            let (i, j) = constraint.bodies;
            let velocity = &self.solver.paths.start.velocity;
            let closing = (velocity[i] - velocity[j]).dot(constraint.normal);
            if self
                .view()
                .bounces(((i, j), constraint.normal), closing, constraint.load_speed)
            {
                match constraint.is_overlap {
                    true => self.exchange_there(&self.view().event_of(&constraint, 0.0), 0.0),
                    false => self.solver.contacts.remove(index),
                }
            }
        }
    }

    /// Queues the ends of contacts of some bodies.
    pub(super) fn queue_contact_ends(&mut self, bodies: &[usize]) {
        let mut events = mem::take(&mut self.queue.waiting);
        for &body in bodies {
            for &index in self.solver.contacts.of_body(body) {
                let constraint = &self.solver.contacts.all()[index as usize];
                let i = constraint.bodies.0;
                if constraint.ends_at < self.solver.scene.settings.dt
                    && (body == i || !self.solver.scene.bodies.is_movable(i))
                {
                    events.push(Event {
                        kind: EventKind::ContactEnd,
                        outcome: Outcome::Rest,
                        ..self.view().event_of(constraint, constraint.ends_at)
                    });
                }
            }
        }
        self.queue.waiting = events;
    }
}
