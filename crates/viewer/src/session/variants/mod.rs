//! Variants of a scene that run along with it: other methods, steps and collision modes, and the exact solution if it
//! is known.
//!
//! They begin at the start of the run's record and follow its time on a thread of their own: the session hands out a
//! job ([`VariantJob`]) and accepts its result.

mod presets;
mod runner;

use std::collections::VecDeque;
use std::time::Duration;

use sim_core::{Collision, DQuat, DVec3, Settings, World};

pub use presets::{PRESETS, Preset};
pub use runner::{Halt, Runner, Snapshot};

use super::figures::Drift;
use super::playback;
use super::{STEP_BUDGET, Session};
use crate::errors;
use crate::picture::{Ghost, Line};

/// The most variants beside the run.
pub const MOST_VARIANTS: usize = 12;
/// The most bodies for which the paths of variants are drawn, and the number of states in a path.
const MOST_PATHS: usize = 20;
const LONGEST_PATH: usize = 1200;
/// The distance below which two positions look equal, in half sizes of the body.
const SAME: f64 = 2e-3;
/// Colours that differ clearly from each other and from the light background, sRGB.
const COLOURS: [[f32; 3]; MOST_VARIANTS] = [
    [0.84, 0.37, 0.00],
    [0.00, 0.45, 0.70],
    [0.80, 0.40, 0.70],
    [0.65, 0.55, 0.00],
    [0.30, 0.65, 0.90],
    [0.55, 0.10, 0.15],
    [0.40, 0.30, 0.75],
    [0.90, 0.60, 0.10],
    [0.10, 0.50, 0.50],
    [0.60, 0.40, 0.25],
    [0.95, 0.45, 0.50],
    [0.35, 0.40, 0.10],
];
/// The colour of the exact solution.
const EXACT: [f32; 3] = [0.05, 0.62, 0.35];

/// A way to run the scene, and its results.
#[derive(Debug)]
pub struct Variant {
    /// Its settings; `None` for the exact solution.
    pub settings: Option<Settings>,
    /// Its colour in the picture and in the plots, sRGB.
    pub colour: [f32; 3],
    /// The reason why it has stopped, if it has.
    pub failure: Option<String>,
    /// The drift since the start.
    pub drift: Option<Drift>,
    /// Real time of all its steps, s, and their number.
    pub cost: (f64, u64),
    /// The largest error of a position so far, m.
    pub worst: Option<f64>,
    record: VecDeque<Snapshot>,
    /// `None` while a job has it.
    runner: Option<Runner>,
}

/// All variants.
#[derive(Debug, Default)]
pub struct Variants {
    list: Vec<Variant>,
    under_way: bool,
    /// The number of changes that make results of earlier jobs obsolete.
    pub(super) edition: u64,
}

/// A job: variants that must reach a time.
#[derive(Debug)]
pub struct VariantJob {
    runners: Vec<(usize, Runner)>,
    until: f64,
    edition: u64,
}

/// Its result.
#[derive(Debug)]
pub struct VariantsDone {
    runs: Vec<(usize, Runner, Vec<Snapshot>, Option<Halt>)>,
    edition: u64,
}

impl VariantJob {
    /// Repeatedly steps the variant that is farthest behind, for at most the time of one frame's steps. `stopwatch`
    /// reads real time.
    pub fn run(self, stopwatch: impl Fn() -> Duration) -> VariantsDone {
        let began = stopwatch();
        let mut runs: Vec<_> = self
            .runners
            .into_iter()
            .map(|(n, runner)| (n, runner, Vec::new(), None))
            .collect();
        loop {
            let behind = runs
                .iter_mut()
                .filter(|(_, runner, _, halt)| halt.is_none() && runner.time() < self.until)
                .min_by(|a, b| a.1.time().total_cmp(&b.1.time()));
            let Some((_, runner, snapshots, halt)) = behind else {
                break;
            };
            match runner.step(&stopwatch) {
                Ok(snapshot) => snapshots.push(snapshot),
                Err(why) => *halt = Some(why),
            }
            if stopwatch().saturating_sub(began) > STEP_BUDGET {
                break;
            }
        }
        VariantsDone {
            runs,
            edition: self.edition,
        }
    }
}

