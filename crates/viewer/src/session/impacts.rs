//! Recent impacts: their points, normals and impulses.

use std::collections::VecDeque;

use sim_core::{DVec3, Impact, World};

use super::Session;
use crate::picture::{Line, Pane};

/// The most impacts shown at a time.
pub(super) const MOST: usize = 200;
/// Simulated time in which an impact fades, s.
const SHOWN: f64 = 0.5;
/// Tolerance of the time of the picture, in steps.
const NOW: f64 = 1e-6;
pub(super) const ORANGE: [f32; 3] = [1.0, 0.45, 0.05];
/// The length of a normal, in half sizes of the smaller body, and its minimum in distances of the camera.
const LENGTH: f64 = 1.6;
const LEAST_LENGTH: f64 = 0.03;
/// The length of the strongest impulse's arrow, in lengths of its normal.
const STRONGEST: f64 = 0.75;
/// Half the width of an arrow's head, in lengths of the arrow; its length equals its width.
const HEAD: f64 = 0.12;

/// The impacts that have not faded, the oldest first.
#[derive(Default)]
pub(super) struct Impacts(VecDeque<Impact>);

impl Impacts {
    /// Adds the impacts of some steps, and removes those that had faded when the last step of `world` began.
    pub(super) fn extend(&mut self, impacts: &[Impact], world: &World) {
        let now = world.time() - world.settings().dt;
        self.0.extend(impacts.iter().cloned());
        let beyond = self.0.len().saturating_sub(MOST);
        self.0.drain(..beyond);
        self.0.retain(|impact| now - impact.time < SHOWN);
    }
}

impl Session {
    /// Draws each contact point as a dot and its normal as a thin line. On it an arrow, proportional to the impulse,
    /// shows the impulse on the second body, or on the first if the second is immovable. Bodies do not hide them.
    pub(super) fn add_impacts(&self, panes: &mut Vec<Pane>, marks: &mut Vec<Line>) {
        let slack = self.slack();
        let now = self.shown_time() + slack;
        let latest = self.seen_impacts().map(|impact| impact.time);
        let latest = latest.fold(0.0, f64::max) - slack;
        let strongest = self.strongest_impulse().unwrap_or(f64::MIN_POSITIVE);
        let [_, _, backward] = self.camera.axes();
        for impact in self.seen_impacts() {
            let age = (now - impact.time) / SHOWN;
            let fresh = (1.0 - age).clamp(0.0, 1.0).powi(2) as f32;
            // Arrows are drawn for the latest instant alone, because those of a crowd would be confusing.
            if impact.time >= latest && age < 1.0 {
                self.add_touching(impact, 1.0 - age as f32, panes, marks);
            }
            // Arrows are relative to the strongest impulse, otherwise the weak ones of a crowd would hide it.
            let strength = impact.impulse / strongest;
            let width = 1.0 + 2.0 * strength as f32;
            let [red, green, blue] = ORANGE;
            let mut line = |from: DVec3, to: DVec3, width: f32| {
                marks.push(Line {
                    from,
                    to,
                    colour: [red, green, blue, fresh],
                    width,
                });
            };
            let along = self.normal_length(impact) * impact.normal;
            // The impulse on the movable body: if the second is immovable, on the first.
            let along = match self.world.kind(impact.bodies.1).is_movable() {
                true => along,
                false => -along,
            };
            line(impact.point, impact.point + along, 1.0);
            let arrow = STRONGEST * strength * along;
            let tip = impact.point + arrow;
            let aside = HEAD * arrow.length() * along.cross(backward).normalize_or_zero();
            line(impact.point, tip, width);
            line(tip, tip - 2.0 * HEAD * arrow + aside, width);
            line(tip, tip - 2.0 * HEAD * arrow - aside, width);
            line(impact.point, impact.point, 3.0 * width);
        }
    }

    /// The impacts up to the time of the picture.
    fn seen_impacts(&self) -> impl Iterator<Item = &Impact> {
        let now = self.shown_time() + self.slack();
        self.impacts
            .0
            .iter()
            .filter(move |impact| impact.time <= now)
    }

    /// Tolerance of the time of the picture, s.
    fn slack(&self) -> f64 {
        NOW * self.world.settings().dt
    }

    /// The strongest impulse drawn, N s: the lengths of arrows are relative to it.
    pub(super) fn strongest_impulse(&self) -> Option<f64> {
        let drawn = self.seen_impacts().filter(|_| self.display.impacts);
        drawn.map(|impact| impact.impulse).reduce(f64::max)
    }

    fn normal_length(&self, impact: &Impact) -> f64 {
        let (i, j) = impact.bodies;
        let sizes = [i, j]
            .into_iter()
            .filter(|&body| !self.is_half_space(body))
            .map(|body| self.bounds(body).half.max_element());
        let smaller = sizes.reduce(f64::min).unwrap_or_default();
        (LENGTH * smaller).max(LEAST_LENGTH * self.camera.distance)
    }
}
