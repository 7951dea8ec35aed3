//! The solution of the contact constraints of an island.
//!
//! An *island* is a set of movable bodies connected by contacts. First the solver replaces the velocities of the
//! island by the nearest ones, in the norm of kinetic energy, with which no contact closes faster than its target
//! allows. Then it replaces the accelerations by the nearest ones (Gauss' principle) with which no contact that has
//! reached its target is accelerated against its normal by more than its surface recedes. Neither step adds energy:
//! the impulses and forces of contacts are orthogonal to the motion that the contacts keep.

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

use super::super::{Bundled, scene::Scene, stepping::Cause};
use super::{
    candidates::Neighbours,
    contact_motion::LEAST_GAP,
    contact_set::{ContactConstraint, ContactSet},
    friction::Friction,
    island::{Island, Places, Visited},
    tallies::Tallies,
    trajectory::Trajectories,
    turning_rest::TurningRest,
    view::View,
};

/// Fraction of the speed that forces give in a step. Bodies that come to rest on each other with less than this speed
/// were at rest before, and no impact is reported.
pub(super) const SLIGHTEST: f64 = 1e-6;

/// The solution of an island, by its constraints and by the places of its bodies.
pub(super) struct Solution {
    /// Whether the island is a heap.
    pub(super) is_bundled: bool,
    /// Whether each contact opens, so that it constrains nothing any more.
    pub(super) open: Vec<bool>,
    /// The acceleration with which each contact may close, m/s².
    pub(super) recession: Vec<f64>,
    /// The accelerations by forces alone, m/s²; `acceleration` are those with contacts.
    pub(super) free: Vec<DVec3>,
    pub(super) acceleration: Vec<DVec3>,
    /// The normal force of each contact, N.
    pub(super) force: Vec<f64>,
    pub(super) friction: Friction,
}

/// The time at which islands are solved, s from the step's start, the bodies whose trajectories start again at that
/// time, and the bodies whose islands are solved already.
struct Now<'a> {
    time: f64,
    restarted: &'a mut Vec<usize>,
    visited: Visited,
}

impl View<'_> {
    /// A speed that changes no gap of an island in a step by more than a small part of the smallest gap of contacts,
    /// m/s.
    pub(super) fn unseen_speed(&self, island: &Island) -> f64 {
        let all = self.contacts.all();
        let hover = |&index: &usize| {
            self.layout()
                .hover_gap(all[index].bodies.0, all[index].bodies.1)
        };
        let least = island
            .constraints
            .iter()
            .map(hover)
            .fold(f64::INFINITY, f64::min);
        0.0625 * LEAST_GAP * least / self.scene.settings.dt
    }
}

/// Contacts, and the trajectories that they change.
pub(super) struct ContactSolver<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) paths: &'a mut Trajectories,
    pub(super) contacts: &'a mut ContactSet,
    pub(super) tallies: &'a mut Tallies,
    pub(super) asleep: &'a mut Vec<bool>,
    pub(super) held: &'a [(usize, usize)],
    pub(super) near: &'a mut Neighbours,
    pub(super) visited: &'a mut Visited,
    pub(super) bundled: &'a mut Bundled,
    pub(super) turning: &'a mut TurningRest,
}

