//! A session: a user sets up a scene, runs it, looks at it and resets it.
//!
//! A session has two objects that must not be confused: the **scene** as it was set up, which is saved and to which a
//! reset returns, and the **world** that runs. In the layout state every edit changes the set-up, and the world follows
//! it. Once physics has begun, edits change only the world. The settings of the simulation (method, rate, collision
//! test) belong to the user rather than to the bodies and survive a reset.
//!
//! This module neither draws nor opens windows nor reads a clock. See `picture` for what is drawn, and [`Session::due`]
//! for how time is passed in and steps are taken.

mod arrows;
mod axes;
mod ball;
mod charts;
mod compare;
mod descent;
mod edit;
mod exact;
mod figures;
mod files;
mod forces;
mod framing;
mod history;
mod impacts;
mod instant;
mod job;
mod missed;
mod notice;
mod opening;
mod overlaps;
mod pick;
mod picture;
mod playback;
mod pull;
mod record;
mod sample;
mod shooting;
#[cfg(test)]
mod tests;
mod ties;
mod touching;
mod tour;
mod trails;
mod variants;
mod view;
mod walls;

use std::time::Duration;

use scene::{Scene, SceneBody};
use sim_core::{Collision, FixedStep, Method, Settings, World};

pub use arrows::Scale;
pub use axes::AxisMarks;
use ball::Balls;
pub use charts::{CHARTS, Chart, Curve, RUN, on_dark};
pub use compare::{Compare, Comparison, Contest, Cost, Trial, Tried};
pub use descent::{Level, Pair, descent, pairs};
pub use exact::Exact;
pub use figures::{Drift, Figures, Reference};
pub use history::Leaving;
use impacts::Impacts;
pub use job::{Done, Job, STEP_BUDGET};
pub use missed::Missed;
pub use notice::{Notice, Notices, Remedy};
use opening::Opening;
pub use opening::Outlook;
use overlaps::Overlaps;
pub use picture::{BvhView, Display};
pub use playback::Playback;
pub use record::{
    Divergence, Input, InputError, MOST_STEPS as MOST_RECORDED, Record, RecordError, Replay,
    ReplayError, Verdict, is_run_file, verify,
};
pub use sample::{COLUMNS, Column, Sample, csv_head, csv_line, turns};
pub use shooting::{Reel, Shooting, TICKS};
pub use touching::Part;
pub use tour::{Attempt, BEYOND, LABS, Lab, Stop, stop, stop_count};
use trails::Trails;
pub use variants::{
    Halt, MOST_VARIANTS, PRESETS, Preset, Runner, Snapshot, Variant, VariantJob, Variants,
    VariantsDone, full_name,
};
pub use view::{OutOfView, Side};

use crate::camera::Camera;

/// Slowest rate offered, in steps per second of simulated time.
pub const MIN_RATE: f64 = 1.0;
/// Fastest rate offered, in steps per second of simulated time.
pub const MAX_RATE: f64 = 100_000.0;

/// The most real time of one frame that is simulated. The excess is dropped, so that a window blocked for ten seconds
/// does not have to simulate ten seconds at once.
const CATCH_UP: Duration = Duration::from_millis(250);

/// The allowed speeds, in simulated seconds per real second.
pub const SPEEDS: std::ops::RangeInclusive<f64> = 1e-3..=10.0;

/// The most bodies whose trails are shown initially.
const MOST_TRAILS: usize = 20;

/// The state of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// At the set-up: edits change the scene.
    Layout,
    /// Physics runs with the clock.
    Running,
    /// Physics has begun and is paused.
    Paused,
}

/// A scene, the world made from it, and one user's view of both.
pub struct Session {
    scene: Scene,
    world: World,
    clock: FixedStep,
    state: State,
    reference: Reference,
    figures: Figures,
    notices: Notices,
    trails: Trails,
    impacts: Impacts,
    balls: Balls,
    opening: Opening,
    overlaps: Overlaps,
    playback: Playback,
    /// The record of the whole run since the start.
    record: Record,
    /// The record with which it is compared, if it is a replay.
    replay: Option<Replay>,
    /// The exact positions of the bodies.
    exact: Exact,
    variants: Variants,
    view: view::View,
    history: history::History,
    /// Simulated seconds per real second.
    speed: f64,
    /// Names of the hidden bodies.
    hidden: std::collections::BTreeSet<String>,
    selection: Option<usize>,
    /// The spring with which the user pulls a body.
    pull: Option<pull::Pull>,
    /// Whether a copy of the world takes steps now.
    under_way: bool,
    /// Steps requested by hand.
    steps_wanted: u32,
    studio: shooting::Studio,
    /// The fraction of the last step that is drawn while paused, if it is not the end.
    instant: Option<f64>,
    /// The poses of bodies at their impacts in the last step.
    passes: instant::Passes,
    /// The number of changes that make results of earlier jobs obsolete.
    edition: u64,
    /// File that the scene was read from or last saved to.
    file: Option<std::path::PathBuf>,
    /// Whether that file no longer exists.
    file_gone: bool,
    /// The viewpoint of the user.
    pub camera: Camera,
    /// The items drawn besides the bodies.
    pub display: Display,
    /// The comparison of naive and BVH.
    pub compare: Compare,
    /// Whether steps are timed by phase. This costs a few clock readings in each.
    pub profiled: bool,
}

