//! The control panel: everything around the picture by which the user sees and changes the session.
//!
//! Each panel is one file with one function `show`. Panels only call methods of the session; the picture is a texture
//! that is drawn elsewhere.

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
mod gallery;
mod handles;
mod keys;
mod live;
mod palette;
mod plots;
mod question;
mod scene;
mod simulation;
mod style;
mod time;
mod tour;
mod variants;
mod viewport;

use egui::{CollapsingHeader, Panel, RichText, ScrollArea};

use crate::preferences::Preferences;
use crate::session::Session;
use crate::words::{Language, say, speak};

pub use style::apply as apply_style;

/// The state of the control panel between frames.
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
    gallery: gallery::Gallery,
    tour: tour::Tour,
    palette: palette::Palette,
    handles: handles::Handles,
    language: Language,
    /// Whether a font has Chinese characters; `None` before the first frame.
    has_chinese: Option<bool>,
    light: bool,
    /// The width of the top bar in one line, without the title, points.
    bar: f32,
    /// Whether naive against BVH is measured, and whether a result has come since.
    measured: [bool; 2],
}

impl Ui {
    /// Lays out one frame; returns the rectangle of the picture, in points.
    pub fn show(
        &mut self,
        root: &mut egui::Ui,
        session: &mut Session,
        picture: egui::TextureId,
    ) -> egui::Rect {
        self.speak(root.ctx(), session);
        root.ctx().set_theme(match self.light {
            true => egui::Theme::Light,
            false => egui::Theme::Dark,
        });
        self.files.poll(root.ctx(), session);
        keys::handle(root.ctx(), self, session);
        bar::show(root, self, session);
        keys::show_line(root);
        time::show(root, self, session);
        tour::show(root, &mut self.tour, session);
        if !self.panel_hidden {
            self.side_panel(root, session);
        }
        dock::show(root, self, session);
        field::tell_refused(root.ctx(), session.notices());
        let rect = viewport::show(root, &mut self.handles, session, picture);
        let pixels = root.ctx().pixels_per_point() * rect.size();
        self.pixels = [pixels.x, pixels.y].map(|side| side.round().max(1.0) as u32);
        banner::show(root.ctx(), rect, session);
        question::show(root.ctx(), session);
        gallery::show(root.ctx(), &mut self.gallery, session);
        palette::show(root.ctx(), self, session);
        keys::show_help(root.ctx(), &mut self.help);
        rect
    }

    /// Applies the preferences saved when the window was last closed.
    pub fn prefer(&mut self, ctx: &egui::Context, session: &mut Session, wanted: &Preferences) {
        self.language = wanted.language;
        self.light = wanted.light;
        self.panel_hidden = !wanted.panel;
        self.live_hidden = !wanted.figures;
        self.plots_hidden = !wanted.plots;
        self.files.recent.clone_from(&wanted.recent);
        session.camera.parallel = wanted.parallel;
        let display = &mut session.display;
        (display.grid, display.numbers) = (wanted.grid, wanted.numbers);
        (display.names, display.wireframe) = (wanted.names, wanted.wireframe);
        ctx.set_zoom_factor(wanted.zoom.clamp(0.5, 4.0));
    }

    /// Moves to another context: keeps the scale and the open windows. Textures are lost.
    pub fn move_to(&mut self, from: &egui::Context, to: &egui::Context) {
        let memory = from.memory(egui::Memory::clone);
        to.memory_mut(|known| *known = memory);
        to.set_zoom_factor(from.zoom_factor());
        self.gallery.forget_pictures();
    }

    /// The present preferences.
    pub fn preferences(&self, ctx: &egui::Context, session: &Session) -> Preferences {
        Preferences {
            language: self.language,
            light: self.light,
            zoom: ctx.zoom_factor(),
            panel: !self.panel_hidden,
            figures: !self.live_hidden,
            plots: !self.plots_hidden,
            grid: session.display.grid,
            numbers: session.display.numbers,
            names: session.display.names,
            wireframe: session.display.wireframe,
            parallel: session.camera.parallel,
            recent: self.files.recent.clone(),
        }
    }

    /// Changes the language from the next frame on.
    pub fn set_language(&mut self, language: Language) {
        self.language = language;
    }

    /// Uses the chosen language, or English if the system has no font for it.
    fn speak(&mut self, ctx: &egui::Context, session: &mut Session) {
        let has_chinese = *self.has_chinese.get_or_insert_with(|| {
            let font = egui::FontId::proportional(13.0);
            ctx.fonts_mut(|fonts| fonts.has_glyphs(&font, Language::Chinese.name()))
        });
        if self.language == Language::Chinese && !has_chinese {
            self.language = Language::English;
            let text = "No font of the system has Chinese characters: install one, such as fonts-noto-cjk.";
            session.notices().error("language", text.to_owned());
        }
        speak(self.language);
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
                        section(ui, "Selected body", |ui| {
                            body::show(ui, &mut self.handles, session);
                        });
                        section(ui, "Forces", |ui| forces::show(ui, session));
                        section(ui, "Display", |ui| display::show(ui, session));
                        let measuring = section(ui, "Naive against BVH", |ui| {
                            compare::show(ui, session);
                        });
                        // The switch is at the end of the panel, and the tour can set it too.
                        let on = session.compare.on;
                        let figure = self.measured[1] || session.compare.last().is_some();
                        let before = std::mem::replace(&mut self.measured, [on, on && figure]);
                        if on && before != self.measured {
                            measuring.scroll_to_me(None);
                        }
                    });
            });
    }
}

fn section(ui: &mut egui::Ui, title: &str, contents: impl FnOnce(&mut egui::Ui)) -> egui::Response {
    let shown = CollapsingHeader::new(RichText::new(say(title)).heading())
        .default_open(true)
        .show_unindented(ui, |ui| {
            ui.add_space(2.0);
            contents(ui);
            ui.add_space(8.0);
        });
    ui.separator();
    shown.body_response.unwrap_or(shown.header_response)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_are_the_same_in_another_context() {
        let scene = ::scene::Scene::load("two-cubes").expect("in the gallery");
        let mut session = Session::new(scene).expect("a world");
        let (from, to) = (egui::Context::default(), egui::Context::default());
        for context in [&from, &to] {
            apply_style(context);
        }
        let mut ui = Ui::default();
        let wanted = Preferences {
            zoom: 1.5,
            light: true,
            ..Preferences::default()
        };
        ui.prefer(&from, &mut session, &wanted);
        ui.gallery.open = true;
        let mut show = |ui: &mut Ui, context: &egui::Context| {
            let mut textures = 0;
            for _ in 0..3 {
                let mut output = context.run_ui(egui::RawInput::default(), |root| {
                    ui.show(root, &mut session, egui::TextureId::User(0));
                });
                textures += output.textures_delta.set.len();
                output.textures_delta.clear();
            }
            // Includes the textures of fonts.
            let whole = textures > ::scene::SCENES.len();
            (whole, ui.preferences(context, &session))
        };
        let before = show(&mut ui, &from);
        ui.move_to(&from, &to);
        assert_eq!(show(&mut ui, &to), before);
        assert_eq!((before.0, before.1.zoom), (true, 1.5));
    }
}
