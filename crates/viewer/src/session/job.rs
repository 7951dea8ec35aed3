//! Steps as jobs that can run on any thread.
//!
//! A step through hierarchies takes microseconds, but a naive one of two detailed meshes can take seconds. So a session
//! does not step its world itself: it hands out a copy of the world and the number of steps due, and accepts the result
//! later. A reset or edit in the meantime makes the result obsolete. The meshes are shared, so the copy is small.

use std::time::Duration;

use sim_core::{Collision, DVec3, Profile, StepError, World};

use super::instant::{Passes, SAME};
use super::playback::Moment;
use super::{
    Exact, Impacts, MAX_RATE, MIN_RATE, Remedy, Sample, Session, State, Trails, impacts, missed,
    trails,
};
use crate::stopwatch::nanoseconds;
use crate::{errors, number};

/// The real time that the steps of one frame may take; the rest of them is then dropped. It leaves half of a 60 Hz
/// frame for drawing.
pub const STEP_BUDGET: Duration = Duration::from_millis(8);

/// A world and the number of steps to take.
#[derive(Debug)]
pub struct Job {
    world: World,
    exact: Exact,
    steps: u32,
    /// Whether positions are recorded after each step.
    traced: bool,
    /// Whether steps are timed by phase.
    profiled: bool,
    edition: u64,
}

/// The result: a world that has taken steps.
#[derive(Debug)]
pub struct Done {
    world: World,
    exact: Exact,
    due: u32,
    taken: u32,
    time: Duration,
    error: Option<StepError>,
    trace: Vec<DVec3>,
    moments: Vec<Moment>,
    edition: u64,
}

impl Job {
    /// Takes the steps, as many as fit into [`STEP_BUDGET`] and at least one. `stopwatch` reads real time; the time to
    /// record a step does not count as its cost.
    pub fn run(mut self, stopwatch: impl Fn() -> Duration) -> Done {
        let began = stopwatch();
        let (mut taken, mut time, mut error) = (0, Duration::ZERO, None);
        let (mut trace, mut moments) = (Vec::new(), Vec::new());
        while taken < self.steps && (taken == 0 || stopwatch().saturating_sub(began) <= STEP_BUDGET)
        {
            let mut impacts = Vec::new();
            let before = stopwatch();
            let mut profile = self.profiled.then(Profile::default);
            error = match &mut profile {
                Some(profile) => self.world.step_profiled(&mut impacts, nanoseconds, profile),
                None => self.world.step_reporting(&mut impacts),
            }
            .err();
            let cost = stopwatch().saturating_sub(before);
            if error.is_some() {
                break;
            }
            taken += 1;
            time += cost;
            let count = impacts.len() as u64;
            let missed = missed::missed(&mut self.world, &impacts);
            impacts.drain(..impacts.len().saturating_sub(impacts::MOST));
            let error = self.exact.error(&self.world);
            let cost = Some(cost.as_secs_f64());
            moments.push(Moment {
                sample: Sample::of(&self.world, error, cost, count).with_profile(profile),
                hash: self.world.state_hash(),
                world: self.world.clone(),
                impacts,
                missed,
            });
            if self.traced {
                trace.extend(trails::positions(&self.world));
            }
        }
        Done {
            world: self.world,
            exact: self.exact,
            due: self.steps,
            taken,
            time,
            error,
            trace,
            moments,
            edition: self.edition,
        }
    }
}

impl Session {
    /// Advances real time by `elapsed` and returns the steps that are due, if any. While earlier steps are still under
    /// way, the time is dropped and counted, and never made up.
    pub fn due(&mut self, elapsed: Duration) -> Option<Job> {
        let steps = match self.state {
            State::Running if self.under_way => {
                self.figures.frame.add(elapsed);
                self.figures.fell_behind(elapsed);
                0
            }
            State::Running => {
                self.figures.frame.add(elapsed);
                let dropped = self.clock.advance(elapsed.mul_f64(self.speed));
                self.figures.fell_behind(dropped.div_f64(self.speed));
                let mut steps = 0;
                while self.clock.take() {
                    steps += 1;
                }
                if steps == 0 {
                    self.figures.steps_per_frame = 0;
                }
                steps.min(self.steps_to_the_end())
            }
            State::Paused if !self.under_way => std::mem::take(&mut self.steps_wanted),
            State::Paused | State::Layout => 0,
        };
        let steps = match steps {
            0 => 0,
            // Inputs apply between steps.
            due => u64::from(due).min(self.replay_inputs()) as u32,
        };
        (steps > 0).then(|| {
            self.under_way = true;
            // The copy is only drawn, so it can lack the cached data of the world.
            let copy = self.world.clone();
            Job {
                world: std::mem::replace(&mut self.world, copy),
                exact: self.exact.clone(),
                steps,
                traced: self.display.trails,
                profiled: self.profiled,
                edition: self.edition,
            }
        })
    }

