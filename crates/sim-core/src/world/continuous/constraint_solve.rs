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
use super::contact_motion::{Course, LEAST_GAP};
use super::friction::Friction;
use super::{Event, EventKind, Outcome};
use crate::impulse::{Joined, Known, apply, greatest, project_with};

/// Part of the speed that forces give in a step below which bodies that come to rest on each other
/// have rested before, and it is no impact.
pub(super) const SLIGHTEST: f64 = 1e-6;

/// An island whose bodies are slower than this part of what forces give them in a step, and that has
/// nothing to accelerate it, is at rest.
const AT_REST: f64 = 1e-6;

/// Part of the accelerations of an island that may be left over where it has none.
const UNBALANCED: f64 = 1e-9;

/// The same where friction holds with all that it has: what rounding makes of it.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Part of the greatest speed at which a contact may still close where its island is solved.
const UNSOLVED: f64 = 1e-6;

/// Bodies and constraints that contacts tie together.
#[derive(Clone, Debug, Default)]
pub(super) struct Island {
    /// The bodies that may move.
    pub(super) bodies: Vec<usize>,
    /// Indices of the constraints.
    pub(super) constraints: Vec<usize>,
}

/// What an island does, by its constraints and the places of its bodies.
pub(super) struct Solution {
    /// Whether it is that of a heap.
    pub(super) is_bundled: bool,
    /// Which contacts part, and keep nothing.
    pub(super) open: Vec<bool>,
    /// Acceleration by which each may close, m/s².
    pub(super) recession: Vec<f64>,
    /// Accelerations by forces alone, and with contacts, m/s².
    pub(super) free: Vec<DVec3>,
    pub(super) acceleration: Vec<DVec3>,
    /// Of each contact, N.
    pub(super) force: Vec<f64>,
    pub(super) friction: Friction,
}

/// Who has been visited in a search for islands.
#[derive(Clone, Debug, Default)]
pub(super) struct Visited {
    round: u32,
    body: Vec<u32>,
}

/// When islands are solved, whose trajectories have started again there, and who has been solved.
struct Now<'a> {
    time: f64,
    restarted: &'a mut Vec<usize>,
    visited: Visited,
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

    /// Whether a body has been visited.
    pub(super) fn has(&self, body: usize) -> bool {
        self.body[body] == self.round
    }

    /// Visits a body, and tells whether it is new.
    pub(super) fn visit(&mut self, body: usize) -> bool {
        mem::replace(&mut self.body[body], self.round) != self.round
    }
}

impl World {
    /// The island of a body, unless it has been visited.
    pub(super) fn island_of(&self, seed: usize, visited: &mut Visited) -> Option<Island> {
        let mut island = self.island_around(seed, visited)?;
        if island.bodies.len() + island.constraints.len() > 2 {
            self.sort(&mut island);
        }
        Some(island)
    }

    /// The same in no order.
    pub(super) fn island_around(&self, seed: usize, visited: &mut Visited) -> Option<Island> {
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
        Some(island)
    }

    /// Puts an island into an order that is not that of the places of bodies: sums over it round.
    fn sort(&self, island: &mut Island) {
        let all = self.contacts.all();
        let pairs = island.constraints.iter().map(|&index| all[index].bodies);
        let order = self.in_order(pairs);
        let bodies = order.bodies.iter().copied();
        island.bodies = bodies.filter(|&body| self.is_movable(body)).collect();
        island.constraints.sort_by_cached_key(|&index| {
            let contact = &all[index];
            (order.between(contact.bodies, contact.normal), index)
        });
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
        let mut now = Now {
            time,
            restarted,
            visited,
        };
        let mut outcome = Ok(());
        for seed in self.in_order(seeds.iter().map(|&body| (body, body))).bodies {
            if let Some(island) = self.island_of(seed, &mut now.visited)
                && !island.constraints.is_empty()
            {
                outcome = self.solve_island(&island, &mut now);
                if outcome.is_err() {
                    break;
                }
            }
        }
        self.continuous.visited = now.visited;
        outcome
    }

