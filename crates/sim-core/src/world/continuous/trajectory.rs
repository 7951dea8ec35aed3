//! The positions of bodies at any time within a step.
//!
//! The *trajectory* of a body leads from its last event in the step, or from the step's start, to the step's end, as
//! its method computes it: the state at any time in between is the state after a step of the method of exactly that
//! length. For a body under a constant acceleration, the trajectory is a parabola and costs nothing. For other bodies
//! each evaluation is a step of the method, with all coupled bodies.
//!
//! A first-order method gives other points for each length of its steps, and two partial steps differ from one whole
//! step: a ball would lose a part of its height at each bounce. But under a constant acceleration `a` its points
//! `x + dt (v + fall dt a)` are on one parabola, on which the velocity is `u = v + s a` with the *velocity stagger*
//! `s = (fall - 1/2) dt`. So symplectic and backward Euler keep the velocity of half a step before, forward Euler
//! that of half a step after. Trajectories use `u`. An impact changes `u` and `v` by the same amount, so that no
//! bounce loses energy, at whatever time it happens. Under other forces `a` is the mean over the step.

use alloc::{vec, vec::Vec};
use core::{mem, ops::Range};
use glam::DVec3;

use super::super::{
    error,
    scene::Scene,
    state::{State, Turned},
    stepping::{Block, Cause},
    system::Part,
};
use super::{contact_set::ContactSet, event::Event, horizon::Horizons, levered, work::Work};
use crate::{
    System,
    integrate::Scratch,
    rotation::{Flight, FlightError},
};

/// Memory for the evaluation of trajectories.
#[derive(Clone, Debug, Default)]
pub(in crate::world) struct Probe {
    pub(super) state: State,
    pub(super) scratch: Scratch,
    /// The work done since this value was last taken.
    pub(super) work: Work,
}

/// The trajectories of all bodies in a step.
#[derive(Clone, Debug, Default)]
pub(in crate::world) struct Trajectories {
    /// The motion of each body at the start of its trajectory, and the time of that start, s from the step's start.
    pub(super) start: State,
    pub(super) since: Vec<f64>,
    /// The motion at the end of the step, or at the horizon; not valid outside of a step.
    pub(in crate::world) end: State,
    pub(in crate::world) horizons: Horizons,
    /// How often the trajectory of each body has changed in this step. Events of older versions are void.
    pub(super) version: Vec<u32>,
    /// The acceleration of each body by forces along its whole trajectory, m/s²: that of constant forces, or of all
    /// forces under a first-order method.
    pub(super) applied_acceleration: Vec<DVec3>,
    /// The same with the forces of contacts.
    pub(super) acceleration: Vec<DVec3>,
    /// The velocity stagger, s: the method keeps the velocity that the trajectory has this long before.
    pub(super) velocity_stagger: f64,
    /// By slot, the flight of the rotation of a turning body from the start of its trajectory to the step's end.
    pub(super) flights: Vec<Flight>,
    /// By slot, the torque of all forces, N m: a constant, or about the mean over the trajectory.
    pub(super) applied_torque: Vec<DVec3>,
    /// By slot, what a first-order method adds to the angular momentum of a body with levers at the end of the step,
    /// kg m²/s.
    pub(super) kicks: Vec<Option<DVec3>>,
    /// By slot, the forces on a body that contacts press.
    pub(super) pressed: Vec<Option<Press>>,
    /// By body, whether its forces are constant from the start of its trajectory on (`ContactSolver::freeze`); empty
    /// if there is no such body.
    pub(super) frozen: Vec<bool>,
    /// Whether every trajectory is a parabola.
    pub(super) is_free: bool,
    /// Memory for the evaluation of trajectories and for trajectories that start again.
    pub(super) probe: Probe,
    restarted_motion: Vec<(DVec3, DVec3)>,
    restarted_turned: Vec<(usize, Turned)>,
}

