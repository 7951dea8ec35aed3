//! Scenes and their bodies: the gallery, files, and the list for selection.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{ComboBox, Galley, RichText, TextEdit};
use scene::{MeshRef, SceneShape, shown};
use sim_core::DVec3;

use super::dialog::{Answer, Dialog, Purpose};
use super::{field, style};
use crate::preferences::MOST_RECENT;
use crate::session::{Leaving, Session};
use crate::words::say;

/// The typed path, and the dialog that replaces it.
#[derive(Default)]
pub(super) struct Files {
    path: String,
    dialog: Option<Dialog>,
    /// Whether a dialog must be opened.
    asked: bool,
    /// Files that were opened or saved, the latest first.
    pub(super) recent: Vec<PathBuf>,
}

impl Files {
    /// Requests the dialog for opening a file, in the next frame.
    pub(super) fn ask(&mut self) {
        self.asked = true;
    }

    /// Records the scene's file as the latest one.
    fn remember(&mut self, session: &Session) {
        let Some(file) = session.file() else { return };
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
        if self.recent.first() != Some(&file) {
            self.recent.retain(|other| *other != file);
            self.recent.insert(0, file);
            self.recent.truncate(MOST_RECENT);
        }
    }

    /// Opens a requested dialog, handles the answer of an open one, and records recent files.
    pub(super) fn poll(&mut self, ctx: &egui::Context, session: &mut Session) {
        if std::mem::take(&mut self.asked) && self.dialog.is_none() {
            self.dialog = Dialog::open(ctx, Purpose::Read);
        }
        self.remember(session);
        match Dialog::answer(&mut self.dialog) {
            None | Some(Answer::Cancelled) => {}
            Some(Answer::Chosen(Purpose::Read, path)) => session.take_in(&path),
            // The dialog has already asked before overwriting.
            Some(Answer::Chosen(Purpose::Save, path)) => session.save(&path, true),
            Some(Answer::Unavailable) => session.notices().error(
                "dialog",
                "The system showed no file dialog: type the path instead.".to_owned(),
            ),
        }
    }
}

pub(super) fn show(ui: &mut egui::Ui, files: &mut Files, session: &mut Session) {
    about(ui, files, session);
    paths(ui, files, session);
    ui.add_space(4.0);
    bodies(ui, session);
}

fn about(ui: &mut egui::Ui, files: &mut Files, session: &mut Session) {
    ui.horizontal(|ui| {
        if ui
            .button(say("New"))
            .on_hover_text(say("Begin an empty scene (Ctrl+N)"))
            .clicked()
        {
            session.leave(Leaving::New);
        }
        let mut chosen = None;
        let list = ComboBox::from_id_salt("recent")
            .selected_text(say("Recent files"))
            .width(ui.available_width() - 8.0)
            .height(340.0)
            .show_ui(ui, |ui| {
                for path in &files.recent {
                    if ui.selectable_label(false, shown::path(path)).clicked() {
                        chosen = Some(path.clone());
                    }
                }
                if files.recent.is_empty() {
                    ui.label(RichText::new(say("No file was opened yet.")).weak());
                }
            })
            .response;
        field::named(&list, "Recent files", "");
        if let Some(path) = chosen {
            session.take_in(&path);
        }
    });
    if !session.scene().about.is_empty() {
        ui.label(say(shown::part(&session.scene().about)));
    }
}

fn paths(ui: &mut egui::Ui, files: &mut Files, session: &mut Session) {
    ui.horizontal(|ui| {
        field::label(
            ui,
            "File",
            "A scene (.toml), a recorded run (.run) or a mesh",
        );
        let edit = TextEdit::singleline(&mut files.path)
            .hint_text(say("path of a scene or mesh"))
            .desired_width(ui.available_width() - 8.0);
        let entered = ui.add(edit).lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        if entered && !files.path.trim().is_empty() {
            session.take_in(Path::new(files.path.trim()));
        }
    });
    ui.horizontal(|ui| {
        let typed = !files.path.trim().is_empty();
        let path = Path::new(files.path.trim());
        if ui
            .add_enabled(typed, egui::Button::new(say("Open")))
            .on_hover_text(say(
                "Open the scene at this path, or add the mesh there as a body",
            ))
            .on_disabled_hover_text(say("Type a path first, or choose a file"))
            .clicked()
        {
            session.take_in(path);
        }
        if ui
            .add_enabled(typed, egui::Button::new(say("Save")))
            .on_hover_text(say("Write the scene as set up to this path (.toml)"))
            .on_disabled_hover_text(say("Type a path first, or choose a file"))
            .clicked()
        {
            session.save(path, false);
        }
        let mut ask = |ui: &mut egui::Ui, text: &str, meaning: &str, purpose| {
            if ui
                .add_enabled(files.dialog.is_none(), egui::Button::new(say(text)))
                .on_hover_text(say(meaning))
                .on_disabled_hover_text(say("A file dialog is open"))
                .clicked()
            {
                files.dialog = Dialog::open(ui.ctx(), purpose);
            }
        };
        ask(
            ui,
            "Choose…",
            "Choose a scene to open or a mesh to add",
            Purpose::Read,
        );
        ask(
            ui,
            "Save as…",
            "Choose where to save the scene",
            Purpose::Save,
        );
    });
}

