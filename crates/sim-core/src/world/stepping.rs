//! Integration: from the previous state to the current one, without contacts.
//!
//! Bodies with only constant forces go through one loop over their columns, which also checks the range. The method
//! steps the others, in blocks that fit into the processor's first cache if no force couples them.

use alloc::vec::Vec;
use core::{mem, ops::Range};

use super::{
    Settings, StepError, World,
    continuous::{ContactSet, Horizons},
    error,
    lever_system::{Kicks, LeverSystem},
    marks::Marks,
    plan::{Group, Plan, Section},
    scene::{Scene, scene},
    state::State,
    system::Part,
};
use glam::DVec3;

use crate::integrate::{Failure, Method, Scratch, Step, Watch, ballistic, stability};
use crate::rotation::{Coordinates, FlightError};

/// Bodies in a block. With some 200 bytes for state, acceleration and a few stages each, they about fill a first cache
/// of 32 KiB.
const BLOCK: usize = 128;

/// If the greatest speed has grown by this factor since forces or motion were last set, the step checks whether the
/// method is stable here.
const GROWTH: f64 = 1e6;

/// The data that integration keeps from step to step.
#[derive(Clone, Debug, Default)]
pub(super) struct Integrator {
    scratch: Scratch,
    /// The greatest component of a velocity, m/s, from which growth is measured; `None` before the first step under a
    /// force that depends on the motion.
    speed_scale: Option<f64>,
    /// The motion from which growth is measured, and later motions.
    marks: Marks,
}

/// The output of integration, and the contacts that limit it.
pub(super) struct Way<'a> {
    pub(super) contacts: &'a ContactSet,
    pub(super) end: &'a mut State,
    pub(super) horizons: &'a mut Horizons,
}

#[cfg(feature = "serde")]
impl Integrator {
    /// The speed and the motions from which growth is measured, if any.
    pub(super) fn growth(&self) -> Option<(f64, &Marks)> {
        self.speed_scale.map(|scale| (scale, &self.marks))
    }

    /// Restores the speed and the motions from which growth is measured.
    pub(super) fn resume_growth(&mut self, scale: f64, marks: Marks) {
        (self.speed_scale, self.marks) = (Some(scale), marks);
    }
}

impl Integrator {
    /// Starts the measurement of growth anew, because bodies or forces were set.
    pub(super) fn forget_growth(&mut self) {
        self.speed_scale = None;
    }

    /// Moves all bodies from the start of the step to its end.
    pub(super) fn integrate(
        &mut self,
        scene: Scene<'_>,
        mut way: Way<'_>,
    ) -> Result<(), (usize, Cause)> {
        way.horizons.clear();
        if let Some(fall) = scene.settings.method.fall
            && scene.forces.plan.sections.is_empty()
        {
            return fall_all(scene, 0..scene.bodies.len(), fall, way.end);
        }
        self.integrate_sections(scene, &mut way)
    }

    // A separate function, so that free bodies do not pay for its stack frame.
    #[inline(never)]
    fn integrate_sections(
        &mut self,
        scene: Scene<'_>,
        way: &mut Way<'_>,
    ) -> Result<(), (usize, Cause)> {
        let mut done = 0;
        let mut fastest = (0.0, 0);
        for section in &scene.forces.plan.sections {
            self.free(scene, way, done..section.bodies.start, &mut fastest)?;
            self.forced(scene, way, section, &mut fastest)?;
            done = section.bodies.end;
        }
        self.free(scene, way, done..scene.bodies.len(), &mut fastest)?;
        self.watch_growth(scene, fastest)
    }

    /// Steps bodies with only constant forces.
    fn free(
        &mut self,
        scene: Scene<'_>,
        way: &mut Way<'_>,
        bodies: Range<usize>,
        fastest: &mut (f64, usize),
    ) -> Result<(), (usize, Cause)> {
        if let Some(fall) = scene.settings.method.fall {
            return fall_all(scene, bodies, fall, way.end);
        }
        let section = Section {
            bodies,
            is_coupled: false,
            groups: Vec::new(),
        };
        self.forced(scene, way, &section, fastest)
    }

