//! The timeline below the picture: the kept states of the run, its impacts, and the speed.

use egui::{Button, Color32, Panel, Sense, Stroke};

use super::{Ui, field, style};
use crate::number;
use crate::session::{SPEEDS, Session, State};
use crate::words::say;

/// The most impacts that are marked; more would merge into one colour.
const MARKS: usize = 2000;
/// The distance up to which a click selects an impact, points.
const SNAP: f32 = 5.0;

pub(super) fn show(root: &mut egui::Ui, state: &Ui, session: &mut Session) {
    Panel::bottom("time").show(root, |ui| {
        ui.add_space(2.0);
        ui.horizontal(|ui| {
            buttons(ui, session);
            speed(ui, session);
            keep(ui, state, session);
            line(ui, session);
        });
        ui.add_space(2.0);
    });
}

fn buttons(ui: &mut egui::Ui, session: &mut Session) {
    let can_go_back = session.state() != State::Layout && session.playback().now() > 0;
    if ui
        .add_enabled(can_go_back, Button::new("⏴"))
        .on_hover_text(say("Go one step back (left arrow or ,)"))
        .on_disabled_hover_text(say("No earlier state is kept"))
        .clicked()
    {
        session.step_back();
    }
    if ui
        .button("⏵⏵ 5")
        .on_hover_text(say("Go five steps ahead and hold there (page down)"))
        .clicked()
    {
        five_steps(session);
    }
}

/// Five steps ahead.
pub(super) fn five_steps(session: &mut Session) {
    for _ in 0..5 {
        session.step_once();
    }
}

fn speed(ui: &mut egui::Ui, session: &mut Session) {
    let mut speed = session.speed();
    ui.spacing_mut().slider_width = 90.0;
    let slider = field::slider(ui, &mut speed, SPEEDS, "", |slider| {
        slider.logarithmic(true).prefix("×").max_decimals(3)
    });
    let response = slider.on_hover_text(say(
        "Simulated seconds in a real one: slow motion below 1. Double click for 1.",
    ));
    if response.double_clicked() {
        session.set_speed(1.0);
    } else if response.changed() {
        session.set_speed(speed);
    }
}

/// The buttons that save the run to files.
fn keep(ui: &mut egui::Ui, state: &Ui, session: &mut Session) {
    if let Some(reel) = session.reel() {
        let [done, total] = reel.progress();
        ui.label(format!("{done} / {total}"));
        if ui
            .button("✖")
            .on_hover_text(say("Draw no more pictures"))
            .clicked()
        {
            reel.cancel();
        }
    } else if ui
        .button(say("GIF"))
        .on_hover_text(say(
            "Draw the run that is kept, from its start or the green mark up to here, as a moving picture at \
             the speed that is set: its last 12 s where it takes longer. F12 draws the picture as it is now",
        ))
        .clicked()
    {
        session.shoot_film(state.pixels);
    }
    let steps = number::count(session.record().steps() as f64);
    if ui
        .add_enabled(session.state() != State::Layout, Button::new(say("Save run")))
        .on_hover_text(say(format!(
            "Write the run since the start, {steps} steps with what was done on the way and a hash of \
             every state, into a file that opens here again, and that `cowbell replay` checks"
        )))
        .on_disabled_hover_text(say("Nothing has run yet"))
        .clicked()
    {
        session.save_run();
    }
}

fn line(ui: &mut egui::Ui, session: &mut Session) {
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let [first, last] = session.playback().span();
    let [left, right] = [rect.left() + 6.0, rect.right() - 6.0];
    let long = (last - first).max(f64::MIN_POSITIVE);
    let place =
        |time: f64| egui::lerp(left..=right, ((time - first) / long).clamp(0.0, 1.0) as f32);
    let painter = ui.painter_at(rect);
    let bar = rect.shrink2(egui::vec2(6.0, 7.0));
    painter.rect_filled(bar, 3.0, ui.visuals().extreme_bg_color);
    let now = session.shown_time();
    let gone = bar.with_max_x(place(now).max(bar.left()));
    painter.rect_filled(gone, 3.0, style::BLUE.of(ui.visuals()).gamma_multiply(0.5));
    let mark = Stroke::new(1.5, Color32::from_rgb(255, 140, 50));
    for time in session.playback().impact_times().take(MARKS) {
        painter.vline(place(time), rect.shrink(3.0).y_range(), mark);
    }
    let unseen = Stroke::new(1.5, style::RED.of(ui.visuals()));
    for time in session.playback().missed_times().take(MARKS) {
        painter.vline(place(time), rect.shrink(3.0).y_range(), unseen);
    }
    let left_record = session.divergence().map(|divergence| divergence.time);
    if let Some(time) = left_record {
        let mark = Stroke::new(3.0, style::RED.of(ui.visuals()));
        painter.vline(place(time), rect.y_range(), mark);
    }
    if let Some(time) = session.film_start() {
        let mark = Stroke::new(3.0, style::GREEN.of(ui.visuals()));
        painter.vline(place(time), rect.y_range(), mark);
    }
    let hand = Stroke::new(2.0, ui.visuals().strong_text_color());
    painter.vline(place(now), rect.y_range(), hand);
    let pointed = response.interact_pointer_pos().or(response.hover_pos());
    let shift = ui.input(|i| i.modifiers.shift);
    if let Some(at) = pointed
        && session.state() != State::Layout
        && (response.clicked() || response.dragged() && !shift)
    {
        let away = |time: &f64| (place(*time) - at.x).abs();
        let impacts = session.playback().contact_times();
        let impact = impacts.min_by(|a, b| away(a).total_cmp(&away(b)));
        match impact.filter(|time| response.clicked() && !shift && away(time) <= SNAP) {
            Some(time) => session.go_to_time(time),
            None => {
                let part = f64::from((at.x - left) / (right - left).max(1.0));
                let time = first + part.clamp(0.0, 1.0) * long;
                let state = session.playback().nearest(time);
                match shift {
                    true => session.begin_film_at(state),
                    false => session.go_to(state),
                }
            }
        }
    }
    let kept = session.playback();
    response.on_hover_text(say(format!(
        "{} states kept, from {first:.3} to {last:.3} s, at most {}, in about {} of memory: the run since \
         the start or the last change. Drag to go there; a click on an impact (orange) goes to its \
         instant within the step (U and I go from one to the next). Red is where bodies passed \
         through each other between two steps. Shift and a click lets a film begin there (green).",
        number::count(kept.len() as f64),
        number::count(kept.capacity() as f64),
        number::bytes(kept.bytes()),
    )));
}
