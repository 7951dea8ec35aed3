//! Scenes with a known final state, and the errors of their runs.

use sim_core::DVec3;

use super::{Engine, Form, Scene, Who};
use crate::hard_cases::Verdict;

/// A scene for each of some speeds, and the engines that must reach its final state.
pub struct Family {
    /// Name in tables and file names.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// The bodies, and the final state.
    pub about: &'static str,
    /// The speeds, m/s.
    pub speeds: &'static [f64],
    /// Makes the scene for a speed.
    pub make: fn(f64) -> Known,
    /// The largest error that passes.
    pub tolerance: f64,
    /// The engines that must pass at every rate; all others must fail.
    pub passed_by: &'static [Who],
}

/// A scene with its final state.
#[derive(Clone, Debug)]
pub struct Known {
    /// Bodies at the start.
    pub scene: Scene,
    /// The duration, s.
    pub duration: f64,
    /// Time of the first impact, s, if it matters.
    pub impact: Option<f64>,
    /// The definition of the error.
    pub goal: Goal,
}

/// The definition of the error.
#[derive(Clone, Debug)]
pub enum Goal {
    /// The distances of bodies from their final positions.
    Places {
        /// Final positions of the movable bodies, m.
        at: Vec<DVec3>,
        /// The length by which errors are divided, m.
        way: f64,
    },
    /// The distance by which contacts are closed ahead of their time, or the depth of overlaps, m.
    Heap,
}

impl Goal {
    /// The description of the error, for axes.
    pub fn unit(&self) -> &'static str {
        match self {
            Goal::Places { way: 1.0, .. } | Goal::Heap => "error, m",
            Goal::Places { .. } => "error of the end, of the way",
        }
    }
}

/// The errors of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Run {
    /// The error, as the goal defines it.
    pub error: f64,
    /// The error of the time of the first impact, s; `None` if there was none.
    pub time: Option<f64>,
    /// Relative change of the energy.
    pub energy: f64,
    /// The greatest rise of the energy in a step, relative to the initial energy.
    pub rise: f64,
    /// The greatest depth of overlap at the end of a step, m.
    pub overlap: f64,
    /// The energy dissipated by bundled contacts, relative to the initial energy; `None` if nothing is bundled.
    pub bundled: Option<f64>,
}

impl Family {
    /// The verdict on a run.
    pub fn verdict(&self, run: &Run) -> Verdict {
        Verdict::of(run.error <= self.tolerance)
    }

    /// The expected verdict.
    pub fn expected(&self, who: Who) -> Verdict {
        Verdict::of(self.passed_by.contains(&who))
    }
}

impl Known {
    /// The same scene at a number of steps per second.
    pub fn at_rate(mut self, rate: u32) -> Known {
        self.scene.dt = 1.0 / f64::from(rate);
        self
    }

    /// Steps to the end.
    pub fn steps(&self) -> u32 {
        (self.duration / self.scene.dt).round() as u32
    }

    /// Steps to the end and measures all errors.
    pub fn run(&self, who: Who) -> Run {
        let mut engine = who.start(&self.scene);
        let engine = engine.as_mut();
        let start = self.energy(engine);
        let (mut now, mut distance, mut taken) = (start, 0.0_f64, None);
        let mut run = Run::default();
        let mut impact = None;
        for _ in 0..self.steps() {
            // The positions of the bodies show the failure of a step.
            let found = engine.step_noting().unwrap_or_default();
            impact = impact.or(found);
            run.overlap = run.overlap.max(self.overlap(engine));
            let after = self.energy(engine);
            run.rise = run.rise.max((after - now) / start);
            now = after;
            if let Some(bundled) = engine.bundled() {
                taken = Some(taken.unwrap_or(0.0) + bundled.energy);
                distance = distance.max(bundled.distance);
            }
        }
        run.error = match &self.goal {
            Goal::Places { at, way } => self.farthest(engine, at) / way,
            Goal::Heap => distance.max(run.overlap),
        };
        let time = impact.zip(self.impact);
        run.time = time.map(|(found, exact)| (found - exact).abs());
        run.energy = (now / start - 1.0).abs();
        run.bundled = taken.map(|taken| taken / start);
        run
    }

    fn energy(&self, engine: &dyn Engine) -> f64 {
        let of = |i: usize| {
            let velocity = engine.velocity(i);
            0.5 * velocity.length_squared() - self.scene.gravity.dot(engine.position(i))
        };
        self.scene.movable().map(of).sum()
    }

    /// The greatest distance of a body from its final position.
    fn farthest(&self, engine: &dyn Engine, places: &[DVec3]) -> f64 {
        let off = self
            .scene
            .movable()
            .zip(places)
            .map(|(i, &place)| (engine.position(i) - place).length());
        off.fold(0.0, f64::max)
    }

    /// The greatest depth of overlap of a body with another one, m; unknown for meshes.
    fn overlap(&self, engine: &dyn Engine) -> f64 {
        let items = &self.scene.items;
        let mut deepest: f64 = 0.0;
        for j in self.scene.movable() {
            let at = engine.position(j);
            for (i, item) in items[..j].iter().enumerate() {
                let offset = at - engine.position(i);
                let depth = match (&item.form, &items[j].form) {
                    (Some(Form::Wall(normal)), Some(Form::Ball(half) | Form::Cube(half))) => {
                        half - normal.dot(at - item.position)
                    }
                    (Some(Form::Ball(one)), Some(Form::Ball(other))) => {
                        one + other - offset.length()
                    }
                    (Some(Form::Cube(one)), Some(Form::Cube(other))) => {
                        (one + other - offset.abs()).min_element()
                    }
                    _ => 0.0,
                };
                deepest = deepest.max(depth);
            }
        }
        deepest
    }
}
