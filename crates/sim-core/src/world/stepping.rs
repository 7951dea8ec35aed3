//! From the previous state to the current one, without regard to contact.
//!
//! Bodies under constant forces alone go through one loop over their columns, a pass that also
//! checks the range. The others are stepped by the method, in blocks small enough for the
//! processor's first cache where nothing couples them.

use core::{mem, ops::Range};

use super::{
    Settings, StepError, World, error,
    plan::{Plan, Section},
    state::State,
    system::Part,
};
use glam::DVec3;

use crate::integrate::{Failure, Scratch, Step, ballistic, stability};

/// Bodies in a block: some 200 bytes each for state, acceleration and a few stages fill about
/// the 32 KiB of a first cache.
const BLOCK: usize = 128;

/// Growth of the greatest speed since forces or motion were last set, after which it is asked
/// whether the method is stable here.
const GROWTH: f64 = 1e6;

impl World {
    pub(super) fn integrate(&mut self) -> Result<(), StepError> {
        if self.plan.is_none() {
            self.make_plan();
        }
        let is_free = self
            .plan
            .as_ref()
            .is_some_and(|plan| plan.sections.is_empty());
        if let Some(fall) = self.settings.method.fall.filter(|_| is_free) {
            let within = ballistic::step(
                (&self.previous.position, &self.previous.velocity),
                &self.acceleration,
                (&mut self.current.position, &mut self.current.velocity),
                (self.settings.dt, fall),
                error::LARGEST,
            );
            if within {
                return Ok(());
            }
        }
        let moved = self.integrate_sections();
        moved.map_err(|(body, cause)| self.failed(body, cause))
    }

    #[cold]
    fn make_plan(&mut self) {
        self.plan = Some(Plan::new(&self.forces, self.len()));
    }

    // Apart, so that free bodies do not pay for its frame.
    #[inline(never)]
    fn integrate_sections(&mut self) -> Result<(), (usize, Cause)> {
        // Out of the world while the world is changed.
        let plan = self.plan.take().unwrap_or_default();
        let outcome = self.integrate_by(&plan);
        self.plan = Some(plan);
        outcome
    }

    fn integrate_by(&mut self, plan: &Plan) -> Result<(), (usize, Cause)> {
        let mut done = 0;
        let mut fastest = (0.0, 0);
        for section in &plan.sections {
            self.free(plan, done..section.bodies.start, &mut fastest)?;
            self.forced(plan, section, &mut fastest)?;
            done = section.bodies.end;
        }
        self.free(plan, done..self.len(), &mut fastest)?;
        self.watch_growth(plan, fastest)
    }

    /// Bodies on which constant forces alone act.
    fn free(
        &mut self,
        plan: &Plan,
        bodies: Range<usize>,
        fastest: &mut (f64, usize),
    ) -> Result<(), (usize, Cause)> {
        if let Some(fall) = self.settings.method.fall {
            return self.fall(bodies, fall);
        }
        let section = Section {
            bodies,
            is_coupled: false,
        };
        self.forced(plan, &section, fastest)
    }

    /// The same in one loop, for a method of which it is known where it puts them.
    fn fall(&mut self, bodies: Range<usize>, fall: f64) -> Result<(), (usize, Cause)> {
        let within = ballistic::step(
            (
                &self.previous.position[bodies.clone()],
                &self.previous.velocity[bodies.clone()],
            ),
            &self.acceleration[bodies.clone()],
            (
                &mut self.current.position[bodies.clone()],
                &mut self.current.velocity[bodies.clone()],
            ),
            (self.settings.dt, fall),
            error::LARGEST,
        );
        if within {
            return Ok(());
        }
        let lost = self.beyond(bodies.clone());
        Err((lost.unwrap_or(bodies.start), Cause::Range))
    }

    /// Bodies that other forces act on.
    fn forced(
        &mut self,
        plan: &Plan,
        section: &Section,
        fastest: &mut (f64, usize),
    ) -> Result<(), (usize, Cause)> {
        let Settings { method, .. } = self.settings;
        let all = section.bodies.clone();
        let length = match section.is_coupled {
            true => all.len(),
            // Each body chooses its own steps.
            false if method.adaptive => 1,
            false => BLOCK,
        };
        let mut start = all.start;
        while start < all.end {
            let bodies = start..all.end.min(start + length);
            // Out of the world while it is looked at.
            let mut to = mem::take(&mut self.current);
            let mut scratch = mem::take(&mut self.scratch);
            let block = Block {
                bodies: bodies.clone(),
                is_coupled: section.is_coupled,
                acceleration: &self.acceleration[bodies.clone()],
                from: &self.previous,
                since: 0.0,
                length: self.settings.dt,
            };
            let moved = self.step_block(plan, block, &mut to, &mut scratch);
            (self.current, self.scratch) = (to, scratch);
            moved?;
            if let Some(body) = self.beyond(bodies.clone()) {
                return Err((body, Cause::Range));
            }
            for body in bodies.clone() {
                let speed = self.current.velocity[body].abs().max_element();
                if speed > fastest.0 {
                    *fastest = (speed, body);
                }
            }
            start = bodies.end;
        }
        Ok(())
    }