/// The constant forces on a body in contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Press {
    /// The torque of all forces, contacts included, N m.
    pub(super) torque: DVec3,
    /// The time at which these forces end, s from the step's start.
    pub(super) until: f64,
}

/// The trajectories with their scene.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) paths: &'a Trajectories,
}

impl Trajectories {
    pub(super) fn motion<'a>(&'a self, scene: &'a Scene<'a>) -> Motion<'a> {
        Motion { scene, paths: self }
    }

    /// Whether the bodies of an event are still on the trajectories that lead to it.
    #[inline]
    pub(super) fn is_current(&self, event: &Event) -> bool {
        let ((i, j), version) = (event.bodies, &self.version);
        event.versions == (version[i], version[j])
    }

    /// Starts every trajectory at the start of the step. The ends must be there already.
    pub(super) fn begin(&mut self, scene: &Scene<'_>) {
        let n = scene.bodies.len();
        let sections = &scene.forces.plan.sections;
        let method = scene.settings.method;
        let is_first_order = method.order == 1 && method.fall.is_some();
        self.is_free = is_first_order || sections.is_empty() && method.fall.is_some();
        // Zero for methods of second and higher order.
        self.velocity_stagger = method.fall.map_or(0.0, |fall| fall - 0.5) * scene.settings.dt;
        self.start.clone_from(scene.before);
        self.applied_acceleration
            .clone_from(&scene.bodies.acceleration);
        if is_first_order {
            let forced = sections.iter();
            for body in forced.flat_map(|section| section.bodies.clone()) {
                let change = self.end.velocity[body] - scene.before.velocity[body];
                self.applied_acceleration[body] = change / scene.settings.dt;
            }
        }
        if self.velocity_stagger != 0.0 {
            let velocity = self.start.velocity.iter_mut();
            for (v, &a) in velocity.zip(&self.applied_acceleration) {
                *v += self.velocity_stagger * a;
            }
        }
        self.acceleration.clone_from(&self.applied_acceleration);
        self.frozen.clear();
        self.since.clear();
        self.since.resize(n, 0.0);
        self.version.clear();
        self.version.resize(n, 0);
    }

    /// Computes the flights of all turning bodies to the end of the step.
    pub(super) fn begin_turning(&mut self, scene: &Scene<'_>) -> Result<(), (usize, Cause)> {
        self.flights.clear();
        self.pressed.clear();
        self.pressed.resize(scene.bodies.turners.body.len(), None);
        self.kicks.clear();
        self.kicks.resize(scene.bodies.turners.body.len(), None);
        self.applied_torque.clone_from(&scene.bodies.turners.torque);
        for (slot, &body) in scene.bodies.turners.body.iter().enumerate() {
            let mut length = scene.settings.dt;
            // If forces that depend on the motion turn a body, the method gives its rotation at the end.
            let is_levered = scene.is_turned_by_levers(body);
            if is_levered {
                self.begin_levered(scene, slot, body)
                    .map_err(|error| (body, Cause::Turning(error)))?;
            }
            if self.motion(scene).coupled_group(body).is_none() {
                let until = self.turns_until(scene, slot, body)?;
                if until < length {
                    length = until;
                    self.end_at(scene, body, until);
                }
            }
            let flight = self
                .flight_from(scene, slot, self.start.turned[slot], length)
                .map_err(|error| (body, Cause::Turning(error)))?;
            self.flights.push(flight);
            if !is_levered {
                self.turn_to_end(slot, length);
            }
        }
        Ok(())
    }

    /// The time until which the trajectory of a turning body is computed: as long as contacts press it with constant
    /// forces, and not for so many turns in a step that each impact would cost thousands of them. Its trajectory
    /// starts again there.
    fn turns_until(
        &self,
        scene: &Scene<'_>,
        slot: usize,
        body: usize,
    ) -> Result<f64, (usize, Cause)> {
        let dt = scene.settings.dt;
        if self.kicks[slot].is_some() {
            return Ok(dt);
        }
        let Turned { rotation, momentum } = self.start.turned[slot];
        let moments = scene.bodies.turners.inertia[slot].moments();
        let torque = self.torque_on(slot);
        let until = self.pressed[slot].map_or(dt, |press| press.until);
        let left = until - self.since[body];
        let affordable = Flight::affordable(moments, rotation, momentum, torque, left)
            .map_err(|error| (body, Cause::Turning(error)))?;
        Ok(match affordable < left {
            true => self.since[body] + affordable,
            false => until,
        })
    }

    /// Ends the parabola of a body at a time, which is its horizon if it is before the step's end.
    fn end_at(&mut self, scene: &Scene<'_>, body: usize, until: f64) {
        let dt = scene.settings.dt;
        let known = (until < dt).then_some(until);
        self.horizons.set(body..body + 1, known, scene);
        let length = until.min(dt) - self.since[body];
        let (x, v) = self.motion(scene).on_parabola(body, length);
        self.end.position[body] = x;
        self.end.velocity[body] = self.motion(scene).unstaggered_velocity(body, v);
    }

    fn torque_on(&self, slot: usize) -> DVec3 {
        match (self.pressed[slot], self.kicks[slot]) {
            (Some(press), _) => press.torque,
            (None, Some(_)) => DVec3::ZERO,
            (None, None) => self.applied_torque[slot],
        }
    }

    /// The flight of a turning body from a given rotation and angular momentum.
    pub(super) fn flight_from(
        &self,
        scene: &Scene<'_>,
        slot: usize,
        turned: Turned,
        duration: f64,
    ) -> Result<Flight, FlightError> {
        let turners = &scene.bodies.turners;
        Flight::new(
            turners.inertia[slot].moments(),
            turned.rotation,
            turned.momentum,
            self.torque_on(slot),
            duration,
        )
    }

    fn turn_to_end(&mut self, slot: usize, length: f64) {
        let flight = &self.flights[slot];
        let kick = self.kicks[slot].filter(|_| self.pressed[slot].is_none());
        self.end.turned[slot] = Turned {
            rotation: flight.rotation_at(length),
            momentum: flight.momentum_at(length) + kick.unwrap_or_default(),
        };
    }

    /// Computes the rotation of a body from the start of its trajectory on.
    fn turn_on(&mut self, scene: &Scene<'_>, slot: usize, body: usize) -> Result<(), FlightError> {
        let mut length = self.motion(scene).horizon(body) - self.since[body];
        let (start, is_bent) = (
            self.start.turned[slot],
            self.motion(scene).is_turning_bent(body),
        );
        if is_bent {
            self.applied_torque[slot] = levered::mean_torque(start, self.end.turned[slot], length);
            length = scene.settings.dt - self.since[body];
        }
        self.flights[slot] = self.flight_from(scene, slot, start, length)?;
        if !is_bent {
            self.turn_to_end(slot, length);
        }
        Ok(())
    }

    /// Starts the trajectory of a body and of the bodies coupled to it again at a time, at their positions then, and
    /// returns these bodies.
    pub(super) fn restart_at(
        &mut self,
        scene: &Scene<'_>,
        body: usize,
        time: f64,
    ) -> Result<Range<usize>, (usize, Cause)> {
        let group = self.motion(scene).coupled_group(body);
        let bodies = group.map_or(body..body + 1, |(bodies, _)| bodies);
        if self.since[body] == time {
            return Ok(bodies);
        }
        let mut probe = mem::take(&mut self.probe);
        let mut motion = mem::take(&mut self.restarted_motion);
        let mut turned = mem::take(&mut self.restarted_turned);
        motion.clear();
        turned.clear();
        let found = bodies.clone().try_for_each(|body| {
            let there = match body == bodies.start {
                true => self.motion(scene).pose_at(body, time, &mut probe)?,
                false => {
                    let first = bodies.start;
                    self.motion(scene)
                        .pose_after(first, body, time, &mut probe)?
                }
            };
            motion.push((there.position, there.velocity));
            if let Some(slot) = scene.bodies.turners.slot(body) {
                let flown = || self.motion(scene).turned_at(slot, body, time);
                turned.push((slot, there.turned.unwrap_or_else(flown)));
            }
            Ok(())
        });
        if found.is_ok() {
            for &(slot, there) in &turned {
                self.start.turned[slot] = there;
            }
            for (body, &(x, v)) in bodies.clone().zip(&motion) {
                self.start.position[body] = x;
                self.start.velocity[body] = v;
                self.since[body] = time;
            }
        }
        (self.probe, self.restarted_motion, self.restarted_turned) = (probe, motion, turned);
        found.map(|()| bodies)
    }

    /// Steps the bodies whose trajectories have started again, in order, to the end of the step; bodies that are
    /// stepped together only once.
    pub(super) fn finish_restarted(
        &mut self,
        scene: &Scene<'_>,
        contacts: &ContactSet,
        restarted: &[usize],
    ) -> Result<(), (usize, Cause)> {
        for &body in restarted {
            let group = self.motion(scene).coupled_group(body);
            let bodies = group.map_or(body..body + 1, |(bodies, _)| bodies);
            if bodies.start == body {
                self.finish(scene, contacts, bodies)?;
            }
        }
        Ok(())
    }

    /// Steps coupled bodies from the start of their trajectories to the end of the step, or to their horizon.
    fn finish(
        &mut self,
        scene: &Scene<'_>,
        contacts: &ContactSet,
        bodies: Range<usize>,
    ) -> Result<(), (usize, Cause)> {
        let dt = scene.settings.dt;
        match self.motion(scene).coupled_group(bodies.start) {
            None => {
                for body in bodies.clone() {
                    let until = match scene.bodies.turners.slot(body) {
                        Some(slot) => self.turns_until(scene, slot, body)?,
                        None => dt,
                    };
                    self.end_at(scene, body, until);
                }
            }
            Some((bodies, is_coupled)) => {
                let mut end = mem::take(&mut self.end);
                let mut probe = mem::take(&mut self.probe);
                let block = self.motion(scene).block_of(bodies.clone(), is_coupled, dt);
                probe.work.moved += bodies.len() as u64;
                let moved = scene.step_to_horizon(contacts, block, &mut end, &mut probe.scratch);
                probe.work.tried += mem::take(&mut probe.scratch.tried);
                (self.end, self.probe) = (end, probe);
                self.horizons.set(bodies, moved?, scene);
            }
        }
        for body in bodies.clone() {
            self.version[body] += 1;
            if let Some(slot) = scene.bodies.turners.slot(body) {
                let turned = self.turn_on(scene, slot, body);
                turned.map_err(|error| (body, Cause::Turning(error)))?;
            }
        }
        match self.end.beyond(bodies.clone(), error::LARGEST) {
            Some(first) => Err((bodies.start + first, Cause::Range)),
            None => Ok(()),
        }
    }
}

