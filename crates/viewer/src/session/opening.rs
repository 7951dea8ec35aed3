//! The view on a scene just opened: all bodies and where they go next.
//!
//! Under forces, and where a scene tells when it ends, that takes steps ahead, and steps can be slow, so
//! they are a job for another thread ([`Outlook`]); until it is done the bodies alone are in view.

use std::time::Duration;

use sim_core::{Collision, DVec3, Force, Settings, World};

use super::Session;
use super::framing::{Bounds, OPENING_REACH};
use crate::camera::Camera;

/// Depth over width and height below which all is in an upright plane, and where to look at that
/// from: yaw and pitch, radians.
const FLAT: f64 = 0.3;
const FRONT: (f64, f64) = (0.2, 0.16);
/// How far the view looks ahead: simulated time, s, where the scene does not tell when it ends, steps, and
/// positions.
const TIME: f64 = 6.4;
const STEPS: f64 = 7200.0;
const POSITIONS: f64 = 20_000.0;
/// Real time for looking ahead in a window.
const BUDGET: Duration = Duration::from_secs(1);

/// A world that is to be followed ahead of time, and the box that grows with it.
#[derive(Debug)]
pub struct Outlook {
    world: World,
    bounds: Vec<Option<Bounds>>,
    low: DVec3,
    high: DVec3,
    min: DVec3,
    max: DVec3,
    /// Simulated time that is looked ahead, s.
    time: f64,
    /// Not after this real time.
    budget: Duration,
    ticket: u64,
}

/// The look ahead of one scene.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Opening {
    /// It has been handed out, or is not wanted.
    begun: bool,
    /// The view that it may change: that of the person since is left alone.
    view: Option<Camera>,
    ticket: u64,
}

impl Opening {
    /// The view stays as it is, whatever comes.
    pub(super) fn settle(&mut self) {
        self.begun = true;
    }

    /// That of the scene opened after this one's.
    pub(super) fn next(self) -> Self {
        Self {
            ticket: self.ticket + 1,
            ..Self::default()
        }
    }
}

impl Outlook {
    /// Follows the motion for some seconds, or for as long as there is real time, by `stopwatch`.
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
                // What falls below all that was there is let go.
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
    /// Looks at the bodies as they were set up, or at a single one and where it goes next, so that
    /// nothing leaves the first view at once. [`outlook`](Self::outlook) does better where it can.
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

    /// Whether any force acts, so that paths bend.
    pub(super) fn is_pushed(&self) -> bool {
        let pushed = |i| self.world.force(i) != DVec3::ZERO;
        !self.world.forces().is_empty() || (0..self.world.len()).any(pushed)
    }

    /// The look ahead that the opening view waits for, once.
    pub fn outlook(&mut self) -> Option<Outlook> {
        let begun = std::mem::replace(&mut self.opening.begun, true);
        if begun || !self.is_pushed() && self.scene.ends.is_none() {
            return None;
        }
        let (low, high) = self.world_box()?;
        let (mut low, mut high) = self.with_feet(low, high);
        for force in self.world.forces() {
            if let Force::Anchor { anchor: point, .. } | Force::Attraction { centre: point, .. } =
                *force
            {
                (low, high) = (low.min(point), high.max(point));
            }
        }
        // A stop of the tour has begun to run by now.
        let mut world = self.playback.first()?.clone();
        // The same answers in less time.
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

    /// Looks at what came into sight, unless the person has turned elsewhere meanwhile.
    pub fn accept_outlook(&mut self, seen: &Outlook) {
        if seen.ticket != self.opening.ticket || self.opening.view != Some(self.camera) {
            return;
        }
        self.opening.view = None;
        let (size, middle) = (seen.max - seen.min, 0.5 * (seen.min + seen.max));
        if self.is_pushed() && size.z < FLAT * size.x.max(size.y) {
            // Motion in an upright plane is looked at nearly from the front.
            (self.camera.yaw, self.camera.pitch) = FRONT;
        }
        let mut radius = (0.47 * size.length()).max(1e-3);
        if (0..self.world.len()).any(|i| self.is_half_space(i)) {
            radius = radius.max(1.1 * self.room().1);
        }
        self.camera.frame(middle, radius);
        self.view.home = Some(self.camera);
    }

    /// Looks ahead now, for as long as it takes or until `is_over`: for pictures without a window.
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
