//! What steps have done, for who asks.

use alloc::vec::Vec;

use super::{Impact, profile::Timer};

/// What has happened since the world was made.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    pub(super) impacts: u64,
    pub(super) last_impact: Option<Impact>,
    /// Where impacts are listed, while someone asks.
    pub(super) list: Option<Vec<Impact>>,
    /// Reads a clock between phases, while someone asks.
    pub(super) timer: Option<Timer>,
    /// Steps that have ended with bodies in contact.
    pub(super) contact_steps: u64,
}

/// A place in the record, to go back to.
#[derive(Clone, Debug)]
pub(super) struct Mark {
    impacts: u64,
    last_impact: Option<Impact>,
    listed: usize,
}

impl Record {
    pub(super) fn note(&mut self, impact: Impact) {
        self.impacts += 1;
        if let Some(list) = &mut self.list {
            list.push(impact.clone());
        }
        self.last_impact = Some(impact);
    }

    pub(super) fn mark(&self) -> Mark {
        Mark {
            impacts: self.impacts,
            last_impact: self.last_impact.clone(),
            listed: self.list.as_ref().map_or(0, Vec::len),
        }
    }

    /// Forgets what has been noted since a mark.
    pub(super) fn go_back(&mut self, mark: &Mark) {
        self.impacts = mark.impacts;
        self.last_impact.clone_from(&mark.last_impact);
        if let Some(list) = &mut self.list {
            list.truncate(mark.listed);
        }
    }
}
