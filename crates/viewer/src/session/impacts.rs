//! Impacts of late: where, along which normal, how strong.

use std::collections::VecDeque;

use sim_core::{DVec3, Impact};

use super::Session;
use crate::picture::{Arrow, Line, Picture};

/// The most that are shown at a time.
pub(super) const MOST: usize = 200;
/// Simulated time in which an impact fades, s.
const SHOWN: f64 = 0.5;
const ORANGE: [f32; 3] = [1.0, 0.45, 0.05];
/// Length of the strongest impulse's arrow and of all normals: in half sizes of the smaller body,
/// and at least in distances of the camera.
const LENGTH: f64 = 0.8;
const LEAST_LENGTH: f64 = 0.02;

/// The impacts that have not faded, the oldest first.
#[derive(Default)]
pub(super) struct Impacts(VecDeque<Impact>);

impl Impacts {
    /// Takes in those of some steps, and forgets what has faded by `now`, s.
    pub(super) fn extend(&mut self, impacts: Vec<Impact>, now: f64) {
        self.0.extend(impacts);
        let beyond = self.0.len().saturating_sub(MOST);
        self.0.drain(..beyond);
        self.0.retain(|impact| now - impact.time < SHOWN);
    }
}

impl Session {
    /// Each point as a dot, its normal as a line, and on it the impulse on the second body as an
    /// arrow, as long as it is strong.
    pub(super) fn add_impacts(&self, picture: &mut Picture) {
        let impacts = &self.impacts.0;
        let strongest = impacts.iter().map(|impact| impact.impulse);
        let strongest = strongest.fold(f64::MIN_POSITIVE, f64::max);
        for impact in impacts {
            let age = (self.world.time() - impact.time) / SHOWN;
            let fresh = (1.0 - age).clamp(0.0, 1.0) as f32;
            let [red, green, blue] = ORANGE;
            let line = |from: DVec3, to: DVec3, width: f32| Line {
                from,
                to,
                colour: [red, green, blue, fresh],
                width,
            };
            let length = self.normal_length(impact);
            let (point, end) = (impact.point, impact.point + length * impact.normal);
            picture.lines.push(line(point, point, 4.0 + 6.0 * fresh));
            picture.lines.push(line(point, end, 1.5));
            picture.arrows.push(Arrow {
                from: point,
                to: point.lerp(end, impact.impulse / strongest),
                colour: ORANGE,
                // Arrows are opaque, so that they fade by growing thin.
                radius: fresh * (0.035 * length) as f32,
            });
        }
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