impl<'a> Motion<'a> {
    /// The bodies that must be stepped with a body, and whether forces couple them; `None` if the trajectory of the
    /// body is a parabola.
    #[inline(always)]
    pub(super) fn coupled_group(&self, body: usize) -> Option<(Range<usize>, bool)> {
        match self.paths.is_free {
            true => None,
            false => self.group_among_forced(body),
        }
    }

    /// The constant forces on a body, if contacts press it.
    pub(super) fn press(&self, body: usize) -> Option<Press> {
        let slot = self.scene.bodies.turners.slot(body)?;
        self.paths.pressed[slot]
    }

    fn is_pressed(&self, body: usize) -> bool {
        self.press(body).is_some()
    }

    #[inline(never)]
    fn group_among_forced(&self, body: usize) -> Option<(Range<usize>, bool)> {
        if self.is_pressed(body) || self.paths.frozen.get(body) == Some(&true) {
            return None;
        }
        match self.scene.forces.plan.section_at(body) {
            Some(section) if section.is_coupled => Some((section.bodies.clone(), true)),
            None if self.scene.settings.method.fall.is_some() => None,
            _ => Some((body..body + 1, false)),
        }
    }

    /// The position and velocity of a body at a time between the start of its trajectory and its horizon, s from the
    /// step's start.
    pub(super) fn motion_at(
        &self,
        body: usize,
        time: f64,
        probe: &mut Probe,
    ) -> Result<(DVec3, DVec3), (usize, Cause)> {
        let paths = self.paths;
        let h = time - paths.since[body];
        if h == 0.0 {
            let start = &paths.start;
            return Ok((start.position[body], start.velocity[body]));
        }
        if time == self.horizon(body) {
            let staggered = self.stagger_of(body) * paths.acceleration[body];
            let v = self.paths.end.velocity[body] + staggered;
            return Ok((self.paths.end.position[body], v));
        }
        let Some((bodies, is_coupled)) = self.coupled_group(body) else {
            return Ok(self.on_parabola(body, h));
        };
        probe.work.check((body, body), self.scene.bodies)?;
        probe.work.moved += bodies.len() as u64;
        probe.state.match_len(&paths.start);
        self.step_group(
            bodies,
            is_coupled,
            time,
            &mut probe.state,
            &mut probe.scratch,
        )?;
        probe.work.tried += mem::take(&mut probe.scratch.tried);
        Ok((probe.state.position[body], probe.state.velocity[body]))
    }

