//! Sleeping bodies, which cost nothing until another body comes.
//!
//! An island at rest that nothing accelerates stays as it is. The same input gives the same result, so its
//! constraints need not be solved again. This is a memo and changes no result. If all bodies are asleep before and after
//! a step, the next one changes nothing but the time.

#[cfg(feature = "serde")]
use alloc::vec::Vec;
use glam::DVec3;

use super::{super::World, Continuous, solver::ContactSolver, view::View};

impl Continuous {
    /// Wakes all bodies, because something was changed from outside.
    pub(in crate::world) fn wake_all(&mut self) {
        self.asleep.clear();
        self.is_dormant = false;
    }

    /// The bodies that are asleep.
    #[cfg(feature = "serde")]
    pub(in crate::world) fn sleepers(&self) -> Vec<usize> {
        let bodies = 0..self.asleep.len();
        bodies.filter(|&body| self.asleep[body]).collect()
    }

    /// Puts some bodies to sleep; `bodies` is the number of all bodies.
    #[cfg(feature = "serde")]
    pub(in crate::world) fn put_to_sleep(&mut self, these: &[usize], bodies: usize) {
        self.asleep.resize(bodies, false);
        these.iter().for_each(|&body| self.asleep[body] = true);
    }
}

impl World {
    /// Whether every body that can move is asleep and no other one moves.
    pub(super) fn all_sleep(&self) -> bool {
        let sleeps = |(body, &asleep): (usize, &bool)| {
            asleep || !self.bodies.is_movable(body) && self.current.velocity[body] == DVec3::ZERO
        };
        self.continuous.asleep.len() == self.len()
            && self.continuous.asleep.iter().enumerate().all(sleeps)
    }
}

impl View<'_> {
    pub(super) fn is_asleep(&self, body: usize) -> bool {
        self.asleep.get(body).is_some_and(|&asleep| asleep)
    }

    /// Whether each of two bodies is asleep, or immovable and at rest.
    pub(super) fn sleep_together(&self, i: usize, j: usize) -> bool {
        let rests = |body: usize| {
            self.is_asleep(body)
                || !self.scene.bodies.is_movable(body)
                    && self.scene.before.velocity[body] == DVec3::ZERO
        };
        !self.asleep.is_empty() && rests(i) && rests(j)
    }
}

impl ContactSolver<'_> {
    pub(super) fn wake(&mut self, body: usize) {
        if let Some(asleep) = self.asleep.get_mut(body) {
            *asleep = false;
        }
    }

    pub(super) fn fall_asleep(&mut self, body: usize) {
        let bodies = self.scene.bodies.len();
        self.asleep.resize(bodies, false);
        self.asleep[body] = true;
    }

    /// Keeps sleeping bodies where they are.
    pub(super) fn sleep_on(&mut self) {
        for body in 0..self.asleep.len() {
            if self.asleep[body] {
                let paths = &mut *self.paths;
                paths.start.velocity[body] = DVec3::ZERO;
                paths.acceleration[body] = DVec3::ZERO;
                paths.end.position[body] = self.scene.before.position[body];
                paths.end.velocity[body] = DVec3::ZERO;
            }
        }
    }
}
