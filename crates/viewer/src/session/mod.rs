//! A person at work on a scene: set it up, let it run, look at it, put it back.
//!
//! A session holds two things that must not be confused: the **scene** as it was set up, which is
//! what gets saved and what a reset returns to, and the **world** that runs. In the layout state
//! every edit changes the set-up and the world follows it; once physics has begun, edits reach
//! only the world. How to simulate (method, rate, collision test) is the person's choice rather
//! than the bodies' and survives a reset.
//!
//! Nothing here draws, opens windows or reads a clock: see `picture` for what is drawn, and
//! [`Session::due`] for how time comes in and steps are taken.

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

/// Real time of one frame that may be caught up with; what exceeds it is dropped, so that a
/// window that was held still for ten seconds does not have to simulate ten seconds at once.
const CATCH_UP: Duration = Duration::from_millis(250);

/// Simulated seconds in a real one that are offered.
pub const SPEEDS: std::ops::RangeInclusive<f64> = 1e-3..=10.0;

/// Bodies up to which their trails are shown at first.
const MOST_TRAILS: usize = 20;

/// What the session is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Stopped at the set-up: edits change the scene.
    Layout,
    /// Physics runs with the clock.
    Running,
    /// Physics has begun and is held still.
    Paused,
}

/// A scene, the world made from it, and one person's view of both.
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
    /// The whole run since the start.
    record: Record,
    /// What it is compared with, if it is a replay.
    replay: Option<Replay>,
    /// Where bodies would be without errors.
    exact: Exact,
    variants: Variants,
    view: view::View,
    history: history::History,
    /// Simulated seconds in a real one.
    speed: f64,
    /// Names of the bodies that are left out of the picture.
    hidden: std::collections::BTreeSet<String>,
    selection: Option<usize>,
    /// What is pulled by a spring.
    pull: Option<pull::Pull>,
    /// Steps are being taken on a copy of the world.
    under_way: bool,
    /// Steps asked for by hand.
    steps_wanted: u32,
    studio: shooting::Studio,
    /// The part of the last step that is drawn while held still, if not its end.
    instant: Option<f64>,
    /// Impacts that bodies pass through in the last step.
    passes: instant::Passes,
    /// Counts what makes results of earlier jobs outdated.
    edition: u64,
    /// File that the scene was read from or last saved to.
    file: Option<std::path::PathBuf>,
    /// That file is not there any more.
    file_gone: bool,
    /// Where the person looks from.
    pub camera: Camera,
    /// What is drawn besides the bodies.
    pub display: Display,
    /// Naive against BVH.
    pub compare: Compare,
    /// Whether steps are timed by phase, which costs some readings of a clock in each.
    pub profiled: bool,
}

impl Session {
    /// A session in the layout state that looks at the whole of `scene` and where it goes.
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
        // Where paths are curved, they show what a method does; those of a crowd hide it.
        let few = session.world.len() <= MOST_TRAILS;
        session.show_trails(few && session.is_pushed());
        // Of a crowd that turns they would hide it too.
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

    /// Whether it is laid out, running or paused.
    pub fn state(&self) -> State {
        self.state
    }

    /// Speed and cost of the last frames.
    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    /// How far energy and momentum are from where they should be.
    pub fn drift(&self) -> Drift {
        self.reference.drift(&self.world)
    }

    /// Largest distance of a body from its exact place, m, among those whose place is known.
    pub fn path_error(&self) -> Option<f64> {
        self.playback.sample().and_then(|sample| sample.error)
    }

    /// The states kept of this run.
    pub fn playback(&self) -> &Playback {
        &self.playback
    }

    /// Simulated seconds in a real one.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Lets simulated time go faster or slower than real time; beyond [`SPEEDS`] the nearest of
    /// these.
    pub fn set_speed(&mut self, speed: f64) {
        let speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
        if speed.is_finite()
            && let Ok(clock) = clock(self.world.settings().dt, speed)
        {
            (self.speed, self.clock) = (speed, clock);
        }
    }

    /// Messages to the person, newest last.
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

    /// Lets physics run, from the set-up or from where it was paused.
    pub fn start(&mut self) {
        match self.state {
            State::Layout => self.begin(),
            State::Paused => self.resume_clock(),
            State::Running => {}
        }
        self.state = State::Running;
    }

    /// Holds physics still at the instant that is drawn. Nothing is lost; the layout state stays as it is.
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

    /// Holds still and makes one more step due, or goes to the next state kept.
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
                // What was refused or failed belongs to what is left behind.
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

    /// Changes how meshes are tested for contact, at any time.
    pub fn set_collision(&mut self, collision: Collision) {
        self.set_settings(Settings {
            collision,
            ..*self.world.settings()
        });
    }

    /// Changes the error that adaptive methods may make in a step.
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

    /// Takes over how the world steps now, in the scene and in the clock.
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

    /// Turns the camera's eye on the selected body, or on everything.
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

    /// Begins anew what is kept, compared and measured of the run, from the world as it is now.
    fn begin_record(&mut self) {
        self.instant = None;
        self.passes = instant::Passes::default();
        self.reference = Reference::of(&self.world);
        self.exact = Exact::of(&self.world);
        self.playback.begin(&self.world, &mut self.exact);
        self.variants.begin(&self.world);
    }

    /// Takes a world freshly made from the scene.
    fn adopt(&mut self, world: World) {
        self.world = world;
        self.pull = None;
        self.state = State::Layout;
        self.keep_up();
        self.select(self.selection);
        self.begin();
    }
}

/// A clock that lets as much real time wait at every speed.
fn clock(dt: f64, speed: f64) -> Result<FixedStep, sim_core::ClockError> {
    FixedStep::new(dt, CATCH_UP.mul_f64(speed.max(1.0)))
}
