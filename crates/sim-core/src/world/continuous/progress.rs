//! Whether a step makes progress, or impacts follow each other without time between them and without end.
//!
//! If bodies have no room, as between walls that fit them, impacts repeat and the step never ends. Without time
//! between impacts the bodies stay where they are, and so do the normals `n` of their contacts. If there is room,
//! there are motions in which every contact opens: velocities `w` with `n·(w_j - w_i) >= 1` for each contact. The
//! sharper the angles, the greater these velocities are. Impulses `λ` change the momenta `p` by `Σ λ n`, so that
//! `Σ λ <= Σ λ n·(w_j - w_i) = Σ w·Δp`. So the sum of impulses is bounded by the momenta times the number of bodies
//! and a factor that depends on the angles. Without room there is no bound. Any number of blocks may count the digits
//! of pi: the sum of their impulses is four times the momentum of the largest.
//!
//! Impacts count as simultaneous while no pair has had the time to move by more than the gap of bodies in contact,
//! which is the least room that this mode distinguishes.

use alloc::vec::Vec;

use super::super::{World, stepping::Cause};
use super::{
    event::{Event, EventKind, Outcome},
    event_loop::EventLoop,
    view::View,
};

/// The greatest sum of impulses without time between them, in momenta of each body: an angle of 1e-3 between
/// contacts.
const MOST_EXCHANGED: f64 = 1e3;

/// How often a body may take part in a simultaneous event without an impulse: the begin or end of a contact, or an
/// impact at which nothing is exchanged.
const MOST_CHANGES: u64 = 1_000;

/// The events without time between them.
#[derive(Clone, Debug, Default)]
pub(in crate::world) struct Progress {
    /// The time of the last of them, s from the start of the step.
    time: f64,
    /// The sum of impulses and the largest one, N s, and the number of events without an impulse.
    impulse: f64,
    largest: f64,
    changes: u64,
    /// The greatest closing speed of two bodies, m/s, and the greatest finite mass of a body, kg.
    fastest: f64,
    heaviest: f64,
    /// The number of the current instant; by body, the last instant in which it took part; and the number of bodies
    /// that took part in the current one.
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

    /// Counts an impulse between bodies of some masses that have closed at a speed.
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

    /// Counts an impact without an impulse, of bodies that do not close.
    pub(super) fn note_nothing(&mut self) {
        self.changes += 1;
    }

    /// Counts the resolved events that are not bounces.
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
        // A body that lies on others passes on more momentum than it has itself.
        let momentum = self.largest.max(self.heaviest * self.fastest);
        self.impulse <= MOST_EXCHANGED * bodies * momentum
            && self.changes <= MOST_CHANGES * self.bodies
    }
}

impl EventLoop<'_> {
    /// Counts events that are about to be resolved, and returns an error if the simultaneous ones before them have no
    /// end. If a body has been between immovable ones that move against each other, the error is that it is squeezed.
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
    /// Whether the bodies of an event have moved by more than a gap since the time `last`: towards each other, or
    /// along each other if a contact ends.
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

    /// Thousands of impacts without an impulse suffice to detect that they have no end.
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
