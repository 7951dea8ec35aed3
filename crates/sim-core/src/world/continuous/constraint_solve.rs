//! What contacts do to bodies: the solution of the constraints of an island.
//!
//! An *island* is what contacts tie together through bodies that may move. Its velocities become the
//! nearest ones, in the norm of kinetic energy, with which no contact moves against its normal
//! faster than its target; then its accelerations the nearest ones (Gauss' principle) with which no
//! contact that has its target is accelerated against its normal by more than its surface recedes.
//! Neither adds energy: what holds a contact is at right angles to how it moves.

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

use super::super::{World, stepping::Cause};
use super::contact_motion::Course;
use super::resolve::SHORTEST_FLIGHT;
use super::{Event, EventKind, Outcome};
use crate::impulse::{Joined, project};

/// Part of the speed that forces give in a step below which bodies that come to rest on each other
/// have rested before, and it is no impact.
pub(super) const SLIGHTEST: f64 = 1e-6;

/// An island whose bodies are slower than this part of what forces give them in a step, and that has
/// nothing to accelerate it, is at rest.
const AT_REST: f64 = 1e-6;

/// Part of the accelerations of an island that may be left over where it has none.
const UNBALANCED: f64 = 1e-9;

/// Part of the greatest speed at which a contact may still close where its island is solved.
const UNSOLVED: f64 = 1e-6;

/// Turns in which contacts are kept from closing and from parting for no time, and sweeps in each.
const MAX_TURNS: usize = 4;
const MAX_SWEEPS: usize = 100;

/// Brings the contacts that are slow to their targets, and keeps the others from closing: by impulses
/// on one contact after the other, until none is off its target by more than it may be (Gauss and
/// Seidel). Without targets the energy is at no time above that at the start.
fn bring_to_targets(
    places: &Places,
    slow: &[bool],
    velocity: &mut [DVec3],
    aim: impl Fn(usize) -> (f64, f64),
) {
    let mut given = alloc::vec![0.0_f64; slow.len()];
    for _ in 0..MAX_SWEEPS {
        let mut is_done = true;
        for (k, joined) in places.joined.iter().enumerate() {
            let (target, tolerance) = aim(k);
            let missing = target - joined.opening(velocity);
            let (i, j) = joined.bodies;
            let (first, second) = (places.inverse_mass[i], places.inverse_mass[j]);
            let mut impulse = missing / (first + second);
            if !slow[k] {
                impulse = impulse.max(-given[k]);
            }
            if impulse.abs() * (first + second) <= tolerance {
                continue;
            }
            is_done = false;
            given[k] += impulse;
            velocity[i] -= first * impulse * joined.normal;
            velocity[j] += second * impulse * joined.normal;
        }
        if is_done {
            return;
        }
    }
}

/// Bodies and constraints that contacts tie together.
#[derive(Clone, Debug, Default)]
pub(super) struct Island {
    /// The bodies that may move.
    pub(super) bodies: Vec<usize>,
    /// Indices of the constraints.
    pub(super) constraints: Vec<usize>,
}

/// Who has been visited in a search for islands.
#[derive(Clone, Debug, Default)]
pub(super) struct Visited {
    round: u32,
    body: Vec<u32>,
}

impl Visited {
    /// Begins with nobody visited.
    pub(super) fn begin(&mut self, bodies: usize) {
        self.body.resize(bodies, 0);
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.body.fill(0);
            self.round = 1;
        }
    }

    /// Visits a body, and tells whether it is new.
    pub(super) fn visit(&mut self, body: usize) -> bool {
        mem::replace(&mut self.body[body], self.round) != self.round
    }
}

impl World {
    /// The island of a body, unless it has been visited.
    pub(super) fn island_of(&self, seed: usize, visited: &mut Visited) -> Option<Island> {
        if !self.is_movable(seed) || !visited.visit(seed) {
            return None;
        }
        let mut island = Island {
            bodies: alloc::vec![seed],
            constraints: Vec::new(),
        };
        let mut next = 0;
        while let Some(&body) = island.bodies.get(next) {
            next += 1;
            for &index in self.contacts.of_body(body) {
                let (i, j) = self.contacts.all()[index as usize].bodies;
                let other = i + j - body;
                // Of two that may move, the lower one names it.
                if !self.is_movable(other) || body < other {
                    island.constraints.push(index as usize);
                }
                if self.is_movable(other) && visited.visit(other) {
                    island.bodies.push(other);
                }
            }
        }
        island.bodies.sort_unstable();
        island
            .constraints
            .sort_unstable_by_key(|&index| (self.contacts.all()[index].bodies, index));
        Some(island)
    }

