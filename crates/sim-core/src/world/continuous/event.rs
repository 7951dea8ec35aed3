//! The events of a step, which wait for their times.

use alloc::{collections::BinaryHeap, vec::Vec};
use core::cmp::Ordering;
use glam::DVec3;

use super::{crush::CrushDetector, progress::Progress, work::Work};
use crate::collide::Contact;

/// The events of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct EventQueue {
    pub(super) waiting: BinaryHeap<Event>,
    /// The number of resolved events.
    pub(super) resolved: u64,
    /// The work of the searches.
    pub(super) work: Work,
    /// The events of one time.
    pub(super) group: Vec<Event>,
    pub(super) crush: CrushDetector,
    pub(super) progress: Progress,
}

/// The kind of an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum EventKind {
    Impact,
    /// The surface of a contact ends, or begins to turn.
    ContactEnd,
    /// A trajectory is not known beyond this time.
    Horizon,
}

/// The outcome of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outcome {
    Bounce,
    /// The bodies stay in contact.
    Rest,
}

/// An event in the future.
#[derive(Clone, Debug)]
pub(super) struct Event {
    /// From the start of the step, s.
    pub(super) time: f64,
    pub(super) bodies: (usize, usize),
    pub(super) versions: (u32, u32),
    pub(super) kind: EventKind,
    /// The contact; its point is in world coordinates.
    pub(super) contact: Contact,
    /// The outcome, valid once the event is resolved.
    pub(super) outcome: Outcome,
    /// The speed with which forces would close the contact in a step, m/s.
    pub(super) load_speed: f64,
    /// How far apart the bodies are taken to be when the event is resolved, m: at its time the room that the search
    /// leaves between them, or for turning bodies the distance within which features touch; before its time the gap
    /// measured then.
    pub(super) gap: f64,
}

impl Event {
    /// An impact of two bodies at a time, at which they are `gap` apart, on trajectories with these versions.
    pub(super) fn impact(
        time: f64,
        bodies: (usize, usize),
        contact: Contact,
        gap: f64,
        version: &[u32],
    ) -> Event {
        Event {
            time,
            bodies,
            versions: (version[bodies.0], version[bodies.1]),
            kind: EventKind::Impact,
            contact,
            outcome: Outcome::Bounce,
            load_speed: 0.0,
            gap,
        }
    }

    pub(super) fn is_rest(&self) -> bool {
        self.kind == EventKind::Impact && self.outcome == Outcome::Rest
    }

    pub(super) fn plane(&self) -> ((usize, usize), DVec3) {
        (self.bodies, self.contact.normal)
    }
}

impl Ord for Event {
    /// The earliest event is the greatest; at the same time, the one with the lowest bodies.
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
