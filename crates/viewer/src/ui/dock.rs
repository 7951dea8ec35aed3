//! The area below the picture: live figures and plots.

use egui::{Panel, ScrollArea};

use super::{Ui, live};
use crate::session::Session;

/// The height reserved for the picture, and the least height of the area below it, points. If there is less room, only
/// the picture is shown.
const PICTURE: f32 = 240.0;
const LEAST: f32 = 120.0;
/// The preferred width of the live figures, and that of plots beside them, points.
const FIGURES: f32 = 348.0;
const PLOTS: f32 = 320.0;

pub(super) fn show(root: &mut egui::Ui, state: &mut Ui, session: &mut Session) {
    let room = root.available_size();
    if state.live_hidden && state.plots_hidden || room.y < PICTURE + LEAST {
        return;
    }
    Panel::bottom("dock")
        .resizable(true)
        .default_size((0.4 * room.y).clamp(180.0, 300.0))
        .min_size(LEAST)
        .max_size((0.75 * room.y).min(room.y - PICTURE))
        .show(root, |ui| {
            let width = FIGURES.min(ui.available_width() - PLOTS);
            if state.plots_hidden || width < 160.0 {
                figures(ui, session);
                return;
            }
            if !state.live_hidden {
                Panel::left("figures")
                    .exact_size(width)
                    .resizable(false)
                    .show(ui, |ui| figures(ui, session));
            }
            egui::CentralPanel::default().show(ui, |ui| state.plots.show(ui, session));
        });
}

fn figures(ui: &mut egui::Ui, session: &mut Session) {
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(ui, |ui| live::show(ui, session));
}
