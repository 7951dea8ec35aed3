//! The resolution of all events of one time, from which trajectories continue.

use alloc::vec::Vec;
use core::mem;

use super::super::stepping::Cause;
use super::{
    contact_motion::LEAST_GAP,
    contact_set::ContactConstraint,
    event::{Event, EventKind, Outcome},
    event_loop::EventLoop,
    island::Island,
    solver::{ContactSolver, SLIGHTEST},
    tallies::Bounces,
};

impl EventLoop<'_> {
    /// Resolves events that happen at the same time.
    pub(super) fn resolve(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
    ) -> Result<(), (usize, Cause)> {
        let mut restarted = mem::take(self.restarted);
        restarted.clear();
        for event in group.iter() {
            self.solver.restart(event.bodies.0, time, &mut restarted)?;
            self.solver.restart(event.bodies.1, time, &mut restarted)?;
        }
        for event in group.iter() {
            let (i, j) = event.bodies;
            let normal = event.contact.normal;
            let ended = self.solver.contacts.of_pair(i, j);
            let ended = ended.copied().find(|known| known.normal == normal);
            if let Some(ended) = ended.filter(|_| event.kind == EventKind::ContactEnd) {
                self.solver.hand_over(&ended)?;
            }
        }
        for event in group.iter_mut() {
            if self.climb(event, time, &mut restarted)? {
                // The body continues on another surface.
                event.kind = EventKind::ContactEnd;
                event.outcome = Outcome::Rest;
            }
            if event.kind == EventKind::Impact {
                self.view().classify(event);
            }
        }
        // The bodies whose constraints must be solved.
        let mut seeds: Vec<usize> = Vec::new();
        self.resolve_turning(group, time, (&mut seeds, &mut restarted))?;
        if group.iter().any(Event::is_rest) {
            self.join_resting(group, time, &mut restarted)?;
        }
        self.count(group);
        let bouncing = group
            .iter()
            .filter(|event| event.outcome == Outcome::Bounce);
        self.bounce_all_of(bouncing.clone(), time);
        seeds.extend(bouncing.flat_map(|event| [event.bodies.0, event.bodies.1]));
        self.bounce_contacts(&mut seeds, time, &mut restarted)?;
        for event in group.iter().filter(|event| event.is_rest()) {
            self.begin_contact(event, time)?;
        }
        let others = group
            .iter()
            .filter(|event| event.outcome != Outcome::Bounce);
        seeds.extend(others.flat_map(|event| [event.bodies.0, event.bodies.1]));
        let before: Vec<f64> = group
            .iter()
            .map(|event| self.view().closing(event))
            .collect();
        if !self.solver.contacts.is_empty() {
            self.solver.solve_islands_of(&seeds, time, &mut restarted)?;
        }
        for (event, closing) in group.iter().zip(before) {
            self.report_rest(event, closing, time);
        }
        restarted.sort_unstable();
        restarted.dedup();
        self.solver.finish_restarted(&restarted)?;
        for &body in &restarted {
            self.update_swept(body);
        }
        for &body in &restarted {
            self.find_impacts_of(body, &restarted)?;
        }
        self.queue_contact_ends(&restarted);
        self.queue_horizons(restarted.iter().copied());
        *self.restarted = restarted;
        Ok(())
    }

    /// Adds to impacts that come to rest the later ones that soon follow in their islands: no farther away than the
    /// height of the shortest flight. If a body comes to rest again and again in a step, all later impacts of its
    /// island are added. In a heap nearly all impacts are of this kind, and each resolved alone would move all other
    /// bodies.
    fn join_resting(
        &mut self,
        group: &mut Vec<Event>,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        loop {
            let mut visited = mem::take(self.solver.visited);
            visited.begin(self.solver.scene.bodies.len());
            let mut is_bundled = false;
            for body in group
                .iter()
                .flat_map(|event| [event.bodies.0, event.bodies.1])
            {
                if let Some(island) = self.view().island_around(body, &mut visited) {
                    is_bundled |= island
                        .bodies
                        .iter()
                        .any(|&body| self.view().is_bundled(body));
                }
            }
            let is_tied = |event: &&Event| {
                let (i, j) = event.bodies;
                event.kind == EventKind::Impact
                    && self.solver.paths.is_current(event)
                    && (visited.has(i) || visited.has(j))
                    && group.iter().all(|known| known.bodies != event.bodies)
            };
            let soon = self.queue.waiting.iter().filter(is_tied);
            let mut soon: Vec<Event> = soon.cloned().collect();
            *self.solver.visited = visited;
            self.view().sort_events(&mut soon);
            let before = group.len();
            for mut event in soon {
                let (gap, opening) = self.gap_before(&event, time)?;
                let push = self.view().greatest_push(event.bodies.0, event.bodies.1);
                let (height, speed) = self.view().shortest_hop(event.bodies, push, is_bundled);
                let is_hop = gap <= height && opening <= speed;
                if is_hop || is_bundled {
                    self.classify_at_its_time(&mut event)?;
                    if event.is_rest() {
                        self.solver.restart(event.bodies.0, time, restarted)?;
                        self.solver.restart(event.bodies.1, time, restarted)?;
                        event.gap = gap.max(0.0);
                        group.push(event);
                    }
                }
            }
            if group.len() == before {
                return Ok(());
            }
        }
    }

    /// The gap of two bodies at a time before their impact, m, and their opening speed, m/s, both along the normal of
    /// the impact.
    fn gap_before(&mut self, event: &Event, from: f64) -> Result<(f64, f64), (usize, Cause)> {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let mut probe = mem::take(&mut self.solver.paths.probe);
        let start = from
            .max(self.solver.paths.since[i])
            .max(self.solver.paths.since[j]);
        let mut apart = |time: f64| {
            let (x1, v1) = self.view().motion().motion_at(i, time, &mut probe)?;
            let (x2, v2) = self.view().motion().motion_at(j, time, &mut probe)?;
            Ok(((x2 - x1).dot(normal), (v2 - v1).dot(normal)))
        };
        let motion = apart(start).and_then(|start| Ok((start, apart(event.time)?)));
        self.solver.paths.probe = probe;
        let ((gap, opening), (end, _)) = motion?;
        Ok((gap - end, opening))
    }

    /// Counts how often bodies have come to rest. If some impacts lose energy, counts the impacts of each body too.
    pub(super) fn count(&mut self, group: &[Event]) {
        for event in group {
            let is_counted = event.outcome != Outcome::Bounce
                || !self.solver.scene.bodies.restitution.is_usual();
            let closing = self.view().closing(event);
            for body in [event.bodies.0, event.bodies.1] {
                if !is_counted
                    || !self.solver.scene.bodies.is_movable(body)
                    || event.kind != EventKind::Impact
                {
                    continue;
                }
                let bodies = self.solver.scene.bodies.len();
                let tallies = &mut *self.solver.tallies;
                if event.outcome == Outcome::Bounce {
                    tallies.bounces.resize(bodies, Bounces::default());
                    let bounces = &mut tallies.bounces[body];
                    bounces.count += 1;
                    bounces.fastest = bounces.fastest.max(closing);
                } else {
                    tallies.rests.resize(bodies, 0);
                    tallies.rests[body] += 1;
                    self.solver.contacts.keep_bundled(&[body]);
                }
            }
        }
    }

    /// Classifies an event by the motion of its bodies at the time of their impact.
    fn classify_at_its_time(&mut self, event: &mut Event) -> Result<(), (usize, Cause)> {
        let ((i, j), normal) = (event.bodies, event.contact.normal);
        let mut probe = mem::take(&mut self.solver.paths.probe);
        let first = self.view().motion().motion_at(i, event.time, &mut probe);
        let second = self.view().motion().motion_at(j, event.time, &mut probe);
        self.solver.paths.probe = probe;
        let closing = (first?.1 - second?.1).dot(normal);
        self.view()
            .classify_by(event, closing, self.view().pressed_on_hop(event, closing));
        Ok(())
    }

    /// Adds the contact constraint of an impact that comes to rest.
    fn begin_contact(&mut self, event: &Event, time: f64) -> Result<(), (usize, Cause)> {
        let (i, j) = event.bodies;
        let hover = self.view().layout().hover_gap(i, j);
        // Bodies that touch are moved apart by a rounding, so that later roundings and the solver have room.
        let least = LEAST_GAP * hover;
        let mut gap = event.gap;
        if gap < least {
            let normal = event.contact.normal;
            gap += self
                .solver
                .move_apart_in_room(event.bodies, (least - gap) * normal, time)?;
            let seen = self.view().layout().resolution_along(i, j, normal);
            if gap < seen {
                self.solver.move_apart(event.bodies, (seen - gap) * normal);
                gap = seen;
            }
        }
        let target = self.view().speed_to_hover(
            gap,
            hover,
            self.solver.scene.settings.dt - time,
            event.load_speed,
        );
        let point = event.contact.point - self.solver.paths.start.position[i];
        self.solver.add_contact(ContactConstraint {
            target,
            load_speed: event.load_speed,
            ..ContactConstraint::new(event.bodies, event.contact.normal, gap, point)
        });
        Ok(())
    }

    /// Records an impact that has come to rest, if it was an impact.
    fn report_rest(&mut self, event: &Event, closing: f64, time: f64) {
        let load = event.load_speed;
        if !event.is_rest() || closing - self.view().unfelt(load) <= SLIGHTEST * load {
            return;
        }
        let (i, j) = event.bodies;
        let normal = event.contact.normal;
        let same = |known: &&ContactConstraint| known.normal.dot(normal) > 0.999;
        let impulse = self
            .solver
            .contacts
            .of_pair(i, j)
            .find(same)
            .map(|c| c.impulse);
        let speeds = (closing, -self.view().closing(event));
        let impulse = impulse.unwrap_or(0.0);
        let scene = self.solver.scene;
        let at = self.view().instant(event.bodies, time);
        let impact = scene.impact(event.bodies, &event.contact, (impulse, speeds), at);
        self.note_impact(impact);
    }
}

impl ContactSolver<'_> {
    /// Starts the trajectory of a body and of the bodies coupled to it again. Immovable bodies keep their
    /// trajectories.
    pub(super) fn restart(
        &mut self,
        body: usize,
        time: f64,
        restarted: &mut Vec<usize>,
    ) -> Result<(), (usize, Cause)> {
        if self.scene.bodies.is_movable(body) {
            restarted.extend(self.paths.restart_at(self.scene, body, time)?);
        }
        Ok(())
    }

    /// Bundles an island if one of its bodies is bundled. Returns whether the island is bundled.
    pub(super) fn spread_bundle(&mut self, island: &Island) -> bool {
        let is_bundled = island
            .bodies
            .iter()
            .any(|&body| self.view().is_bundled(body));
        if is_bundled {
            self.contacts.bundle(&island.bodies);
        }
        is_bundled
    }
}
