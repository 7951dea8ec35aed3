//! The record of steps: counts, and on request impacts and events.

use alloc::{boxed::Box, vec::Vec};

use super::{Impact, events::Events, profile::Timer};

/// The record since the world was made.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    pub(super) impacts: u64,
    pub(super) last_impact: Option<Impact>,
    /// The list of impacts, while it is requested.
    pub(super) list: Option<Vec<Impact>>,
    /// Reads a clock between phases, while this is requested.
    pub(super) timer: Option<Timer>,
    /// Contacts that begin and end, while these are requested.
    pub(super) events: Option<Box<Events>>,
    /// The number of steps that ended with bodies in contact.
    pub(super) contact_steps: u64,
}

/// A state of the record to which it can be reset.
#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    impacts: u64,
    last_impact: Option<Impact>,
    listed: usize,
    pushes: usize,
}

impl Record {
    pub(super) fn note(&mut self, impact: Impact) {
        self.impacts += 1;
        if let Some(list) = &mut self.list {
            list.push(impact.clone());
        }
        if let Some(events) = &mut self.events {
            events.note(&impact);
        }
        self.last_impact = Some(impact);
    }

    /// Removes the entries of a body; the indices of the bodies after it decrease by one.
    pub(super) fn remove_body(&mut self, body: usize) {
        let is_gone = |impact: &mut Impact| impact.bodies.0 == body || impact.bodies.1 == body;
        self.last_impact.take_if(is_gone);
        if let Some(Impact { bodies: (i, j), .. }) = &mut self.last_impact {
            *i -= usize::from(*i > body);
            *j -= usize::from(*j > body);
        }
    }

    pub(super) fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            impacts: self.impacts,
            last_impact: self.last_impact.clone(),
            listed: self.list.as_ref().map_or(0, Vec::len),
            pushes: self
                .events
                .as_ref()
                .map_or(0, |events| events.impacts.len()),
        }
    }

    /// Removes the entries since a checkpoint.
    pub(super) fn roll_back(&mut self, to: &Checkpoint) {
        self.impacts = to.impacts;
        self.last_impact.clone_from(&to.last_impact);
        if let Some(list) = &mut self.list {
            list.truncate(to.listed);
        }
        if let Some(events) = &mut self.events {
            events.impacts.truncate(to.pushes);
        }
    }
}
