//! The guided tour of the labs: what to observe, what to try, a question and its answer.

use egui::{CollapsingHeader, Panel, RichText, ScrollArea};

use crate::session::{Leaving, Session, stop, stop_count};
use crate::words::say;

/// The state of the tour.
#[derive(Default)]
pub(super) struct Tour {
    pub(super) open: bool,
    number: usize,
}

pub(super) fn show(root: &mut egui::Ui, tour: &mut Tour, session: &mut Session) {
    let Some((lab, here)) = stop(tour.number).filter(|_| tour.open) else {
        return;
    };
    Panel::left("tour")
        .default_size(286.0)
        .min_size(220.0)
        .max_size(0.4 * root.available_width().max(560.0))
        .show(root, |ui| {
            ui.add_space(4.0);
            turning(ui, tour);
            ScrollArea::vertical()
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    ui.label(RichText::new(say(lab.title)).weak());
                    ui.label(RichText::new(say(here.title)).heading().strong());
                    part(ui, "Watch", here.watch);
                    ui.add_space(8.0);
                    ui.label(RichText::new(say("Try")).strong());
                    let hint = "Each of these opens the scene anew.";
                    ui.label(RichText::new(say(hint)).weak());
                    for (attempt, what) in here.attempts.iter().enumerate() {
                        let button = ui.button(say(what.title));
                        if button
                            .on_hover_text(say("Open the scene anew and set it up in this way"))
                            .clicked()
                        {
                            let stop = tour.number;
                            session.leave(Leaving::Tour { stop, attempt });
                        }
                    }
                    part(ui, "Question", here.question);
                    ui.add_space(4.0);
                    CollapsingHeader::new(say("Answer"))
                        .id_salt(("answer", tour.number))
                        .show(ui, |ui| ui.label(say(here.answer)));
                });
        });
}

/// The number of the stop, and the buttons to the others.
fn turning(ui: &mut egui::Ui, tour: &mut Tour) {
    ui.horizontal(|ui| {
        let last = stop_count() - 1;
        let back = egui::Button::new("◀");
        if ui
            .add_enabled(tour.number > 0, back)
            .on_hover_text(say("The stop before"))
            .clicked()
        {
            tour.number -= 1;
        }
        ui.label(format!("{} / {}", tour.number + 1, last + 1));
        let on = egui::Button::new(say("Next ▶"));
        if ui
            .add_enabled(tour.number < last, on)
            .on_hover_text(say("The next stop"))
            .clicked()
        {
            tour.number += 1;
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let close = egui::Button::new("✖").frame(false);
            if ui.add(close).on_hover_text(say("Close the tour")).clicked() {
                tour.open = false;
            }
        });
    });
}

fn part(ui: &mut egui::Ui, title: &str, text: &str) {
    ui.add_space(8.0);
    ui.label(RichText::new(say(title)).strong());
    ui.label(say(text));
}

impl Tour {
    /// Opens a stop.
    pub(super) fn go(&mut self, number: usize) {
        (self.open, self.number) = (true, number);
    }
}
