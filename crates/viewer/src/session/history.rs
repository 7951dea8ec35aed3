//! Undo and redo of the set-up, and what would be lost with it.
//!
//! A snapshot of the scene is taken once it has been left alone for a moment, so that a drag of a number
//! is one step; meshes are shared, so snapshots are small.

use std::path::{Path, PathBuf};
use std::time::Duration;

use scene::Scene;

use super::{Session, State};

/// How long a scene is left alone before what has changed counts as one edit.
const PAUSE: Duration = Duration::from_millis(400);
/// The most edits that can be taken back.
const MOST: usize = 200;

/// The scene after each edit, the oldest first.
#[derive(Debug, Default)]
pub(super) struct History {
    states: Vec<(u64, Scene)>,
    now: usize,
    /// Number of the state that is in the file, or that came from the gallery.
    saved: u64,
    next: u64,
    /// An edit is under way, and how long ago its last change was.
    pending: Option<Duration>,
    /// What is to be done once it is said what happens to the edits.
    leaving: Option<Leaving>,
    /// The window is to be closed.
    closing: bool,
}

/// What takes the scene away.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// Another scene is opened.
    Open(PathBuf),
    /// An empty scene is begun.
    New,
    /// A stop of the tour is set up, with one of its attempts; see [`stop`](super::stop).
    Tour {
        /// The number of the stop.
        stop: usize,
        /// The number of its attempt.
        attempt: usize,
    },
    /// The window is closed.
    Close,
}

impl History {
    /// Begins with a scene as it was opened.
    pub(super) fn begin(scene: &Scene) -> Self {
        Self {
            states: vec![(0, scene.clone())],
            next: 1,
            ..Self::default()
        }
    }

    fn push(&mut self, scene: &Scene) {
        self.pending = None;
        if self
            .states
            .get(self.now)
            .is_some_and(|(_, last)| last == scene)
        {
            return;
        }
        self.states.truncate(self.now + 1);
        self.states.push((self.next, scene.clone()));
        self.next += 1;
        let beyond = self.states.len().saturating_sub(MOST + 1);
        self.states.drain(..beyond);
        self.now = self.states.len() - 1;
    }
}

impl Session {
    /// What has been changed so far is nothing to take back or to lose.
    pub(super) fn begin_history(&mut self) {
        self.history = History::begin(&self.scene);
    }

    /// The scene has been changed, or may have been.
    pub(super) fn edited(&mut self) {
        self.history.pending = Some(Duration::ZERO);
    }

    /// Lets real time pass: an edit that has been left alone is done.
    pub fn settle(&mut self, elapsed: Duration) {
        if let Some(quiet) = &mut self.history.pending {
            *quiet += elapsed;
            if *quiet >= PAUSE {
                self.history.push(&self.scene);
            }
        }
    }

    /// Ends an edit, whether it has been left alone or not.
    pub fn settle_at_once(&mut self) {
        if self.is_settling() {
            self.history.push(&self.scene);
        }
    }

    /// Whether an edit waits for being done.
    pub fn is_settling(&self) -> bool {
        self.history.pending.is_some()
    }

    /// Whether there is something to take back.
    pub fn can_undo(&self) -> bool {
        self.history.now > 0 || self.differs()
    }

    /// Whether something was taken back.
    pub fn can_redo(&self) -> bool {
        self.history.now + 1 < self.history.states.len() && !self.differs()
    }

    /// Whether the scene is other than the last snapshot.
    fn differs(&self) -> bool {
        let last = self.history.states.get(self.history.now);
        self.history.pending.is_some() && last.is_none_or(|(_, last)| *last != self.scene)
    }

    /// Takes the last edit of the set-up back. Physics returns to the layout first.
    pub fn undo(&mut self) {
        self.history.push(&self.scene);
        if self.history.now > 0 {
            self.history.now -= 1;
            self.adopt_snapshot("Took back");
        } else {
            self.notices
                .info("undo", "There is nothing to take back.".to_owned());
        }
    }

