//! Whether a step gets on: impacts that follow each other in no time, and have no end.
//!
//! Where bodies have no room, as between walls that fit them, impacts repeat and the step never ends.
//! Without time between them bodies stay where they are, and the normals `n` of their contacts the
//! same. If there is room, there are ways to go on which every contact opens: velocities `w` with
//! `n·(w_j - w_i) >= 1` for each contact, as fast as their angles are sharp. Impulses `λ` change the
//! momenta `p` by `Σ λ n`, so that `Σ λ <= Σ λ n·(w_j - w_i) = Σ w·Δp`: what is exchanged in all is
//! bounded by the momenta there are, times the number of bodies and a factor that the angles make.
//! Without room nothing bounds it. So many blocks as one likes may count the digits of pi: all that
//! they exchange is four times the momentum of the largest.
//!
//! Impacts are taken for those of one instant while no pair has the time to move by more than the gap
//! of bodies in contact, below which this mode knows no room.

use alloc::vec::Vec;

use super::super::{World, stepping::Cause};
use super::{
    event::{Event, EventKind, Outcome},
    event_loop::EventLoop,
    view::View,
};

/// What bodies may exchange in no time, in momenta of each: an angle of 1e-3 between contacts.
const MOST_EXCHANGED: f64 = 1e3;

/// How often a body may take part in something in no time that goes without an impulse: a contact that begins or
/// ends, an impact at which nothing is exchanged.
const MOST_CHANGES: u64 = 1_000;

/// What has happened in no time.
#[derive(Clone, Debug, Default)]
pub(in crate::world) struct Progress {
    /// When it last did, s from the start of the step.
    time: f64,
    /// Impulses exchanged, N s, in all and the largest, and events without one.
    impulse: f64,
    largest: f64,
    changes: u64,
    /// The greatest speed at which two bodies have closed, m/s, and the greatest mass that has, kg.
    fastest: f64,
    heaviest: f64,
    /// The bodies that have taken part, by the number of the instant.
    instant: u32,
    part_of: Vec<u32>,
    bodies: u64,
}

impl Progress {
    /// Begins a step.
    pub(super) fn begin(&mut self, bodies: usize) {
        self.part_of.clear();
        self.part_of.resize(bodies, 0);
        self.instant = 0;
        self.begin_instant(0.0);
    }

    fn begin_instant(&mut self, time: f64) {
        self.time = time;
        (self.impulse, self.largest, self.changes) = (0.0, 0.0, 0);
        (self.fastest, self.heaviest) = (0.0, 0.0);
        (self.instant, self.bodies) = (self.instant + 1, 0);
    }

    /// Notes an impulse between bodies of some masses that have closed at a speed.
    pub(in crate::world) fn note_impulse(
        &mut self,
        impulse: f64,
        closing: f64,
        masses: (f64, f64),
    ) {
        if impulse == 0.0 {
            self.note_nothing();
        }
        self.impulse += impulse;
        self.largest = self.largest.max(impulse);
        self.fastest = self.fastest.max(closing);
        for mass in [masses.0, masses.1] {
            if mass.is_finite() {
                self.heaviest = self.heaviest.max(mass);
            }
        }
    }

    /// Notes an impact at which nothing is exchanged: bodies that do not close.
    pub(super) fn note_nothing(&mut self) {
        self.changes += 1;
    }

    /// Notes events that have been resolved.
    pub(super) fn note_changes(&mut self, group: &[Event]) {
        let is_change = |event: &&Event| event.outcome == Outcome::Rest;
        self.changes += group.iter().filter(is_change).count() as u64;
    }

    fn takes_part(&self, body: usize) -> bool {
        self.part_of[body] == self.instant
    }

    fn take_part(&mut self, body: usize) {
        if !self.takes_part(body) {
            self.part_of[body] = self.instant;
            self.bodies += 1;
        }
    }

    fn has_end(&self) -> bool {
        let bodies = self.bodies as f64;
        // What lies on others gives on more than it has itself.
        let momentum = self.largest.max(self.heaviest * self.fastest);
        self.impulse <= MOST_EXCHANGED * bodies * momentum
            && self.changes <= MOST_CHANGES * self.bodies
    }
}

impl EventLoop<'_> {
    /// Counts events that are about to be resolved, and stops where those before them have no end: where
    /// a body has been between immovable ones that move against each other, it is squeezed.
    pub(super) fn count_events(&mut self, group: &[Event]) -> Result<(), (usize, Cause)> {
        let Some(first) = group.first() else {
            return Ok(());
        };
        let body = first.bodies.1;
        self.queue.resolved += group.len() as u64;
        let resolved = self.queue.resolved;
        if resolved > World::MOST_IMPACTS {
            return Err((body, Cause::Impacts(World::MOST_IMPACTS)));
        }
        if self.view().moves_since(first, self.queue.progress.time) {
            self.queue.progress.begin_instant(first.time);
        }
        let progress = &mut self.queue.progress;
        progress.time = first.time;
        for event in group {
            progress.take_part(event.bodies.0);
            progress.take_part(event.bodies.1);
        }
        let progress = &self.queue.progress;
        if progress.has_end() {
            return Ok(());
        }
        let caught = (0..self.solver.scene.bodies.len()).filter(|&body| progress.takes_part(body));
        let crush = &self.queue.crush;
        let mut squeezed = caught.filter_map(|body| Some((body, crush.between(body)?)));
        Err(match squeezed.next() {
            Some((body, between)) => (body, Cause::Squeezed(between)),
            None => (body, Cause::Impacts(resolved)),
        })
    }
}

impl View<'_> {
    /// Whether the bodies of an event have moved by more than a gap since events at a time: towards
    /// each other, or along each other where a contact ends.
    fn moves_since(&self, event: &Event, last: f64) -> bool {
        let (i, j) = event.bodies;
        let time = event.time - last;
        let velocity = &self.paths.start.velocity;
        let relative = velocity[i] - velocity[j];
        let speed = match event.kind {
            EventKind::Impact => relative.dot(event.contact.normal).abs(),
            EventKind::ContactEnd => relative.length(),
            EventKind::Horizon => return true,
        };
        time * speed > self.layout().hover_gap(i, j)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thousands of impacts at which nothing is exchanged are enough to see that they have no end.
    #[test]
    fn what_exchanges_nothing_in_no_time_has_no_end() {
        let mut progress = Progress::default();
        progress.begin(3);
        (0..3).for_each(|body| progress.take_part(body));
        let impacts = (0..).take_while(|_| {
            progress.note_impulse(0.0, 1e-12, (1.0, 1.0));
            progress.has_end()
        });
        assert_eq!(impacts.count() as u64, 3 * MOST_CHANGES);
    }
}