    /// The rotation and angular momentum of a turning body at a time between the start of its trajectory and the
    /// step's end, s from the step's start. If the torque depends on the motion, its mean is used.
    pub(super) fn turned_at(&self, slot: usize, body: usize, time: f64) -> Turned {
        let h = time - self.paths.since[body];
        if h == 0.0 {
            return self.paths.start.turned[slot];
        }
        let flight = &self.paths.flights[slot];
        Turned {
            rotation: flight.rotation_at(h),
            momentum: flight.momentum_at(h),
        }
    }

    /// The position and velocity of a body on a parabola, `h` seconds after the start of its trajectory.
    #[inline]
    fn on_parabola(&self, body: usize, h: f64) -> (DVec3, DVec3) {
        let start = &self.paths.start;
        let (x, v) = (start.position[body], start.velocity[body]);
        let a = self.paths.acceleration[body];
        (x + h * (v + 0.5 * h * a), v + h * a)
    }

    /// Steps coupled bodies, or a single one, from the start of their trajectories to a time.
    pub(super) fn step_group(
        &self,
        bodies: Range<usize>,
        is_coupled: bool,
        time: f64,
        to: &mut State,
        scratch: &mut Scratch,
    ) -> Result<(), (usize, Cause)> {
        let block = self.block_of(bodies, is_coupled, time);
        self.scene.step_block(block, to, scratch, None)
    }

