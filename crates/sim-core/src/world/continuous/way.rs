//! Where bodies are at any time within a step.
//!
//! A *way* is the motion of a body from its last impact in the step, or from the step's start, to
//! the step's end, as its method makes it: the state at any time in between is that after a step of
//! the method of just that length. For a body under a constant acceleration that is a parabola, and
//! free; for others each question is a step of the method, of all bodies that are coupled.
//!
//! A first-order method is another one for each length of its steps, and a step in two parts is not
//! the whole: a ball that it lets fall would lose a part of its height at each bounce. But what it
//! makes of a constant acceleration `a`, `x + dt (v + fall dt a)`, are points of one parabola, on
//! which the velocity is `u = v + lag a` with a *lag* of `(fall - 1/2) dt`. So symplectic and
//! backward Euler keep the velocity of half a step before, forward Euler that of half a step after.
//! Ways go along that parabola with `u`, impacts change `u` and `v` by the same, and no bounce takes
//! anything, whenever it comes. Under other forces `a` is the mean over the step.

use alloc::vec;
use core::{mem, ops::Range};
use glam::DVec3;

use super::super::{
    World, error,
    state::State,
    stepping::{Block, Cause},
    system::Part,
};
use super::MOST_RESTS;
use crate::{System, integrate::Scratch};

/// Room to ask where bodies are.
#[derive(Clone, Debug, Default)]
pub(super) struct Probe {
    state: State,
    scratch: Scratch,
}

impl World {
    /// Lets every way start where the step does. The ends are in the current state already.
    pub(super) fn start_ways(&mut self) {
        let n = self.len();
        let sections = self.plan.as_ref().map_or(0, |plan| plan.sections.len());
        let method = self.settings.method;
        let is_first_order = method.order == 1 && method.fall.is_some();
        self.continuous.is_free = is_first_order || sections == 0 && method.fall.is_some();
        // Zero from the second order on.
        self.continuous.lag = method.fall.map_or(0.0, |fall| fall - 0.5) * self.settings.dt;
        let ways = &mut self.continuous;
        ways.start.clone_from(&self.previous);
        ways.given.clone_from(&self.acceleration);
        if is_first_order && let Some(plan) = &self.plan {
            let forced = plan.sections.iter();
            for body in forced.flat_map(|section| section.bodies.clone()) {
                let change = self.current.velocity[body] - self.previous.velocity[body];
                ways.given[body] = change / self.settings.dt;
            }
        }
        if ways.lag != 0.0 {
            for (v, &a) in ways.start.velocity.iter_mut().zip(&ways.given) {
                *v += ways.lag * a;
            }
        }
        ways.acceleration.clone_from(&ways.given);
        ways.since.clear();
        ways.since.resize(n, 0.0);
        ways.rests.clear();
        ways.bounces.clear();
        ways.version.clear();
        ways.version.resize(n, 0);
    }

    /// The bodies that must be stepped with one, and whether they are coupled; `None` where its
    /// way is a parabola.
    #[inline(always)]
    pub(super) fn unit(&self, body: usize) -> Option<(Range<usize>, bool)> {
        match self.continuous.is_free {
            true => None,
            false => self.unit_among_forced(body),
        }
    }

    #[inline(never)]
    fn unit_among_forced(&self, body: usize) -> Option<(Range<usize>, bool)> {
        let sections = self.plan.as_ref().map_or(&[][..], |plan| &plan.sections);
        let section = sections.get(sections.partition_point(|s| s.bodies.end <= body));
        match section.filter(|section| section.bodies.contains(&body)) {
            Some(section) if section.is_coupled => Some((section.bodies.clone(), true)),
            None if self.settings.method.fall.is_some() => None,
            _ => Some((body..body + 1, false)),
        }
    }

