//! The view of a scene just opened: all bodies and where they go next.
//!
//! Under forces, and if a scene has an end time, this requires steps ahead. Steps can be slow, so they are a job for
//! another thread ([`Outlook`]). Until it is done, the view shows the bodies alone.

use std::time::Duration;

use sim_core::{Collision, DVec3, Force, Settings, World};

use super::Session;
use super::framing::{Bounds, OPENING_REACH};
use crate::camera::Camera;

/// The ratio of depth to width and height below which all bodies lie in a vertical plane, and the view of that plane:
/// yaw and pitch, radians.
const FLAT: f64 = 0.3;
const FRONT: (f64, f64) = (0.2, 0.16);
/// The limits of looking ahead: simulated time, s, if the scene has no end time, steps, and positions.
const TIME: f64 = 6.4;
const STEPS: f64 = 7200.0;
const POSITIONS: f64 = 20_000.0;
/// The real time for looking ahead in a window.
const BUDGET: Duration = Duration::from_secs(1);

/// A world to be stepped ahead, and the box of its bodies, which grows with the steps.
#[derive(Debug)]
pub struct Outlook {
    world: World,
    bounds: Vec<Option<Bounds>>,
    low: DVec3,
    high: DVec3,
    min: DVec3,
    max: DVec3,
    /// Simulated time to look ahead, s.
    time: f64,
    /// The limit of real time.
    budget: Duration,
    ticket: u64,
}

/// The state of the look ahead of one scene.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Opening {
    /// Whether it has been handed out, or is not wanted.
    begun: bool,
    /// The view that it may change: a view that the user has changed stays.
    view: Option<Camera>,
    ticket: u64,
}

impl Opening {
    /// Keeps the view, whatever the result.
    pub(super) fn settle(&mut self) {
        self.begun = true;
    }

    /// The state for the scene opened after this one.
    pub(super) fn next(self) -> Self {
        Self {
            ticket: self.ticket + 1,
            ..Self::default()
        }
    }
}

impl Outlook {
    /// Steps the world ahead until the limits of simulated or real time; `stopwatch` reads real time.
    #[must_use]
    pub fn run(mut self, stopwatch: impl Fn() -> Duration) -> Self {
        let began = stopwatch();
        let has_weight = |force: &Force| matches!(force, Force::Gravity { .. });
        let sinks = |i| self.world.force(i).y < 0.0;
        let falls = self.world.forces().iter().any(has_weight) || (0..self.world.len()).any(sinks);
        let size = (self.high - self.low).max_element();
        let least = self.low - OPENING_REACH * size;
        let most = self.high + OPENING_REACH * size;
        let steps = (self.time / self.world.settings().dt).min(STEPS);
        let steps = steps.min(POSITIONS / self.world.len().max(1) as f64);
        for _ in 0..steps as u32 {
            if self.world.step().is_err() || stopwatch().saturating_sub(began) > self.budget {
                break;
            }
            for (i, bounds) in self.bounds.iter().enumerate() {
                let (Some(bounds), at) = (bounds, self.world.position(i)) else {
                    continue;
                };
                // A body that falls below all others at the start is not followed.
                if falls && at.y + bounds.half.y < self.low.y {
                    continue;
                }
                let at = at.clamp(least, most);
                self.min = self.min.min(at - bounds.half);
                self.max = self.max.max(at + bounds.half);
            }
        }
        self
    }
}

impl Session {
    /// Frames the bodies as they were set up, or a single one and where it goes next, so that nothing leaves the first
    /// view at once. [`outlook`](Self::outlook) gives a better view if it can.
    pub(super) fn frame_opening(&mut self) {
        let mut bodies = (0..self.world.len()).filter(|&i| !self.is_half_space(i));
        let Some(body) = bodies.next() else {
            return self.frame();
        };
        let (centre, radius) = self.room();
        if self.world.len() > 1 || self.is_pushed() {
            return self.camera.frame(centre, 1.2 * radius);
        }
        let velocity = self.world.velocity(body);
        let (mut min, mut max) = (centre - radius, centre + radius);
        for time in [0.5, 1.0, 1.5, 2.0, 2.5, 3.0] {
            let there = centre + (velocity * time).clamp_length_max(OPENING_REACH * radius);
            (min, max) = (min.min(there - radius), max.max(there + radius));
        }
        let ball = (max - min).length() / 2.0;
        self.camera.frame((min + max) / 2.0, ball);
    }

    /// Whether any force acts, so that paths are curved.
    pub(super) fn is_pushed(&self) -> bool {
        let pushed = |i| self.world.force(i) != DVec3::ZERO;
        !self.world.forces().is_empty() || (0..self.world.len()).any(pushed)
    }

    /// The look ahead for the opening view; it is returned once.
    pub fn outlook(&mut self) -> Option<Outlook> {
        let begun = std::mem::replace(&mut self.opening.begun, true);
        if begun || !self.is_pushed() && self.scene.ends.is_none() {
            return None;
        }
        let (low, high) = self.world_box()?;
        let (mut low, mut high) = self.with_feet(low, high);
        for force in self.world.forces() {
            if let Some(point) = force.nature().tie.point() {
                (low, high) = (low.min(point), high.max(point));
            }
        }
        // A stop of the tour may already have begun to run.
        let mut world = self.playback.first()?.clone();
        // The hierarchies give the same answers faster.
        if world.settings().collision == Collision::Naive {
            let settings = Settings {
                collision: Collision::Bvh,
                ..*world.settings()
            };
            world.set_settings(settings).ok()?;
        }
        let bounds = |i| (!self.is_half_space(i)).then(|| self.bounds(i));
        let bounds = (0..world.len()).map(bounds).collect();
        self.opening.view = Some(self.camera);
        Some(Outlook {
            world,
            bounds,
            low,
            high,
            min: low,
            max: high,
            time: self.scene.ends.unwrap_or(TIME),
            budget: BUDGET,
            ticket: self.opening.ticket,
        })
    }

    /// Frames the result, unless the user has changed the view in the meantime.
    pub fn accept_outlook(&mut self, seen: &Outlook) {
        if seen.ticket != self.opening.ticket || self.opening.view != Some(self.camera) {
            return;
        }
        self.opening.view = None;
        let (size, middle) = (seen.max - seen.min, 0.5 * (seen.min + seen.max));
        if self.is_pushed() && size.z < FLAT * size.x.max(size.y) {
            // Motion in a vertical plane is viewed nearly from the front.
            (self.camera.yaw, self.camera.pitch) = FRONT;
        }
        let mut radius = (0.47 * size.length()).max(1e-3);
        if (0..self.world.len()).any(|i| self.is_half_space(i)) {
            radius = radius.max(1.1 * self.room().1);
        }
        self.camera.frame(middle, radius);
        self.view.home = Some(self.camera);
    }

    /// Looks ahead synchronously, without limit or until `is_over`: for pictures without a window.
    pub fn look_ahead(&mut self, is_over: impl Fn() -> bool) {
        if let Some(outlook) = self.outlook() {
            let time = || match is_over() {
                true => Duration::MAX,
                false => Duration::ZERO,
            };
            self.accept_outlook(&outlook.run(time));
        }
    }
}