    fn solve_island(&mut self, island: &Island, now: &mut Now) -> Result<(), (usize, Cause)> {
        self.start_island(island, now)?;
        match self.remeasure(island, now.time)? {
            true => self.solve_again(island, now, true),
            false => self.solve_measured(island, now, true),
        }
    }

    /// Lets the trajectories of the bodies of an island start at a time, and those of immovable ones that it
    /// touches.
    fn start_island(&mut self, island: &Island, now: &mut Now) -> Result<(), (usize, Cause)> {
        for &body in &island.bodies {
            now.visited.visit(body);
            self.wake(body);
            self.restart(body, now.time, now.restarted)?;
        }
        for &index in &island.constraints {
            let (i, j) = self.contacts.all()[index].bodies;
            for body in [i, j] {
                if !self.is_movable(body) {
                    self.restart_at(body, now.time)?;
                }
            }
        }
        Ok(())
    }

    /// Solves an island whose contacts have changed: it may be several now, or a part of a larger one.
    fn solve_again(
        &mut self,
        island: &Island,
        now: &mut Now,
        hands_over: bool,
    ) -> Result<(), (usize, Cause)> {
        let mut again = Visited::default();
        again.begin(self.len());
        for &body in &island.bodies {
            if let Some(island) = self.island_of(body, &mut again) {
                self.start_island(&island, now)?;
                self.solve_measured(&island, now, hands_over)?;
            }
        }
        Ok(())
    }

    /// Looks again at contacts whose normals turn, where bodies are at a time, and tells whether some
    /// are no more.
    fn remeasure(&mut self, island: &Island, time: f64) -> Result<bool, (usize, Cause)> {
        let mut gone: Vec<usize> = Vec::new();
        if time == 0.0 {
            return Ok(false);
        }
        for &index in &island.constraints {
            let constraint = self.contacts.all()[index];
            if constraint.is_turning || constraint.ends_at <= time {
                match self.measured(constraint, self.settings.dt - time) {
                    Some(mut measured) => {
                        measured.sticks |= constraint.ends_at <= time;
                        *self.contacts.get_mut(index) = measured;
                    }
                    None => gone.push(index),
                }
            }
        }
        let is_gone = !gone.is_empty();
        let ended = self.contacts.remove_all(gone);
        self.hand_over_all(&ended)?;
        Ok(is_gone)
    }

    /// Solves an island whose bodies are at the start of their trajectories.
    fn solve_measured(
        &mut self,
        island: &Island,
        now: &mut Now,
        hands_over: bool,
    ) -> Result<(), (usize, Cause)> {
        let time = now.time;
        let is_bundled = self.spread_bundle(island);
        let places = Places::of(self, &island.constraints);
        let mut solution = self.solve_velocities(island, &places, is_bundled, time)?;
        self.solve_accelerations(island, &places, &mut solution, time);
        let gone = (0..island.constraints.len())
            .filter(|&k| solution.open[k])
            .map(|k| island.constraints[k]);
        let ended = self.contacts.remove_all(gone.collect());
        // What has been borne by one body is borne by another one now.
        match hands_over && self.hand_over_all(&ended)? {
            true => self.solve_again(island, now, false),
            false => Ok(()),
        }
    }

