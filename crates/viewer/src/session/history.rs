//! Undo and redo of the set-up, and the question about unsaved edits.
//!
//! A snapshot of the scene is taken once it has not changed for a moment, so that dragging a number is one edit. Meshes
//! are shared, so snapshots are small.

use std::path::{Path, PathBuf};
use std::time::Duration;

use scene::Scene;

use super::{Session, State};

/// The time without changes after which the changes count as one edit.
const PAUSE: Duration = Duration::from_millis(400);
/// The most edits that can be undone.
const MOST: usize = 200;

/// The scene after each edit, the oldest first.
#[derive(Debug, Default)]
pub(super) struct History {
    states: Vec<(u64, Scene)>,
    now: usize,
    /// The number of the state that is in the file, or that came from the gallery.
    saved: u64,
    next: u64,
    /// The time since the last change of an unfinished edit.
    pending: Option<Duration>,
    /// The action that waits for the user's answer about the edits.
    leaving: Option<Leaving>,
    /// Whether the window must close.
    closing: bool,
}

/// An action that discards the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// Opens another scene.
    Open(PathBuf),
    /// Begins an empty scene.
    New,
    /// Sets up a stop of the tour, with one of its attempts; see [`stop`](super::stop).
    Tour {
        /// The number of the stop.
        stop: usize,
        /// The number of its attempt.
        attempt: usize,
    },
    /// Closes the window.
    Close,
}

impl History {
    /// The history of a scene as it was opened.
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
    /// Discards the history: the changes so far can neither be undone nor lost.
    pub(super) fn begin_history(&mut self) {
        self.history = History::begin(&self.scene);
    }

    /// Records that the scene has, or may have, changed.
    pub(super) fn edited(&mut self) {
        self.history.pending = Some(Duration::ZERO);
    }

    /// Advances real time; an edit without recent changes is finished.
    pub fn settle(&mut self, elapsed: Duration) {
        if let Some(quiet) = &mut self.history.pending {
            *quiet += elapsed;
            if *quiet >= PAUSE {
                self.history.push(&self.scene);
            }
        }
    }

    /// Finishes an edit at once.
    pub fn settle_at_once(&mut self) {
        if self.is_settling() {
            self.history.push(&self.scene);
        }
    }

    /// Whether an edit is unfinished.
    pub fn is_settling(&self) -> bool {
        self.history.pending.is_some()
    }

    /// Whether there is an edit to undo.
    pub fn can_undo(&self) -> bool {
        self.history.now > 0 || self.differs()
    }

    /// Whether there is an undone edit to redo.
    pub fn can_redo(&self) -> bool {
        self.history.now + 1 < self.history.states.len() && !self.differs()
    }

    /// Whether the scene differs from the last snapshot.
    fn differs(&self) -> bool {
        let last = self.history.states.get(self.history.now);
        self.history.pending.is_some() && last.is_none_or(|(_, last)| *last != self.scene)
    }

    /// Undoes the last edit of the set-up. The session first returns to the layout state.
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

    /// Redoes the last undone edit.
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

    /// Whether the set-up has changes that no file has.
    pub fn is_changed(&self) -> bool {
        self.file_gone || self.has_edits()
    }

    /// Whether there are edits that were never in a file.
    pub(super) fn has_edits(&self) -> bool {
        let saved = |(number, _): &(u64, Scene)| *number == self.history.saved;
        self.differs() || !self.history.states.get(self.history.now).is_some_and(saved)
    }

    /// The number of the last edit, if no file has it. Each edit has a different number.
    pub fn unsaved(&self) -> Option<u64> {
        let (number, _) = self.history.states.get(self.history.now)?;
        self.is_changed().then_some(*number)
    }

    /// Records that the set-up is in a file now.
    pub(super) fn mark_saved(&mut self) {
        self.file_gone = false;
        self.history.push(&self.scene);
        if let Some((number, _)) = self.history.states.get(self.history.now) {
            self.history.saved = *number;
        }
    }

    /// Names the scene after its file. Undo keeps the name.
    pub(super) fn name_after(&mut self, file: &Path) {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        for (_, scene) in &mut self.history.states {
            scene.name = name.to_string();
        }
        self.scene.name = name.to_string();
    }

    /// Opens another scene or closes the window: at once, or after the user has decided about unsaved edits.
    pub fn leave(&mut self, leaving: Leaving) {
        if self.is_changed() {
            self.history.leaving = Some(leaving);
        } else {
            self.go(leaving);
        }
    }

    /// The action that waits for an answer.
    pub fn leaving(&self) -> Option<&Leaving> {
        self.history.leaving.as_ref()
    }

    /// The user cancels the action; scene and edits stay.
    pub fn stay(&mut self) {
        self.history.leaving = None;
    }

    /// The user discards the edits; the action is done.
    pub fn leave_unsaved(&mut self) {
        if let Some(leaving) = self.history.leaving.take() {
            self.go(leaving);
        }
    }

    /// Saves to the scene's own file or to a new one in the working directory, and then does the action if that
    /// succeeded.
    pub fn save_and_leave(&mut self) {
        self.save_own();
        if !self.is_changed() {
            self.leave_unsaved();
        }
    }

    /// Saves to the scene's own file, or to a new one in the working directory.
    pub fn save_own(&mut self) {
        let path = match &self.file {
            Some(own) => own.clone(),
            None => self.new_file("toml"),
        };
        self.save(&path, false);
    }

    /// Whether the window must close.
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

    /// Opens a scene or adds a mesh, depending on the extension; asks before edits are lost.
    pub fn take_in(&mut self, path: &Path) {
        if super::files::is_scene_file(path) || super::record::is_run_file(path) {
            self.leave(Leaving::Open(path.to_path_buf()));
        } else {
            self.import(path);
        }
    }
}