    /// Does again what was taken back.
    pub fn redo(&mut self) {
        self.history.push(&self.scene);
        if self.history.now + 1 < self.history.states.len() {
            self.history.now += 1;
            self.adopt_snapshot("Did again");
        } else {
            self.notices
                .info("undo", "There is nothing to do again.".to_owned());
        }
    }

    fn adopt_snapshot(&mut self, what: &str) {
        let Some((_, scene)) = self.history.states.get(self.history.now) else {
            return;
        };
        let scene = scene.clone();
        match scene.world() {
            Ok(world) => {
                let running = self.state != State::Layout;
                self.scene = scene;
                self.notices.clear();
                self.adopt(world);
                if let Ok(clock) = super::clock(self.scene.dt, self.speed) {
                    self.clock = clock;
                }
                let reset = if running { ", and reset" } else { "" };
                let text = format!("{what} an edit of the set-up{reset}.");
                self.notices.info("undo", text);
            }
            Err(error) => self.notices.error("undo", error.to_string()),
        }
    }

    /// Whether there is something in the set-up that no file has.
    pub fn is_changed(&self) -> bool {
        self.file_gone || self.has_edits()
    }

    /// Whether there are edits that no file has had.
    pub(super) fn has_edits(&self) -> bool {
        let saved = |(number, _): &(u64, Scene)| *number == self.history.saved;
        self.differs() || !self.history.states.get(self.history.now).is_some_and(saved)
    }

    /// The number of the last edit, if no file has it: another one after each.
    pub fn unsaved(&self) -> Option<u64> {
        let (number, _) = self.history.states.get(self.history.now)?;
        self.is_changed().then_some(*number)
    }

    /// The set-up is in a file now.
    pub(super) fn mark_saved(&mut self) {
        self.file_gone = false;
        self.history.push(&self.scene);
        if let Some((number, _)) = self.history.states.get(self.history.now) {
            self.history.saved = *number;
        }
    }

    /// The scene is called after its file, and so it stays when edits are taken back.
    pub(super) fn name_after(&mut self, file: &Path) {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        for (_, scene) in &mut self.history.states {
            scene.name = name.to_string();
        }
        self.scene.name = name.to_string();
    }

    /// Opens another scene or closes the window, at once or once it is said what happens to edits
    /// that no file has.
    pub fn leave(&mut self, leaving: Leaving) {
        if self.is_changed() {
            self.history.leaving = Some(leaving);
        } else {
            self.go(leaving);
        }
    }

    /// What waits for an answer.
    pub fn leaving(&self) -> Option<&Leaving> {
        self.history.leaving.as_ref()
    }

    /// The edits are kept, and so the scene is.
    pub fn stay(&mut self) {
        self.history.leaving = None;
    }

    /// The edits are given up.
    pub fn leave_unsaved(&mut self) {
        if let Some(leaving) = self.history.leaving.take() {
            self.go(leaving);
        }
    }

    /// Saves, to the scene's own file or a new one beside the program, and leaves if that worked.
    pub fn save_and_leave(&mut self) {
        self.save_own();
        if !self.is_changed() {
            self.leave_unsaved();
        }
    }

    /// Saves to the scene's own file, or a new one beside the program.
    pub fn save_own(&mut self) {
        let path = match &self.file {
            Some(own) => own.clone(),
            None => self.new_file("toml"),
        };
        self.save(&path, false);
    }

    /// Whether the window is to be closed.
    pub fn is_closing(&self) -> bool {
        self.history.closing
    }

    fn go(&mut self, leaving: Leaving) {
        match leaving {
            Leaving::Open(path) => self.open(path),
            Leaving::New => self.begin_scene(),
            Leaving::Tour { stop, attempt } => self.set_up(stop, attempt),
            Leaving::Close => self.history.closing = true,
        }
    }

    /// Opens a scene or adds a mesh, by the name's ending; asks before edits are lost.
    pub fn take_in(&mut self, path: &Path) {
        if super::files::is_scene_file(path) || super::record::is_run_file(path) {
            self.leave(Leaving::Open(path.to_path_buf()));
        } else {
            self.import(path);
        }
    }
}