    /// Solves the islands of some bodies at a time, and adds the bodies whose trajectories have started
    /// again to a list.
    pub(super) fn solve_islands_of(
        &mut self,
        seeds: &[usize],
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let mut visited = mem::take(&mut self.continuous.visited);
        visited.begin(self.len());
        let mut outcome = Ok(());
        for &seed in seeds {
            if let Some(island) = self.island_of(seed, &mut visited)
                && !island.constraints.is_empty()
            {
                outcome = self.solve_island(&island, time, restarted);
                if outcome.is_err() {
                    break;
                }
            }
        }
        self.continuous.visited = visited;
        outcome
    }

    fn solve_island(
        &mut self,
        island: &Island,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        for &body in &island.bodies {
            self.wake(body);
            self.restart(body, time, restarted)?;
        }
        if self.remeasure(island, time) {
            // What is left may be several islands.
            let mut visited = Visited::default();
            visited.begin(self.len());
            for &body in &island.bodies {
                if let Some(island) = self.island_of(body, &mut visited) {
                    self.solve_measured(&island, time)?;
                }
            }
            return Ok(());
        }
        self.solve_measured(island, time)
    }

    /// Looks again at contacts whose normals turn, where bodies are at a time, and tells whether some
    /// are no more.
    fn remeasure(&mut self, island: &Island, time: f64) -> bool {
        let mut gone = Vec::new();
        if time == 0.0 {
            return false;
        }
        for &index in &island.constraints {
            let constraint = self.contacts.all()[index];
            if constraint.is_turning || constraint.ends_at <= time {
                match self.measured(constraint, self.settings.dt - time) {
                    Some(measured) => *self.contacts.get_mut(index) = measured,
                    None => gone.push(index),
                }
            }
        }
        gone.sort_unstable_by(|a, b| b.cmp(a));
        for &index in &gone {
            self.contacts.remove(index);
        }
        !gone.is_empty()
    }

    /// Solves an island whose bodies are at the start of their trajectories.
    fn solve_measured(&mut self, island: &Island, time: f64) -> Result<(), (usize, Cause)> {
        let places = Places::of(self, &island.constraints);
        let mut open = self.solve_velocities(island, &places, self.settings.dt - time)?;
        self.solve_accelerations(island, &places, &mut open, time)?;
        let mut gone: Vec<usize> = (0..open.len())
            .filter(|&k| open[k])
            .map(|k| island.constraints[k])
            .collect();
        gone.sort_unstable_by(|a, b| b.cmp(a));
        for index in gone {
            self.contacts.remove(index);
        }
        Ok(())
    }

