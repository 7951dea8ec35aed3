//! The velocities of an island: the nearest ones, in the norm of kinetic energy, with which no contact closes faster
//! than its target allows.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::stepping::Cause;
use super::{
    friction::Friction,
    island::{Island, Places},
    solver::{ContactSolver, SLIGHTEST, Solution},
    view::View,
};
use crate::impulse::{Known, greatest, project_with};

/// Fraction of the greatest speed at which a contact of a solved island may still close.
const UNSOLVED: f64 = 1e-6;

impl ContactSolver<'_> {
    /// Gives the bodies of an island velocities with which no contact closes faster than its target allows. In a heap
    /// no contact that forces press together opens for less than the shortest flight.
    pub(super) fn solve_velocities(
        &mut self,
        island: &Island,
        places: &Places,
        is_bundled: bool,
        time: f64,
    ) -> Result<Solution, (usize, Cause)> {
        let left = self.scene.settings.dt - time;
        for &body in &island.bodies {
            let paths = &mut *self.paths;
            paths.acceleration[body] = paths.applied_acceleration[body];
        }
        let free = places.each(|body| self.view().motion().acceleration_there(body));
        let mut velocity = places.each(|body| self.paths.start.velocity[body]);
        let fastest = greatest(&velocity);
        let rounding = 4.0 * f64::EPSILON * fastest;
        let count = island.constraints.len();
        let constraint = |k: usize| &self.contacts.all()[island.constraints[k]];
        let hop = |k: usize| {
            let (view, load) = (self.view(), constraint(k).load_speed);
            let ((i, j), usual) = (constraint(k).bodies, view.shortest_flight(is_bundled));
            match view.are_steep(i, j) {
                true => {
                    view.shortest_hop((i, j), load / self.scene.settings.dt, is_bundled)
                        .1
                }
                false => 0.5 * usual * load,
            }
        };
        let hop: Vec<f64> = (0..count).map(hop).collect();
        // At a lower speed a gap grows in a step by less than the gap of bodies in contact, or the speed is
        // negligible beside that of the shortest hop.
        let still = |k: usize| {
            let (i, j) = constraint(k).bodies;
            let hover = self.view().layout().hover_gap(i, j) / self.scene.settings.dt;
            hover.max(4.0 * rounding).max(SLIGHTEST * hop[k])
        };
        let still: Vec<f64> = (0..count).map(still).collect();
        // In a heap, a contact that forces press together is held: it does not open, unless its speed is more than
        // forces reverse in a step. This takes energy and gives none, because standing still is one of the allowed
        // motions.
        let is_held =
            |k: usize| is_bundled && constraint(k).target >= 0.0 && constraint(k).load_speed > 0.0;
        let mut held: Vec<bool> = (0..count).map(is_held).collect();
        let before = velocity.clone();
        let limits = (&hop[..], &still[..], rounding);
        let (mut given, target) =
            self.view()
                .stop_closing(island, places, &mut velocity, &mut held, limits);
        let mut spent = None;
        if self.scene.bodies.is_rough() {
            let bundled = is_bundled.then_some(left);
            let checks = (rounding, &target[..]);
            let rubbed =
                self.view()
                    .rub(island, places, &mut velocity, &mut given, checks, bundled);
            let Some(rubbed) = rubbed else {
                return self.bundle_and_solve(island, places, time);
            };
            spent = bundled.map(|left| rubbed.into_iter().map(|rubbed| rubbed / left).collect());
        }
        // If the normal of a contact turns, the velocity is along the surface only up to the discretisation by steps.
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
        // The remaining opening speed reverses by the end of the step.
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
        if self.scene.bodies.is_rough() {
            solution.friction = self
                .view()
                .friction_of(island, places, &velocity, spent, time);
        }
        if !self.view().constrain(island, places, &mut solution) && !is_bundled {
            return self.bundle_and_solve(island, places, time);
        }
        if let Some(k) = (0..count).find(|&k| parting[k] < -(still[k] + UNSOLVED * fastest))
            && let Some(crushed) = self.view().crushed(island, constraint(k).bodies)
        {
            return Err(crushed);
        }
        let bundled = is_bundled.then(|| {
            self.view()
                .cost_of_bundling(places, (&before, &velocity), &target, &given, left)
        });
        let is_busy = is_bundled
            && (0..count)
                .any(|k| held[k] || target[k] < 0.0 && (given[k] > 0.0 || solution.force[k] > 0.0));
        places.put(
            &velocity,
            &mut self.paths.start.velocity,
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

    /// Solves an island as a heap, because its friction was not found otherwise.
    pub(super) fn bundle_and_solve(
        &mut self,
        island: &Island,
        places: &Places,
        time: f64,
    ) -> Result<Solution, (usize, Cause)> {
        self.contacts.bundle(&island.bodies);
        self.contacts.keep_bundled(&island.bodies);
        self.solve_velocities(island, places, true, time)
    }
}

impl View<'_> {
    /// Stops contacts from closing faster than their targets, and held contacts from opening. Returns the impulse of
    /// each contact, N s, and its target, which is lowered to zero if gaps cannot be widened.
    fn stop_closing(
        &self,
        island: &Island,
        places: &Places,
        velocity: &mut [DVec3],
        held: &mut [bool],
        (hop, still, rounding): (&[f64], &[f64], f64),
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
                    prepared: Some(&places.prepared),
                };
                given = project_with(joined, inverse_mass, velocity, &closing, known);
                let leaving = leaving(places, &before, (held, hop), (&target, &given), enough);
                if !leaving.is_empty() {
                    velocity.copy_from_slice(&before);
                    leaving.into_iter().for_each(|k| held[k] = false);
                    continue;
                }
            } else {
                given.fill(0.0);
            }
            // Gaps are widened only if there is room, and if this takes no more energy than four times what the
            // forces that press the contacts together give back.
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

    /// The kinetic energy that contacts have taken from bundled bodies, J. The second value is a length, m: the
    /// greatest distance by which a gap was closed too early, or the greatest height of a suppressed flight.
    fn cost_of_bundling(
        &self,
        places: &Places,
        (before, after): (&[DVec3], &[DVec3]),
        target: &[f64],
        given: &[f64],
        left: f64,
    ) -> (f64, f64) {
        let masses = places
            .bodies
            .iter()
            .map(|&body| self.scene.bodies.mass[body]);
        let lost =
            masses
                .zip(before.iter().zip(after))
                .map(|(mass, (v, u))| match mass.is_finite() {
                    true => 0.5 * mass * (v.length_squared() - u.length_squared()),
                    false => 0.0,
                });
        let distance = |k: usize| match (target[k] < 0.0, given[k]) {
            (true, pushed) if pushed > 0.0 => -target[k] * left,
            // The flight would go up and down within the time; its height is a quarter of time times speed.
            (false, pulled) if pulled < 0.0 => {
                0.25 * left * places.joined[k].opening(before).max(0.0)
            }
            _ => 0.0,
        };
        let farthest = (0..given.len()).map(distance).fold(0.0, f64::max);
        (lost.sum::<f64>().max(0.0), farthest)
    }

    /// The error that the bodies of a contact are crushed, if immovable bodies of the island move relative to each
    /// other.
    fn crushed(&self, island: &Island, (i, j): (usize, usize)) -> Option<(usize, Cause)> {
        let both = |&index: &usize| {
            let (i, j) = self.contacts.all()[index].bodies;
            [i, j]
        };
        let walls = island.constraints.iter().flat_map(both);
        let mut walls = walls.filter(|&body| !self.scene.bodies.is_movable(body));
        let first = walls.next()?;
        let velocity = &self.scene.before.velocity;
        let other = walls.find(|&wall| velocity[wall] != velocity[first])?;
        let body = if self.scene.bodies.is_movable(i) {
            i
        } else {
            j
        };
        Some((body, Cause::Squeezed((first.min(other), first.max(other)))))
    }
}

/// The held contacts that would open faster than a hop if no contact were held. Between surfaces whose normals differ
/// a little from one to the next, held contacts would stop everything that slides along them.
fn leaving(
    places: &Places,
    before: &[DVec3],
    (held, hop): (&[bool], &[f64]),
    (target, given): (&[f64], &[f64]),
    enough: f64,
) -> Vec<usize> {
    let joined = &places.joined;
    let pulls = |&k: &usize| held[k] && given[k] * places.yielding(k) < -hop[k];
    let mut leaving: Vec<usize> = (0..given.len()).filter(pulls).collect();
    if leaving.is_empty() {
        return leaving;
    }
    let mut free = before.to_vec();
    let missing = |k: usize| target[k] - joined[k].opening(before);
    let missing: Vec<f64> = (0..given.len()).map(missing).collect();
    let known = Known {
        enough,
        prepared: Some(&places.prepared),
        ..Known::default()
    };
    project_with(joined, &places.inverse_mass, &mut free, &missing, known);
    leaving.retain(|&k| joined[k].opening(&free) > hop[k]);
    leaving
}
