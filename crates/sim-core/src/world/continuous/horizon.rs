//! How far a method computes the motion of bodies before their impacts are known.
//!
//! Forces between bodies, and towards a centre, may grow without bound at places that no body ever reaches, because
//! it meets another one first. A method that computed the whole step would pass through these places, and fail or
//! give a wrong motion. So it computes the motion up to a *horizon* only:
//!
//! - A method with error control reports each step that it takes within `dt`, and stops after the first one on whose
//!   chord two bodies meet. Each of these steps keeps the tolerance, so that it does not go past a place within a
//!   body.
//! - If another method finds no motion for the whole step, it computes a part of the step. The length is found by
//!   bisection between parts on which nothing is met and parts for which there is no motion, until something is met
//!   on one. If nothing is, the step fails with its first error.
//!
//! Impacts are searched up to the horizon. There the trajectory starts again from the motion after these impacts, and
//! has a new horizon.

use alloc::vec::Vec;
use core::{mem, ops::Range};
use glam::DVec3;

use super::super::{
    scene::Scene,
    state::State,
    stepping::{Block, Cause},
};
use super::{
    contact_set::ContactSet,
    event::{Event, EventKind, Outcome},
    event_loop::EventLoop,
    impact_search::nearest_on_chord,
    trajectory::Motion,
    view::View,
};
use crate::{
    Shape,
    collide::{Contact, first_contact, snap},
    force::Reach,
    integrate::Scratch,
};

/// The number of bisections of a step in search of a part for which there is a motion, and on which something is met.
const HALVINGS: u32 = 52;

impl Motion<'_> {
    /// The time until which the trajectory of a body is known, s from the step's start.
    #[inline]
    pub(super) fn horizon(&self, body: usize) -> f64 {
        let known = self.paths.horizons.known.get(body).copied();
        known.unwrap_or(self.scene.settings.dt)
    }
}

impl View<'_> {
    /// Whether forces on one of two bodies may grow without bound, and the method has error control, so that it
    /// follows the forces however short the time is in which they change.
    pub(super) fn are_steep(&self, i: usize, j: usize) -> bool {
        if !self.scene.settings.method.adaptive {
            return false;
        }
        let forced = [i, j].map(|body| self.motion().coupled_group(body));
        let mut forced = forced.into_iter().flatten();
        forced.any(|(bodies, is_coupled)| self.scene.are_forces_steep(&bodies, is_coupled))
    }
}

/// The times until which trajectories are known, s from the step's start.
#[derive(Clone, Debug, Default)]
pub(in crate::world) struct Horizons {
    /// By body; empty if all are known to the step's end.
    known: Vec<f64>,
}

impl Horizons {
    /// Sets all horizons to the end of the step.
    pub(in crate::world) fn clear(&mut self) {
        self.known.clear();
    }

    /// Stores the horizon of some bodies; `None` is the end of the step.
    pub(in crate::world) fn set(
        &mut self,
        bodies: Range<usize>,
        time: Option<f64>,
        scene: &Scene<'_>,
    ) {
        let (all, dt) = (scene.bodies.len(), scene.settings.dt);
        if self.known.is_empty() && time.is_none() {
            return;
        }
        self.known.resize(all, dt);
        self.known[bodies].fill(time.unwrap_or(dt));
    }
}