impl Variant {
    fn new(world: &World, settings: Option<Settings>, colour: [f32; 3]) -> Option<Self> {
        let runner = match settings {
            Some(settings) => Runner::stepping(world, settings).ok(),
            None => Runner::exact(world),
        };
        let mut variant = Self {
            settings,
            colour,
            failure: None,
            drift: None,
            cost: (0.0, 0),
            worst: None,
            record: VecDeque::new(),
            runner: Some(runner?),
        };
        variant.begin();
        Some(variant)
    }

    /// Records its initial state.
    fn begin(&mut self) {
        let first = self.runner.as_mut().map(|runner| runner.snapshot(None, 0));
        self.record.extend(first);
    }

    /// The recorded states, the oldest first.
    pub fn record(&self) -> impl ExactSizeIterator<Item = &Snapshot> {
        self.record.iter()
    }

    /// The positions of its bodies in each recorded state, m.
    #[cfg(test)]
    pub(super) fn last_places(&self) -> &[DVec3] {
        self.record.back().map_or(&[], |last| &last.places)
    }

    /// Simulated time reached, s.
    pub fn time(&self) -> f64 {
        self.record.back().map_or(0.0, |last| last.sample.time)
    }

    /// Real time per simulated second, s, once it is known.
    pub fn load(&self) -> Option<f64> {
        let (seconds, steps) = self.cost;
        let dt = self.settings?.dt;
        (steps > 0).then(|| seconds / (steps as f64 * dt))
    }

    fn take_in(&mut self, snapshots: Vec<Snapshot>) {
        for snapshot in snapshots {
            let sample = &snapshot.sample;
            if let Some(cost) = sample.cost {
                self.cost = (self.cost.0 + cost, self.cost.1 + 1);
            }
            self.worst = match (self.worst, sample.error) {
                (Some(worst), Some(error)) => Some(worst.max(error)),
                (worst, error) => worst.or(error),
            };
            self.record.push_back(snapshot);
        }
        let bodies = self.record.back().map_or(0, |last| last.places.len());
        let beyond = self.record.len().saturating_sub(playback::capacity(bodies));
        self.record.drain(..beyond);
    }

    /// The positions of its bodies at a time, s, and their rotations if any is a turning body: interpolated between the
    /// states before and after. If it has not come so far, the present ones.
    fn poses(&self, time: f64) -> Option<(Vec<DVec3>, Vec<DQuat>)> {
        let whole = |s: &Snapshot| (s.places.to_vec(), s.rotations.to_vec());
        let after = self.record.partition_point(|s| s.sample.time < time);
        let next = match self.record.get(after) {
            Some(next) => next,
            None => return Some(whole(self.record.back()?)),
        };
        let Some(last) = after.checked_sub(1).map(|n| &self.record[n]) else {
            return Some(whole(next));
        };
        let part = (time - last.sample.time) / (next.sample.time - last.sample.time);
        let part = part.clamp(0.0, 1.0);
        let places = last.places.iter().zip(&next.places);
        let rotations = last.rotations.iter().zip(&next.rotations);
        Some((
            places.map(|(a, b)| a.lerp(*b, part)).collect(),
            rotations.map(|(a, b)| a.slerp(*b, part)).collect(),
        ))
    }
}

impl Variants {
    /// All variants, the exact solution last.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Variant> {
        self.list.iter()
    }

    /// Whether there are no variants.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Restarts every variant from the present state of a world.
    pub(super) fn begin(&mut self, world: &World) {
        self.disown();
        let settings: Vec<Settings> = self.list.iter().filter_map(|v| v.settings).collect();
        self.list.clear();
        for (settings, colour) in settings.into_iter().zip(COLOURS) {
            self.list
                .extend(Variant::new(world, Some(settings), colour));
        }
        if !self.list.is_empty() {
            self.list.extend(Variant::new(world, None, EXACT));
        }
    }

    fn disown(&mut self) {
        self.edition += 1;
        self.under_way = false;
    }

    /// Whether a variant has not reached a time, s.
    fn is_behind(&self, time: f64) -> bool {
        let behind = |v: &Variant| v.failure.is_none() && v.time() < time;
        self.list.iter().any(behind)
    }
}

