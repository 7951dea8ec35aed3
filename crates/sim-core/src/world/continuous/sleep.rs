//! Bodies at rest, which cost nothing until something comes.
//!
//! An island that is at rest and has nothing to accelerate it stays as it is: the same input gives the
//! same answer, so its constraints need not be solved again. This is a memo, and changes no answer.

use glam::DVec3;

use super::{super::World, Continuous};

impl Continuous {
    /// Wakes all bodies: something has changed from outside.
    pub(in crate::world) fn wake_all(&mut self) {
        self.asleep.clear();
    }
}

impl World {
    pub(super) fn is_asleep(&self, body: usize) -> bool {
        self.continuous
            .asleep
            .get(body)
            .is_some_and(|&asleep| asleep)
    }

    pub(super) fn wake(&mut self, body: usize) {
        if let Some(asleep) = self.continuous.asleep.get_mut(body) {
            *asleep = false;
        }
    }

    pub(super) fn fall_asleep(&mut self, body: usize) {
        let bodies = self.bodies.len();
        self.continuous.asleep.resize(bodies, false);
        self.continuous.asleep[body] = true;
    }

    /// Keeps bodies at rest where they are.
    pub(super) fn sleep_on(&mut self) {
        for body in 0..self.continuous.asleep.len() {
            if self.continuous.asleep[body] {
                let continuous = &mut self.continuous;
                continuous.start.velocity[body] = DVec3::ZERO;
                continuous.acceleration[body] = DVec3::ZERO;
                self.current.position[body] = self.previous.position[body];
                self.current.velocity[body] = DVec3::ZERO;
            }
        }
    }

    /// Whether two bodies are at rest beside each other.
    pub(super) fn sleep_together(&self, i: usize, j: usize) -> bool {
        let rests = |body: usize| {
            self.is_asleep(body)
                || !self.bodies.is_movable(body) && self.previous.velocity[body] == DVec3::ZERO
        };
        !self.continuous.asleep.is_empty() && rests(i) && rests(j)
    }
}