    /// Gives the bodies of an island velocities with which no contact closes faster than its target, nor
    /// parts for less than the shortest flight.
    fn solve_velocities(
        &mut self,
        island: &Island,
        places: &Places,
        is_bundled: bool,
        time: f64,
    ) -> Result<Solution, (usize, Cause)> {
        let left = self.settings.dt - time;
        for &body in &island.bodies {
            let continuous = &mut self.continuous;
            continuous.acceleration[body] = continuous.applied_acceleration[body];
        }
        let free = places.each(|body| self.acceleration_there(body));
        let mut velocity = places.each(|body| self.continuous.start.velocity[body]);
        let fastest = greatest(&velocity);
        let rounding = 4.0 * f64::EPSILON * fastest;
        let count = island.constraints.len();
        let constraint = |k: usize| &self.contacts.all()[island.constraints[k]];
        let hop: Vec<f64> = (0..count)
            .map(|k| 0.5 * self.shortest_flight(is_bundled) * constraint(k).load_speed)
            .collect();
        // Slower than this a gap grows by less than that of contacts in a step, or than a hop counts.
        let still = |k: usize| {
            let (i, j) = constraint(k).bodies;
            let hover = self.hover_gap(i, j) / self.settings.dt;
            hover.max(4.0 * rounding).max(SLIGHTEST * hop[k])
        };
        let still: Vec<f64> = (0..count).map(still).collect();
        // In a heap, what forces press does not part. That takes energy and gives none, as standing still is
        // among what is allowed.
        let is_held =
            |k: usize| is_bundled && constraint(k).target >= 0.0 && constraint(k).load_speed > 0.0;
        let held: Vec<bool> = (0..count).map(is_held).collect();
        let before = velocity.clone();
        let (mut given, target) =
            self.stop_closing(island, places, &mut velocity, (&held, &still, rounding));
        let mut spent = None;
        if self.is_rough() {
            let bundled = is_bundled.then_some(left);
            let checks = (rounding, &target[..]);
            let rubbed = self.rub(island, places, &mut velocity, &mut given, checks, bundled);
            let Some(rubbed) = rubbed else {
                return self.bundle_and_solve(island, places, time);
            };
            spent = bundled.map(|left| rubbed.into_iter().map(|rubbed| rubbed / left).collect());
        }
        // Where normals turn a velocity is along the surface but for what steps round off.
        let turned: Vec<f64> = (0..count)
            .map(|k| match constraint(k).is_turning {
                true => hop[k],
                false => 0.0,
            })
            .collect();
        let parting: Vec<f64> = (0..count)
            .map(|k| places.joined[k].opening(&velocity) - target[k])
            .collect();
        let open: Vec<bool> = (0..count)
            .map(|k| !is_bundled && parting[k] > still[k].max(turned[k]))
            .collect();
        // What is left of a speed at which it parts turns back by the end of the step.
        let recession = |k: usize| match parting[k] > 4.0 * rounding {
            true => 2.0 * parting[k] / left,
            false => 0.0,
        };
        let recession: Vec<f64> = (0..count).map(recession).collect();
        let mut solution = Solution {
            is_bundled,
            open,
            recession,
            free,
            acceleration: Vec::new(),
            force: Vec::new(),
            friction: Friction::default(),
        };
        if self.is_rough() {
            solution.friction = self.friction_of(island, places, &velocity, spent, time);
        }
        if !self.constrain(island, places, &mut solution) && !is_bundled {
            return self.bundle_and_solve(island, places, time);
        }
        if let Some(k) = (0..count).find(|&k| parting[k] < -(still[k] + UNSOLVED * fastest))
            && let Some(crushed) = self.crushed(island, constraint(k).bodies)
        {
            return Err(crushed);
        }
        let bundled = is_bundled
            .then(|| self.cost_of_bundling(places, (&before, &velocity), &target, &given, left));
        let is_busy = is_bundled
            && (0..count)
                .any(|k| held[k] || target[k] < 0.0 && (given[k] > 0.0 || solution.force[k] > 0.0));
        places.put(
            &velocity,
            &mut self.continuous.start.velocity,
            &places.inverse_mass,
        );
        for (k, &index) in island.constraints.iter().enumerate() {
            let constraint = self.contacts.get_mut(index);
            constraint.impulse = given[k];
            constraint.target = target[k];
            constraint.is_turning = false;
            constraint.ends_at = f64::INFINITY;
        }
        if let Some((energy, distance)) = bundled {
            self.bundled.energy += energy;
            self.bundled.distance = self.bundled.distance.max(distance);
        }
        if is_busy {
            self.contacts.keep_bundled(&island.bodies);
        }
        Ok(solution)
    }

    /// Solves an island as a heap, as its friction is not found otherwise.
    fn bundle_and_solve(
        &mut self,
        island: &Island,
        places: &Places,
        time: f64,
    ) -> Result<Solution, (usize, Cause)> {
        self.contacts.bundle(&island.bodies);
        self.contacts.keep_bundled(&island.bodies);
        self.solve_velocities(island, places, true, time)
    }

