//! Where bodies are at any time within a step.
//!
//! The *trajectory* of a body leads from its last event in the step, or from the step's start, to the
//! step's end, as its method makes it: the state at any time in between is that after a step of the
//! method of just that length. For a body under a constant acceleration that is a parabola, and
//! free; for others each question is a step of the method, of all bodies that are coupled.
//!
//! A first-order method gives other points for each length of its steps, and a step in two parts is
//! not the whole: a ball would lose a part of its height at each bounce. But what it makes of a
//! constant acceleration `a`, `x + dt (v + fall dt a)`, are points of one parabola, on which the
//! velocity is `u = v + s a` with the *velocity stagger* `s = (fall - 1/2) dt`. So symplectic and
//! backward Euler keep the velocity of half a step before, forward Euler that of half a step after.
//! Trajectories use `u`; impacts change `u` and `v` by the same, and no bounce takes anything,
//! whenever it comes. Under other forces `a` is the mean over the step.

use alloc::vec;
use core::{mem, ops::Range};
use glam::DVec3;

use super::super::{
    World, error,
    state::State,
    stepping::{Block, Cause},
    system::Part,
};
use crate::{System, integrate::Scratch};

/// Room to ask where bodies are.
#[derive(Clone, Debug, Default)]
pub(super) struct Probe {
    state: State,
    scratch: Scratch,
}

impl World {
    /// Lets every trajectory start where the step does. The ends are in the current state already.
    pub(super) fn begin_trajectories(&mut self) {
        let n = self.bodies.len();
        let sections = self.plan.as_ref().map_or(0, |plan| plan.sections.len());
        let method = self.settings.method;
        let is_first_order = method.order == 1 && method.fall.is_some();
        let continuous = &mut self.continuous;
        continuous.is_free = is_first_order || sections == 0 && method.fall.is_some();
        // Zero from the second order on.
        continuous.velocity_stagger = method.fall.map_or(0.0, |fall| fall - 0.5) * self.settings.dt;
        continuous.start.clone_from(&self.previous);
        continuous
            .applied_acceleration
            .clone_from(&self.bodies.acceleration);
        if is_first_order && let Some(plan) = &self.plan {
            let forced = plan.sections.iter();
            for body in forced.flat_map(|section| section.bodies.clone()) {
                let change = self.current.velocity[body] - self.previous.velocity[body];
                continuous.applied_acceleration[body] = change / self.settings.dt;
            }
        }
        if continuous.velocity_stagger != 0.0 {
            let velocity = continuous.start.velocity.iter_mut();
            for (v, &a) in velocity.zip(&continuous.applied_acceleration) {
                *v += continuous.velocity_stagger * a;
            }
        }
        let applied = &continuous.applied_acceleration;
        continuous.acceleration.clone_from(applied);
        continuous.since.clear();
        continuous.since.resize(n, 0.0);
        continuous.bounces.clear();
        continuous.rests.clear();
        continuous.climbs.clear();
        continuous.handed.clear();
        continuous.version.clear();
        continuous.version.resize(n, 0);
    }

    /// The bodies that must be stepped with one, and whether forces couple them; `None` where its
    /// trajectory is a parabola.
    #[inline(always)]
    pub(super) fn coupled_group(&self, body: usize) -> Option<(Range<usize>, bool)> {
        match self.continuous.is_free {
            true => None,
            false => self.group_among_forced(body),
        }
    }

    #[inline(never)]
    fn group_among_forced(&self, body: usize) -> Option<(Range<usize>, bool)> {
        let sections = self.plan.as_ref().map_or(&[][..], |plan| &plan.sections);
        let section = sections.get(sections.partition_point(|s| s.bodies.end <= body));
        match section.filter(|section| section.bodies.contains(&body)) {
            Some(section) if section.is_coupled => Some((section.bodies.clone(), true)),
            None if self.settings.method.fall.is_some() => None,
            _ => Some((body..body + 1, false)),
        }
    }