    /// Accepts the result of a job; a result from before a reset, a pause or an edit is ignored. A failed step pauses
    /// the session, shows a message and selects the body where it happened.
    pub fn accept(&mut self, done: Done) {
        if !self.under_way || done.edition != self.edition {
            return;
        }
        self.under_way = false;
        let left = self.time_left();
        self.world = done.world;
        self.exact = done.exact;
        if done.taken > 0 {
            self.figures.cost.add(done.time / done.taken);
        }
        self.figures.steps_per_frame = done.taken;
        if self.display.trails {
            self.trails.extend(&done.trace);
        }
        for moment in &done.moments {
            self.impacts.extend(&moment.impacts, &self.world);
        }
        self.tell_missed(&done.moments);
        self.record_moments(&done.moments);
        if let Some(last) = done.moments.last() {
            self.passes = Passes::of(&self.world, &last.impacts);
        }
        self.playback.extend(done.moments);
        match done.error {
            None if self.state == State::Running => {
                let left = f64::from(done.due - done.taken) * self.clock.dt() / self.speed;
                self.figures
                    .fell_behind(Duration::try_from_secs_f64(left).unwrap_or_default());
            }
            None => {}
            Some(error) => {
                self.pause();
                self.select(Some(error.body()));
                self.notices
                    .error("step", errors::step_error(&self.scene, &error));
                if let Some(rate) = stable_rate(&error) {
                    self.notices.offer("step", Remedy::Rate(rate));
                }
            }
        }
        self.hold_at_the_end(left);
    }

    /// The number of steps until the demonstration is over, at least one. Unlimited if it has no end or is over
    /// already.
    fn steps_to_the_end(&self) -> u32 {
        let left = self.time_left().map(|left| left / self.world.settings().dt);
        left.map_or(u32::MAX, |steps| (steps.ceil() as u32).max(1))
    }

    /// Simulated time until the demonstration is over, s, if that is in the future.
    fn time_left(&self) -> Option<f64> {
        let slack = SAME * self.world.settings().dt;
        let left = self.scene.ends? - self.world.time();
        (left > slack).then_some(left)
    }

    /// Pauses once when the demonstration is over.
    fn hold_at_the_end(&mut self, came_from: Option<f64>) {
        if let (Some(_), None, Some(ends)) = (came_from, self.time_left(), self.scene.ends)
            && self.state == State::Running
        {
            self.pause();
            self.instant = None;
            let text = format!("The scene ends here, at {ends} s. Space goes on, R goes back.");
            self.notices.info("end", text);
        }
    }

    /// Shows a message about impacts that steps have missed, and how to detect them.
    fn tell_missed(&mut self, moments: &[Moment]) {
        let Some(last) = moments.iter().flat_map(|moment| &moment.missed).last() else {
            return;
        };
        let count = moments
            .iter()
            .map(|moment| moment.missed.len())
            .sum::<usize>()
            + self.playback.missed_times().count();
        let bodies = &self.scene.bodies;
        let mut text = last.text(|i| bodies.get(i).map_or_else(String::new, |b| b.name.clone()));
        if count > 1 {
            text += &format!(" Passes so far: {}.", number::count(count as f64));
        }
        self.notices.error("missed", text);
        let remedy = Remedy::Collision(Collision::Continuous);
        self.notices.offer("missed", remedy);
    }

    /// Pauses at a kept state.
    pub fn go_to(&mut self, index: usize) {
        self.pause();
        self.disown_jobs();
        let Some(moment) = self.playback.go_to(index) else {
            return;
        };
        self.world = moment.world.clone();
        self.passes = Passes::of(&self.world, &moment.impacts);
        self.impacts = Impacts::default();
        for moment in self.playback.past() {
            self.impacts.extend(&moment.impacts, &self.world);
        }
        if self.display.trails {
            self.trails = Trails::default();
            for (n, moment) in self.playback.past().enumerate() {
                match n {
                    0 => self.trails.begin(&moment.world),
                    _ => {
                        let positions: Vec<DVec3> = trails::positions(&moment.world).collect();
                        self.trails.extend(&positions);
                    }
                }
            }
        }
    }

    /// Pauses and goes to the previous state, if it is kept.
    pub fn step_back(&mut self) {
        if self.state != State::Layout {
            self.go_to(self.playback.now().saturating_sub(1));
        }
    }

    /// Whether steps are under way or due.
    pub fn awaits_steps(&self) -> bool {
        self.under_way || self.steps_wanted > 0
    }

    /// Makes the results of all earlier jobs obsolete.
    pub(super) fn disown_jobs(&mut self) {
        self.edition += 1;
        self.under_way = false;
        self.steps_wanted = 0;
        self.instant = None;
    }
}

/// The least whole rate, Hz, of two digits at which the method is stable, if it is in the allowed range.
fn stable_rate(error: &StepError) -> Option<f64> {
    let dt = match *error {
        StepError::Unstable { stable_dt, .. } => stable_dt,
        StepError::OutOfRange { stable_dt, .. } => stable_dt?,
        _ => return None,
    };
    let least = 1.0 / dt;
    let digit = 10_f64.powf(least.log10().floor() - 1.0).max(1.0);
    // A rate that equals the limit up to rounding is not rounded up.
    let rate = (least * (1.0 - 1e-9) / digit).ceil() * digit;
    (MIN_RATE..=MAX_RATE).contains(&rate).then_some(rate)
}
