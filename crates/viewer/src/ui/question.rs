//! The question before edits are lost.

use egui::{Id, Modal, RichText};
use scene::shown;

use crate::session::{Leaving, Session};
use crate::words::say;

pub(super) fn show(ctx: &egui::Context, session: &mut Session) {
    let what = match session.leaving() {
        None => return,
        Some(Leaving::Open(path)) => say(format!("{} is opened", shown::path(path))),
        Some(Leaving::New) => say("a new scene is begun"),
        Some(Leaving::Tour { .. }) => say("the tour goes on"),
        Some(Leaving::Close) => say("the window is closed"),
    };
    let modal = Modal::new(Id::unique("question")).show(ctx, |ui| {
        ui.set_max_width(420.0);
        let name = shown::name(&session.scene().name);
        ui.label(RichText::new(say(format!("Save the edits of {name}?"))).heading());
        ui.label(say(format!("They are in no file, and lost when {what}.")));
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            if ui
                .button(say("Save"))
                .on_hover_text(say(
                    "To the scene's own file, or a new one in the folder of the start",
                ))
                .clicked()
            {
                session.save_and_leave();
            }
            if ui.button(say("Do not save")).clicked() {
                session.leave_unsaved();
            }
            if ui.button(say("Cancel")).clicked() {
                session.stay();
            }
        });
    });
    if modal.should_close() {
        session.stay();
    }
}
