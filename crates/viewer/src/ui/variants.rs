//! Comparisons: other ways to run the scene along with it, their costs and errors.

use egui::{ComboBox, Grid, RichText};
use sim_core::{Collision, METHODS, Settings};

use super::field;
use crate::number;
use crate::session::{MAX_RATE, MIN_RATE, PRESETS, Session};
use crate::words::say;

/// The variant to add next; its settings are those of the scene until they are changed.
#[derive(Default)]
pub(super) struct Choice {
    scene: String,
    settings: Option<Settings>,
}

pub(super) fn show(ui: &mut egui::Ui, choice: &mut Choice, session: &mut Session) {
    let own = *session.world().settings();
    let list = ComboBox::from_id_salt("presets")
        .selected_text(say("Compare…"))
        .width(ui.available_width() - 8.0)
        .show_ui(ui, |ui| {
            for preset in &PRESETS {
                let offer = ui.selectable_label(false, say(preset.title));
                if offer.on_hover_text(say(preset.meaning)).clicked() {
                    session.compare_with((preset.settings)(&own));
                }
            }
        })
        .response;
    field::named(&list, "Compare…", "");
    add(ui, choice, session);
    if session.variants().is_empty() {
        let text = "Variants run beside the scene, as ghosts in the picture and as curves in the \
                    plots, with the exact solution where it is known.";
        ui.label(RichText::new(say(text)).weak());
    } else {
        table(ui, session);
    }
}

/// A row to define one more variant.
fn add(ui: &mut egui::Ui, choice: &mut Choice, session: &mut Session) {
    let own = *session.world().settings();
    if choice.scene != session.scene().name {
        choice.scene.clone_from(&session.scene().name);
        choice.settings = None;
    }
    let mut settings = choice.settings.unwrap_or(own);
    settings.tolerance = own.tolerance;
    let before = settings;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let list = ui.scope(|ui| {
            // Names are truncated at the width of the list, not of the panel.
            ui.set_max_width(118.0);
            ComboBox::from_id_salt("variant method")
                .selected_text(say(settings.method.title))
                .width(118.0)
                .truncate()
                .height(340.0)
                .show_ui(ui, |ui| {
                    for method in METHODS {
                        ui.selectable_value(&mut settings.method, method, say(method.title));
                    }
                })
                .response
        });
        let list = list.inner;
        field::named(&list, "Integrator of the variant", settings.method.title);
        let mut rate = 1.0 / settings.dt;
        if field::within(ui, &mut rate, MIN_RATE..=MAX_RATE, " Hz")
            .on_hover_text(say("Steps per simulated second of the variant"))
            .changed()
        {
            settings.dt = 1.0 / rate;
        }
        let list = ComboBox::from_id_salt("variant collision")
            .selected_text(say(collision_name(settings.collision)))
            .width(62.0)
            .truncate()
            .show_ui(ui, |ui| {
                for how in [Collision::Continuous, Collision::Bvh, Collision::Naive] {
                    ui.selectable_value(&mut settings.collision, how, say(collision_name(how)));
                }
            })
            .response;
        field::named(
            &list,
            "Collisions of the variant",
            collision_name(settings.collision),
        );
        if ui
            .button(say("Add"))
            .on_hover_text(say("Run the scene in this way too"))
            .clicked()
        {
            let mut all = session.compared();
            all.push(settings);
            session.compare_with(all);
        }
    });
    if settings != before {
        choice.settings = Some(settings);
    }
}

fn collision_name(how: Collision) -> &'static str {
    match how {
        Collision::Continuous => "within",
        Collision::Bvh => "BVH",
        Collision::Naive => "naive",
    }
}