fn bodies(ui: &mut egui::Ui, session: &mut Session) {
    if session.scene().bodies.is_empty() {
        ui.label(
            RichText::new(say(
                "No bodies. Add a mesh by its path or by dropping it here.",
            ))
            .weak(),
        );
    }
    ui.horizontal(|ui| {
        field::label(ui, "Add", "A body beside all others; returns to the layout");
        let shapes = [
            ("cube", MeshRef::builtin("cube.obj").map(SceneShape::Mesh)),
            ("cow", MeshRef::builtin("cow.obj").map(SceneShape::Mesh)),
            ("sphere", Some(SceneShape::Sphere { radius: 0.5 })),
            ("floor", Some(SceneShape::HalfSpace { normal: DVec3::Y })),
        ];
        for (name, shape) in shapes {
            if let Some(shape) = shape
                && ui.button(say(name)).clicked()
            {
                session.add(name, shape);
            }
        }
    });
    let chosen = list(ui, session);
    if let Some(chosen) = chosen {
        session.select(chosen);
    }
}

/// The bodies by name in rows; only visible rows are laid out. Returns a choice.
fn list(ui: &mut egui::Ui, session: &Session) -> Option<Option<usize>> {
    let labels: Vec<Arc<Galley>> = (0..session.scene().bodies.len())
        .map(|i| label(ui, session, i))
        .collect();
    let spacing = ui.spacing();
    let (gap, padding) = (spacing.item_spacing.x, 2.0 * spacing.button_padding.x);
    let room = ui.available_width() - spacing.scroll.allocated_width();
    let widths = labels.iter().map(|label| label.size().x + padding);
    let rows = rows(widths, gap, room);
    let height = spacing.interact_size.y;
    let mut chosen = None;
    egui::ScrollArea::vertical()
        .max_height(120.0)
        .auto_shrink([false, true])
        .show_rows(ui, height, rows.len(), |ui, seen| {
            for row in &rows[seen] {
                ui.horizontal(|ui| {
                    for i in row.clone() {
                        let selected = session.selection() == Some(i);
                        if ui.selectable_label(selected, labels[i].clone()).clicked() {
                            chosen = Some((!selected).then_some(i));
                        }
                    }
                });
            }
        });
    chosen
}

/// A dot in the colour of a body and its name.
fn label(ui: &egui::Ui, session: &Session, i: usize) -> Arc<Galley> {
    let mut text = egui::text::LayoutJob::default();
    let font = egui::TextStyle::Button.resolve(ui.style());
    let mut part = |what: &str, colour| {
        let format = egui::TextFormat::simple(font.clone(), colour);
        text.append(what, 0.0, format);
    };
    part("⏺ ", style::curve(session.colour(i), ui.visuals()));
    let colour = match (session.selection() == Some(i), session.is_hidden(i)) {
        (true, _) => ui.visuals().selection.stroke.color,
        (false, true) => ui.visuals().weak_text_color(),
        (false, false) => ui.visuals().strong_text_color(),
    };
    part(&shown::name(&session.scene().bodies[i].name), colour);
    ui.fonts_mut(|fonts| fonts.layout_job(text))
}

/// Distributes items over rows: the ranges of items side by side, for their widths, the gap between them and the
/// available room.
fn rows(widths: impl Iterator<Item = f32>, gap: f32, room: f32) -> Vec<Range<usize>> {
    let mut rows: Vec<Range<usize>> = Vec::new();
    let mut end = 0.0;
    for (i, width) in widths.enumerate() {
        match rows.last_mut() {
            Some(row) if end + gap + width <= room => {
                row.end = i + 1;
                end += gap + width;
            }
            _ => {
                rows.push(i..i + 1);
                end = width;
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::rows;

    #[test]
    fn rows_hold_what_there_is_room_for_and_each_thing_once() {
        let widths = [30.0, 30.0, 40.0, 200.0, 10.0, 80.0];
        assert_eq!(
            rows(widths.into_iter(), 5.0, 100.0),
            [0..2, 2..3, 3..4, 4..6]
        );
        assert_eq!(rows([].into_iter(), 5.0, 100.0), []);
    }
}