    /// Position and velocity of a body at a time between its trajectory's start and its horizon, s from
    /// the step's start.
    pub(super) fn motion_at(
        &self,
        body: usize,
        time: f64,
        probe: &mut Probe,
    ) -> Result<(DVec3, DVec3), (usize, Cause)> {
        let continuous = &self.continuous;
        let h = time - continuous.since[body];
        if h == 0.0 {
            let start = &continuous.start;
            return Ok((start.position[body], start.velocity[body]));
        }
        if time == self.horizon(body) {
            let staggered = continuous.velocity_stagger * continuous.acceleration[body];
            let v = self.current.velocity[body] + staggered;
            return Ok((self.current.position[body], v));
        }
        let Some((bodies, is_coupled)) = self.coupled_group(body) else {
            return Ok(self.on_parabola(body, h));
        };
        probe.state.position.resize(self.bodies.len(), DVec3::ZERO);
        probe.state.velocity.resize(self.bodies.len(), DVec3::ZERO);
        self.step_group(
            bodies,
            is_coupled,
            time,
            &mut probe.state,
            &mut probe.scratch,
        )?;
        Ok((probe.state.position[body], probe.state.velocity[body]))
    }

    /// Position and velocity of a body on a parabola, some time after its trajectory has started.
    fn on_parabola(&self, body: usize, h: f64) -> (DVec3, DVec3) {
        let start = &self.continuous.start;
        let (x, v) = (start.position[body], start.velocity[body]);
        let a = self.continuous.acceleration[body];
        (x + h * (v + 0.5 * h * a), v + h * a)
    }

    /// Steps coupled bodies, or one, from the start of their trajectories to a time.
    fn step_group(
        &self,
        bodies: Range<usize>,
        is_coupled: bool,
        time: f64,
        to: &mut State,
        scratch: &mut Scratch,
    ) -> Result<(), (usize, Cause)> {
        let Some(plan) = &self.plan else {
            return Ok(());
        };
        let block = self.block_of(bodies, is_coupled, time);
        self.step_block(plan, block, to, scratch, None)
    }