impl Session {
    /// The variants of the run.
    pub fn variants(&self) -> &Variants {
        &self.variants
    }

    /// Runs exactly these variants along with the scene, from the start of its record. Duplicates, and the settings of
    /// the run itself, are left out.
    pub fn compare_with(&mut self, settings: impl IntoIterator<Item = Settings>) {
        let mut kept: Vec<Settings> = Vec::new();
        for settings in settings {
            if settings != *self.world.settings() && !kept.contains(&settings) {
                kept.push(settings);
            }
        }
        kept.truncate(MOST_VARIANTS);
        let world = match self.playback.first() {
            Some(first) => first.clone(),
            None => self.world.clone(),
        };
        self.variants.disown();
        self.variants.list = kept
            .into_iter()
            .zip(COLOURS)
            .filter_map(|(settings, colour)| Variant::new(&world, Some(settings), colour))
            .collect();
        if !self.variants.list.is_empty() {
            let exact = Variant::new(&world, None, EXACT);
            self.variants.list.extend(exact);
        }
    }

    /// The settings compared now, without the run's own.
    pub fn compared(&self) -> Vec<Settings> {
        self.variants.iter().filter_map(|v| v.settings).collect()
    }

    /// The job that variants need, if any.
    pub fn variants_due(&mut self) -> Option<VariantJob> {
        let until = self.world.time();
        if self.variants.under_way || !self.variants.is_behind(until) {
            return None;
        }
        self.variants.under_way = true;
        let list = self.variants.list.iter_mut().enumerate();
        let runners = list.filter(|(_, variant)| variant.failure.is_none());
        let runners = runners.filter_map(|(n, variant)| Some((n, variant.runner.take()?)));
        Some(VariantJob {
            runners: runners.collect(),
            until,
            edition: self.variants.edition,
        })
    }

    /// Accepts the result of a job; variants restarted since are not changed.
    pub fn accept_variants(&mut self, done: VariantsDone) {
        if done.edition != self.variants.edition {
            return;
        }
        self.variants.under_way = false;
        for (n, runner, snapshots, halt) in done.runs {
            let Some(variant) = self.variants.list.get_mut(n) else {
                continue;
            };
            if variant.settings.is_some() {
                variant.drift = Some(runner.drift());
            }
            variant.take_in(snapshots);
            variant.failure = halt.map(|halt| match halt {
                Halt::Step(error) => errors::step_error(&self.scene, &error),
                Halt::Unknown => "not known from here on".to_owned(),
            });
            variant.runner = Some(runner);
        }
    }

    /// Discards the steps under way and all variants.
    pub fn drop_variants(&mut self) {
        self.variants.disown();
        self.variants.list.clear();
    }

    /// Whether variants are behind the run.
    pub fn awaits_variants(&self) -> bool {
        self.variants.under_way || self.variants.is_behind(self.world.time())
    }

    /// Short names of the run and of the variants: only the settings in which they differ.
    pub fn variant_names(&self) -> (String, Vec<String>) {
        let own = *self.world.settings();
        let all: Vec<Settings> = std::iter::once(own).chain(self.compared()).collect();
        let differs = |same: fn(&Settings, &Settings) -> bool| all.iter().any(|s| !same(s, &own));
        let parts = Parts {
            method: differs(|a, b| a.method == b.method),
            dt: differs(|a, b| a.dt == b.dt),
            collision: differs(|a, b| a.collision == b.collision),
            tolerance: differs(|a, b| a.tolerance == b.tolerance),
        };
        let names = self.variants.iter().map(|variant| match &variant.settings {
            Some(settings) => name(settings, parts),
            None => "Exact".to_owned(),
        });
        (name(&own, parts), names.collect())
    }

