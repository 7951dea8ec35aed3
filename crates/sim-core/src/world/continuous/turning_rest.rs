//! Turning bodies that stay in contact for the rest of a step.
//!
//! First the closing contacts are stopped: the bodies take the nearest motion, in the norm of kinetic energy, in
//! which no contact closes. This only takes energy. Then each contact pushes with a constant force `f`, along a
//! constant direction and with constant lever arms, so that the bodies move on parabolas and turn under constant
//! torques. Such a rotation is computed exactly ([`crate::rotation`]; [`super::turning_forces`] finds the forces).
//! The forces last for the rest of the step, or for half of it, or a quarter, until forces are found that give no
//! energy. After that time they are computed anew.
//!
//! Impacts on these trajectories are searched like all others. An earlier impact ends the contact forces, and they
//! are computed anew with that contact as well. So bodies cannot cross, whatever the forces are.

use alloc::{vec, vec::Vec};
use glam::{DMat3, DVec3};

use super::super::stepping::Cause;
use super::{
    event::{Event, EventKind},
    event_loop::EventLoop,
    solver::ContactSolver,
    trajectory::Press,
    turning_forces::{Anchored, At, Forces, Mover, PARTS, Pressing, Turns},
    turning_response::{ArmIsland, Touching},
};
use crate::{
    impulse::arms::{self, Arms, Twist, Yielding},
    rotation,
};

/// The number of impacts in succession that bodies in contact may have before they stop for the rest of the step.
const MANY_ROUNDS: u32 = 24;

/// The least time for which constant forces last, as a fraction of the step, unless the step ends before.
const SHORTEST_PRESS: f64 = 1.0 / 512.0;

/// Two normals whose cosine is above this count as the same.
const SAME_NORMAL: f64 = 1.0 - 1e-6;

/// The turning bodies in contact in a step.
#[derive(Clone, Debug, Default)]
pub(super) struct TurningRest {
    /// By slot, the number of impacts and of rounds of contact in the step.
    pub(super) impacts: Vec<u32>,
    rounds: Vec<u32>,
    /// By slot, the kept motion of a body that is stopped for the rest of the step.
    stopped: Vec<Option<Kept>>,
    /// The known contacts.
    contacts: Vec<Anchored>,
}

/// The kept motion of a stopped body. Impacts use and change it, and the body continues with it in the next step. So
/// a body that hits the stopped body exchanges momentum and energy with it as with any other.
#[derive(Clone, Copy, Debug)]
struct Kept {
    velocity: DVec3,
    momentum: DVec3,
}

impl TurningRest {
    /// Begins a step.
    pub(super) fn begin(&mut self, slots: usize) {
        self.impacts.clear();
        self.impacts.resize(slots, 0);
        self.rounds.clear();
        self.rounds.resize(slots, 0);
        self.stopped.clear();
        self.stopped.resize(slots, None);
        self.contacts.clear();
    }
}

impl EventLoop<'_> {
    /// Gives the bodies that were stopped in the step their kept motion.
    pub(super) fn go_on_turning(&mut self) {
        let ContactSolver {
            scene,
            paths,
            turning,
            ..
        } = &mut self.solver;
        for (slot, stopped) in turning.stopped.iter().enumerate() {
            let body = scene.bodies.turners.body[slot];
            if let Some(kept) = stopped {
                paths.end.velocity[body] = kept.velocity;
                paths.end.turned[slot].momentum = kept.momentum;
            }
        }
    }
}

