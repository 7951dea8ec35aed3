//! File dialogs of the system, on a thread of their own so that the picture goes on.

use std::future::Future;
use std::path::PathBuf;
use std::thread::JoinHandle;

use rfd::{AsyncFileDialog, FileHandle};

/// What a dialog asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// A scene or mesh to read.
    Read,
    /// A file to write the scene to.
    Save,
}

/// An answer closer than this to the question came from no person, s.
const TOO_FAST: f64 = 0.4;

/// A dialog that the person has before them.
pub(super) struct Dialog {
    purpose: Purpose,
    opened: f64,
    thread: JoinHandle<Option<FileHandle>>,
}

/// How a dialog ended.
pub(super) enum Answer {
    /// A file was chosen.
    Chosen(Purpose, PathBuf),
    /// None was chosen.
    Cancelled,
    /// The system showed no dialog.
    Unavailable,
}

impl Dialog {
    /// Opens a dialog; none if the system gives no thread for it.
    pub(super) fn open(ctx: &egui::Context, purpose: Purpose) -> Option<Self> {
        let dialog = AsyncFileDialog::new();
        match purpose {
            Purpose::Read => {
                let endings: Vec<&str> = scene::FORMATS
                    .iter()
                    .flat_map(|format| format.extensions.iter().copied())
                    .chain(["toml"])
                    .collect();
                let dialog = dialog
                    .set_title("Open a scene or add a mesh")
                    .add_filter("Scenes and meshes", &endings);
                Self::wait(ctx, purpose, dialog.pick_file())
            }
            Purpose::Save => {
                let dialog = dialog
                    .set_title("Save the scene")
                    .add_filter("Scenes", &["toml"]);
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
            let file = pollster::block_on(file);
            redraw.request_repaint();
            file
        });
        Some(Self {
            purpose,
            opened: ctx.time(),
            thread: thread.ok()?,
        })
    }

    /// The answer, once there is one.
    pub(super) fn answer(dialog: &mut Option<Self>, now: f64) -> Option<Answer> {
        let Dialog {
            purpose,
            opened,
            thread,
        } = dialog.take_if(|dialog| dialog.thread.is_finished())?;
        Some(match thread.join() {
            Ok(Some(file)) => Answer::Chosen(purpose, file.path().to_path_buf()),
            Ok(None) if now - opened > TOO_FAST => Answer::Cancelled,
            Ok(None) | Err(_) => Answer::Unavailable,
        })
    }
}