impl Scene<'_> {
    /// Steps a block as far as contacts let the method be evaluated. Returns that time, s from the step's start, if
    /// it is before the block's end.
    pub(in crate::world) fn step_to_horizon(
        &self,
        contacts: &ContactSet,
        block: Block<'_>,
        to: &mut State,
        scratch: &mut Scratch,
    ) -> Result<Option<f64>, (usize, Cause)> {
        let (since, length) = (block.since, block.length);
        if !self.has_horizon(&block) {
            self.step_block(block, to, scratch, None)?;
            return Ok(None);
        }
        let mut reached = length;
        let mut watch =
            |time: f64, body: &dyn Fn(usize) -> usize, before: &[DVec3], after: &[DVec3]| {
                let is_met = self.meets_on_way(contacts, since + time, body, before, after);
                if is_met {
                    reached = reached.min(time);
                }
                is_met
            };
        let done = self.step_block(block.clone(), to, scratch, Some(&mut watch));
        if reached < length {
            let part = Block {
                length: reached,
                ..block
            };
            self.step_block(part, to, scratch, None)?;
            return Ok(Some(since + reached));
        }
        let Err(failure) = done else {
            return Ok(None);
        };
        // A method with error control has seen that nothing is met on its steps.
        if self.settings.method.adaptive {
            return Err(failure);
        }
        let (mut low, mut high) = (0.0, length);
        for _ in 0..HALVINGS {
            let part = Block {
                length: 0.5 * (low + high),
                ..block.clone()
            };
            let time = part.length;
            if self.step_block(part, to, scratch, None).is_err() {
                high = time;
                continue;
            }
            let before = &block.from.position[block.bodies.clone()];
            let after = &to.position[block.bodies.clone()];
            let first = block.bodies.start;
            if self.meets_on_way(
                contacts,
                since + time,
                &|place| first + place,
                before,
                after,
            ) {
                return Ok(Some(since + time));
            }
            low = time;
        }
        Err(failure)
    }

    /// Whether forces on these bodies may grow without bound at places that contacts keep them from. A first-order
    /// method makes one parabola of the whole step and has no horizon.
    fn has_horizon(&self, block: &Block<'_>) -> bool {
        self.settings.collision == crate::Collision::Continuous
            && self.settings.method.order > 1
            && self.bodies.solid.len() > 1
            && self.are_forces_steep(&block.bodies, block.is_coupled)
    }

    /// Whether forces on some bodies may grow without bound. `is_coupled` says whether forces couple the bodies.
    fn are_forces_steep(&self, bodies: &Range<usize>, is_coupled: bool) -> bool {
        self.forces.list.iter().any(|force| {
            force.nature().is_unbounded
                && match force.reach() {
                    Reach::Weight | Reach::EachBody => true,
                    Reach::Body(body) => bodies.contains(&body),
                    Reach::Pair([first, _]) => bodies.contains(&first),
                    Reach::EachPair => is_coupled,
                }
        })
    }

    /// Whether some of these bodies touch each other, or an immovable body, on the chords of their ways to a time, s
    /// from the step's start.
    fn meets_on_way(
        &self,
        contacts: &ContactSet,
        time: f64,
        body: &dyn Fn(usize) -> usize,
        before: &[DVec3],
        after: &[DVec3],
    ) -> bool {
        let ways = || before.iter().zip(after).enumerate();
        for (place, from) in ways() {
            let i = body(place);
            if !self.bodies.has_shape(i) {
                continue;
            }
            let others = ways().skip(place + 1);
            if others
                .clone()
                .any(|(place, to)| self.touch_on_chord(contacts, (i, body(place)), from, to))
            {
                return true;
            }
            for &wall in self
                .bodies
                .solid
                .iter()
                .filter(|&&body| !self.bodies.is_movable(body))
            {
                let at = self.before.position[wall] + time * self.before.velocity[wall];
                if self.touch_on_chord(contacts, (i, wall), from, (&at, &at))
                    && ways().all(|(place, _)| body(place) != wall)
                {
                    return true;
                }
            }
        }
        false
    }

    /// Whether two bodies touch on chords, each from one position to another.
    fn touch_on_chord(
        &self,
        contacts: &ContactSet,
        (i, j): (usize, usize),
        first: (&DVec3, &DVec3),
        second: (&DVec3, &DVec3),
    ) -> bool {
        if i == j || !self.bodies.has_shape(j) {
            return false;
        }
        let (from, to) = (second.0 - first.0, second.1 - first.1);
        let motion = to - from;
        let size = |body: usize| match self.bodies.shape(body) {
            Some(Shape::HalfSpace { .. }) => f64::INFINITY,
            _ => self.bodies.extent(body).reach.length(),
        };
        // Twice the reach, because of rounding.
        if nearest_on_chord(from, motion) > 2.0 * (size(i) + size(j))
            || !self.may_collide(i, j)
            || contacts.of_pair(i, j).next().is_some()
        {
            return false;
        }
        self.bodies.need_bvh(i);
        self.bodies.need_bvh(j);
        let forms = self.bodies.forms(i, j);
        forms.is_some_and(|(a, b)| first_contact(a, b, snap(from), snap(motion)).is_some())
    }
}

impl EventLoop<'_> {
    /// Queues the times at which trajectories of some bodies must start again, once for bodies that are stepped
    /// together.
    pub(super) fn queue_horizons(&mut self, bodies: impl Iterator<Item = usize>) {
        if self.solver.paths.horizons.known.is_empty() {
            return;
        }
        let mut events = mem::take(&mut self.queue.waiting);
        for body in bodies {
            let first = self
                .view()
                .motion()
                .coupled_group(body)
                .map_or(body, |(all, _)| all.start);
            let time = self.view().motion().horizon(body);
            if body != first || time >= self.solver.scene.settings.dt {
                continue;
            }
            let nothing = Contact {
                time: 0.0,
                point: DVec3::ZERO,
                normal: DVec3::ZERO,
                feature: None,
                face: None,
            };
            let version = &self.solver.paths.version;
            events.push(Event {
                kind: EventKind::Horizon,
                outcome: Outcome::Rest,
                ..Event::impact(time, (body, body), nothing, 0.0, version)
            });
        }
        self.queue.waiting = events;
    }
}
