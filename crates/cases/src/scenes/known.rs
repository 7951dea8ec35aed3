//! Scenes whose end is known, and what a run of one has got wrong.

use sim_core::DVec3;

use super::{Engine, Form, Scene, Who};
use crate::hard_cases::Verdict;

/// A scene for each of some speeds, with who must come to its end.
pub struct Family {
    /// Name in tables and file names.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// Bodies, and the end.
    pub about: &'static str,
    /// Speeds that it is made for, m/s.
    pub speeds: &'static [f64],
    /// Makes it for a speed.
    pub make: fn(f64) -> Known,
    /// The largest error that passes.
    pub tolerance: f64,
    /// Who must pass, at every rate; all others must not.
    pub passed_by: &'static [Who],
}

/// A scene with its end.
#[derive(Clone, Debug)]
pub struct Known {
    /// Bodies at the start.
    pub scene: Scene,
    /// s
    pub duration: f64,
    /// Time of the first impact, s, where that matters.
    pub impact: Option<f64>,
    /// What counts as the error.
    pub goal: Goal,
}

/// What counts as the error.
#[derive(Clone, Debug)]
pub enum Goal {
    /// How far bodies are from where they should end.
    Places {
        /// Ends of what may move, m.
        at: Vec<DVec3>,
        /// What errors are divided by, m.
        way: f64,
    },
    /// How far contacts are closed ahead of their time, or bodies are in each other, m.
    Heap,
}

impl Goal {
    /// What the error is, for axes.
    pub fn unit(&self) -> &'static str {
        match self {
            Goal::Places { way: 1.0, .. } | Goal::Heap => "error, m",
            Goal::Places { .. } => "error of the end, of the way",
        }
    }
}

/// What a run has got wrong.
#[derive(Clone, Copy, Debug, Default)]
pub struct Run {
    /// As the goal has it.
    pub error: f64,
    /// Of the first impact, s; `None` if there was none.
    pub time: Option<f64>,
    /// Relative change of the energy.
    pub energy: f64,
    /// The most that the energy has risen in a step, of that at the start.
    pub rise: f64,
    /// How deep bodies have been in each other at the end of a step, m.
    pub overlap: f64,
    /// Energy that bundled contacts have taken, of that at the start; `None` where nothing is bundled.
    pub bundled: Option<f64>,
}

impl Family {
    /// What a run comes to.
    pub fn verdict(&self, run: &Run) -> Verdict {
        Verdict::of(run.error <= self.tolerance)
    }

    /// What it must come to.
    pub fn expected(&self, who: Who) -> Verdict {
        Verdict::of(self.passed_by.contains(&who))
    }
}

impl Known {
    /// The same in so many steps a second.
    pub fn at_rate(mut self, rate: u32) -> Known {
        self.scene.dt = 1.0 / f64::from(rate);
        self
    }

    /// Steps to the end.
    pub fn steps(&self) -> u32 {
        (self.duration / self.scene.dt).round() as u32
    }

    /// Steps to the end and looks at all of it.
    pub fn run(&self, who: Who) -> Run {
        let mut engine = who.start(&self.scene);
        let engine = engine.as_mut();
        let start = self.energy(engine);
        let (mut now, mut distance, mut taken) = (start, 0.0_f64, None);
        let mut run = Run::default();
        let mut impact = None;
        for _ in 0..self.steps() {
            // What fails is told by where it leaves the bodies.
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

    /// How far the worst body is from its place.
    fn farthest(&self, engine: &dyn Engine, places: &[DVec3]) -> f64 {
        let off = self
            .scene
            .movable()
            .zip(places)
            .map(|(i, &place)| (engine.position(i) - place).length());
        off.fold(0.0, f64::max)
    }

    /// How deep the worst body is in another one, m; of meshes this is not known.
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
