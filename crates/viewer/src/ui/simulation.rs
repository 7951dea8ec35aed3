//! How to simulate: integrator, rate and collision test, all changeable while running.

use egui::{ComboBox, Slider};
use sim_core::{Collision, METHODS, Settings};

use super::field;
use crate::number;
use crate::session::{MAX_RATE, MIN_RATE, Session};

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    let now = *session.world().settings();
    ui.horizontal(|ui| {
        field::label(
            ui,
            "Integrator",
            "How velocities and positions go from step to step",
        );
        let list = ComboBox::from_id_salt("integrator")
            .selected_text(now.method.title)
            .width(ui.available_width() - 8.0)
            .height(340.0)
            .show_ui(ui, |ui| {
                for method in METHODS {
                    let chosen = ui
                        .selectable_label(method == now.method, method.title)
                        .on_hover_text(about(method))
                        .clicked();
                    if chosen {
                        session.set_method(method);
                    }
                }
            })
            .response
            .on_hover_text(about(now.method));
        field::named(&list, "Integrator", now.method.title);
    });
    if now.method.adaptive {
        tolerance(ui, session, now.tolerance);
    }
    ui.horizontal(|ui| {
        field::label(ui, "Rate", "Steps per second of simulated time");
        let mut rate = 1.0 / now.dt;
        let slider = Slider::new(&mut rate, MIN_RATE..=MAX_RATE)
            .logarithmic(true)
            .clamping(egui::SliderClamping::Never)
            .suffix(" Hz")
            .max_decimals(1)
            .step_by(1.0);
        if ui
            .add(slider)
            .on_hover_text(format!(
                "One step is {}. From {MIN_RATE} to {MAX_RATE} Hz; click the number to type.",
                number::seconds(now.dt)
            ))
            .changed()
        {
            session.set_rate(rate);
        }
    });
    ui.horizontal(|ui| {
        field::label(ui, "Collision", "How collisions are found");
        for (how, name, meaning) in [
            (
                Collision::Continuous,
                "Continuous",
                "At the time of impact, wherever it is within the step",
            ),
            (
                Collision::Bvh,
                "BVH",
                "Through bounding volume hierarchies: only parts that are near each other meet",
            ),
            (
                Collision::Naive,
                "Naive",
                "Every edge of one mesh against every triangle of the other: the same answer, slowly",
            ),
        ] {
            if ui
                .selectable_label(now.collision == how, name)
                .on_hover_text(meaning)
                .clicked()
            {
                session.set_collision(how);
            }
        }
    });
}

fn tolerance(ui: &mut egui::Ui, session: &mut Session, now: f64) {
    let meaning =
        "Error that a step may make, relative and, in m and m/s, absolute: from 1e-15 to 1";
    ui.horizontal(|ui| {
        field::label(ui, "Tolerance", meaning);
        let mut value = now;
        let slider = Slider::new(&mut value, Settings::TOLERANCES)
            .logarithmic(true)
            .clamping(egui::SliderClamping::Edits)
            .custom_formatter(|value, _| format!("{value:.1e}"))
            .custom_parser(|text| text.trim().parse().ok());
        if ui.add(slider).on_hover_text(meaning).changed() {
            session.set_tolerance(value);
        }
    });
}

fn about(method: &sim_core::Method) -> String {
    format!(
        "{}\nOrder {}; {}\n{}",
        method.title, method.order, method.stability, method.source
    )
}
