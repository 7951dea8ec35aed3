//! The settings of the simulation: integrator, rate and collision mode, all changeable while running.

use egui::ComboBox;
use sim_core::{Collision, METHODS, Settings};

use super::field;
use crate::number;
use crate::session::{MAX_RATE, MIN_RATE, Session};
use crate::words::say;

/// The formulas of a step of each method: positions x, velocities v, accelerations a.
const FORMULAS: [(&str, &str); METHODS.len()] = [
    ("forward-euler", "x₁ = x₀ + v₀ dt,  v₁ = v₀ + a(x₀, v₀) dt"),
    ("backward-euler", "x₁ = x₀ + v₁ dt,  v₁ = v₀ + a(x₁, v₁) dt"),
    (
        "symplectic-euler",
        "v₁ = v₀ + a(x₀, v₀) dt,  x₁ = x₀ + v₁ dt",
    ),
    (
        "rk4",
        "y₁ = y₀ + (k₁ + 2 k₂ + 2 k₃ + k₄) dt/6,  with y = (x, v) and slopes k at the start, twice in the \
         middle and at the end",
    ),
    (
        "velocity-verlet",
        "x₁ = x₀ + v₀ dt + a₀ dt²/2,  v₁ = v₀ + (a₀ + a₁) dt/2",
    ),
    (
        "implicit-midpoint",
        "x₁ = x₀ + v dt,  v₁ = v₀ + a(x, v) dt,  with x = (x₀ + x₁)/2 and v = (v₀ + v₁)/2",
    ),
    (
        "symplectic-4",
        "fourth order by six kicks and drifts with tuned shares of dt",
    ),
    (
        "symplectic-8",
        "eighth order by seventeen kicks and drifts with tuned shares of dt",
    ),
    (
        "radau5",
        "three stages at Radau's points, solved together, the last one at the end of the step",
    ),
    (
        "dopri5",
        "explicit Runge-Kutta of order 5; the difference to order 4 is the error that the step is chosen by",
    ),
    (
        "dop853",
        "explicit Runge-Kutta of order 8; differences to orders 5 and 3 are the error that the step is \
         chosen by",
    ),
];

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    let now = *session.world().settings();
    ui.horizontal(|ui| {
        field::label(
            ui,
            "Integrator",
            "How velocities and positions go from step to step",
        );
        let list = ComboBox::from_id_salt("integrator")
            .selected_text(say(now.method.title))
            .width(ui.available_width() - 8.0)
            .truncate()
            .height(340.0)
            .show_ui(ui, |ui| {
                for method in METHODS {
                    let chosen = ui
                        .selectable_label(method == now.method, say(method.title))
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
        let slider = field::slider(ui, &mut rate, MIN_RATE..=MAX_RATE, " Hz", |slider| {
            // A file may have a rate outside the range of the slider.
            let slider = slider.clamping(egui::SliderClamping::Edits);
            // A typed value is accepted exactly, and shown rounded.
            let slider = slider.custom_formatter(|rate, _| field::shown(rate, 1));
            slider.logarithmic(true)
        });
        if slider
            .on_hover_text(say(format!(
                "One step is {}. From {MIN_RATE} to {MAX_RATE} Hz; click the number to type.",
                number::seconds(now.dt)
            )))
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
                .selectable_label(now.collision == how, say(name))
                .on_hover_text(say(meaning))
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
        let slider = field::slider(ui, &mut value, Settings::TOLERANCES, "", |slider| {
            slider
                .logarithmic(true)
                .clamping(egui::SliderClamping::Edits)
                .custom_formatter(|value, _| format!("{value:.1e}"))
        });
        if slider.on_hover_text(say(meaning)).changed() {
            session.set_tolerance(value);
        }
    });
}

fn about(method: &sim_core::Method) -> String {
    let order = say(format!("Order {}; {}", method.order, method.stability));
    let formula = FORMULAS.iter().find(|(name, _)| *name == method.name);
    let mut lines = vec![say(method.title)];
    lines.extend(formula.map(|(_, formula)| say(formula)));
    lines.extend([order, method.source.to_owned()]);
    lines.join("\n")
}
