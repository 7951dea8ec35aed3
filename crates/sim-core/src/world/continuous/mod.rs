//! The continuous mode: impacts at their times of impact, and contacts that last.
//!
//! A step goes through these phases (`World::go_through_phases`):
//!
//! 1. [`trajectory`]: each body has a trajectory through the step, as its method computes it, or as far as contacts
//!    let the method be evaluated ([`horizon`]).
//! 2. [`initial_contacts`]: finds the contacts of bodies that have just been placed.
//! 3. [`contact_motion`]: measures the contacts left from the last step ([`contact_set`]). [`solver`]: gives the
//!    bodies of each [`island`] the velocities ([`velocity_solve`]) and accelerations ([`acceleration_solve`],
//!    [`friction`]) with which none of its contacts closes.
//! 4. [`candidates`]: finds the pairs whose swept boxes meet. [`impact_search`]: finds the next impact of each of
//!    these pairs, which waits in a queue ([`event`]). The end of each contact that a body leaves waits there too.
//! 5. [`event_loop`]: takes the earliest event with all simultaneous ones ([`resolve`]). [`outcome`]: the bodies
//!    separate ([`bounce`]), or stay in contact and their island is solved. New trajectories start, and their events
//!    are searched. [`hand_over`] and [`ledge`]: a sliding body moves on from one body to the next. [`progress`],
//!    [`crush`] and [`work`] stop a step that would not end.
//! 6. [`position_correction`]: an exact test ensures that no two bodies meet.
//!
//! [`turning_search`], [`turning_response`], [`turning_rest`]: the same for turning bodies, which are in no island.
//! They bounce with their lever arms, or stay in contact for the rest of the step under constant forces.
//!
//! [`held_overlaps`]: if bodies that were placed in overlap would get deeper, the whole step is taken again with the
//! two held.
//!
//! A step costs a box test for each pair that comes near, a search for each pair whose swept boxes meet, and about
//! two searches for each event.

mod acceleration_solve;
mod bounce;
mod candidates;
mod contact_motion;
mod contact_set;
mod crush;
mod event;
mod event_loop;
mod friction;
mod hand_over;
mod held_overlaps;
mod horizon;
mod impact_search;
mod initial_contacts;
mod island;
mod ledge;
mod levered;
mod outcome;
mod position_correction;
mod progress;
mod resolve;
mod sleep;
mod solver;
mod tallies;
#[cfg(test)]
mod tests;
mod trajectory;
mod turning_forces;
mod turning_response;
mod turning_rest;
mod turning_search;
mod velocity_solve;
mod view;
mod work;

use alloc::vec::Vec;
use core::mem;

use super::{Bundled, World, profile::Phase, scene::scene, stepping::Cause};
use candidates::Neighbours;
#[cfg(feature = "serde")]
pub(super) use contact_set::ContactConstraint;
pub(super) use contact_set::ContactSet;
use event::EventQueue;
use event_loop::EventLoop;
pub(super) use horizon::Horizons;
use island::Visited;
use position_correction::Correction;
use solver::ContactSolver;
use tallies::Tallies;
use trajectory::Trajectories;
use turning_rest::TurningRest;

/// The data of the continuous mode beside the state; empty if the mode was never used.
#[derive(Clone, Debug, Default)]
pub(super) struct Continuous {
    pub(super) paths: Trajectories,
    tallies: Tallies,
    /// By body, whether it is asleep: at rest until another body comes.
    asleep: Vec<bool>,
    /// Whether another step would change nothing but the time.
    pub(super) is_dormant: bool,
    near: Neighbours,
    queue: EventQueue,
    visited: Visited,
    /// Memory for the bodies whose trajectories start again.
    restarted: Vec<usize>,
    /// Whether bodies were placed since contacts were last searched for placed bodies.
    pub(super) placed: bool,
    /// The contacts before the step.
    contacts_before: ContactSet,
    /// Pairs in overlap that move as one body in this step.
    held: Vec<(usize, usize)>,
    /// Turning bodies in contact in this step.
    turning: TurningRest,
    /// The effects of bundling in the step.
    pub(super) bundled: Bundled,
}

