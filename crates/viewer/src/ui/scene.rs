//! Scenes and their bodies: the gallery, files, and the list to select from.

use std::path::Path;

use egui::{ComboBox, RichText, TextEdit};
use scene::{MeshRef, SceneShape, shown};
use sim_core::DVec3;

use super::dialog::{Answer, Dialog, Purpose};
use super::field;
use crate::session::{Leaving, Session};

/// The path typed, and the dialog opened instead.
#[derive(Default)]
pub(super) struct Files {
    path: String,
    dialog: Option<Dialog>,
}

impl Files {
    /// Takes the answer of a dialog, once there is one.
    pub(super) fn poll(&mut self, session: &mut Session) {
        match Dialog::answer(&mut self.dialog) {
            None | Some(Answer::Cancelled) => {}
            Some(Answer::Chosen(Purpose::Read, path)) => session.take_in(&path),
            // The dialog has asked before overwriting.
            Some(Answer::Chosen(Purpose::Save, path)) => session.save(&path, true),
            Some(Answer::Unavailable) => session.notices().error(
                "dialog",
                "The system showed no file dialog: type the path instead.".to_owned(),
            ),
        }
    }
}

pub(super) fn show(ui: &mut egui::Ui, files: &mut Files, session: &mut Session) {
    gallery(ui, session);
    paths(ui, files, session);
    ui.add_space(4.0);
    bodies(ui, session);
}

fn gallery(ui: &mut egui::Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        field::label(ui, "Gallery", "Scenes that come with the program");
        let mut chosen = None;
        let list = ComboBox::from_id_salt("gallery")
            .selected_text(shown::name(&session.scene().name))
            .width(ui.available_width() - 8.0)
            .height(340.0)
            .show_ui(ui, |ui| {
                for entry in scene::SCENES {
                    let current = entry.name == session.scene().name;
                    let title = entry.title();
                    if ui
                        .selectable_label(current, format!("{}: {title}", entry.name))
                        .clicked()
                    {
                        chosen = Some(entry.name);
                    }
                }
            })
            .response;
        field::named(&list, "Gallery", &shown::name(&session.scene().name));
        if let Some(name) = chosen {
            session.leave(Leaving::Open(name.into()));
        }
    });
    if !session.scene().about.is_empty() {
        ui.label(shown::part(&session.scene().about));
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
            .hint_text("path of a scene or mesh")
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
            .add_enabled(typed, egui::Button::new("Open"))
            .on_hover_text("Open the scene at this path, or add the mesh there as a body")
            .on_disabled_hover_text("Type a path first, or choose a file")
            .clicked()
        {
            session.take_in(path);
        }
        if ui
            .add_enabled(typed, egui::Button::new("Save"))
            .on_hover_text("Write the scene as set up to this path (.toml)")
            .on_disabled_hover_text("Type a path first, or choose a file")
            .clicked()
        {
            session.save(path, false);
        }
        let mut ask = |ui: &mut egui::Ui, text: &str, meaning: &str, purpose| {
            if ui
                .add_enabled(files.dialog.is_none(), egui::Button::new(text))
                .on_hover_text(meaning)
                .on_disabled_hover_text("A file dialog is open")
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
        ui.label(RichText::new("No bodies. Add a mesh by its path or by dropping it here.").weak());
    }
    ui.horizontal(|ui| {
        field::label(ui, "Add", "A body beside all others; returns to the layout");
        let shapes = [
            ("cube", MeshRef::builtin("cube.obj").map(SceneShape::Mesh)),
            ("sphere", Some(SceneShape::Sphere { radius: 0.5 })),
            ("floor", Some(SceneShape::HalfSpace { normal: DVec3::Y })),
        ];
        for (name, shape) in shapes {
            if let Some(shape) = shape
                && ui.button(name).clicked()
            {
                session.add(name, shape);
            }
        }
    });
    let mut chosen = None;
    egui::ScrollArea::vertical()
        .max_height(120.0)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (i, body) in session.scene().bodies.iter().enumerate() {
                    let [r, g, b] = session.colour(i).map(|part| (255.0 * part) as u8);
                    let selected = session.selection() == Some(i);
                    let mut text = egui::text::LayoutJob::default();
                    let font = egui::TextStyle::Button.resolve(ui.style());
                    let mut part = |what: &str, colour| {
                        let format = egui::TextFormat::simple(font.clone(), colour);
                        text.append(what, 0.0, format);
                    };
                    part("⏺ ", egui::Color32::from_rgb(r, g, b));
                    part(&shown::name(&body.name), ui.visuals().strong_text_color());
                    if ui.selectable_label(selected, text).clicked() {
                        chosen = Some((!selected).then_some(i));
                    }
                }
            });
        });
    if let Some(chosen) = chosen {
        session.select(chosen);
    }
}