    /// Gives the bodies of an island velocities with which no contact closes faster than its target, and
    /// tells for each contact whether it opens.
    fn solve_velocities(
        &mut self,
        island: &Island,
        places: &Places,
        left: f64,
    ) -> Result<Vec<bool>, (usize, Cause)> {
        let mut velocity = places.each(|body| self.continuous.start.velocity[body]);
        let length = |v: &DVec3| v.length();
        let fastest = velocity.iter().map(length).fold(0.0, f64::max);
        let rounding = 4.0 * f64::EPSILON * fastest;
        let constraint = |k: usize| &self.contacts.all()[island.constraints[k]];
        let opening = |k: usize, velocity: &[DVec3]| {
            places.joined[k].opening(velocity) - constraint(k).target
        };
        let count = island.constraints.len();
        let missing: Vec<f64> = (0..count).map(|k| -opening(k, &velocity)).collect();
        let mut given = alloc::vec![0.0; count];
        if missing.iter().any(|&missing| missing > rounding) {
            given = project(
                &places.joined,
                &places.inverse_mass,
                &mut velocity,
                &missing,
            );
        }
        // What would be back within the shortest flight does not part: it is brought to its target. Like
        // what keeps contacts from closing that takes energy and gives none, and the two in turns lead
        // to where both hold.
        let hop = |k: usize| 0.5 * SHORTEST_FLIGHT * constraint(k).load_speed;
        // Slower than this a gap grows by less than that of contacts in a step, or than a hop counts.
        let still = |k: usize| {
            let (i, j) = constraint(k).bodies;
            let hover = self.hover_gap(i, j) / self.settings.dt;
            hover.max(4.0 * rounding).max(SLIGHTEST * hop(k))
        };
        for _ in 0..MAX_TURNS {
            let is_slow = |k: usize| {
                let speed = opening(k, &velocity);
                still(k) < speed && speed <= hop(k)
            };
            let slow: Vec<bool> = (0..count).map(is_slow).collect();
            if !slow.contains(&true) {
                break;
            }
            bring_to_targets(places, &slow, &mut velocity, |k| {
                (constraint(k).target, 0.5 * still(k))
            });
            let missing: Vec<f64> = (0..count).map(|k| -opening(k, &velocity)).collect();
            if missing.iter().any(|&missing| missing > rounding) {
                project(
                    &places.joined,
                    &places.inverse_mass,
                    &mut velocity,
                    &missing,
                );
            }
        }
        let parting: Vec<f64> = (0..count).map(|k| opening(k, &velocity)).collect();
        if let Some(k) = (0..count).find(|&k| parting[k] < -(still(k) + UNSOLVED * fastest))
            && let Some(crushed) = self.crushed(island, constraint(k).bodies)
        {
            return Err(crushed);
        }
        let open = (0..count)
            .map(|k| parting[k] > still(k).max(hop(k)))
            .collect();
        places.put(
            &velocity,
            &mut self.continuous.start.velocity,
            &places.inverse_mass,
        );
        for (k, &index) in island.constraints.iter().enumerate() {
            let constraint = self.contacts.get_mut(index);
            constraint.impulse = given[k];
            // What is left of a speed at which it parts turns back by the end of the step.
            let parting = if parting[k] > 4.0 * rounding {
                parting[k]
            } else {
                0.0
            };
            constraint.recession = 2.0 * parting / left;
            constraint.is_turning = parting > 0.0;
            constraint.ends_at = f64::INFINITY;
        }
        Ok(open)
    }

    /// That the bodies of a contact are crushed, if immovable bodies of the island move against each other.
    fn crushed(&self, island: &Island, (i, j): (usize, usize)) -> Option<(usize, Cause)> {
        let both = |&index: &usize| {
            let (i, j) = self.contacts.all()[index].bodies;
            [i, j]
        };
        let walls = island.constraints.iter().flat_map(both);
        let mut walls = walls.filter(|&body| !self.is_movable(body));
        let first = walls.next()?;
        let velocity = &self.previous.velocity;
        let other = walls.find(|&wall| velocity[wall] != velocity[first])?;
        let body = if self.is_movable(i) { i } else { j };
        Some((body, Cause::Squeezed((first.min(other), first.max(other)))))
    }