    /// One call of the method.
    pub(super) fn step_block(
        &self,
        plan: &Plan,
        block: Block<'_>,
        to: &mut State,
        scratch: &mut Scratch,
    ) -> Result<(), (usize, Cause)> {
        let Settings {
            method, tolerance, ..
        } = self.settings;
        let Block {
            bodies,
            is_coupled,
            acceleration,
            from,
            since,
            length,
        } = block;
        let start = bodies.start;
        let step = Step {
            time: self.time() + since,
            dt: length,
            tolerance,
            position: &from.position[bodies.clone()],
            velocity: &from.velocity[bodies.clone()],
            new_position: &mut to.position[bodies.clone()],
            new_velocity: &mut to.velocity[bodies.clone()],
            scratch,
        };
        let part = Part {
            forces: &self.forces,
            plan,
            is_coupled,
            mass: &self.mass[bodies.clone()],
            acceleration,
            bodies,
        };
        (method.step)(&part, step).map_err(|failure| match failure {
            Failure::NotConverged { body, .. } | Failure::TooManySteps { body, .. } => {
                (start + body, Cause::Failure(failure))
            }
        })
    }

    /// The first of some bodies whose motion has left the range.
    fn beyond(&self, bodies: Range<usize>) -> Option<usize> {
        let start = bodies.start;
        let first = self.current.beyond(bodies, error::LARGEST);
        first.map(|body| start + body)
    }

    /// Speaks up when speeds have grown out of all proportion and the method is unstable here.
    /// Where it is unstable at every step, as forward Euler is without damping, it may go on:
    /// that is its nature, and worth watching.
    fn watch_growth(&mut self, plan: &Plan, fastest: (f64, usize)) -> Result<(), (usize, Cause)> {
        let (speed, body) = fastest;
        let Some(scale) = self.speed_scale else {
            self.speed_scale = (speed > 0.0).then_some(speed);
            return Ok(());
        };
        if speed <= GROWTH * scale {
            return Ok(());
        }
        let stable_dt = self.stable_dt(plan, body);
        if stable_dt.is_some_and(|stable| 0.0 < stable && stable < self.settings.dt) {
            return Err((body, Cause::Growth));
        }
        self.speed_scale = Some(speed);
        Ok(())
    }

    /// The largest stable `dt` where a body was before the step, if its forces are stiff.
    fn stable_dt(&mut self, plan: &Plan, body: usize) -> Option<f64> {
        let mut sections = plan.sections.iter();
        let section = sections.find(|section| section.bodies.contains(&body))?;
        let bodies = match section.is_coupled {
            true => section.bodies.clone(),
            false => body..body + 1,
        };
        let part = Part {
            forces: &self.forces,
            plan,
            is_coupled: section.is_coupled,
            mass: &self.mass[bodies.clone()],
            acceleration: &self.acceleration[bodies.clone()],
            bodies: bodies.clone(),
        };
        let (x, v) = (
            &self.previous.position[bodies.clone()],
            &self.previous.velocity[bodies],
        );
        stability::largest_stable_step(self.settings.method, &part, self.time(), x, v)
    }

    /// Puts every body back, and says why.
    #[cold]
    pub(super) fn failed(&mut self, body: usize, cause: Cause) -> StepError {
        self.current.copy_from(&self.previous);
        let (step, method) = (self.steps + 1, self.settings.method.title);
        let stable_dt = self.plan.take().and_then(|plan| {
            let stable_dt = self.stable_dt(&plan, body);
            self.plan = Some(plan);
            stable_dt
        });
        match cause {
            Cause::Range => StepError::OutOfRange {
                body,
                step,
                method,
                stable_dt,
            },
            Cause::Squeezed(between) => StepError::Squeezed {
                body,
                between,
                step,
            },
            Cause::Impacts => StepError::TooManyImpacts {
                body,
                step,
                method,
                impacts: World::MOST_IMPACTS,
            },
            Cause::Growth => StepError::Unstable {
                body,
                step,
                method,
                stable_dt: stable_dt.unwrap_or(0.0),
            },
            Cause::Failure(Failure::NotConverged { iterations, .. }) => StepError::NotConverged {
                body,
                step,
                method,
                iterations,
            },
            Cause::Failure(Failure::TooManySteps { steps, .. }) => StepError::TooManySteps {
                body,
                step,
                method,
                steps,
            },
        }
    }
}

/// Bodies that are stepped at once, and how.
pub(super) struct Block<'a> {
    pub(super) bodies: Range<usize>,
    pub(super) is_coupled: bool,
    /// What constant forces do to these bodies, m/s².
    pub(super) acceleration: &'a [DVec3],
    /// The motion of all bodies before.
    pub(super) from: &'a State,
    /// When that is after the start of the world's step, s, and how long the block's is.
    pub(super) since: f64,
    pub(super) length: f64,
}

/// Why a step failed at a body.
pub(super) enum Cause {
    Range,
    /// No room is left between these bodies.
    Squeezed((usize, usize)),
    /// More impacts than [`World::MOST_IMPACTS`].
    Impacts,
    Growth,
    Failure(Failure),
}