/// The cost and the error of each run.
fn table(ui: &mut egui::Ui, session: &mut Session) {
    let (own, names) = session.variant_names();
    let none = || "-".to_owned();
    let metres = |error: Option<f64>| error.map_or_else(none, number::short);
    let mut removed = None;
    Grid::new("variants")
        .num_columns(5)
        .striped(true)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for (title, meaning) in [
                ("", ""),
                (
                    "Error, m",
                    "Distance from the exact path now, and the largest so far on hovering",
                ),
                (
                    "Energy",
                    "Change of the energy since the start, relative or in J on hovering",
                ),
                (
                    "Cost, s",
                    "Real time for a simulated second, and for a step on hovering",
                ),
            ] {
                ui.label(RichText::new(say(title)).small().strong())
                    .on_hover_text(say(meaning));
            }
            ui.end_row();
            let dt = session.world().settings().dt;
            let cost = session.figures().cost.seconds();
            run_name(
                ui,
                RichText::new(format!("⏺ {}", say(&own))).strong(),
                "The run itself",
            );
            figure(ui, metres(session.path_error()), String::new());
            let drift = session.drift();
            let energy = drift.relative_energy.or(drift.energy);
            figure(
                ui,
                energy.map_or_else(none, number::error),
                drift.energy_text(),
            );
            figure(
                ui,
                cost.map_or_else(none, |cost| number::short(cost / dt)),
                cost.map_or_else(String::new, |cost| {
                    format!("{} a step", number::seconds(cost))
                }),
            );
            ui.end_row();
            for (n, (variant, name)) in session.variants().iter().zip(&names).enumerate() {
                let text = RichText::new(format!("⏺ {}", say(name)));
                let text = text.color(super::style::word(variant.colour, ui.visuals()));
                run_name(ui, text, name);
                if let Some(why) = &variant.failure {
                    // Time and reason are shown on hovering, because the table is narrow.
                    let when = say(format!("stopped at {:.3} s", variant.time()));
                    let colour = super::style::AMBER.of(ui.visuals());
                    ui.label(RichText::new(say("stopped")).color(colour))
                        .on_hover_text(format!("{when}\n{}", say(why)));
                    ui.label("");
                    ui.label("");
                } else {
                    let now = variant.record().last().and_then(|last| last.sample.error);
                    let worst = variant.worst.map_or_else(String::new, |worst| {
                        format!("{} m at most so far", number::figure(worst))
                    });
                    figure(ui, metres(now), worst);
                    let drift = variant.drift.as_ref();
                    let energy = drift.and_then(|drift| drift.relative_energy.or(drift.energy));
                    let text = drift.map_or_else(String::new, |drift| drift.energy_text());
                    figure(ui, energy.map_or_else(none, number::error), text);
                    let (seconds, steps) = variant.cost;
                    let step = format!(
                        "{} a step, {} steps",
                        number::seconds(seconds / steps.max(1) as f64),
                        number::count(steps as f64)
                    );
                    figure(ui, variant.load().map_or_else(none, number::short), step);
                }
                if variant.settings.is_some()
                    && ui
                        .add(egui::Button::new("✖").small().frame(false))
                        .on_hover_text(say(format!("Compare no longer with {name}")))
                        .clicked()
                {
                    removed = Some(n);
                }
                ui.end_row();
            }
        });
    if let Some(n) = removed {
        let mut all = session.compared();
        all.remove(n);
        session.compare_with(all);
    }
    if ui
        .button(say("Compare nothing"))
        .on_hover_text(say("Forget all variants"))
        .clicked()
    {
        session.compare_with([]);
    }
}

/// The name of a run, truncated if it is too long.
fn run_name(ui: &mut egui::Ui, name: RichText, more: &str) {
    let size = egui::vec2(102.0, ui.spacing().interact_size.y);
    let left = egui::Layout::left_to_right(egui::Align::Center);
    ui.allocate_ui_with_layout(size, left, |ui| {
        ui.set_min_width(size.x);
        ui.add(egui::Label::new(name).truncate())
            .on_hover_text(say(more));
    });
}

fn figure(ui: &mut egui::Ui, text: String, more: String) {
    let label = ui.label(RichText::new(text).monospace());
    if !more.is_empty() {
        label.on_hover_text(say(more));
    }
}