    /// Steps bodies with other forces.
    fn forced(
        &mut self,
        scene: Scene<'_>,
        way: &mut Way<'_>,
        section: &Section,
        fastest: &mut (f64, usize),
    ) -> Result<(), (usize, Cause)> {
        let Settings { method, .. } = scene.settings;
        let all = section.bodies.clone();
        let length = match section.is_coupled {
            true => all.len(),
            // An adaptive method chooses partial steps for each body by itself.
            false if method.adaptive => 1,
            false => BLOCK,
        };
        let mut start = all.start;
        while start < all.end {
            let bodies = start..all.end.min(start + length);
            let block = Block {
                bodies: bodies.clone(),
                is_coupled: section.is_coupled,
                acceleration: &scene.bodies.acceleration[bodies.clone()],
                from: scene.before,
                since: 0.0,
                length: scene.settings.dt,
            };
            let moved = scene.step_to_horizon(way.contacts, block, way.end, &mut self.scratch);
            way.horizons.set(bodies.clone(), moved?, &scene);
            if let Some(body) = beyond(way.end, bodies.clone()) {
                return Err((body, Cause::Range));
            }
            for body in bodies.clone() {
                let speed = way.end.velocity[body].abs().max_element();
                if speed > fastest.0 {
                    *fastest = (speed, body);
                }
            }
            start = bodies.end;
        }
        Ok(())
    }

    /// Returns an error if speeds have grown out of all proportion and the method is unstable here. A method that is
    /// unstable at every step, as forward Euler is without damping, may go on: instability is its nature, and worth
    /// watching.
    fn watch_growth(
        &mut self,
        scene: Scene<'_>,
        fastest: (f64, usize),
    ) -> Result<(), (usize, Cause)> {
        let (speed, body) = fastest;
        let Some(scale) = self.speed_scale else {
            self.count_growth_from(scene, speed);
            return Ok(());
        };
        if self.marks.is_due(speed) {
            // If no force couples the bodies, keep the motion of the growing one only.
            let section = company(&scene.forces.plan, body);
            let bodies = section.map_or(body..body + 1, |section| section.bodies);
            let time = scene.time;
            self.marks.add(time, speed, bodies, scene.before);
        }
        if speed <= GROWTH * scale {
            return Ok(());
        }
        match self.stable_dt(scene, body) {
            Some(stable_dt) if stable_dt > 0.0 => Err((body, Cause::Growth { stable_dt })),
            _ => {
                self.count_growth_from(scene, speed);
                Ok(())
            }
        }
    }

    /// Measures growth from the motion before this step.
    fn count_growth_from(&mut self, scene: Scene<'_>, speed: f64) {
        let coupled = scene
            .forces
            .plan
            .sections
            .iter()
            .filter(|section| section.is_coupled);
        let most = coupled.map(|section| section.bodies.len()).max();
        self.marks.begin(scene.bodies.len(), most.unwrap_or(1));
        self.speed_scale = (speed > 0.0).then_some(speed);
        if speed > 0.0 {
            let (all, time) = (0..scene.bodies.len(), scene.time);
            self.marks.add(time, speed, all, scene.before);
        }
    }

    /// The largest `dt` at which the method is stable for a body's forces where its growth began. The candidates are
    /// the motions kept, the motion before this step, and the motion one step after each of these. The first one
    /// whose limit is below the world's `dt` decides. 0 if it is only known that the method is stable at no `dt`;
    /// `None` if the method is stable, or if this cannot be decided.
    pub(super) fn stable_dt(&self, scene: Scene<'_>, body: usize) -> Option<f64> {
        let section = company(&scene.forces.plan, body)?;
        let bodies = section.bodies.clone();
        // The stiffness of a force with a lever arm does not follow from positions alone.
        if bodies
            .clone()
            .any(|body| scene.forces.plan.is_levered(body))
        {
            return None;
        }
        let part = Part {
            forces: &scene.forces.list,
            plan: &scene.forces.plan,
            is_coupled: section.is_coupled,
            mass: &scene.bodies.mass[bodies.clone()],
            acceleration: &scene.bodies.acceleration[bodies.clone()],
            bodies: bodies.clone(),
            group: None,
        };
        // Without a scale, the marks are from before bodies or forces were last set.
        let marks = self.speed_scale.map(|_| self.marks.of(bodies.clone()));
        let kept = marks.into_iter().flatten();
        let last = (
            scene.time,
            &scene.before.position[bodies.clone()],
            &scene.before.velocity[bodies.clone()],
        );
        let mut at_all = None;
        let mut is_below = |time, x: &[DVec3], v: &[DVec3]| {
            let limit = stability::largest_stable_step(scene.settings.method, &part, time, x, v);
            if limit == Some(0.0) {
                at_all = limit;
            }
            limit.filter(|&dt| 0.0 < dt && dt < scene.settings.dt)
        };
        for (time, x, v) in kept.chain([last]) {
            // A motion that begins at rest may have blown up within its first step.
            let limit = is_below(time, x, v).or_else(|| {
                let (x, v) = followed(&part, time, scene.settings.dt, (x, v))?;
                is_below(time + scene.settings.dt, &x, &v)
            });
            if limit.is_some() {
                return limit;
            }
        }
        at_all
    }
}