    /// Stops contacts from closing faster than their targets, and those that are held from parting. Returns
    /// the impulse of each, N s, and its target, which is lowered to none where gaps cannot be widened.
    fn stop_closing(
        &self,
        island: &Island,
        places: &Places,
        velocity: &mut [DVec3],
        (held, still, rounding): (&[bool], &[f64], f64),
    ) -> (Vec<f64>, Vec<f64>) {
        let (joined, inverse_mass) = (&places.joined, &places.inverse_mass);
        let constraint = |k: usize| &self.contacts.all()[island.constraints[k]];
        let count = joined.len();
        let enough = self.unseen_speed(island);
        let before = velocity.to_vec();
        let mut target: Vec<f64> = (0..count).map(|k| constraint(k).target).collect();
        let mut given = alloc::vec![0.0; count];
        loop {
            let missing = |velocity: &[DVec3], k: usize| target[k] - joined[k].opening(velocity);
            let closing: Vec<f64> = (0..count).map(|k| missing(velocity, k)).collect();
            let is_due = |k: usize| closing[k] > rounding || held[k] && closing[k] < -still[k];
            if (0..count).any(is_due) {
                let known = Known {
                    held,
                    warm: &given,
                    enough,
                };
                given = project_with(joined, inverse_mass, velocity, &closing, known);
            } else {
                given.fill(0.0);
            }
            // A gap is widened where there is room for it, and where it takes no more than forces give back
            // that press it together.
            let widened: Vec<usize> = (0..count).filter(|&k| target[k] > 0.0).collect();
            let most = (4.0 * enough).max(4.0 * rounding);
            let is_met = (0..count).all(|k| missing(velocity, k) <= most);
            let taken = |&k: &usize| target[k] * given[k];
            let pressed = |&k: &usize| target[k] * constraint(k).load_speed / places.yielding(k);
            let is_light = widened.iter().map(taken).sum::<f64>()
                <= 4.0 * widened.iter().map(pressed).sum::<f64>();
            if widened.is_empty() || is_met && is_light {
                return (given, target);
            }
            velocity.copy_from_slice(&before);
            for k in widened {
                target[k] = 0.0;
            }
        }
    }

    /// The kinetic energy that contacts have taken from bundled bodies, J, and how far ahead of their time
    /// gaps are closed or what height flights would have had, m.
    fn cost_of_bundling(
        &self,
        places: &Places,
        (before, after): (&[DVec3], &[DVec3]),
        target: &[f64],
        given: &[f64],
        left: f64,
    ) -> (f64, f64) {
        let masses = places.bodies.iter().map(|&body| self.mass[body]);
        let lost =
            masses
                .zip(before.iter().zip(after))
                .map(|(mass, (v, u))| match mass.is_finite() {
                    true => 0.5 * mass * (v.length_squared() - u.length_squared()),
                    false => 0.0,
                });
        let distance = |k: usize| match (target[k] < 0.0, given[k]) {
            (true, pushed) if pushed > 0.0 => -target[k] * left,
            // Up and down again within the time: a quarter of what its speed would make of it.
            (false, pulled) if pulled < 0.0 => {
                0.25 * left * places.joined[k].opening(before).max(0.0)
            }
            _ => 0.0,
        };
        let farthest = (0..given.len()).map(distance).fold(0.0, f64::max);
        (lost.sum::<f64>().max(0.0), farthest)
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
        solution: &mut Solution,
        time: f64,
    ) {
        let Solution {
            free,
            acceleration,
            force,
            friction,
            ..
        } = &*solution;
        if self.balance(island, places, free, acceleration, (force, friction), time) {
            self.note_forces(island, places, solution, time);
            return;
        }
        // Where events come thick, surfaces count as flat for the rest of the step: nothing meets, and what
        // opens closes in the next one.
        if !solution.is_bundled && self.follow_surfaces(island, places, solution, time) {
            self.constrain(island, places, solution);
        }
        self.note_forces(island, places, solution, time);
        for (place, &body) in places.bodies.iter().enumerate() {
            if self.is_movable(body) {
                let by = solution.acceleration[place] - solution.free[place];
                self.continuous.acceleration[body] =
                    self.continuous.applied_acceleration[body] + by;
            }
        }
    }