    /// Position and velocity of a body on its way at a time from the way's start to the end of the
    /// step, s from the step's start.
    pub(super) fn motion_at(
        &self,
        body: usize,
        time: f64,
        probe: &mut Probe,
    ) -> Result<(DVec3, DVec3), (usize, Cause)> {
        let ways = &self.continuous;
        let (x, v) = (ways.start.position[body], ways.start.velocity[body]);
        let h = time - ways.since[body];
        if h == 0.0 || self.is_stopped(body) {
            return Ok((x, v));
        }
        if time == self.settings.dt {
            let v = self.current.velocity[body] + ways.lag * ways.acceleration[body];
            return Ok((self.current.position[body], v));
        }
        let Some((bodies, is_coupled)) = self.unit(body) else {
            return Ok(self.on_parabola(body, h));
        };
        probe.state.position.resize(self.len(), DVec3::ZERO);
        probe.state.velocity.resize(self.len(), DVec3::ZERO);
        self.step_unit(
            bodies,
            is_coupled,
            time,
            &mut probe.state,
            &mut probe.scratch,
        )?;
        Ok((probe.state.position[body], probe.state.velocity[body]))
    }

    /// The same as others meet it: what has stopped stands, whatever it will do in the next step.
    pub(super) fn seen_at(
        &self,
        body: usize,
        time: f64,
        probe: &mut Probe,
    ) -> Result<(DVec3, DVec3), (usize, Cause)> {
        let (x, v) = self.motion_at(body, time, probe)?;
        let v = if self.is_stopped(body) {
            DVec3::ZERO
        } else {
            v
        };
        Ok((x, v))
    }

    /// Position and velocity of a body on a parabola, some time after its way has started. Methods of
    /// higher order have no other one, and those of first order have their lag.
    fn on_parabola(&self, body: usize, h: f64) -> (DVec3, DVec3) {
        let ways = &self.continuous;
        let (x, v) = (ways.start.position[body], ways.start.velocity[body]);
        let a = ways.acceleration[body];
        (x + h * (v + 0.5 * h * a), v + h * a)
    }

    /// Steps coupled bodies, or one, from the start of their way to a time.
    fn step_unit(
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
        let ways = &self.continuous;
        let since = ways.since[bodies.start];
        let block = Block {
            // Resting contacts push like constant forces.
            acceleration: &ways.acceleration[bodies.clone()],
            bodies,
            is_coupled,
            from: &ways.start,
            since,
            length: time - since,
        };
        self.step_block(plan, block, to, scratch)
    }

    /// Lets the way of a body, and of those coupled to it, start anew at a time, where they are
    /// then, and tells which bodies those are.
    pub(super) fn restart_at(
        &mut self,
        body: usize,
        time: f64,
    ) -> Result<Range<usize>, (usize, Cause)> {
        let unit = self.unit(body);
        let bodies = unit.map_or(body..body + 1, |(bodies, _)| bodies);
        if self.continuous.since[body] == time {
            return Ok(bodies);
        }
        let mut probe = mem::take(&mut self.continuous.probe);
        let mut motion = mem::take(&mut self.continuous.renewed_motion);
        motion.clear();
        let found = bodies.clone().try_for_each(|body| {
            motion.push(self.motion_at(body, time, &mut probe)?);
            Ok(())
        });
        let ways = &mut self.continuous;
        if found.is_ok() {
            for (body, &(x, v)) in bodies.clone().zip(&motion) {
                (ways.start.position[body], ways.start.velocity[body]) = (x, v);
                ways.since[body] = time;
            }
        }
        (ways.probe, ways.renewed_motion) = (probe, motion);
        found.map(|()| bodies)
    }

