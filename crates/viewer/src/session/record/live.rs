//! Records the run in the session, and replays a record in it.

use std::path::Path;

use scene::shown;

use super::input::InputError;
use super::{Divergence, Input, Record, Replay};
use crate::errors;
use crate::session::playback::Moment;
use crate::session::{Session, State};

impl Session {
    /// A session at the start of a recorded run.
    pub fn replaying(record: Record) -> anyhow::Result<Self> {
        let mut session = Self::new(record.scene.clone())?;
        session.replay = Some(Replay::new(record));
        session.compare_start();
        Ok(session)
    }

    /// The run since the start, as far as it is recorded.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The record that is being replayed.
    pub fn replay(&self) -> Option<&Replay> {
        self.replay.as_ref()
    }

    /// The first difference between the replay and its record.
    pub fn divergence(&self) -> Option<&Divergence> {
        self.replay.as_ref()?.divergence.as_ref()
    }

    /// Changes the world, and records the change if physics has begun. A change by the user ends a replay.
    pub(in crate::session) fn change(&mut self, input: Input) -> Result<Vec<usize>, InputError> {
        let moved = input.apply(&mut self.world)?;
        if self.state != State::Layout {
            self.record.note(self.world.steps(), input);
        }
        if self.replay.take().is_some() {
            let text = "The replay ends here: this is a run of its own now.";
            self.notices.info("replay", text.to_owned());
        }
        Ok(moved)
    }

    /// Begins a record from the world as it is set up, and restarts a replay.
    pub(in crate::session) fn begin_recording(&mut self) {
        self.record = Record::begin(&self.scene, &self.world);
        if let Some(replay) = &mut self.replay {
            (replay.made, replay.divergence) = (0, None);
            self.compare_start();
        }
    }

    fn compare_start(&mut self) {
        if let Some(replay) = &mut self.replay {
            replay.compare(0, 0.0, self.world.state_hash());
        }
    }

    /// Adds the states after some steps to the record, and compares them with those of a replay.
    pub(in crate::session) fn record_moments(&mut self, moments: &[Moment]) {
        for moment in moments {
            let (step, time) = (moment.world.steps(), moment.world.time());
            self.record.push(step, moment.hash);
            if let Some(replay) = &mut self.replay
                && replay.divergence.is_none()
            {
                replay.compare(step, time, moment.hash);
                if let Some(divergence) = &replay.divergence {
                    let text = format!("The replay {divergence}.");
                    self.notices.error("replay", text);
                }
            }
        }
    }

    /// Makes the due inputs of a replay, and returns the number of steps until the next one. At the end of the record
    /// the run is paused.
    pub(in crate::session) fn replay_inputs(&mut self) -> u64 {
        let Some(mut replay) = self.replay.take() else {
            return u64::MAX;
        };
        let step = self.world.steps();
        // After going back, some inputs must be made again.
        replay.made = replay
            .record
            .inputs
            .partition_point(|&(after, _)| after < step);
        let noted = self.record.inputs.iter();
        replay.made += noted.filter(|&&(after, _)| after == step).count();
        while let Some((after, input)) = replay.record.inputs.get(replay.made)
            && *after == step
        {
            if let Err(error) = self.make(input.clone()) {
                let why = error.text(&self.scene);
                let text = format!("The replay cannot go on after step {step}: {why}");
                self.notices.error("replay", text);
                self.pause();
                break;
            }
            replay.made += 1;
        }
        let ahead = replay.steps_ahead(step);
        if ahead == 0 && step >= replay.record.steps() {
            self.end_replay(&replay);
        }
        self.replay = Some(replay);
        ahead
    }

    fn make(&mut self, input: Input) -> Result<(), InputError> {
        self.change(input.clone())?;
        if let Input::Settings(settings) = input {
            self.take_settings(settings);
        }
        self.begin_record();
        Ok(())
    }

    fn end_replay(&mut self, replay: &Replay) {
        self.pause();
        self.steps_wanted = 0;
        if replay.divergence.is_none() {
            let steps = replay.record.steps();
            let text = format!("The record ends here: all {steps} steps gave the same states.");
            self.notices.info("replay", text);
        }
    }

    /// Writes the run since the start to a new file in the working directory.
    pub fn save_run(&mut self) {
        let path = self.new_file("run");
        match self.record.text_at(&path) {
            Ok(text) => {
                self.export_to(&path, text.as_bytes());
            }
            Err(error) => self.notices.error("export", error.to_string()),
        }
    }

    /// Opens a recorded run at its start; on failure the present scene stays.
    pub(in crate::session) fn open_run(&mut self, path: &Path) -> anyhow::Result<Session> {
        Session::replaying(Record::read(path)?)
    }
}

impl InputError {
    /// A description with the names of bodies.
    pub fn text(&self, scene: &scene::Scene) -> String {
        match self {
            Self::World(error) => shown::part(&errors::with_names(scene, error)),
            Self::Separate(error) => errors::separate_error(scene, error),
        }
    }
}