impl ContactSolver<'_> {
    #[inline]
    pub(super) fn view(&self) -> View<'_> {
        View {
            scene: self.scene,
            paths: self.paths,
            contacts: self.contacts,
            tallies: self.tallies,
            asleep: self.asleep,
            held: self.held,
        }
    }

    /// Adds a contact. It replaces a contact of the same bodies along the same normal.
    pub(super) fn add_contact(&mut self, new: ContactConstraint) {
        self.contacts.insert(new, self.scene.bodies);
    }

    /// Steps the bodies whose trajectories have started again, in order, to the end of the step.
    pub(super) fn finish_restarted(&mut self, restarted: &[usize]) -> Result<(), (usize, Cause)> {
        self.paths
            .finish_restarted(self.scene, self.contacts, restarted)
    }

    /// Solves the islands of `seeds` at `time`, and adds the bodies whose trajectories start again to `restarted`.
    pub(super) fn solve_islands_of(
        &mut self,
        seeds: &[usize],
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        let mut visited = mem::take(self.visited);
        visited.begin(self.scene.bodies.len());
        let mut now = Now {
            time,
            restarted,
            visited,
        };
        let mut outcome = Ok(());
        for seed in self.scene.in_order(seeds.iter().copied()).bodies {
            if let Some(island) = self.view().island_of(seed, &mut now.visited)
                && !island.constraints.is_empty()
            {
                outcome = self.solve_island(&island, &mut now);
                if outcome.is_err() {
                    break;
                }
            }
        }
        *self.visited = now.visited;
        outcome
    }

    fn solve_island(&mut self, island: &Island, now: &mut Now) -> Result<(), (usize, Cause)> {
        self.start_island(island, now)?;
        match self.remeasure(island, now.time)? {
            true => self.solve_again(island, now, true),
            false => self.solve_measured(island, now, true),
        }
    }

    /// Starts the trajectories of the bodies of an island again at the current time, and those of the immovable
    /// bodies that the island touches.
    fn start_island(&mut self, island: &Island, now: &mut Now) -> Result<(), (usize, Cause)> {
        for &body in &island.bodies {
            now.visited.visit(body);
            self.wake(body);
            self.restart(body, now.time, now.restarted)?;
        }
        for &index in &island.constraints {
            let (i, j) = self.contacts.all()[index].bodies;
            for body in [i, j] {
                if !self.scene.bodies.is_movable(body) {
                    self.paths.restart_at(self.scene, body, now.time)?;
                }
            }
        }
        Ok(())
    }

    /// Solves an island whose contacts have changed. It may now consist of several islands, or be part of a larger
    /// one.
    fn solve_again(
        &mut self,
        island: &Island,
        now: &mut Now,
        hands_over: bool,
    ) -> Result<(), (usize, Cause)> {
        let mut again = Visited::default();
        again.begin(self.scene.bodies.len());
        for &body in &island.bodies {
            if let Some(island) = self.view().island_of(body, &mut again) {
                self.start_island(&island, now)?;
                self.solve_measured(&island, now, hands_over)?;
            }
        }
        Ok(())
    }

    /// Measures contacts again whose normals turn or whose surfaces have ended by `time`, at the positions of the
    /// bodies at that time. Returns whether some of them no longer exist.
    fn remeasure(&mut self, island: &Island, time: f64) -> Result<bool, (usize, Cause)> {
        let mut gone: Vec<usize> = Vec::new();
        if time == 0.0 {
            return Ok(false);
        }
        for &index in &island.constraints {
            let constraint = self.contacts.all()[index];
            if constraint.is_turning || constraint.ends_at <= time {
                match self
                    .view()
                    .measured(constraint, self.scene.settings.dt - time)
                {
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

    /// Solves an island whose bodies are at the start of their trajectories, and whose contacts are measured.
    fn solve_measured(
        &mut self,
        island: &Island,
        now: &mut Now,
        hands_over: bool,
    ) -> Result<(), (usize, Cause)> {
        let time = now.time;
        let is_bundled = self.spread_bundle(island);
        let places = Places::of(self.view(), island);
        let mut solution = self.solve_velocities(island, &places, is_bundled, time)?;
        self.solve_accelerations(island, &places, &mut solution, time);
        let gone = (0..island.constraints.len())
            .filter(|&k| solution.open[k])
            .map(|k| island.constraints[k]);
        let ended = self.contacts.remove_all(gone.collect());
        // If another body now supports what the ended contacts supported, the island has new contacts.
        match hands_over && self.hand_over_all(&ended)? {
            true => self.solve_again(island, now, false),
            false => Ok(()),
        }
    }

    /// For methods with a velocity stagger: gives bodies in contact the velocities that the method keeps. Contacts
    /// are judged by these at the start of a step.
    pub(super) fn unstagger_velocities(&mut self) {
        if self.paths.velocity_stagger != 0.0 {
            for constraint in self.contacts.all() {
                for body in [constraint.bodies.0, constraint.bodies.1] {
                    self.paths.start.velocity[body] = self.scene.before.velocity[body];
                }
            }
        }
    }

    /// Staggers the velocities of bodies again, by their accelerations in contact.
    pub(super) fn stagger_velocities(&mut self, bodies: &[usize]) {
        let paths = &mut *self.paths;
        if paths.velocity_stagger != 0.0 {
            for &body in bodies {
                let by = paths.velocity_stagger * paths.acceleration[body];
                paths.start.velocity[body] += by;
            }
        }
    }
}