    /// Coupled bodies, or one, from the start of their trajectories to a time.
    fn block_of(&self, bodies: Range<usize>, is_coupled: bool, time: f64) -> Block<'_> {
        let continuous = &self.continuous;
        let since = continuous.since[bodies.start];
        Block {
            // Resting contacts push like constant forces.
            acceleration: &continuous.acceleration[bodies.clone()],
            bodies,
            is_coupled,
            from: &continuous.start,
            since,
            length: time - since,
        }
    }

    /// Lets the trajectory of a body, and of those coupled to it, start again at a time, where they
    /// are then, and tells which bodies those are.
    pub(super) fn restart_at(
        &mut self,
        body: usize,
        time: f64,
    ) -> Result<Range<usize>, (usize, Cause)> {
        let group = self.coupled_group(body);
        let bodies = group.map_or(body..body + 1, |(bodies, _)| bodies);
        if self.continuous.since[body] == time {
            return Ok(bodies);
        }
        let mut probe = mem::take(&mut self.continuous.probe);
        let mut motion = mem::take(&mut self.continuous.restarted_motion);
        motion.clear();
        let found = bodies.clone().try_for_each(|body| {
            motion.push(self.motion_at(body, time, &mut probe)?);
            Ok(())
        });
        let continuous = &mut self.continuous;
        if found.is_ok() {
            for (body, &(x, v)) in bodies.clone().zip(&motion) {
                continuous.start.position[body] = x;
                continuous.start.velocity[body] = v;
                continuous.since[body] = time;
            }
        }
        (continuous.probe, continuous.restarted_motion) = (probe, motion);
        found.map(|()| bodies)
    }

    /// Moves bodies whose trajectories have started again, in order, to the end of the step: of those that
    /// are stepped together once all.
    pub(super) fn finish_restarted(&mut self, restarted: &[usize]) -> Result<(), (usize, Cause)> {
        for &body in restarted {
            let group = self.coupled_group(body);
            let bodies = group.map_or(body..body + 1, |(bodies, _)| bodies);
            if bodies.start == body {
                self.finish_trajectories(bodies)?;
            }
        }
        Ok(())
    }

    /// Moves bodies that are stepped together from the start of their trajectories to the end of the
    /// step, or to their horizon.
    pub(super) fn finish_trajectories(
        &mut self,
        bodies: Range<usize>,
    ) -> Result<(), (usize, Cause)> {
        let dt = self.settings.dt;
        match self.coupled_group(bodies.start) {
            None => {
                for body in bodies.clone() {
                    let (x, v) = self.on_parabola(body, dt - self.continuous.since[body]);
                    self.current.position[body] = x;
                    self.current.velocity[body] = self.unstaggered_velocity(body, v);
                }
            }
            Some((bodies, is_coupled)) => {
                let mut current = mem::take(&mut self.current);
                let mut scratch = mem::take(&mut self.scratch);
                let moved = match &self.plan {
                    Some(plan) => {
                        let block = self.block_of(bodies.clone(), is_coupled, dt);
                        self.step_to_horizon(plan, block, &mut current, &mut scratch)
                    }
                    None => Ok(dt),
                };
                (self.current, self.scratch) = (current, scratch);
                self.set_horizon(bodies, moved?);
            }
        }
        for body in bodies.clone() {
            self.continuous.version[body] += 1;
        }
        match self.current.beyond(bodies.clone(), error::LARGEST) {
            Some(first) => Err((bodies.start + first, Cause::Range)),
            None => Ok(()),
        }
    }

    /// The velocity that the method keeps where a body's trajectory has another one.
    fn unstaggered_velocity(&self, body: usize, on_trajectory: DVec3) -> DVec3 {
        on_trajectory - self.continuous.velocity_stagger * self.continuous.acceleration[body]
    }

    /// What forces and contacts do to a body where its trajectory starts, m/s².
    pub(super) fn acceleration_there(&self, body: usize) -> DVec3 {
        self.acceleration_beside(body, &[])
    }

    /// The same if some bodies were moved from there, each by so much, m.
    pub(super) fn acceleration_beside(&self, body: usize, moved: &[(usize, DVec3)]) -> DVec3 {
        let continuous = &self.continuous;
        let Some((bodies, is_coupled)) = self.coupled_group(body) else {
            return continuous.acceleration[body];
        };
        let Some(plan) = &self.plan else {
            return continuous.acceleration[body];
        };
        let part = Part {
            forces: &self.forces,
            plan,
            is_coupled,
            mass: &self.bodies.mass[bodies.clone()],
            acceleration: &continuous.acceleration[bodies.clone()],
            bodies: bodies.clone(),
            group: None,
        };
        let time = self.time() + continuous.since[body];
        let mut all = vec![DVec3::ZERO; bodies.len()];
        let (x, v) = (&continuous.start.position, &continuous.start.velocity);
        let mut x = x[bodies.clone()].to_vec();
        for &(other, by) in moved {
            if bodies.contains(&other) {
                x[other - bodies.start] += by;
            }
        }
        part.accelerations(time, &x, &v[bodies.clone()], &mut all);
        all[body - bodies.start]
    }

    /// How far a body's trajectory departs from its chord, m, by component: at most so on a parabola,
    /// about so where the method makes the trajectory, but not where it turns round and back within
    /// a step.
    #[inline(always)]
    pub(super) fn chord_deviation(&self, body: usize) -> DVec3 {
        let continuous = &self.continuous;
        let h = self.horizon(body) - continuous.since[body];
        if self.coupled_group(body).is_none() {
            return (0.125 * h * h) * continuous.acceleration[body].abs();
        }
        // Of a parabola the sum is four times the deviation.
        let chord = self.current.position[body] - continuous.start.position[body];
        let before = chord - h * continuous.start.velocity[body];
        let after = chord - h * self.current.velocity[body];
        0.25 * (before.abs() + after.abs())
    }

    /// How far the relative trajectory of two bodies departs from a chord, m, per square of its length,
    /// s², by component.
    pub(super) fn deviation_per_time2(&self, i: usize, j: usize) -> DVec3 {
        if self.coupled_group(i).is_none() && self.coupled_group(j).is_none() {
            let push = &self.continuous.acceleration;
            let relative = push[j] - push[i];
            return 0.125 * relative.abs();
        }
        let of = |body: usize| {
            let h = self.horizon(body) - self.continuous.since[body];
            let deviation = self.chord_deviation(body);
            if deviation == DVec3::ZERO {
                DVec3::ZERO
            } else {
                deviation / (h * h)
            }
        };
        of(i) + of(j)
    }
}