    /// Gives the bodies of an island accelerations with which no contact that is not open closes.
    fn solve_accelerations(
        &mut self,
        island: &Island,
        places: &Places,
        open: &mut [bool],
        time: f64,
    ) -> Result<(), (usize, Cause)> {
        for &body in &island.bodies {
            let continuous = &mut self.continuous;
            continuous.acceleration[body] = continuous.applied_acceleration[body];
        }
        let free = places.each(|body| self.acceleration_there(body));
        let (mut acceleration, mut force) = self.constrained(island, places, open, &free);
        if self.balance(island, places, &free, &acceleration, time) {
            self.note_loads(island, places, &force);
            return Ok(());
        }
        // Where the surface of a contact turns or ends, seen along the motion that it allows.
        let mut turns = false;
        let length = self.settings.dt - time;
        for k in 0..open.len() {
            let index = island.constraints[k];
            let constraint = self.contacts.all()[index];
            if open[k] || constraint.is_overlap || length <= 0.0 {
                continue;
            }
            let (i, j) = constraint.bodies;
            let start = &self.continuous.start;
            let (a, b) = places.joined[k].bodies;
            let stagger = match time == 0.0 {
                true => self.continuous.velocity_stagger,
                false => 0.0,
            };
            let pushed = acceleration[b] - acceleration[a];
            let motion = (
                start.position[j] - start.position[i],
                start.velocity[j] - start.velocity[i] + stagger * pushed,
                pushed,
            );
            // Where events come thick, surfaces count as flat for the rest of the step: nothing meets, and
            // what opens closes in the next one.
            if self.is_bundled(i) || self.is_bundled(j) {
                continue;
            }
            // What would press them together without this contact.
            let load = force[k] * (places.inverse_mass[a] + places.inverse_mass[b]);
            if load <= 0.0 {
                continue;
            }
            match self.course_below(&constraint, motion, length, load) {
                Course::Flat => {}
                Course::Receding(recession) => {
                    let constraint = self.contacts.get_mut(index);
                    constraint.recession += recession;
                    constraint.is_turning = true;
                    turns = true;
                }
                Course::EndsAfter(after) => {
                    self.contacts.get_mut(index).ends_at = time + after;
                }
                Course::Ended => {
                    open[k] = true;
                    turns = true;
                }
            }
        }
        if turns {
            (acceleration, force) = self.constrained(island, places, open, &free);
        }
        self.note_loads(island, places, &force);
        for (place, &body) in places.bodies.iter().enumerate() {
            if self.is_movable(body) {
                self.continuous.acceleration[body] += acceleration[place] - free[place];
            }
        }
        Ok(())
    }

    /// The accelerations nearest to free ones with which no contact that is not open closes more than
    /// its surface recedes, and the force of each contact.
    fn constrained(
        &self,
        island: &Island,
        places: &Places,
        open: &[bool],
        free: &[DVec3],
    ) -> (Vec<DVec3>, Vec<f64>) {
        let mut acceleration = free.to_vec();
        let kept: Vec<usize> = (0..open.len()).filter(|&k| !open[k]).collect();
        let joined: Vec<Joined> = kept.iter().map(|&k| places.joined[k]).collect();
        let missing: Vec<f64> = kept
            .iter()
            .map(|&k| {
                let recession = self.contacts.all()[island.constraints[k]].recession;
                -recession - places.joined[k].opening(free)
            })
            .collect();
        let given = project(&joined, &places.inverse_mass, &mut acceleration, &missing);
        let mut force = alloc::vec![0.0; open.len()];
        for (k, given) in kept.into_iter().zip(given) {
            force[k] = given;
        }
        (acceleration, force)
    }

    /// Notes by what speed each contact would close in a step if it were not there.
    fn note_loads(&mut self, island: &Island, places: &Places, force: &[f64]) {
        let dt = self.settings.dt;
        for (k, &index) in island.constraints.iter().enumerate() {
            let (i, j) = places.joined[k].bodies;
            let both = places.inverse_mass[i] + places.inverse_mass[j];
            self.contacts.get_mut(index).load_speed = dt * force[k] * both;
        }
    }

    /// Brings an island to rest that hardly moves and that nothing accelerates, and tells whether it has.
    fn balance(
        &mut self,
        island: &Island,
        places: &Places,
        free: &[DVec3],
        acceleration: &[DVec3],
        time: f64,
    ) -> bool {
        let push = free.iter().fold(0.0_f64, |most, a| most.max(a.length()));
        let is_still = |v: DVec3| v.length() <= AT_REST * push * self.settings.dt;
        let at_rest =
            time == 0.0
                && places.bodies.iter().enumerate().all(|(place, &body)| {
                    match self.is_movable(body) {
                        false => self.previous.velocity[body] == DVec3::ZERO,
                        true => {
                            is_still(self.continuous.start.velocity[body])
                                && acceleration[place].length() <= UNBALANCED * push
                                && self.coupled_group(body).is_none()
                        }
                    }
                })
                && island.constraints.iter().all(|&index| {
                    let constraint = &self.contacts.all()[index];
                    constraint.target == 0.0
                });
        if at_rest {
            for &body in &island.bodies {
                self.continuous.start.velocity[body] = DVec3::ZERO;
                self.continuous.acceleration[body] = DVec3::ZERO;
                self.fall_asleep(body);
            }
        }
        at_rest
    }