impl ContactSolver<'_> {
    /// Whether an event only requires a new search.
    pub(super) fn goes_on(&mut self, event: &Event) -> bool {
        let (i, j) = event.bodies;
        if event.kind != EventKind::Horizon {
            return false;
        }
        for body in [i, j] {
            if let Some(slot) = self.scene.bodies.turners.slot(body) {
                self.turning.rounds[slot] += 1;
            }
        }
        !self.is_stopped(i) && !self.is_stopped(j)
    }

    /// Ends the contact forces on a body whose trajectory starts at this time. Returns whether there were any.
    pub(super) fn release(&mut self, body: usize) -> bool {
        let Some(slot) = self.scene.bodies.turners.slot(body) else {
            return false;
        };
        let is_pressed = self.paths.pressed[slot].take().is_some();
        if is_pressed {
            let applied = self.paths.applied_acceleration[body];
            self.paths.acceleration[body] = applied;
            self.paths.start.velocity[body] += self.paths.velocity_stagger * applied;
            let kick = self.kick_left(slot, body);
            self.paths.start.turned[slot].momentum -= kick;
        }
        is_pressed
    }

    /// Stores a contact of two bodies at a time, in the frames of the bodies.
    pub(super) fn anchor(&mut self, touching: &Touching, time: f64) {
        let (i, j) = touching.bodies;
        let inverse = [i, j].map(|body| self.rotation_at(body, time).inverse());
        let contact = Anchored::of(touching, inverse);
        // A known contact of the same features is replaced.
        let is_same = |known: &Anchored| {
            known.bodies == contact.bodies
                && known.owner == contact.owner
                && known.normal.dot(contact.normal) > SAME_NORMAL
                && (0..2)
                    .any(|k| (known.points[k] - contact.points[k]).length() <= 4.0 * contact.room)
        };
        self.turning.contacts.retain(|known| !is_same(known));
        self.turning.contacts.push(contact);
    }

    /// The known contacts among `bodies` and with the bodies that they touch, at a time.
    fn known_contacts(
        &mut self,
        bodies: &[usize],
        time: f64,
    ) -> Result<Vec<Touching>, (usize, Cause)> {
        let mut touching = Vec::new();
        for place in 0..self.turning.contacts.len() {
            let contact = self.turning.contacts[place];
            let (i, j) = contact.bodies;
            // A body that has bounced off since then is no longer in contact.
            let is_off = |body: usize| {
                let all = self.scene.bodies;
                all.is_movable(body) && all.tumbles(body) && !bodies.contains(&body)
            };
            if !bodies.contains(&i) && !bodies.contains(&j) || is_off(i) || is_off(j) {
                continue;
            }
            let rotations = [i, j].map(|body| self.rotation_at(body, time));
            let between = self.place_at(j, time)? - self.place_at(i, time)?;
            let edges = contact
                .edges
                .map(|[e, f]| [rotations[0] * e, rotations[1] * f]);
            let at = |rotation, position| At { position, rotation };
            let later = contact.later([at(rotations[0], DVec3::ZERO), at(rotations[1], between)]);
            // Bodies never meet. A contact with such a deep overlap has left the other body, over the end of an edge
            // or the border of a face.
            if later.gap < -contact.room {
                continue;
            }
            touching.push(Touching {
                bodies: contact.bodies,
                arms: later.arms,
                normal: later.normal,
                owner: contact.owner,
                edges,
                gap: later.gap,
                room: contact.room,
            });
        }
        Ok(touching)
    }

    /// The kept motion of a body, if it is stopped.
    fn kept(&self, body: usize) -> Option<Kept> {
        let slot = self.scene.bodies.turners.slot(body)?;
        self.turning.stopped[slot]
    }

    /// The motion of a body that impacts change.
    pub(super) fn twist_of(&self, body: usize) -> Twist {
        let (all, start) = (self.scene.bodies, &self.paths.start);
        match (all.turners.slot(body), self.kept(body)) {
            (Some(slot), Some(kept)) => {
                let moments = all.turners.inertia[slot].moments();
                let rotation = start.turned[slot].rotation;
                Twist {
                    velocity: kept.velocity,
                    spin: rotation::spin(moments, rotation, kept.momentum),
                }
            }
            _ => all.twist_in(start, body),
        }
    }

    /// The parts of the motion of a body that impacts change: its velocity and, if it turns, its angular momentum.
    pub(super) fn changed(&mut self, body: usize) -> (&mut DVec3, Option<&mut DVec3>) {
        let slot = self.scene.bodies.turners.slot(body);
        let start = &mut self.paths.start;
        match slot.and_then(|slot| self.turning.stopped[slot].as_mut()) {
            Some(kept) => (&mut kept.velocity, Some(&mut kept.momentum)),
            None => (
                &mut start.velocity[body],
                slot.map(|slot| &mut start.turned[slot].momentum),
            ),
        }
    }

    /// Whether a body has had so many impacts in the step that it is stopped.
    fn is_stopped(&self, body: usize) -> bool {
        let slot = self.scene.bodies.turners.slot(body);
        slot.is_some_and(|slot| self.turning.rounds[slot] > MANY_ROUNDS)
    }

    /// Adds the contacts of bodies that do not turn and that turning bodies push, because these bodies pass on the
    /// push.
    fn add_kept_contacts(
        &mut self,
        touching: &mut Vec<Touching>,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let all = self.scene.bodies;
        let mut bodies: Vec<usize> = Vec::new();
        let reach = |bodies: &mut Vec<usize>, (i, j): (usize, usize)| {
            for body in [i, j] {
                if all.is_movable(body) && !all.tumbles(body) && !bodies.contains(&body) {
                    bodies.push(body);
                }
            }
        };
        for touching in touching.iter() {
            reach(&mut bodies, touching.bodies);
        }
        let mut known: Vec<u32> = Vec::new();
        let mut next = 0;
        while let Some(&body) = bodies.get(next) {
            next += 1;
            for &index in self.contacts.of_body(body) {
                if known.contains(&index) {
                    continue;
                }
                known.push(index);
                let constraint = &self.contacts.all()[index as usize];
                reach(&mut bodies, constraint.bodies);
                touching.push(Touching {
                    bodies: constraint.bodies,
                    arms: (DVec3::ZERO, DVec3::ZERO),
                    normal: constraint.normal,
                    owner: 0,
                    edges: None,
                    gap: 0.0,
                    room: 0.0,
                });
            }
        }
        for body in bodies {
            self.restart(body, time, restarted)?;
        }
        Ok(())
    }

    /// The movable bodies among `seen`, and those connected to them by contacts that press.
    fn tied_in_contact(&self, seen: &[usize]) -> Vec<usize> {
        let all = self.scene.bodies;
        let mut bodies: Vec<usize> = seen
            .iter()
            .copied()
            .filter(|&body| all.is_movable(body))
            .collect();
        bodies.sort_unstable();
        bodies.dedup();
        let mut next = 0;
        while let Some(&body) = bodies.get(next) {
            next += 1;
            for contact in &self.turning.contacts {
                let (i, j) = contact.bodies;
                if body != i && body != j {
                    continue;
                }
                let other = i + j - body;
                let slot = all.turners.slot(other);
                let is_tied = all.is_movable(other)
                    && slot.is_some_and(|slot| self.paths.pressed[slot].is_some());
                if is_tied && !bodies.contains(&other) {
                    bodies.push(other);
                }
            }
        }
        bodies
    }

    /// Keeps touching bodies, and those in contact with them, in contact by constant forces until the forces must be
    /// computed anew. `is_met` says whether they had an impact, which is counted, or only former forces have ended.
    pub(super) fn press_all(
        &mut self,
        (seen, is_met): (&[usize], bool),
        time: f64,
        (seeds, restarted): (&mut Vec<usize>, &mut Vec<usize>),
    ) -> Result<(), (usize, Cause)> {
        let bodies = self.tied_in_contact(seen);
        for &body in &bodies {
            self.restart(body, time, restarted)?;
            self.release(body);
            self.freeze(body);
        }
        let mut touching = self.known_contacts(&bodies, time)?;
        self.add_kept_contacts(&mut touching, time, restarted)?;
        let tied = touching
            .iter()
            .flat_map(|touching| [touching.bodies.0, touching.bodies.1]);
        seeds.extend(tied.chain(bodies.iter().copied()));
        self.lift(&bodies, &mut touching, time, restarted)?;
        let pulls = self.begin_contact((&bodies, is_met), &touching, time);
        let mut island = self.gather(&touching, time)?;
        // Stop the contacts that close.
        let wanted: Vec<f64> = island
            .contacts
            .iter()
            .map(|contact| -contact.opening(&island.twists))
            .collect();
        let given = arms::multipliers(&island.contacts, &island.yielding, &wanted);
        arms::push(
            &island.contacts,
            &island.yielding,
            &mut island.twists,
            &given,
        );
        self.put(&island, &given);
        let left = self.scene.settings.dt - time;
        let mut length = left;
        loop {
            let pressing = self.pressing(&island, &touching, &pulls, (time, length))?;
            let is_shortest = length <= SHORTEST_PRESS * self.scene.settings.dt;
            let forces = match pressing.find() {
                Some((forces, is_found)) if is_found || is_shortest => forces,
                _ if is_shortest => pressing.no_forces(),
                _ => {
                    length *= 0.5;
                    continue;
                }
            };
            let until = match length < left {
                true => time + length,
                false => self.scene.settings.dt,
            };
            self.press(&pressing, &forces, until);
            return Ok(());
        }
    }

    /// Moves bodies apart whose gaps are less than the room of their contacts. The distances are roundings and as
    /// small as possible, and other bodies must leave room for them.
    fn lift(
        &mut self,
        bodies: &[usize],
        touching: &mut [Touching],
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let wanted: Vec<f64> = touching
            .iter()
            .map(|touching| (touching.room - touching.gap).max(0.0))
            .collect();
        if wanted.iter().all(|&wanted| wanted == 0.0) {
            return Ok(());
        }
        let mut island = self.gather(touching, time)?;
        for (yielding, body) in island.yielding.iter_mut().zip(&island.bodies) {
            let moves = self.scene.bodies.tumbles(*body) && bodies.contains(body);
            yielding.mass = if moves { yielding.mass } else { 0.0 };
            yielding.inertia = DMat3::ZERO;
        }
        loop {
            let given = arms::multipliers(&island.contacts, &island.yielding, &wanted);
            let mut way = vec![Twist::default(); island.bodies.len()];
            arms::push(&island.contacts, &island.yielding, &mut way, &given);
            let ways = island.bodies.iter().copied().zip(&way);
            let ways = ways.map(|(body, way)| (body, way.velocity));
            let Some(blocked) = self.move_by(ways, time, restarted)? else {
                for (contact, touching) in island.contacts.iter().zip(touching) {
                    touching.gap += contact.opening(&way);
                }
                return Ok(());
            };
            // A body without room stays, and the others move farther.
            let place = island.bodies.iter().position(|&body| body == blocked);
            match place.filter(|&place| island.yielding[place].mass > 0.0) {
                Some(place) => island.yielding[place].mass = 0.0,
                None => return Ok(()),
            }
        }
    }

    /// Moves bodies, and the bodies in their way with them. If one of the given bodies has no room, no body is moved,
    /// and that body is returned.
    fn move_by(
        &mut self,
        ways: impl Iterator<Item = (usize, DVec3)>,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<Option<usize>, (usize, Cause)> {
        // Each body with its displacement, its former position, and the body whose displacement it follows.
        let mut moved: Vec<(usize, DVec3, DVec3, usize)> = ways
            .filter(|&(_, way)| way != DVec3::ZERO)
            .map(|(body, way)| (body, way, self.paths.start.position[body], body))
            .collect();
        for &(body, way, ..) in &moved {
            self.paths.start.position[body] += way;
        }
        let mut next = 0;
        while let Some(&(body, way, _, first)) = moved.get(next) {
            let Some(other) = self.met_by(body, time)? else {
                next += 1;
                continue;
            };
            let all = self.scene.bodies;
            let is_free = all.is_movable(other) && all.tumbles(other);
            if !is_free || moved.iter().any(|&(body, ..)| body == other) {
                for (body, _, before, _) in moved {
                    self.paths.start.position[body] = before;
                }
                return Ok(Some(first));
            }
            self.restart(other, time, restarted)?;
            moved.push((other, way, self.paths.start.position[other], first));
            self.paths.start.position[other] += way;
        }
        Ok(None)
    }

    /// Takes bodies out of their usual stepping, because their forces are constant from here on. Returns by body the
    /// acceleration by these forces. Bodies with too many impacts are stopped, and so are the bodies that touch them.
    fn begin_contact(
        &mut self,
        (bodies, is_met): (&[usize], bool),
        touching: &[Touching],
        time: f64,
    ) -> Vec<(usize, DVec3)> {
        let all = self.scene.bodies;
        let left = self.scene.settings.dt - time;
        for &body in bodies {
            if let Some(slot) = all.turners.slot(body) {
                self.turning.rounds[slot] += u32::from(is_met);
            }
        }
        self.stop_together(bodies, touching);
        let mut pulls = Vec::new();
        for &body in bodies {
            let Some(slot) = all.turners.slot(body) else {
                continue;
            };
            if !all.is_movable(body) || !all.tumbles(body) && !self.is_stopped(body) {
                continue;
            }
            let mut pull = self.view().motion().acceleration_there(body);
            let staggered = self.paths.velocity_stagger * self.paths.acceleration[body];
            self.paths.start.velocity[body] -= staggered;
            let kick = self.kick_left(slot, body);
            self.paths.start.turned[slot].momentum += kick;
            if self.is_stopped(body) {
                // If forces between bodies act on it, the other bodies get the reaction. So its kept motion gets the
                // impulse of its forces for the rest of the step.
                let section = self.scene.forces.plan.section_at(body);
                let is_coupled = section.is_some_and(|section| section.bodies.len() > 1);
                let given = if is_coupled { left } else { 0.0 };
                let torque = self.view().motion().torque_there(slot, body);
                let start = &mut self.paths.start;
                let (velocity, turned) = (&mut start.velocity[body], &mut start.turned[slot]);
                self.turning.stopped[slot].get_or_insert(Kept {
                    velocity: *velocity + given * pull,
                    momentum: turned.momentum + given * torque,
                });
                (*velocity, turned.momentum) = (DVec3::ZERO, DVec3::ZERO);
                pull = DVec3::ZERO;
            }
            pulls.push((body, pull));
        }
        pulls
    }

    /// Stops the bodies that touch a stopped body, because it would be in their way.
    fn stop_together(&mut self, bodies: &[usize], touching: &[Touching]) {
        let turners = &self.scene.bodies.turners;
        loop {
            let next = touching.iter().find_map(|touching| {
                let (i, j) = touching.bodies;
                let follows = match (self.is_stopped(i), self.is_stopped(j)) {
                    (true, false) => j,
                    (false, true) => i,
                    _ => return None,
                };
                turners.slot(follows).filter(|_| bodies.contains(&follows))
            });
            let Some(slot) = next else {
                return;
            };
            self.turning.rounds[slot] = MANY_ROUNDS + 1;
        }
    }

    /// Collects the data from which the contact forces are computed.
    fn pressing<'a>(
        &mut self,
        island: &'a ArmIsland,
        touching: &'a [Touching],
        pulls: &[(usize, DVec3)],
        (time, length): (f64, f64),
    ) -> Result<Pressing<'a>, (usize, Cause)> {
        let all = self.scene.bodies;
        let mut movers = Vec::with_capacity(island.bodies.len());
        for (place, &body) in island.bodies.iter().enumerate() {
            let pull = pulls.iter().find(|(pulled, _)| *pulled == body);
            let is_kept = self.kept(body).is_some();
            let turns = pull.filter(|_| !is_kept).and_then(|&(_, pull)| {
                let slot = all.turners.slot(body)?;
                let inertia = &all.turners.inertia[slot];
                Some(Turns {
                    slot,
                    pull,
                    torque: self.view().motion().torque_there(slot, body),
                    moments: inertia.moments(),
                    axes: inertia.axes(),
                    turned: self.paths.start.turned[slot],
                })
            });
            // A stopped body does not move.
            let (velocity, mass) = match is_kept {
                true => (DVec3::ZERO, 0.0),
                false => (island.twists[place].velocity, island.yielding[place].mass),
            };
            movers.push(Mover {
                body,
                turns,
                position: self.place_at(body, time)?,
                velocity,
                mass,
                rotations: match is_kept {
                    true => [self.rotation_at(body, time); PARTS.len()],
                    false => PARTS.map(|part| self.rotation_at(body, time + part * length)),
                },
            });
        }
        // Under a constant force the mean speed is half of the speed at the end. A body that does not turn gets its
        // impulse at once.
        let yielding = island.yielding.iter().zip(&movers);
        let yielding = yielding
            .map(|(yielding, mover)| match mover.turns {
                Some(_) => Yielding {
                    mass: 0.5 * yielding.mass,
                    inertia: 0.5 * yielding.inertia,
                },
                None if mover.mass > 0.0 => *yielding,
                None => Yielding::NOTHING,
            })
            .collect();
        let place = |contact: &Arms| [contact.bodies.0, contact.bodies.1];
        let contacts = island.contacts.iter().zip(touching);
        let anchored = contacts
            .map(|(contact, touching)| {
                let inverse = place(contact).map(|k| movers[k].rotations[0].inverse());
                Anchored::of(touching, inverse)
            })
            .collect();
        // No body is lifted from a stopped body.
        let room = island.contacts.iter().zip(touching);
        let room = room
            .map(|(contact, touching)| {
                let mut bodies = place(contact).into_iter().map(|k| movers[k].body);
                match bodies.any(|body| self.is_stopped(body)) {
                    true => touching.gap.min(touching.room),
                    false => touching.room,
                }
            })
            .collect();
        Ok(Pressing {
            length,
            movers,
            yielding,
            touching,
            anchored,
            room,
            contacts: &island.contacts,
        })
    }

    /// Applies forces until a time.
    fn press(&mut self, pressing: &Pressing<'_>, forces: &Forces, until: f64) {
        let all = self.scene.bodies;
        let pushes = pressing.pushes(forces);
        for (mover, &(impulse, torque)) in pressing.movers.iter().zip(&pushes) {
            // A stopped body does not move, and is immovable for bodies that do not turn.
            if self.kept(mover.body).is_some()
                && let Some(slot) = all.turners.slot(mover.body)
            {
                self.paths.acceleration[mover.body] = DVec3::ZERO;
                self.paths.pressed[slot] = Some(Press {
                    torque: DVec3::ZERO,
                    until: self.scene.settings.dt,
                });
                continue;
            }
            match &mover.turns {
                Some(turns) => {
                    let by_contact = mover.mass / pressing.length * impulse;
                    self.paths.acceleration[mover.body] = turns.pull + by_contact;
                    let torque = turns.torque + torque;
                    self.paths.pressed[turns.slot] = Some(Press { torque, until });
                }
                None if mover.mass > 0.0 => {
                    self.paths.start.velocity[mover.body] += mover.mass * impulse;
                }
                None => (),
            }
        }
    }
}