    /// Moves bodies that are stepped together from the start of their way to the end of the step.
    pub(super) fn finish_way(&mut self, bodies: Range<usize>) -> Result<(), (usize, Cause)> {
        let dt = self.settings.dt;
        match self.unit(bodies.start) {
            _ if self.is_stopped(bodies.start) => {
                let ways = &self.continuous;
                for body in bodies.clone() {
                    self.current.position[body] = ways.start.position[body];
                    self.current.velocity[body] = self.kept(body, ways.start.velocity[body]);
                }
            }
            None => {
                let body = bodies.start;
                let (x, v) = self.on_parabola(body, dt - self.continuous.since[body]);
                self.current.position[body] = x;
                self.current.velocity[body] = self.kept(body, v);
            }
            Some((bodies, is_coupled)) => {
                let mut current = mem::take(&mut self.current);
                let mut scratch = mem::take(&mut self.scratch);
                let moved = self.step_unit(bodies, is_coupled, dt, &mut current, &mut scratch);
                (self.current, self.scratch) = (current, scratch);
                moved?;
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

    /// The velocity that the method keeps where a body's way has another one.
    fn kept(&self, body: usize, on_way: DVec3) -> DVec3 {
        on_way - self.continuous.lag * self.continuous.acceleration[body]
    }

    /// What forces and resting contacts do to a body where its way starts, m/s².
    pub(super) fn acceleration_there(&self, body: usize) -> DVec3 {
        if self.is_stopped(body) {
            return DVec3::ZERO;
        }
        let Some((bodies, is_coupled)) = self.unit(body) else {
            return self.continuous.acceleration[body];
        };
        let Some(plan) = &self.plan else {
            return self.continuous.acceleration[body];
        };
        let ways = &self.continuous;
        let part = Part {
            forces: &self.forces,
            plan,
            is_coupled,
            mass: &self.mass[bodies.clone()],
            acceleration: &ways.acceleration[bodies.clone()],
            bodies: bodies.clone(),
        };
        let time = self.time() + ways.since[body];
        let mut all = vec![DVec3::ZERO; bodies.len()];
        let (x, v) = (&ways.start.position, &ways.start.velocity);
        part.accelerations(time, &x[bodies.clone()], &v[bodies.clone()], &mut all);
        all[body - bodies.start]
    }

    /// Whether a body, or one coupled to it, has come to rest too often in this step.
    #[inline(always)]
    pub(super) fn is_stopped(&self, body: usize) -> bool {
        !self.continuous.rests.is_empty() && self.rests_too_often(body)
    }

    #[inline(never)]
    fn rests_too_often(&self, body: usize) -> bool {
        let rests = &self.continuous.rests;
        let Some((bodies, _)) = self.unit(body) else {
            return rests[body] > MOST_RESTS;
        };
        rests[bodies].iter().any(|&rests| rests > MOST_RESTS)
    }

    /// How far a body's way departs from its chord, m, by component: at most so on a parabola, about so
    /// where the method makes the way, but not where it turns round and back within a step.
    #[inline(always)]
    pub(super) fn bulge(&self, body: usize) -> DVec3 {
        let ways = &self.continuous;
        let h = self.settings.dt - ways.since[body];
        if self.is_stopped(body) {
            return DVec3::ZERO;
        }
        if self.unit(body).is_none() {
            return (0.125 * h * h) * ways.acceleration[body].abs();
        }
        // Of a parabola the sum is four times the bulge.
        let chord = self.current.position[body] - ways.start.position[body];
        let before = chord - h * ways.start.velocity[body];
        let after = chord - h * self.current.velocity[body];
        0.25 * (before.abs() + after.abs())
    }

    /// How far the relative way of two bodies departs from a chord, m, per square of its length, s².
    pub(super) fn bend(&self, i: usize, j: usize) -> f64 {
        let is_free = |body| self.unit(body).is_none() && !self.is_stopped(body);
        if is_free(i) && is_free(j) {
            let push = &self.continuous.acceleration;
            let relative = push[j] - push[i];
            return 0.125 * relative.length();
        }
        let of = |body: usize| {
            let h = self.settings.dt - self.continuous.since[body];
            let bulge = self.bulge(body).length();
            if bulge == 0.0 { 0.0 } else { bulge / (h * h) }
        };
        of(i) + of(j)
    }
}
