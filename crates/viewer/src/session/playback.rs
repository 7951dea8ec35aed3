//! The kept states of a run, to which the user can go back: a ring buffer of bounded size.
//!
//! Each state is a whole world, so that continuing from it gives the same bits as the first time.

use std::collections::VecDeque;

use sim_core::{Impact, World};

use super::{Exact, Missed, Sample};

/// The most states, and the most bodies in all of them together.
const MOST_STATES: usize = 3600;
const MOST_BODIES: usize = 200_000;

/// Bytes of a state, without the data that grows with its bodies.
const STATE_BYTES: usize = 4600;
/// Bytes that each body adds to a state.
const BODY_BYTES: usize = 350;
/// Bytes that each persisting contact adds to a state.
const CONTACT_BYTES: usize = 300;

/// A world after a step, the impacts of that step, and its figures.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    pub(super) world: World,
    pub(super) impacts: Vec<Impact>,
    pub(super) sample: Sample,
    /// [`World::state_hash`] of the world.
    pub(super) hash: u64,
    /// The impacts that its step has missed.
    pub(super) missed: Vec<Missed>,
}

/// The states since the start or the last change, the oldest first, and the current one.
#[derive(Debug, Default)]
pub struct Playback {
    moments: VecDeque<Moment>,
    now: usize,
}

impl Playback {
    /// Restarts with a world.
    pub(super) fn begin(&mut self, world: &World, exact: &mut Exact) {
        self.moments.clear();
        self.now = 0;
        self.moments.push_back(Moment {
            sample: Sample::of(world, exact.error(world), None, 0),
            hash: world.state_hash(),
            world: world.clone(),
            impacts: Vec::new(),
            missed: Vec::new(),
        });
    }

    /// The oldest state.
    pub(super) fn first(&self) -> Option<&World> {
        self.moments.front().map(|moment| &moment.world)
    }

    /// The figures of all states, the oldest first.
    pub fn samples(&self) -> impl ExactSizeIterator<Item = &Sample> + Clone {
        self.moments.iter().map(|moment| &moment.sample)
    }

    /// The figures of the current state.
    pub fn sample(&self) -> Option<&Sample> {
        self.moments.get(self.now).map(|moment| &moment.sample)
    }

    /// Adds states after the current one. Earlier states after it are removed, and the oldest ones if there is no more
    /// room.
    pub(super) fn extend(&mut self, moments: Vec<Moment>) {
        self.moments.truncate(self.now + 1);
        self.moments.extend(moments);
        let bodies = self.moments.back().map_or(0, |last| last.world.len());
        let kept = capacity(bodies);
        let beyond = self.moments.len().saturating_sub(kept);
        self.moments.drain(..beyond);
        self.now = self.moments.len().saturating_sub(1);
    }

    /// Makes a state the current one; the last one if the index is too large.
    pub(super) fn go_to(&mut self, index: usize) -> Option<&Moment> {
        self.now = index.min(self.moments.len().saturating_sub(1));
        self.moments.get(self.now)
    }

    /// The states up to the current one, the oldest first.
    pub(super) fn past(&self) -> impl DoubleEndedIterator<Item = &Moment> {
        self.moments.range(..self.moments.len().min(self.now + 1))
    }

    /// The number of states, at least one once a scene is open.
    #[expect(
        clippy::len_without_is_empty,
        reason = "it never is, for whoever sees it"
    )]
    pub fn len(&self) -> usize {
        self.moments.len()
    }

    /// The most states that are kept for a world with so many bodies.
    pub fn capacity(&self) -> usize {
        capacity(self.moments.back().map_or(0, |last| last.world.len()))
    }

    /// The approximate size of the states in bytes, without meshes, which are shared with the world.
    pub fn bytes(&self) -> usize {
        let state = |moment: &Moment| {
            let impacts = moment.impacts.capacity() * size_of::<Impact>();
            let contacts = CONTACT_BYTES * moment.sample.contacts;
            STATE_BYTES + BODY_BYTES * moment.world.len() + contacts + impacts
        };
        self.moments.iter().map(state).sum()
    }

    /// Index of the current state.
    pub fn now(&self) -> usize {
        self.now
    }

    /// Whether there are states after the current one.
    pub fn is_back(&self) -> bool {
        self.now + 1 < self.moments.len()
    }

    /// Simulated times of the oldest and of the latest state, s.
    pub fn span(&self) -> [f64; 2] {
        let time = |moment: Option<&Moment>| moment.map_or(0.0, |moment| moment.world.time());
        [time(self.moments.front()), time(self.moments.back())]
    }

    /// Index of the state nearest to a simulated time, s.
    pub fn nearest(&self, time: f64) -> usize {
        let after = self.moments.partition_point(|m| m.world.time() < time);
        let away = |i: usize| (self.moments[i].world.time() - time).abs();
        match (after.checked_sub(1), self.moments.len()) {
            (None, _) => 0,
            (Some(before), len) if after == len || away(before) <= away(after) => before,
            _ => after,
        }
    }

    /// Index of the first state at a simulated time, s, or after it; of the last state if there is none.
    pub(super) fn first_from(&self, time: f64) -> usize {
        let after = self.moments.partition_point(|m| m.world.time() < time);
        after.min(self.moments.len().saturating_sub(1))
    }

    /// Simulated times at which bodies passed through each other undetected, s.
    pub fn missed_times(&self) -> impl Iterator<Item = f64> {
        let missed = self.moments.iter().flat_map(|moment| &moment.missed);
        missed.map(|missed| missed.time)
    }

    /// Simulated times of impacts, found and missed, s.
    pub fn contact_times(&self) -> impl Iterator<Item = f64> {
        self.impact_times().chain(self.missed_times())
    }

    /// Simulated times of the detected impacts, s, in order of the steps.
    pub fn impact_times(&self) -> impl Iterator<Item = f64> {
        let impacts = self.moments.iter().flat_map(|moment| &moment.impacts);
        impacts.map(|impact| impact.time)
    }
}

pub(super) fn capacity(bodies: usize) -> usize {
    (MOST_BODIES / bodies.max(1)).clamp(2, MOST_STATES)
}