impl Continuous {
    /// The data of a world that continues without caches, because it was read from a snapshot or a body was removed.
    pub(super) fn resumed(placed: bool, knows_near: bool, bundled: Bundled) -> Continuous {
        Continuous {
            placed,
            bundled,
            near: Neighbours {
                knows_near,
                ..Neighbours::default()
            },
            ..Continuous::default()
        }
    }

    /// Whether the neighbours of the bodies at their positions are known, because no body was placed since they were
    /// found.
    pub(super) fn knows_near(&self) -> bool {
        self.near.knows_near
    }
}

impl World {
    /// The greatest number of events in one step; with more, the step fails. If bodies have no room, so that impacts
    /// follow each other without time between them, the step fails after some thousands.
    pub const MOST_IMPACTS: u64 = 4_000_000;

    /// Resolves the impacts and contacts of bodies on the way from the previous state to the current one.
    pub(super) fn collide_continuously(&mut self) -> Result<(), (usize, Cause)> {
        let all_slept = self.all_sleep();
        let record = self.record.checkpoint();
        self.continuous.contacts_before.copy_from(&self.contacts);
        let placed = self.continuous.placed.then(|| {
            let position = self.previous.position.clone();
            (position, self.overlaps.pairs.clone())
        });
        self.continuous.bundled = Bundled::default();
        self.continuous.near.knows_near &= placed.is_none();
        self.separate_placed();
        if let Err(failed) = self.collide_without_deepening() {
            self.record.roll_back(&record);
            mem::swap(&mut self.contacts, &mut self.continuous.contacts_before);
            if let Some((position, overlapping)) = placed {
                self.continuous.placed = true;
                self.previous.position = position;
                self.overlaps.pairs = overlapping;
            }
            // Bodies that fell asleep in the failed step are awake again.
            self.continuous.wake_all();
            return Err(failed);
        }
        self.forget_parted_overlaps();
        self.continuous.bundled.bodies = self.contacts.bundled_bodies();
        self.contacts.end_step();
        self.continuous.is_dormant =
            all_slept && self.all_sleep() && self.continuous.bundled == Bundled::default();
        self.record.contact_steps += u64::from(!self.contacts.is_empty());
        Ok(())
    }

    /// Goes through the phases once; the current state gives the ends of trajectories.
    fn collide_once(&mut self) -> Result<(), (usize, Cause)> {
        mem::swap(&mut self.current, &mut self.continuous.paths.end);
        let done = self.go_through_phases();
        mem::swap(&mut self.current, &mut self.continuous.paths.end);
        done
    }

    fn go_through_phases(&mut self) -> Result<(), (usize, Cause)> {
        let scene = scene!(self);
        let continuous = &mut self.continuous;
        let is_placed = mem::take(&mut continuous.placed);
        continuous.paths.begin(&scene);
        continuous.paths.begin_turning(&scene)?;
        continuous.turning.begin(scene.bodies.turners.body.len());
        continuous.tallies.clear();
        let mut events = EventLoop {
            solver: ContactSolver {
                scene: &scene,
                paths: &mut continuous.paths,
                contacts: &mut self.contacts,
                tallies: &mut continuous.tallies,
                asleep: &mut continuous.asleep,
                held: &continuous.held,
                near: &mut continuous.near,
                visited: &mut continuous.visited,
                bundled: &mut continuous.bundled,
                turning: &mut continuous.turning,
            },
            queue: &mut continuous.queue,
            record: &mut self.record,
            restarted: &mut continuous.restarted,
        };
        events.record.enter(Phase::Respond);
        events.keep_contacts(is_placed)?;
        events.find_all_impacts()?;
        events.record.enter(Phase::Respond);
        events.resolve_all()?;
        events.go_on_turning();
        self.record.enter(Phase::Narrow);
        let mut correction = Correction {
            scene: &scene,
            end: &mut continuous.paths.end,
            contacts: &self.contacts,
            record: &mut self.record,
        };
        correction.separate_meeting(&mut continuous.near.candidate_pairs)?;
        self.record.enter(Phase::Respond);
        Ok(())
    }
}
