//! The instant that is drawn. Between two states bodies move straight and rotate uniformly; bodies with impacts in the
//! step pass through their poses at these times.

use sim_core::{Collision, DQuat, DVec3, Impact, World};

use super::{Session, State, clock};

/// A state counts as reached from this fraction of a step before it.
pub(super) const SAME: f64 = 1e-9;

/// The poses of bodies at their impacts within the last step, in the order of bodies and times.
#[derive(Debug, Default)]
pub(super) struct Passes(Vec<Pass>);

/// The position of a body's moving point, m, and the rotation of its shape.
type Placed = (DVec3, DQuat);

/// The pose of a body at an impact.
#[derive(Clone, Copy, Debug)]
struct Pass {
    body: usize,
    /// The time as a fraction of the step.
    part: f64,
    place: DVec3,
    rotation: DQuat,
}

impl Passes {
    /// The poses of the last step of `world`. None in the discrete modes, which move bodies back from the contact.
    pub(super) fn of(world: &World, impacts: &[Impact]) -> Self {
        let settings = world.settings();
        if settings.collision != Collision::Continuous {
            return Self::default();
        }
        let begin = world.time() - settings.dt;
        let both = |impact: &Impact| {
            let part = ((impact.time - begin) / settings.dt).clamp(0.0, 1.0);
            let ((i, j), (a, b)) = (impact.bodies, impact.positions);
            let (first, second) = impact.rotations;
            [(i, a, first), (j, b, second)].map(|(body, place, rotation)| Pass {
                body,
                part,
                place,
                rotation,
            })
        };
        let mut all: Vec<Pass> = impacts.iter().flat_map(both).collect();
        all.sort_by(|a, b| a.body.cmp(&b.body).then(a.part.total_cmp(&b.part)));
        Self(all)
    }

    fn of_body(&self, body: usize) -> &[Pass] {
        let begin = self.0.partition_point(|pass| pass.body < body);
        let end = self.0.partition_point(|pass| pass.body <= body);
        &self.0[begin..end]
    }
}

impl Session {
    /// The fraction of the last step at which bodies are drawn; 1 is the state itself.
    pub(super) fn shown_part(&self) -> f64 {
        match self.state {
            // The first state has no predecessor.
            _ if self.world.steps() == 0 => 1.0,
            State::Running if self.display.between => self.clock.fraction(),
            State::Paused => self.instant.unwrap_or(1.0),
            State::Running | State::Layout => 1.0,
        }
    }

    /// The simulated time of the picture, s.
    pub fn shown_time(&self) -> f64 {
        self.world.time() - (1.0 - self.shown_part()) * self.world.settings().dt
    }

    /// Whether bodies are drawn between two states.
    pub fn is_between(&self) -> bool {
        self.shown_part() < 1.0
    }

    /// The origin of body `i` as drawn, m.
    pub(super) fn shown_position(&self, i: usize) -> DVec3 {
        let centre = self.shown_centre(i);
        match self.world.inertia(i) {
            Some(inertia) => centre - self.shown_rotation(i) * inertia.centre(),
            None => centre,
        }
    }

    /// The rotation of body `i` as drawn.
    pub(super) fn shown_rotation(&self, i: usize) -> DQuat {
        match self.shown_part() {
            _ if !self.world.turns(i) => DQuat::IDENTITY,
            1.0 => self.world.rotation(i),
            part => {
                let [(from, a), (to, b)] = self.legs(i, part);
                a.1.slerp(b.1, ((part - from) / (to - from)).clamp(0.0, 1.0))
            }
        }
    }

    /// The moving point of body `i` as drawn, m: its centre of mass if it is a turning body, else its origin.
    pub(super) fn shown_centre(&self, i: usize) -> DVec3 {
        match self.shown_part() {
            1.0 => self.world.position(i),
            part => {
                let [(from, a), (to, b)] = self.legs(i, part);
                a.0.lerp(b.0, ((part - from) / (to - from)).clamp(0.0, 1.0))
            }
        }
    }

    /// A point of body `i` as drawn, given in the frame of its shape, m; without one, its moving point.
    pub(super) fn shown_point(&self, i: usize, point: Option<DVec3>) -> DVec3 {
        match point {
            Some(point) => self.shown_position(i) + self.shown_rotation(i) * point,
            None => self.shown_centre(i),
        }
    }

    /// The velocity of body `i` in the picture, m/s: in a step with impacts, that between two of them.
    pub(super) fn shown_velocity(&self, i: usize) -> DVec3 {
        let part = self.shown_part();
        if part == 1.0 || self.passes.of_body(i).is_empty() {
            return self.world.velocity(i);
        }
        let [(from, a), (to, b)] = self.legs(i, part);
        (b.0 - a.0) / ((to - from) * self.world.settings().dt)
    }

    /// The positions of a body at its impacts in this step, up to the instant drawn, m.
    pub(super) fn passed_places(&self, i: usize) -> impl Iterator<Item = DVec3> {
        let part = self.shown_part();
        let passes = self.passes.of_body(i).iter();
        let passed = passes.filter(move |pass| part < 1.0 && pass.part < part);
        passed.map(|pass| pass.place)
    }

    /// The fractions of the step and the poses before and after a given fraction of the step: positions of the moving
    /// point, m, and rotations.
    fn legs(&self, i: usize, part: f64) -> [(f64, Placed); 2] {
        let passes = self.passes.of_body(i).iter();
        let start = self.world.interpolated_pose(i, 0.0).1;
        let mut from = (0.0, (self.world.previous_position(i), start));
        for pass in passes {
            // Of several impacts at the same time, the first.
            let there = (pass.part, (pass.place, pass.rotation));
            if pass.part >= part && pass.part > from.0 {
                return [from, there];
            }
            from = there;
        }
        // If the step ends with an impact, the last leg has zero length.
        let end = (self.world.position(i), self.world.rotation(i));
        [from, (1.0_f64.max(from.0 + SAME), end)]
    }

    /// Pauses at a simulated time, s, within the step that contains it. A time outside the kept states is clamped to
    /// them.
    pub fn go_to_time(&mut self, time: f64) {
        let index = self.playback.first_from(time);
        self.go_to(index);
        let part = 1.0 - (self.world.time() - time) / self.world.settings().dt;
        if index > 0 && part < 1.0 - SAME {
            self.instant = Some(part.max(0.0));
        }
    }

    /// Pauses at the next or the previous kept impact, found or missed.
    pub fn go_to_impact(&mut self, next: bool) {
        let now = self.shown_time();
        let slack = SAME * self.world.settings().dt;
        let times = self.playback.contact_times();
        let found = match next {
            true => times.filter(|&t| t > now + slack).reduce(f64::min),
            false => times.filter(|&t| t < now - slack).reduce(f64::max),
        };
        match found {
            Some(time) => self.go_to_time(time),
            None => {
                let text = match next {
                    true => "No later impact is kept.",
                    false => "No earlier impact is kept.",
                };
                self.notices.info("impact", text.to_owned());
            }
        }
    }

    /// Continues the clock from the instant drawn.
    pub(super) fn resume_clock(&mut self) {
        let dt = self.world.settings().dt;
        let part = self.instant.take().unwrap_or(1.0).min(1.0 - SAME);
        if let Ok(mut clock) = clock(dt, self.speed) {
            // Less than a step, so that no step is due.
            clock.advance(std::time::Duration::from_secs_f64(part * dt));
            self.clock = clock;
        }
    }
}
