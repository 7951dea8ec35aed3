//! The control panel: what the person sees around the picture and can do to the session.
//!
//! Each panel is one file with one `show`. Panels call the session's methods and nothing else;
//! the picture arrives as a texture, drawn elsewhere.

mod banner;
mod bar;
mod body;
mod compare;
mod dialog;
mod display;
mod dock;
mod export;
mod field;
mod forces;
mod keys;
mod live;
mod plots;
mod question;
mod scene;
mod simulation;
mod style;
mod time;
mod variants;
mod viewport;

use egui::{CollapsingHeader, Panel, RichText, ScrollArea};

use crate::session::Session;

pub use style::apply as apply_style;

/// What the control panel remembers between frames.
#[derive(Default)]
pub struct Ui {
    help: bool,
    panel_hidden: bool,
    live_hidden: bool,
    plots_hidden: bool,
    plots: plots::Plots,
    variants: variants::Choice,
    files: scene::Files,
    /// Size of the picture, pixels.
    pixels: [u32; 2],
}

impl Ui {
    /// Lays out one frame; returns the rectangle of the picture, in points.
    pub fn show(
        &mut self,
        root: &mut egui::Ui,
        session: &mut Session,
        picture: egui::TextureId,
    ) -> egui::Rect {
        self.files.poll(session);
        keys::handle(root.ctx(), self, session);
        bar::show(root, self, session);
        keys::show_line(root);
        time::show(root, self, session);
        if !self.panel_hidden {
            self.side_panel(root, session);
        }
        dock::show(root, self, session);
        if let Some(text) = field::take_refused(root.ctx()) {
            session.notices().error("number", text);
        }
        let rect = viewport::show(root, session, picture);
        let pixels = root.ctx().pixels_per_point() * rect.size();
        self.pixels = [pixels.x, pixels.y].map(|side| side.round().max(1.0) as u32);
        banner::show(root.ctx(), rect, session);
        question::show(root.ctx(), session);
        keys::show_help(root.ctx(), &mut self.help);
        rect
    }

    fn side_panel(&mut self, root: &mut egui::Ui, session: &mut Session) {
        Panel::right("panel")
            .default_size(328.0)
            .min_size(290.0)
            .max_size(0.6 * root.available_width().max(484.0))
            .show(root, |ui| {
                ScrollArea::vertical()
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        section(ui, "Scene", |ui| scene::show(ui, &mut self.files, session));
                        section(ui, "Simulation", |ui| simulation::show(ui, session));
                        section(ui, "Compare", |ui| {
                            variants::show(ui, &mut self.variants, session);
                        });
                        section(ui, "Selected body", |ui| body::show(ui, session));
                        section(ui, "Forces", |ui| forces::show(ui, session));
                        section(ui, "Display", |ui| display::show(ui, session));
                        section(ui, "Naive against BVH", |ui| compare::show(ui, session));
                    });
            });
    }
}

fn section(ui: &mut egui::Ui, title: &str, contents: impl FnOnce(&mut egui::Ui)) {
    CollapsingHeader::new(RichText::new(title).heading())
        .default_open(true)
        .show_unindented(ui, |ui| {
            ui.add_space(2.0);
            contents(ui);
            ui.add_space(8.0);
        });
    ui.separator();
}