    /// Looks where the surfaces of contacts turn or end, along the motion that they allow, and tells
    /// whether that changes what they allow.
    fn follow_surfaces(
        &mut self,
        island: &Island,
        places: &Places,
        solution: &mut Solution,
        time: f64,
    ) -> bool {
        let mut turns = false;
        let length = self.settings.dt - time;
        for k in 0..island.constraints.len() {
            let index = island.constraints[k];
            let constraint = self.contacts.all()[index];
            if solution.open[k] || constraint.is_overlap || length <= 0.0 {
                continue;
            }
            let (i, j) = constraint.bodies;
            let start = &self.continuous.start;
            let (a, b) = places.joined[k].bodies;
            let stagger = match time == 0.0 {
                true => self.continuous.velocity_stagger,
                false => 0.0,
            };
            let pushed = solution.acceleration[b] - solution.acceleration[a];
            let motion = (
                start.position[j] - start.position[i],
                start.velocity[j] - start.velocity[i] + stagger * pushed,
                pushed,
            );
            // What would press them together without this contact.
            let load = solution.force[k] * places.yielding(k);
            if load <= 0.0 {
                continue;
            }
            match self.course_below(&constraint, motion, (length, time == 0.0), load) {
                Course::Flat => {}
                Course::Receding(recession) => {
                    solution.recession[k] += recession;
                    self.contacts.get_mut(index).is_turning = true;
                    turns = true;
                }
                Course::EndsAfter(after) => {
                    self.contacts.get_mut(index).ends_at = time + after;
                }
                Course::Ended => {
                    solution.open[k] = true;
                    turns = true;
                }
            }
        }
        turns
    }

    /// A speed that changes no gap of an island in a step by more than a small part of the least one, m/s.
    pub(super) fn unseen_speed(&self, island: &Island) -> f64 {
        let all = self.contacts.all();
        let hover = |&index: &usize| self.hover_gap(all[index].bodies.0, all[index].bodies.1);
        let least = island
            .constraints
            .iter()
            .map(hover)
            .fold(f64::INFINITY, f64::min);
        0.0625 * LEAST_GAP * least / self.settings.dt
    }

    /// The accelerations nearest to free ones with which no contact that is not open closes more than
    /// its surface recedes, and the force of each contact; and whether they have been found.
    fn constrain(&self, island: &Island, places: &Places, solution: &mut Solution) -> bool {
        if !solution.friction.is_empty() {
            return self.press_and_drag(island, places, solution);
        }
        self.press(island, places, solution);
        true
    }

    /// The same where friction does what it does.
    pub(super) fn press(&self, island: &Island, places: &Places, solution: &mut Solution) {
        let Solution {
            open,
            recession,
            free,
            ..
        } = solution;
        let mut acceleration = free.clone();
        let friction = &solution.friction;
        for (joined, &dragged) in places.joined.iter().zip(&friction.force) {
            apply(joined, &places.inverse_mass, &mut acceleration, dragged);
        }
        let free = acceleration.clone();
        let kept: Vec<usize> = (0..open.len()).filter(|&k| !open[k]).collect();
        let joined: Vec<Joined> = kept.iter().map(|&k| places.joined[k]).collect();
        let missing = |&k: &usize| -recession[k] - places.joined[k].opening(&free);
        let missing: Vec<f64> = kept.iter().map(missing).collect();
        // What they did before is near.
        let before = |&k: &usize| {
            let load = self.contacts.all()[island.constraints[k]].load_speed / self.settings.dt;
            let known = solution.force.get(k).copied();
            known.unwrap_or(load.max(0.0) / places.yielding(k))
        };
        let warm: Vec<f64> = kept.iter().map(before).collect();
        let inverse_mass = &places.inverse_mass;
        let known = Known {
            held: &[],
            warm: &warm,
            enough: self.unseen_speed(island) / self.settings.dt,
        };
        let given = project_with(&joined, inverse_mass, &mut acceleration, &missing, known);
        let mut force = alloc::vec![0.0; open.len()];
        for (k, given) in kept.into_iter().zip(given) {
            force[k] = given;
        }
        (solution.acceleration, solution.force) = (acceleration, force);
    }

