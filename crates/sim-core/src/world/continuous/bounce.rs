//! Bodies that separate after an impact: two of them, or all that simultaneous impacts connect.

use alloc::{vec, vec::Vec};
use glam::DVec3;

use super::super::stepping::Cause;
use super::{
    event::{Event, Outcome},
    event_loop::EventLoop,
    island::Places,
    outcome::MANY_BOUNCES,
};
use crate::{
    impulse::{ALL_SWEEPS, drag, greatest, limit, reflect},
    pieces::ties,
};

impl EventLoop<'_> {
    /// Lets the contacts of some bodies bounce that close after an impulse, and then the contacts of the bodies that
    /// these push.
    pub(super) fn bounce_contacts(
        &mut self,
        seeds: &mut Vec<usize>,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        if self.solver.contacts.is_empty() {
            return Ok(());
        }
        let mut changed = seeds.clone();
        let mut round = 0;
        while !changed.is_empty() {
            round += 1;
            let mut group: Vec<Event> = Vec::new();
            for &body in &changed {
                for &index in self.solver.contacts.of_body(body) {
                    let constraint = self.solver.contacts.all()[index as usize];
                    let is_known = |event: &Event| {
                        event.bodies == constraint.bodies
                            && event.contact.normal == constraint.normal
                    };
                    if !group.iter().any(is_known) {
                        group.push(self.view().event_of(&constraint, time));
                    }
                }
            }
            self.view().sort_events(&mut group);
            for event in &group {
                self.solver.restart(event.bodies.0, time, restarted)?;
                self.solver.restart(event.bodies.1, time, restarted)?;
            }
            group.retain_mut(|event| {
                self.view().classify(event);
                let (i, j) = event.bodies;
                // In a row of bodies, impacts with restitution less than one would go to and fro without end, so that
                // the contact comes to rest after many rounds; in a heap, at once.
                let is_lossy = self.solver.scene.bodies.pair_restitution(i, j) < 1.0;
                let is_bundled = self.view().is_bundled(i) || self.view().is_bundled(j);
                let ends = is_lossy && (is_bundled || round > MANY_BOUNCES);
                event.outcome == Outcome::Bounce && !ends
            });
            self.count(&group);
            self.watch_crush(&group)?;
            self.count_events(&group)?;
            self.bounce_all_of(group.iter(), time);
            changed.clear();
            changed.extend(
                group
                    .iter()
                    .flat_map(|event| [event.bodies.0, event.bodies.1]),
            );
            changed.retain(|&body| self.solver.scene.bodies.is_movable(body));
            seeds.extend(&changed);
        }
        Ok(())
    }

    /// Lets bodies bounce: those of one impact, or all that simultaneous impacts connect.
    pub(super) fn bounce_all_of<'a>(
        &mut self,
        events: impl Iterator<Item = &'a Event> + Clone,
        time: f64,
    ) {
        if events.clone().nth(1).is_none() {
            if let Some(event) = events.clone().next() {
                self.exchange_there(event, time);
            }
            return;
        }
        let scene = self.solver.scene;
        let places = Places::between(scene.bodies, scene.before, events.clone().map(Event::plane));
        let pairs = places.joined.iter().map(|joined| joined.bodies);
        let is_movable = |place: usize| places.inverse_mass[place] > 0.0;
        let ties = ties(pairs, places.bodies.len(), is_movable);
        let mut of_events: Vec<(usize, &Event)> = ties.into_iter().zip(events).collect();
        of_events.sort_by_key(|&(tie, _)| tie);
        for tied in of_events.chunk_by(|a, b| a.0 == b.0) {
            match tied {
                [(_, event)] => self.bounce_all_of(core::iter::once(*event), time),
                _ => self.bounce_together(tied.iter().map(|&(_, event)| event), time),
            }
        }
    }

    /// Lets bodies bounce off each other all at once, with the least restitution of all.
    pub(super) fn bounce_together<'a>(
        &mut self,
        events: impl Iterator<Item = &'a Event> + Clone,
        time: f64,
    ) {
        let restitution = events
            .clone()
            .map(|event| {
                self.solver
                    .scene
                    .bodies
                    .pair_restitution(event.bodies.0, event.bodies.1)
            })
            .fold(1.0, f64::min);
        let scene = self.solver.scene;
        let places = Places::between(scene.bodies, scene.before, events.clone().map(Event::plane));
        let mut velocity = places.each(|body| self.solver.paths.start.velocity[body]);
        let before = velocity.clone();
        let given = reflect(
            &places.joined,
            &places.inverse_mass,
            &mut velocity,
            restitution,
        );
        if self.solver.scene.bodies.is_rough() {
            let bodies = events.clone().map(|event| event.bodies).zip(&given);
            let most = bodies
                .map(|((i, j), &given)| limit(self.solver.scene.bodies.pair_friction(i, j), given));
            let most: Vec<f64> = most.collect();
            let fastest = greatest(&before);
            let none = vec![DVec3::ZERO; given.len()];
            let mut dragged = none.clone();
            let enough = (16.0 * f64::EPSILON * fastest, ALL_SWEEPS);
            let Places {
                joined,
                inverse_mass,
                ..
            } = &places;
            drag(
                joined,
                inverse_mass,
                &mut velocity,
                &most,
                &none,
                &mut dragged,
                enough,
            );
        }
        places.put(
            &velocity,
            &mut self.solver.paths.start.velocity,
            &places.inverse_mass,
        );
        for ((event, joined), given) in events.zip(&places.joined).zip(given) {
            let speeds = (-joined.opening(&before), joined.opening(&velocity));
            let at = self.view().instant(event.bodies, time);
            let impact = scene.impact(event.bodies, &event.contact, (given, speeds), at);
            self.note_impact(impact);
        }
    }

    /// Exchanges the impulse of one impact.
    pub(super) fn exchange_there(&mut self, event: &Event, time: f64) {
        let scene = self.solver.scene;
        let at = self.view().instant(event.bodies, time);
        let velocity = &mut self.solver.paths.start.velocity;
        let impact = scene.exchange(event.bodies, &event.contact, velocity, at);
        match impact {
            Some(impact) => self.note_impact(impact),
            None => self.queue.progress.note_nothing(),
        }
    }
}