impl Session {
    /// A session in the layout state whose view shows all of `scene` and where its bodies go.
    pub fn new(scene: Scene) -> anyhow::Result<Self> {
        let world = scene.world()?;
        let clock = clock(scene.dt, 1.0)?;
        let mut session = Self {
            history: history::History::begin(&scene),
            reference: Reference::of(&world),
            exact: Exact::of(&world),
            record: Record::begin(&scene, &world),
            replay: None,
            scene,
            world,
            clock,
            state: State::Layout,
            figures: Figures::default(),
            notices: Notices::default(),
            trails: Trails::default(),
            impacts: Impacts::default(),
            balls: Balls::default(),
            opening: Opening::default(),
            overlaps: Overlaps::default(),
            playback: Playback::default(),
            variants: Variants::default(),
            view: view::View::default(),
            speed: 1.0,
            hidden: std::collections::BTreeSet::new(),
            selection: None,
            pull: None,
            under_way: false,
            steps_wanted: 0,
            studio: shooting::Studio::default(),
            instant: None,
            passes: instant::Passes::default(),
            edition: 0,
            file: None,
            file_gone: false,
            camera: Camera::default(),
            display: Display::default(),
            compare: Compare::default(),
            profiled: false,
        };
        // Curved paths show the errors of a method; those of a crowd would hide it.
        let few = session.world.len() <= MOST_TRAILS;
        session.show_trails(few && session.is_pushed());
        // Rotation arrows of a crowd would hide it too.
        let turning = (0..session.world.len()).filter(|&i| session.world.turns(i));
        session.display.spins = turning.count() == 1;
        session.fit_arrows();
        session.begin_record();
        session.frame_opening();
        session.view.home = Some(session.camera);
        Ok(session)
    }

    /// The scene as it was set up.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The world as it is now.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The state of the session.
    pub fn state(&self) -> State {
        self.state
    }

    /// Speed and cost of the last frames.
    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    /// The errors of energy and momentum.
    pub fn drift(&self) -> Drift {
        self.reference.drift(&self.world)
    }

    /// Largest distance of a body from its exact position, m, among the bodies whose position is known.
    pub fn path_error(&self) -> Option<f64> {
        self.playback.sample().and_then(|sample| sample.error)
    }

    /// The states kept of this run.
    pub fn playback(&self) -> &Playback {
        &self.playback
    }

    /// Simulated seconds per real second.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Sets the simulated time per real time. Values outside [`SPEEDS`] are clamped.
    pub fn set_speed(&mut self, speed: f64) {
        let speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
        if speed.is_finite()
            && let Ok(clock) = clock(self.world.settings().dt, speed)
        {
            (self.speed, self.clock) = (speed, clock);
        }
    }

    /// Messages to the user, newest last.
    pub fn notices(&mut self) -> &mut Notices {
        &mut self.notices
    }

    /// Index of the selected body.
    pub fn selection(&self) -> Option<usize> {
        self.selection
    }

    /// Selects a body, or none; an index without a body selects none.
    pub fn select(&mut self, body: Option<usize>) {
        self.selection = body.filter(|&i| i < self.world.len());
        self.follow_anew();
    }

    /// The selected body as it was set up.
    pub fn selected(&self) -> Option<&SceneBody> {
        self.selection.and_then(|i| self.scene.bodies.get(i))
    }

    /// Runs physics, from the set-up or from where it was paused.
    pub fn start(&mut self) {
        match self.state {
            State::Layout => self.begin(),
            State::Paused => self.resume_clock(),
            State::Running => {}
        }
        self.state = State::Running;
    }

    /// Pauses physics at the instant drawn. Nothing is lost; the layout state stays as it is.
    pub fn pause(&mut self) {
        if self.state == State::Running {
            let part = self.shown_part();
            self.state = State::Paused;
            self.disown_jobs();
            self.instant = Some(part).filter(|&part| part < 1.0 && self.playback.len() > 1);
        }
    }

