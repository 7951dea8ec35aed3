//! The motion of bodies, in columns.

use alloc::vec::Vec;
use core::ops::Range;
use glam::{DQuat, DVec3};

/// Motion of all bodies.
#[derive(Debug, Default)]
pub(super) struct State {
    /// Places, m; of bodies that turn, of their centres of mass.
    pub(super) position: Vec<DVec3>,
    pub(super) velocity: Vec<DVec3>,
    /// The rotations of turning bodies, by slot.
    pub(super) turned: Vec<Turned>,
}

/// The rotation and angular momentum of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub(super) struct Turned {
    /// The rotation from principal axes into the world.
    pub(super) rotation: DQuat,
    /// Angular momentum about the centre of mass in the world, kg m²/s; of an immovable body, per kg m² of it.
    pub(super) momentum: DVec3,
}

impl Clone for State {
    fn clone(&self) -> State {
        State {
            position: self.position.clone(),
            velocity: self.velocity.clone(),
            turned: self.turned.clone(),
        }
    }

    /// Keeps the allocated memory, because steps must not allocate.
    fn clone_from(&mut self, other: &State) {
        self.position.clone_from(&other.position);
        self.velocity.clone_from(&other.velocity);
        self.turned.clone_from(&other.turned);
    }
}

impl State {
    pub(super) fn push(&mut self, position: DVec3, velocity: DVec3) {
        self.position.push(position);
        self.velocity.push(velocity);
    }

    /// Removes a body; the indices of the bodies after it decrease by one.
    pub(super) fn remove(&mut self, body: usize) {
        self.position.remove(body);
        self.velocity.remove(body);
    }

    /// Resizes to the number of bodies of another state.
    pub(super) fn match_len(&mut self, other: &State) {
        self.position.resize(other.position.len(), DVec3::ZERO);
        self.velocity.resize(other.velocity.len(), DVec3::ZERO);
        self.turned.resize(other.turned.len(), Turned::default());
    }

    /// The first of some bodies with a component of position or velocity that is beyond ±`largest` or NaN, as an index
    /// relative to the first of them.
    pub(super) fn beyond(&self, bodies: Range<usize>, largest: f64) -> Option<usize> {
        let largest = DVec3::splat(largest);
        let within = |x: &DVec3| x.abs().cmple(largest).all();
        let lost = |(x, v): (&DVec3, &DVec3)| !(within(x) && within(v));
        let position = self.position[bodies.clone()].iter();
        position.zip(&self.velocity[bodies]).position(lost)
    }
}
