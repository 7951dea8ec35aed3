//! Counts of rests, climbs, handovers and bounces of each body in a step.

use alloc::vec::Vec;

/// Counts by body; each list is empty until there is something to count.
#[derive(Clone, Debug, Default)]
pub(super) struct Tallies {
    /// How often each body has come to rest.
    pub(super) rests: Vec<u32>,
    /// How often each body has been lifted onto a ledge.
    pub(super) climbs: Vec<u32>,
    /// How often each body has been handed over to another one.
    pub(super) handed: Vec<u32>,
    /// The impacts of each body, counted only if some impacts lose energy.
    pub(super) bounces: Vec<Bounces>,
}

/// The impacts of a body in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bounces {
    pub(super) count: u32,
    /// The greatest closing speed of one of them, m/s.
    pub(super) fastest: f64,
}

impl Tallies {
    /// Begins a step.
    pub(super) fn clear(&mut self) {
        self.rests.clear();
        self.climbs.clear();
        self.handed.clear();
        self.bounces.clear();
    }
}