impl Scene<'_> {
    /// Calls the method once; for coupled bodies, once for each group. An adaptive method reports each partial step,
    /// and the bodies that it moves, to `watch`, and stops if `watch` asks for it.
    pub(super) fn step_block(
        &self,
        block: Block<'_>,
        to: &mut State,
        scratch: &mut Scratch,
        mut watch: Option<&mut BlockWatch<'_>>,
    ) -> Result<(), (usize, Cause)> {
        let section = match block.is_coupled {
            true => self.forces.plan.section_at(block.bodies.start),
            false => None,
        };
        let Some(section) = section else {
            return self.step_run(&block, None, (to, scratch), watch);
        };
        let fall = self.settings.method.fall;
        section.groups.iter().try_for_each(|group| {
            if !group.levered.is_empty() {
                return self.step_gathered(&block, group, (to, scratch), watch.as_deref_mut());
            }
            if let Some(fall) = fall.filter(|_| self.forces.plan.is_free(group)) {
                self.fall_in(&block, group.bodies[0], fall, to);
                return Ok(());
            }
            match group.run {
                Some(_) => self.step_run(&block, Some(group), (to, scratch), watch.as_deref_mut()),
                None => self.step_gathered(&block, group, (to, scratch), watch.as_deref_mut()),
            }
        })
    }

    /// Moves a body of a block with only constant forces; the caller checks its range later.
    fn fall_in(&self, block: &Block<'_>, body: usize, fall: f64, to: &mut State) {
        let (own, in_block) = (body..body + 1, body - block.bodies.start);
        ballistic::step(
            (
                &block.from.position[own.clone()],
                &block.from.velocity[own.clone()],
            ),
            &block.acceleration[in_block..in_block + 1],
            (&mut to.position[own.clone()], &mut to.velocity[own]),
            (block.length, fall),
            error::LARGEST,
        );
    }

    /// Calls the method once for bodies that are adjacent in the columns: a block, or one of its groups.
    fn step_run(
        &self,
        block: &Block<'_>,
        group: Option<&Group>,
        (to, scratch): (&mut State, &mut Scratch),
        watch: Option<&mut BlockWatch<'_>>,
    ) -> Result<(), (usize, Cause)> {
        let run = group.and_then(|group| group.run.clone());
        let bodies = run.unwrap_or_else(|| block.bodies.clone());
        let (start, first) = (bodies.start, bodies.start - block.bodies.start);
        let mut watch = watch.map(|watch| {
            move |time: f64, x: &[DVec3], y: &[DVec3]| watch(time, &|place| start + place, x, y)
        });
        let step = Step {
            time: self.time + block.since,
            dt: block.length,
            tolerance: self.settings.tolerance,
            position: &block.from.position[bodies.clone()],
            velocity: &block.from.velocity[bodies.clone()],
            new_position: &mut to.position[bodies.clone()],
            new_velocity: &mut to.velocity[bodies.clone()],
            scratch,
            watch: watch.as_mut().map(|watch| Watch::new(watch)),
        };
        let part = Part {
            forces: &self.forces.list,
            plan: &self.forces.plan,
            is_coupled: block.is_coupled && bodies.len() > 1,
            mass: &self.bodies.mass[bodies.clone()],
            acceleration: &block.acceleration[first..first + bodies.len()],
            bodies,
            group,
        };
        let stepped = (self.settings.method.step)(&part, step);
        stepped.map_err(|failure| (start + body_of(&failure), Cause::Failure(failure)))
    }

    /// Calls the method once for the bodies of a group. They are copied side by side for it, followed by the rotors
    /// of those on which forces act at points.
    fn step_gathered(
        &self,
        block: &Block<'_>,
        group: &Group,
        (to, scratch): (&mut State, &mut Scratch),
        watch: Option<&mut BlockWatch<'_>>,
    ) -> Result<(), (usize, Cause)> {
        let count = group.bodies.len();
        // Taken out of the scratch, because the method borrows the scratch.
        let mut gathered = scratch.gathered.take().unwrap_or_default();
        let mut rotors = mem::take(&mut gathered.rotors);
        rotors.clear();
        let turned = &block.from.turned;
        let levered = group.levered.iter();
        let coordinates = match self.settings.method.is_midpoint() {
            true => Coordinates::Midpoint,
            false => Coordinates::Vector,
        };
        rotors.extend(levered.filter_map(|&place| {
            self.bodies
                .rotor((group.bodies[place], place), turned, coordinates)
        }));
        let ([x, v, acceleration, new_x, new_v], mass) = gathered.columns(count + rotors.len());
        for (i, &body) in group.bodies.iter().enumerate() {
            x[i] = block.from.position[body];
            v[i] = block.from.velocity[body];
            acceleration[i] = block.acceleration[body - block.bodies.start];
            mass[i] = self.bodies.mass[body];
        }
        for (i, rotor) in (count..).zip(&rotors) {
            x[i] = DVec3::ZERO;
            v[i] = rotor.first_rate();
        }
        let (acceleration, mass) = (&acceleration[..count], &mass[..count]);
        let mut watch = watch.map(|watch| {
            |time: f64, x: &[DVec3], y: &[DVec3]| {
                watch(time, &|place| group.bodies[place], &x[..count], &y[..count])
            }
        });
        let step = Step {
            time: self.time + block.since,
            dt: block.length,
            tolerance: self.settings.tolerance,
            position: x,
            velocity: v,
            new_position: new_x,
            new_velocity: new_v,
            scratch,
            watch: watch.as_mut().map(|watch| Watch::new(watch)),
        };
        let part = Part {
            forces: &self.forces.list,
            plan: &self.forces.plan,
            is_coupled: true,
            mass,
            acceleration,
            bodies: 0..count,
            group: Some(group),
        };
        let kicks = Kicks {
            part,
            rotors: &rotors,
        };
        let stepped = match group.levered.is_empty() {
            true => (self.settings.method.step)(&kicks.part, step),
            false => (self.settings.method.step)(&LeverSystem(kicks), step),
        };
        for (i, &body) in group.bodies.iter().enumerate() {
            to.position[body] = new_x[i];
            to.velocity[body] = new_v[i];
        }
        let mut lost = None;
        for (i, rotor) in (count..).zip(&rotors) {
            if !self
                .bodies
                .note_turned(rotor, (new_x[i], new_v[i]), &mut to.turned)
            {
                lost = lost.or(Some(rotor.place));
            }
        }
        let place = |i: usize| {
            rotors
                .get(i.wrapping_sub(count))
                .map_or(i, |rotor| rotor.place)
        };
        let stepped =
            stepped.map_err(|failure| (place(body_of(&failure)), Cause::Failure(failure)));
        let duration = block.length;
        let turned = lost.map_or(Ok(()), |place| {
            Err((place, Cause::Turning(FlightError::HalfTurn { duration })))
        });
        gathered.rotors = rotors;
        scratch.gathered = Some(gathered);
        let done = stepped.and(turned);
        done.map_err(|(place, cause)| (group.bodies[place], cause))
    }
}

