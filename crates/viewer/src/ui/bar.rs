//! The bar at the top: the scene's title, and the buttons that start, pause and reset it.

use egui::{Button, Panel, RichText};
use scene::shown;

use super::{Ui, style};
use crate::number;
use crate::session::{Session, State};
use crate::words::{Language, say};

pub(super) fn show(root: &mut egui::Ui, state: &mut Ui, session: &mut Session) {
    let frame =
        egui::Frame::side_top_panel(root.style()).inner_margin(egui::Margin::symmetric(10, 7));
    Panel::top("bar").frame(frame).show(root, |ui| {
        let room = ui.available_width();
        // If the bar does not fit into one line, it takes several, so that buttons do not overlap.
        if state.bar > room {
            ui.horizontal_wrapped(|ui| {
                buttons(ui, session);
                status(ui, session);
                switches(ui, state);
            });
            return;
        }
        ui.horizontal(|ui| {
            let left = ui.cursor().left();
            buttons(ui, session);
            ui.add_space(6.0);
            status(ui, session);
            let taken = ui.cursor().left() - left;
            let right = egui::Layout::right_to_left(egui::Align::Center);
            let size = egui::vec2(room - state.bar, ui.available_height());
            ui.allocate_ui_with_layout(size, right, |ui| title(ui, session));
            let switches = ui.scope(|ui| switches(ui, state)).response.rect;
            // Includes the gap after the title.
            state.bar = taken + switches.width() + ui.spacing().item_spacing.x;
        });
        if state.bar > room {
            ui.ctx().request_discard("bar");
        }
    });
}

/// The scene's title, whether it has edits, and the delay behind real time, if there is one.
fn title(ui: &mut egui::Ui, session: &Session) {
    if behind(ui, session) {
        return;
    }
    let mark = if session.is_changed() { " *" } else { "" };
    let title = say(shown::part(&session.scene().title)) + mark;
    ui.add(egui::Label::new(RichText::new(title)).truncate())
        .on_hover_text(say(shown::part(&session.scene().about)));
}

/// Switches for what is shown, and how.
fn switches(ui: &mut egui::Ui, state: &mut Ui) {
    ui.toggle_value(&mut state.gallery.open, say("Gallery"))
        .on_hover_text(say("Scenes that come with the program (Ctrl+G)"));
    ui.toggle_value(&mut state.tour.open, say("Tour"))
        .on_hover_text(say("A guided tour of the four labs (Ctrl+T)"));
    hiding(ui, &mut state.live_hidden, "Live", "Live figures (L)");
    hiding(ui, &mut state.plots_hidden, "Plots", "Curves over time (G)");
    hiding(ui, &mut state.panel_hidden, "Panel", "Side panel (P)");
    ui.toggle_value(&mut state.help, say("Keys"))
        .on_hover_text(say("All keys and mouse gestures (H, ? or F1)"));
    let theme = if state.light { "🌙" } else { "☀" };
    if ui
        .button(theme)
        .on_hover_text(say("Dark or light panels"))
        .clicked()
    {
        state.light ^= true;
    }
    let other = match state.language {
        Language::English => Language::Chinese,
        Language::Chinese => Language::English,
    };
    let name = match state.has_chinese {
        Some(true) => other.name(),
        _ => "Chinese",
    };
    if ui
        .button(name)
        .on_hover_text(say("The language of the window"))
        .clicked()
    {
        state.language = other;
    }
}

fn buttons(ui: &mut egui::Ui, session: &mut Session) {
    let start = match session.state() {
        State::Layout => "▶ Start",
        State::Running => "⏸ Pause",
        State::Paused => "▶ Go on",
    };
    let button = Button::new(RichText::new(say(start)).strong()).min_size(egui::vec2(78.0, 26.0));
    if ui
        .add(button)
        .on_hover_text(say("Start or pause physics (Space)"))
        .clicked()
    {
        session.toggle();
    }
    let small = |text: &'static str| Button::new(say(text)).min_size(egui::vec2(66.0, 26.0));
    if ui
        .add(small("⏩ Step"))
        .on_hover_text(say("Go one step ahead and hold there (right arrow or .)"))
        .clicked()
    {
        session.step_once();
    }
    if ui
        .add_enabled(session.state() != State::Layout, small("⟲ Reset"))
        .on_hover_text(say("Put every body back as it was set up (R)"))
        .on_disabled_hover_text(say("Everything is as it was set up"))
        .clicked()
    {
        session.reset();
    }
    let undo = Button::new("⮪").min_size(egui::vec2(26.0, 26.0));
    if ui
        .add_enabled(session.can_undo(), undo)
        .on_hover_text(say("Take the last edit of the set-up back (Ctrl+Z)"))
        .on_disabled_hover_text(say("There is nothing to take back"))
        .clicked()
    {
        session.undo();
    }
    let redo = Button::new("⮫").min_size(egui::vec2(26.0, 26.0));
    if ui
        .add_enabled(session.can_redo(), redo)
        .on_hover_text(say("Do again what was taken back (Ctrl+Shift+Z or Ctrl+Y)"))
        .on_disabled_hover_text(say("Nothing was taken back"))
        .clicked()
    {
        session.redo();
    }
}

/// A button that shows or hides something.
fn hiding(ui: &mut egui::Ui, hidden: &mut bool, name: &str, meaning: &str) {
    let mut shown = !*hidden;
    ui.toggle_value(&mut shown, say(name))
        .on_hover_text(say(meaning));
    *hidden = !shown;
}

fn status(ui: &mut egui::Ui, session: &Session) {
    let (text, colour, meaning) = match session.state() {
        State::Layout => (
            "Layout",
            style::BLUE.of(ui.visuals()),
            "Stopped at the set-up. Edits change the scene, and Reset returns here.",
        ),
        State::Running => (
            "Running",
            style::GREEN.of(ui.visuals()),
            "Physics runs with the clock.",
        ),
        State::Paused => (
            "Paused",
            style::AMBER.of(ui.visuals()),
            "Physics is held still. Edits last until Reset.",
        ),
    };
    ui.label(RichText::new(say(text)).strong().color(colour))
        .on_hover_text(say(meaning));
    ui.label(RichText::new(format!("{:.3} s", session.shown_time())).monospace())
        .on_hover_text(say("Simulated time"));
}

/// Shows the delay of the simulation behind real time, if there is one.
fn behind(ui: &mut egui::Ui, session: &Session) -> bool {
    let figures = session.figures();
    let shown = session.state() == State::Running && figures.is_behind();
    if shown {
        let time = number::seconds(figures.behind.as_secs_f64());
        let text = RichText::new(say(format!("behind real time by {time}")))
            .color(style::AMBER.of(ui.visuals()));
        ui.add(egui::Label::new(text).truncate()).on_hover_text(say(
            "Steps or pictures took longer than the time they stand for, so the rest was given \
             up. If steps are slow, lower the rate or test collisions through the BVH.",
        ));
    }
    shown
}