    /// Where methods stagger velocities, gives bodies in contact the velocities that the method keeps, by
    /// which contacts are judged at the start of a step.
    pub(super) fn unstagger_velocities(&mut self) {
        if self.continuous.velocity_stagger != 0.0 {
            for constraint in self.contacts.all() {
                for body in [constraint.bodies.0, constraint.bodies.1] {
                    self.continuous.start.velocity[body] = self.previous.velocity[body];
                }
            }
        }
    }

    /// Staggers the velocities of bodies anew, by what they are accelerated with in contact.
    pub(super) fn stagger_velocities(&mut self, bodies: &[usize]) {
        let continuous = &mut self.continuous;
        if continuous.velocity_stagger != 0.0 {
            for &body in bodies {
                let by = continuous.velocity_stagger * continuous.acceleration[body];
                continuous.start.velocity[body] += by;
            }
        }
    }

    /// Lets go of contacts that close so fast that they bounce, for the search to find. Bodies in overlap,
    /// which it does not look at, bounce at once.
    pub(super) fn release_bouncing(&mut self) {
        for index in (0..self.contacts.all().len()).rev() {
            let constraint = self.contacts.all()[index];
            let (i, j) = constraint.bodies;
            let velocity = &self.continuous.start.velocity;
            let closing = (velocity[i] - velocity[j]).dot(constraint.normal);
            if self.bounces((i, j), closing, constraint.load_speed) {
                match constraint.is_overlap {
                    true => self.exchange_there(&self.event_of(&constraint, 0.0), 0.0),
                    false => self.contacts.remove(index),
                }
            }
        }
    }

    /// The events at which contacts of some bodies end.
    pub(super) fn contact_ends(&self, bodies: &[usize], events: &mut Vec<Event>) {
        for &body in bodies {
            for &index in self.contacts.of_body(body) {
                let constraint = &self.contacts.all()[index as usize];
                let (i, j) = constraint.bodies;
                if constraint.ends_at < self.settings.dt && (body == i || !self.is_movable(i)) {
                    let version = &self.continuous.version;
                    events.push(Event {
                        time: constraint.ends_at,
                        bodies: (i, j),
                        versions: (version[i], version[j]),
                        kind: EventKind::ContactEnd,
                        outcome: Outcome::Rest,
                        load_speed: 0.0,
                        gap: 0.0,
                        contact: crate::collide::Contact {
                            time: 0.0,
                            point: constraint.point,
                            normal: constraint.normal,
                            feature: None,
                            face: None,
                        },
                    });
                }
            }
        }
    }
}

/// The bodies of some constraints, once each, in order, and the constraints between their places.
pub(super) struct Places {
    pub(super) bodies: Vec<usize>,
    pub(super) joined: Vec<Joined>,
    pub(super) inverse_mass: Vec<f64>,
}

impl Places {
    fn of(world: &World, constraints: &[usize]) -> Places {
        let all = world.contacts.all();
        let pairs = constraints.iter().map(|&index| &all[index]);
        Places::between(world, pairs.map(|c| (c.bodies, c.normal)))
    }

    pub(super) fn between(
        world: &World,
        contacts: impl Iterator<Item = ((usize, usize), DVec3)> + Clone,
    ) -> Places {
        let both = contacts.clone().flat_map(|((i, j), _)| [i, j]);
        let mut bodies: Vec<usize> = both.collect();
        bodies.sort_unstable();
        bodies.dedup();
        let place = |body: usize| bodies.partition_point(|&other| other < body);
        let joined = contacts
            .map(|((i, j), normal)| Joined {
                bodies: (place(i), place(j)),
                normal,
            })
            .collect();
        let inverse_mass = bodies.iter().map(|&body| 1.0 / world.mass[body]).collect();
        Places {
            bodies,
            joined,
            inverse_mass,
        }
    }

    pub(super) fn each(&self, of: impl Fn(usize) -> DVec3) -> Vec<DVec3> {
        self.bodies.iter().map(|&body| of(body)).collect()
    }

    /// Writes the values of bodies that may move.
    pub(super) fn put(&self, values: &[DVec3], to: &mut [DVec3], inverse_mass: &[f64]) {
        for ((&body, &value), &inverse) in self.bodies.iter().zip(values).zip(inverse_mass) {
            if inverse > 0.0 {
                to[body] = value;
            }
        }
    }
}