    /// Starts or pauses, whichever applies.
    pub fn toggle(&mut self) {
        match self.state {
            State::Running => self.pause(),
            State::Layout | State::Paused => self.start(),
        }
    }

    /// Pauses and requests one more step, or goes to the next kept state.
    pub fn step_once(&mut self) {
        if self.playback.is_back() {
            return self.go_to(self.playback.now() + 1);
        }
        match self.state {
            State::Layout => self.begin(),
            State::Running => self.pause(),
            State::Paused => {}
        }
        self.state = State::Paused;
        self.instant = None;
        self.steps_wanted += 1;
    }

    /// Returns to the layout state: every body as it was set up, time 0.
    pub fn reset(&mut self) {
        match self.scene.world() {
            Ok(world) => {
                // Messages of refusals and failures refer to the discarded state.
                self.notices.clear();
                self.adopt(world);
            }
            Err(error) => self.notices.error("reset", error.to_string()),
        }
    }

    /// Changes the integrator, at any time.
    pub fn set_method(&mut self, method: &'static Method) {
        self.set_settings(Settings {
            method,
            ..*self.world.settings()
        });
    }

    /// Changes how many steps make one simulated second, at any time. Rates outside of
    /// [`MIN_RATE`] to [`MAX_RATE`] are refused.
    pub fn set_rate(&mut self, rate: f64) {
        if !(MIN_RATE..=MAX_RATE).contains(&rate) {
            let text = format!("The rate goes from {MIN_RATE} to {MAX_RATE} Hz, not {rate}.");
            self.notices.error("settings", text);
            return;
        }
        self.set_settings(Settings {
            dt: 1.0 / rate,
            ..*self.world.settings()
        });
    }

    /// Changes the collision mode, at any time.
    pub fn set_collision(&mut self, collision: Collision) {
        self.set_settings(Settings {
            collision,
            ..*self.world.settings()
        });
    }

    /// Changes the error tolerance of adaptive methods in a step.
    pub fn set_tolerance(&mut self, tolerance: f64) {
        self.set_settings(Settings {
            tolerance,
            ..*self.world.settings()
        });
    }

    fn set_settings(&mut self, settings: Settings) {
        if let Err(error) = self.try_settings(settings) {
            self.notices.error("settings", error.to_string());
            return;
        }
        self.edited();
        self.notices.dismiss("settings");
        self.figures = Figures::default();
    }

    fn try_settings(&mut self, settings: Settings) -> anyhow::Result<()> {
        clock(settings.dt, self.speed)?;
        self.change(Input::Settings(settings))
            .map_err(|error| anyhow::anyhow!(error.text(&self.scene)))?;
        self.disown_jobs();
        self.take_settings(settings);
        self.begin_record();
        Ok(())
    }

    /// Copies the world's present settings to the scene and the clock.
    fn take_settings(&mut self, settings: Settings) {
        if settings.dt != self.clock.dt()
            && let Ok(clock) = clock(settings.dt, self.speed)
        {
            self.clock = clock;
            self.trails.pace(settings.dt);
        }
        self.scene.dt = settings.dt;
        self.scene.method = settings.method;
        self.scene.collision = settings.collision;
        self.scene.tolerance = settings.tolerance;
    }

    /// Turns the camera to the selected body, or to everything.
    pub fn frame(&mut self) {
        if let Some((centre, radius)) = self.extent() {
            self.camera.frame(centre, radius);
        }
    }

    /// Leaves the layout state: physics begins here.
    fn begin(&mut self) {
        self.disown_jobs();
        self.figures = Figures::default();
        self.compare.forget();
        self.impacts = Impacts::default();
        self.overlaps = Overlaps::default();
        self.begin_record();
        self.begin_recording();
        self.notices.dismiss("step");
        if self.display.trails {
            self.trails.begin(&self.world);
        }
    }

    /// Restarts the record, the comparisons and the figures of the run from the present world.
    fn begin_record(&mut self) {
        self.instant = None;
        self.passes = instant::Passes::default();
        self.reference = Reference::of(&self.world);
        self.exact = Exact::of(&self.world);
        self.playback.begin(&self.world, &mut self.exact);
        self.variants.begin(&self.world);
    }

    /// Adopts a world newly made from the scene.
    fn adopt(&mut self, world: World) {
        self.world = world;
        self.pull = None;
        self.state = State::Layout;
        self.keep_up();
        self.select(self.selection);
        self.begin();
    }
}

/// A clock that can accumulate the same real time at every speed.
fn clock(dt: f64, speed: f64) -> Result<FixedStep, sim_core::ClockError> {
    FixedStep::new(dt, CATCH_UP.mul_f64(speed.max(1.0)))
}