/// Steps bodies with only constant forces in one loop. The method must have a known end position for them (`fall`).
fn fall_all(
    scene: Scene<'_>,
    bodies: Range<usize>,
    fall: f64,
    end: &mut State,
) -> Result<(), (usize, Cause)> {
    let within = ballistic::step(
        (
            &scene.before.position[bodies.clone()],
            &scene.before.velocity[bodies.clone()],
        ),
        &scene.bodies.acceleration[bodies.clone()],
        (
            &mut end.position[bodies.clone()],
            &mut end.velocity[bodies.clone()],
        ),
        (scene.settings.dt, fall),
        error::LARGEST,
    );
    if within {
        return Ok(());
    }
    let lost = beyond(end, bodies.clone());
    Err((lost.unwrap_or(bodies.start), Cause::Range))
}

/// The first body of a range whose motion is out of the allowed range.
fn beyond(end: &State, bodies: Range<usize>) -> Option<usize> {
    let start = bodies.start;
    let first = end.beyond(bodies, error::LARGEST);
    first.map(|body| start + body)
}

impl World {
    /// Puts every body back to the start of the step, and returns the error.
    #[cold]
    pub(super) fn failed(&mut self, body: usize, cause: Cause) -> StepError {
        let error = self.step_error(body, cause);
        mem::swap(&mut self.current, &mut self.previous);
        mem::swap(&mut self.previous, &mut self.earlier);
        error
    }

