//! How often things have happened to each body in a step.

use alloc::vec::Vec;

/// Counts by body, each once there is one.
#[derive(Clone, Debug, Default)]
pub(super) struct Tallies {
    /// How often each body has come to rest.
    pub(super) rests: Vec<u32>,
    /// How often it has been lifted onto a ledge.
    pub(super) climbs: Vec<u32>,
    /// How often it has been handed over to another one.
    pub(super) handed: Vec<u32>,
    /// What impacts it has had, where some give back a part only.
    pub(super) bounces: Vec<Bounces>,
}

/// Impacts of a body in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bounces {
    pub(super) count: u32,
    /// The greatest speed at which one closed, m/s.
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
