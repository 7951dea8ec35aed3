//! File dialogs of the system, on a thread of their own so that the window stays responsive.

use std::future::Future;
use std::path::PathBuf;
use std::thread::JoinHandle;
use std::time::Duration;

use rfd::{AsyncFileDialog, FileHandle};

use crate::stopwatch::Stopwatch;
use crate::words::say;

/// The purpose of a dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// A scene or mesh to read.
    Read,
    /// A file to write the scene to.
    Save,
}

/// No user answers faster than this, so the dialog was not shown.
const TOO_FAST: Duration = Duration::from_millis(400);

/// An open dialog.
pub(super) struct Dialog {
    purpose: Purpose,
    thread: JoinHandle<(Option<FileHandle>, Duration)>,
}

/// The result of a dialog.
pub(super) enum Answer {
    /// The user chose a file.
    Chosen(Purpose, PathBuf),
    /// The user chose none.
    Cancelled,
    /// The system showed no dialog.
    Unavailable,
}

impl Dialog {
    /// Opens a dialog; `None` if the system cannot start a thread for it.
    pub(super) fn open(ctx: &egui::Context, purpose: Purpose) -> Option<Self> {
        let dialog = AsyncFileDialog::new();
        match purpose {
            Purpose::Read => {
                let endings: Vec<&str> = scene::FORMATS
                    .iter()
                    .flat_map(|format| format.extensions.iter().copied())
                    .chain(["toml", "run"])
                    .collect();
                let dialog = dialog
                    .set_title(say("Open a scene or add a mesh"))
                    .add_filter(say("Scenes, runs and meshes"), &endings);
                Self::wait(ctx, purpose, dialog.pick_file())
            }
            Purpose::Save => {
                let dialog = dialog
                    .set_title(say("Save the scene"))
                    .add_filter(say("Scenes"), &["toml"]);
                Self::wait(ctx, purpose, dialog.save_file())
            }
        }
    }

    fn wait(
        ctx: &egui::Context,
        purpose: Purpose,
        file: impl Future<Output = Option<FileHandle>> + Send + 'static,
    ) -> Option<Self> {
        let redraw = ctx.clone();
        let thread = std::thread::Builder::new().spawn(move || {
            let stopwatch = Stopwatch::start();
            let file = pollster::block_on(file);
            redraw.request_repaint();
            (file, stopwatch.read())
        });
        Some(Self {
            purpose,
            thread: thread.ok()?,
        })
    }

    /// The answer, once there is one.
    pub(super) fn answer(dialog: &mut Option<Self>) -> Option<Answer> {
        let Dialog { purpose, thread } = dialog.take_if(|dialog| dialog.thread.is_finished())?;
        Some(match thread.join() {
            Ok((Some(file), _)) => Answer::Chosen(purpose, file.path().to_path_buf()),
            Ok((None, time)) if time > TOO_FAST => Answer::Cancelled,
            Ok((None, _)) | Err(_) => Answer::Unavailable,
        })
    }
}