    fn step_error(&self, body: usize, cause: Cause) -> StepError {
        let (step, method) = (self.elapsed.steps + 1, self.settings.method.title);
        match cause {
            Cause::Range => StepError::OutOfRange {
                body,
                step,
                method,
                stable_dt: self.integrator.stable_dt(scene!(self), body),
            },
            Cause::Squeezed(between) => StepError::Squeezed {
                body,
                between,
                step,
            },
            Cause::Impacts(impacts) => StepError::TooManyImpacts {
                body,
                step,
                method,
                impacts,
            },
            Cause::Work => StepError::TooMuchWork { body, step, method },
            Cause::Growth { stable_dt } => StepError::Unstable {
                body,
                step,
                method,
                stable_dt,
            },
            Cause::Turning(error) => StepError::Turning { body, step, error },
            Cause::Failure(Failure::NotConverged { iterations, .. }) => StepError::NotConverged {
                body,
                other: self.nearest_tied(body),
                step,
                method,
                iterations,
            },
            Cause::Failure(Failure::TooManySteps { steps, .. }) => StepError::TooManySteps {
                body,
                other: self.nearest_tied(body),
                step,
                method,
                steps,
            },
        }
    }

    /// The nearest of the bodies that forces connect to a body, at the start of the step.
    fn nearest_tied(&self, body: usize) -> Option<usize> {
        let scene = scene!(self);
        let section = scene.forces.plan.section_at(body)?;
        let mut groups = section.groups.iter();
        let group = groups.find(|group| group.bodies.contains(&body))?;
        let from = scene.before.position[body];
        let distance = |other: usize| scene.before.position[other].distance(from);
        let others = group.bodies.iter().copied().filter(|&other| other != body);
        others.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    }
}

/// The motion after one step of a method that is stable at every `dt`; `None` if the method fails. Contacts do not
/// matter here.
fn followed(
    part: &Part<'_>,
    time: f64,
    dt: f64,
    (x, v): (&[DVec3], &[DVec3]),
) -> Option<(Vec<DVec3>, Vec<DVec3>)> {
    let (mut new_x, mut new_v) = (x.to_vec(), v.to_vec());
    let step = Step {
        time,
        dt,
        tolerance: Settings::default().tolerance,
        position: x,
        velocity: v,
        new_position: &mut new_x,
        new_velocity: &mut new_v,
        scratch: &mut Scratch::default(),
        watch: None,
    };
    (Method::named("radau5")?.step)(part, step).ok()?;
    Some((new_x, new_v))
}

/// The bodies that must be stepped together with a body (perhaps the body alone); `None` under constant forces.
fn company(plan: &Plan, body: usize) -> Option<Section> {
    let mut sections = plan.sections.iter();
    let section = sections.find(|section| section.bodies.contains(&body))?;
    let bodies = match section.is_coupled {
        true => section.bodies.clone(),
        false => body..body + 1,
    };
    Some(Section {
        bodies,
        is_coupled: section.is_coupled,
        groups: Vec::new(),
    })
}

/// The body at which a method failed, by its place among the bodies of the call.
fn body_of(failure: &Failure) -> usize {
    match *failure {
        Failure::NotConverged { body, .. } | Failure::TooManySteps { body, .. } => body,
    }
}

/// Called after each partial step of a block. Receives the time, s from the start of the block; the map from places in
/// the block to bodies; and the positions before and after the partial step, m. Returns whether to stop there.
pub(super) type BlockWatch<'a> =
    dyn FnMut(f64, &dyn Fn(usize) -> usize, &[DVec3], &[DVec3]) -> bool + 'a;

/// Bodies that one call steps, and its parameters.
#[derive(Clone)]
pub(super) struct Block<'a> {
    pub(super) bodies: Range<usize>,
    pub(super) is_coupled: bool,
    /// The accelerations of these bodies by constant forces, m/s².
    pub(super) acceleration: &'a [DVec3],
    /// The motion of all bodies at the start of the block.
    pub(super) from: &'a State,
    /// The start of the block, s after the start of the world's step, and its length, s.
    pub(super) since: f64,
    pub(super) length: f64,
}

/// The reason why a step failed at a body.
#[derive(Debug)]
pub(super) enum Cause {
    Range,
    /// Another body has no room left between these bodies.
    Squeezed((usize, usize)),
    /// The number of impacts reached this limit without an end.
    Impacts(u64),
    /// To follow a body costs more than a step may.
    Work,
    /// Speeds have grown, and the method is unstable above this `dt`, s.
    Growth {
        stable_dt: f64,
    },
    Failure(Failure),
    /// A rotation that cannot be computed.
    Turning(FlightError),
}