    /// Notes by what speed each contact would close in a step if it were not there, its friction, and when
    /// it stops sliding.
    fn note_forces(&mut self, island: &Island, places: &Places, solution: &Solution, time: f64) {
        let dt = self.settings.dt;
        let friction = &solution.friction;
        for (k, &index) in island.constraints.iter().enumerate() {
            let constraint = self.contacts.get_mut(index);
            constraint.load_speed = dt * solution.force[k] * places.yielding(k);
            if !friction.is_empty() {
                constraint.friction = friction.force[k];
                constraint.sticks = !friction.slides(k, solution.force[k]);
                constraint.ends_at = constraint.ends_at.min(time + friction.ends_after[k]);
            }
        }
    }

    /// Brings an island to rest that hardly moves and that nothing accelerates, and tells whether it has.
    fn balance(
        &mut self,
        island: &Island,
        places: &Places,
        free: &[DVec3],
        acceleration: &[DVec3],
        (force, friction): (&[f64], &Friction),
        time: f64,
    ) -> bool {
        let push = greatest(free);
        let is_still = |v: DVec3| v.length() <= AT_REST * push * self.settings.dt;
        // What friction hardly fails to hold is accelerated by little.
        let unbalanced = match (0..force.len()).any(|k| friction.slides(k, force[k])) {
            true => ROUNDING,
            false => UNBALANCED,
        };
        let at_rest =
            time == 0.0
                && places.bodies.iter().enumerate().all(|(place, &body)| {
                    match self.is_movable(body) {
                        false => self.previous.velocity[body] == DVec3::ZERO,
                        true => {
                            is_still(self.continuous.start.velocity[body])
                                && acceleration[place].length() <= unbalanced * push
                                && self.coupled_group(body).is_none()
                        }
                    }
                })
                && island
                    .constraints
                    .iter()
                    .zip(force)
                    .all(|(&index, &force)| {
                        let constraint = &self.contacts.all()[index];
                        constraint.target == 0.0 || force <= 0.0
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
            if self.bounces(((i, j), constraint.normal), closing, constraint.load_speed) {
                match constraint.is_overlap {
                    true => self.exchange_there(&self.event_of(&constraint, 0.0), 0.0),
                    false => self.contacts.remove(index),
                }
            }
        }
    }

    /// Queues the events at which contacts of some bodies end.
    pub(super) fn queue_contact_ends(&mut self, bodies: &[usize]) {
        let mut events = mem::take(&mut self.continuous.events);
        for &body in bodies {
            for &index in self.contacts.of_body(body) {
                let constraint = &self.contacts.all()[index as usize];
                let i = constraint.bodies.0;
                if constraint.ends_at < self.settings.dt && (body == i || !self.is_movable(i)) {
                    events.push(Event {
                        kind: EventKind::ContactEnd,
                        outcome: Outcome::Rest,
                        ..self.event_of(constraint, constraint.ends_at)
                    });
                }
            }
        }
        self.continuous.events = events;
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
        let order = world.in_order(contacts.clone().map(|(bodies, _)| bodies));
        let joined = contacts
            .map(|((i, j), normal)| Joined {
                bodies: (order.place(i), order.place(j)),
                normal,
            })
            .collect();
        let bodies = order.bodies;
        let inverse_mass = bodies.iter().map(|&body| 1.0 / world.mass[body]).collect();
        Places {
            bodies,
            joined,
            inverse_mass,
        }
    }

    /// What an impulse on a contact opens it by, 1/kg.
    pub(super) fn yielding(&self, k: usize) -> f64 {
        let (i, j) = self.joined[k].bodies;
        self.inverse_mass[i] + self.inverse_mass[j]
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
