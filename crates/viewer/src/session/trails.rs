//! The recent paths of bodies, which fade with age.

use std::collections::VecDeque;

use sim_core::{DVec3, World};

use super::Session;
use crate::picture::Line;

/// The least simulated time of a path, s, and the number of its points. A point is recorded after each step or, if
/// steps are short, after every few steps.
const TIME: f64 = 10.0;
const LONGEST: usize = 600;
/// The most points of all paths together.
const MOST_POINTS: usize = 60_000;

/// The latest positions of all bodies, recorded at regular numbers of steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Trails {
    bodies: usize,
    /// Columns of positions, the latest last.
    points: VecDeque<DVec3>,
    /// The number of steps between two columns.
    stride: u64,
    /// Steps since the start.
    steps: u64,
}

impl Trails {
    /// Restarts at the present positions of a world.
    pub(super) fn begin(&mut self, world: &World) {
        (self.bodies, self.points) = (world.len(), positions(world).collect());
        self.pace(world.settings().dt);
    }

    /// Adapts to steps of another length, s, from the latest column on.
    pub(super) fn pace(&mut self, dt: f64) {
        let stride = TIME / (LONGEST as f64 * dt);
        (self.stride, self.steps) = ((stride.round() as u64).max(1), 0);
    }

    /// Adds the positions after some steps, and removes the oldest.
    pub(super) fn extend(&mut self, positions: &[DVec3]) {
        for column in positions.chunks_exact(self.bodies.max(1)) {
            // Between two regular columns, the latest column is replaced.
            if !self.steps.is_multiple_of(self.stride.max(1)) {
                self.points.truncate(self.points.len() - self.bodies);
            }
            self.steps += 1;
            self.points.extend(column);
        }
        let kept = self.bodies * LONGEST.min(MOST_POINTS / self.bodies.max(1));
        self.points.drain(..self.points.len().saturating_sub(kept));
    }

    /// The positions of a body, the oldest first.
    fn of(&self, body: usize) -> impl ExactSizeIterator<Item = DVec3> {
        let points = self.points.iter().copied();
        points.skip(body).step_by(self.bodies.max(1))
    }

    /// The number of points.
    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }
}

/// The positions of the bodies of a world.
pub(super) fn positions(world: &World) -> impl Iterator<Item = DVec3> {
    (0..world.len()).map(|i| world.position(i))
}

impl Session {
    /// Shows or hides the paths. They begin when they are shown.
    pub fn show_trails(&mut self, shown: bool) {
        self.display.trails = shown;
        self.trails = Trails::default();
        if shown {
            self.trails.begin(&self.world);
        }
    }

    /// Draws the path of a body up to its drawn position.
    pub(super) fn add_trail(&self, i: usize, lines: &mut Vec<Line>) {
        let points = self.trails.of(i);
        // Between two states, the last point lies in the future of the picture.
        let whole = points.len() - usize::from(self.is_between()).min(points.len());
        let [red, green, blue] = self.colour(i).map(|part| 0.8 * part);
        let end = self.shown_centre(i);
        let mut from = None;
        let passed = self.passed_places(i);
        for (n, to) in points.take(whole).chain(passed).chain([end]).enumerate() {
            // The oldest part remains visible.
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