    /// The block of coupled bodies, or of a single one, from the start of their trajectories to a time.
    fn block_of(&self, bodies: Range<usize>, is_coupled: bool, time: f64) -> Block<'a> {
        let paths = self.paths;
        let since = paths.since[bodies.start];
        Block {
            // Resting contacts push like constant forces.
            acceleration: &paths.acceleration[bodies.clone()],
            bodies,
            is_coupled,
            from: &paths.start,
            since,
            length: time - since,
        }
    }

    /// The velocity that the method keeps when the velocity of a body on its trajectory is `on_trajectory`.
    fn unstaggered_velocity(&self, body: usize, on_trajectory: DVec3) -> DVec3 {
        on_trajectory - self.stagger_of(body) * self.paths.acceleration[body]
    }

    /// The velocity stagger of a body, s: the trajectory's velocity is the method's plus this times the acceleration.
    fn stagger_of(&self, body: usize) -> f64 {
        let stagger = self.paths.velocity_stagger;
        if stagger == 0.0 {
            return 0.0;
        }
        match self.is_pressed(body) {
            true => 0.0,
            false => stagger,
        }
    }

    /// The acceleration of a body by forces and contacts at the start of its trajectory, m/s².
    pub(super) fn acceleration_there(&self, body: usize) -> DVec3 {
        self.acceleration_beside(body, &[])
    }

    /// The same if some bodies were displaced from there, each by the given vector, m.
    pub(super) fn acceleration_beside(&self, body: usize, moved: &[(usize, DVec3)]) -> DVec3 {
        self.loads_beside(body, moved).0
    }

    /// The acceleration, m/s², and the torque of all forces, N m, if the body is coupled to one with levers.
    pub(super) fn loads_beside(
        &self,
        body: usize,
        moved: &[(usize, DVec3)],
    ) -> (DVec3, Option<DVec3>) {
        let paths = self.paths;
        let Some((bodies, is_coupled)) = self.coupled_group(body) else {
            return (paths.acceleration[body], None);
        };
        let part = Part {
            forces: &self.scene.forces.list,
            plan: &self.scene.forces.plan,
            is_coupled,
            mass: &self.scene.bodies.mass[bodies.clone()],
            acceleration: &paths.acceleration[bodies.clone()],
            bodies: bodies.clone(),
            group: None,
        };
        let time = self.scene.time + paths.since[body];
        let mut all = vec![DVec3::ZERO; bodies.len()];
        let (x, v) = (&paths.start.position, &paths.start.velocity);
        let mut x = x[bodies.clone()].to_vec();
        for &(other, by) in moved {
            if bodies.contains(&other) {
                x[other - bodies.start] += by;
            }
        }
        let v = &v[bodies.clone()];
        if !bodies
            .clone()
            .any(|body| self.scene.forces.plan.is_levered(body))
        {
            part.accelerations(time, &x, v, &mut all);
            return (all[body - bodies.start], None);
        }
        self.scene
            .loads(part, time, (&x, v), &paths.start.turned, body)
    }

    /// The deviation of a body's trajectory from its chord, m, by component. On a parabola it is a bound. For other
    /// trajectories it is an estimate, unless the trajectory turns around and back within a step.
    #[inline(always)]
    pub(super) fn chord_deviation(&self, body: usize) -> DVec3 {
        let paths = self.paths;
        let h = self.horizon(body) - paths.since[body];
        if self.coupled_group(body).is_none() {
            return (0.125 * h * h) * paths.acceleration[body].abs();
        }
        // On a parabola the sum is four times the deviation.
        let chord = self.paths.end.position[body] - paths.start.position[body];
        let before = chord - h * paths.start.velocity[body];
        let after = chord - h * self.paths.end.velocity[body];
        0.25 * (before.abs() + after.abs())
    }

    /// The deviation of the relative trajectory of two bodies from a chord, m, divided by the square of the duration
    /// of the chord, s², by component.
    pub(super) fn deviation_per_time2(&self, i: usize, j: usize) -> DVec3 {
        if self.coupled_group(i).is_none() && self.coupled_group(j).is_none() {
            let push = &self.paths.acceleration;
            let relative = push[j] - push[i];
            return 0.125 * relative.abs();
        }
        let length = |body: usize| self.horizon(body) - self.paths.since[body];
        let h = length(i);
        // Forces that act on both bodies alike bend both trajectories alike, but not the relative one. So the
        // relative trajectory is used if both trajectories cover the same time.
        if h > 0.0 && self.paths.since[i] == self.paths.since[j] && h == length(j) {
            let (start, end) = (&self.paths.start, &self.paths.end);
            let from = start.position[j] - start.position[i];
            let chord = (end.position[j] - end.position[i]) - from;
            let before = chord - h * (start.velocity[j] - start.velocity[i]);
            let after = chord - h * (end.velocity[j] - end.velocity[i]);
            return 0.25 * (before.abs() + after.abs()) / (h * h);
        }
        let of = |body: usize| {
            let h = self.horizon(body) - self.paths.since[body];
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
