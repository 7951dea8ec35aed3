//! Where bodies have been of late: a fading path behind each.

use std::collections::VecDeque;

use sim_core::{DVec3, World};

use super::Session;
use crate::picture::Line;

/// Simulated time that a path goes back at least, s, and its points: each is of a step, or where steps are
/// short, of the last one of several.
const TIME: f64 = 10.0;
const LONGEST: usize = 600;
/// Points of all paths together.
const MOST_POINTS: usize = 60_000;

/// The latest positions of all bodies, step by step.
#[derive(Clone, Debug, Default)]
pub(super) struct Trails {
    bodies: usize,
    /// Columns of positions, the latest last.
    points: VecDeque<DVec3>,
    /// Steps from one column to the next.
    stride: u64,
    /// Steps since the start.
    steps: u64,
}

impl Trails {
    /// Begins afresh where the bodies of a world are.
    pub(super) fn begin(&mut self, world: &World) {
        (self.bodies, self.points) = (world.len(), positions(world).collect());
        self.pace(world.settings().dt);
    }

    /// Notes from the latest column on steps of another length, s.
    pub(super) fn pace(&mut self, dt: f64) {
        let stride = TIME / (LONGEST as f64 * dt);
        (self.stride, self.steps) = ((stride.round() as u64).max(1), 0);
    }

    /// Takes in the positions after some steps, and forgets those of long ago.
    pub(super) fn extend(&mut self, positions: &[DVec3]) {
        for column in positions.chunks_exact(self.bodies.max(1)) {
            // What is between two columns that stay gives way to the latest.
            if !self.steps.is_multiple_of(self.stride.max(1)) {
                self.points.truncate(self.points.len() - self.bodies);
            }
            self.steps += 1;
            self.points.extend(column);
        }
        let kept = self.bodies * LONGEST.min(MOST_POINTS / self.bodies.max(1));
        self.points.drain(..self.points.len().saturating_sub(kept));
    }

    /// Where a body was, the oldest position first.
    fn of(&self, body: usize) -> impl ExactSizeIterator<Item = DVec3> {
        let points = self.points.iter().copied();
        points.skip(body).step_by(self.bodies.max(1))
    }

    /// Points kept.
    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }
}

/// Where the bodies of a world are.
pub(super) fn positions(world: &World) -> impl Iterator<Item = DVec3> {
    (0..world.len()).map(|i| world.position(i))
}

impl Session {
    /// Shows or hides the paths; shown, they begin here.
    pub fn show_trails(&mut self, shown: bool) {
        self.display.trails = shown;
        self.trails = Trails::default();
        if shown {
            self.trails.begin(&self.world);
        }
    }

    /// The path of a body, to where it is drawn.
    pub(super) fn add_trail(&self, i: usize, lines: &mut Vec<Line>) {
        let points = self.trails.of(i);
        // The last point is yet to come where bodies are drawn between two states.
        let whole = points.len() - usize::from(self.is_between()).min(points.len());
        let [red, green, blue] = self.colour(i).map(|part| 0.8 * part);
        let end = self.shown_centre(i);
        let mut from = None;
        let passed = self.passed_places(i);
        for (n, to) in points.take(whole).chain(passed).chain([end]).enumerate() {
            // The oldest part stays in sight.
            let age = 0.3 + 0.7 * (n as f32 / whole.max(1) as f32).min(1.0);
            if let Some(from) = from.filter(|&from| from != to) {
                lines.push(Line {
                    from,
                    to,
                    colour: [red, green, blue, 0.9 * age],
                    width: 2.0,
                });
            }
            from = Some(to);
        }
    }
}