    /// Draws the bodies of each variant, translucent and in its colour, and their paths.
    pub(super) fn add_ghosts(&mut self, ghosts: &mut Vec<Ghost>, lines: &mut Vec<Line>) {
        let time = self.shown_time();
        let moves: Vec<bool> = (0..self.world.len()).map(|i| !self.is_static(i)).collect();
        let mut taken: Vec<Vec<(DVec3, DQuat)>> = vec![Vec::new(); moves.len()];
        for n in 0..self.variants.list.len() {
            let variant = &self.variants.list[n];
            let colour = variant.colour;
            let Some((places, rotations)) = variant.poses(time) else {
                continue;
            };
            if places.len() != moves.len() {
                continue;
            }
            for (i, place) in places.iter().enumerate().filter(|&(i, _)| moves[i]) {
                // A ghost that coincides with the body or with another ghost would only tint it.
                let same = SAME * self.bounds(i).half.max_element();
                let rotation = rotations.get(i).copied().unwrap_or_default();
                let known = [(self.shown_position(i), self.shown_rotation(i))];
                let mut known = known.into_iter().chain(taken[i].iter().copied());
                if known.any(|(at, turned)| {
                    at.distance(*place) <= same && turned.angle_between(rotation) <= SAME
                }) {
                    continue;
                }
                taken[i].push((*place, rotation));
                match self.body_mesh(i) {
                    Some(mesh) => ghosts.push(Ghost {
                        mesh,
                        position: *place,
                        rotation,
                        colour,
                    }),
                    None if !self.is_half_space(i) => lines.push(Line {
                        from: *place,
                        to: *place,
                        colour: [colour[0], colour[1], colour[2], 0.8],
                        width: 8.0,
                    }),
                    None => {}
                }
            }
            let [red, green, blue] = colour;
            let variant = &self.variants.list[n];
            let past = variant.record.partition_point(|s| s.sample.time <= time);
            let long = LONGEST_PATH.min(past);
            let points = variant.record.range(past - long..past);
            for (i, _) in moves.iter().enumerate().filter(|&(_, &moves)| moves) {
                if moves.len() > MOST_PATHS {
                    break;
                }
                let ends = points.clone().map(|s| s.places[i]).chain([places[i]]);
                for (from, to) in ends.clone().zip(ends.skip(1)) {
                    if from != to {
                        lines.push(Line {
                            from,
                            to,
                            colour: [red, green, blue, 0.75],
                            width: 1.6,
                        });
                    }
                }
            }
        }
    }
}

/// The parts of the settings that a name contains.
#[derive(Clone, Copy)]
struct Parts {
    method: bool,
    dt: bool,
    collision: bool,
    tolerance: bool,
}

fn name(settings: &Settings, parts: Parts) -> String {
    let mut words = Vec::new();
    let nothing = !(parts.dt || parts.collision || parts.tolerance);
    if parts.method || nothing {
        words.push(settings.method.title.to_owned());
    }
    if parts.dt {
        words.push(rate_text(settings.dt));
    }
    if parts.collision {
        words.push(collision_text(settings.collision).to_owned());
    }
    if parts.tolerance {
        words.push(format!("{:e}", settings.tolerance));
    }
    words.join(", ")
}

/// The full name of settings for tables: method, rate, collision mode.
pub fn full_name(settings: &Settings) -> String {
    let collision = match settings.collision {
        Collision::Naive => "naive",
        Collision::Bvh => "bvh",
        Collision::Continuous => "continuous",
    };
    let rate = rate_text(settings.dt);
    let mut text = format!("{} {rate} {collision}", settings.method.name);
    if settings.method.adaptive {
        text += &format!(" {:e}", settings.tolerance);
    }
    text
}

/// Steps per simulated second, with as many digits as identify it.
fn rate_text(dt: f64) -> String {
    let rate = 1.0 / dt;
    let digits = 10_f64.powf(5.0 - rate.log10().floor());
    format!("{} Hz", (rate * digits).round() / digits)
}

fn collision_text(collision: Collision) -> &'static str {
    match collision {
        Collision::Naive => "naive",
        Collision::Bvh => "BVH",
        Collision::Continuous => "continuous",
    }
}
