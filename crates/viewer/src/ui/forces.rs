//! The forces of the scene: a block of fields for each, and a menu to add others.

use egui::{ComboBox, RichText};
use scene::shown;
use sim_core::force::{Field, Value};
use sim_core::{DVec3, FORCES, Force};

use super::field;
use crate::session::{Session, State};
use crate::words::say;

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    let stopped = session.state() != State::Running;
    // Always one line, so that the contents below do not move.
    let about = match session.state() {
        State::Layout => "Beside the constant force of each body.",
        State::Running => "Pause to change them.",
        State::Paused => "Edits last until Reset.",
    };
    ui.label(RichText::new(say(about)).weak());
    ui.add_enabled_ui(stopped, |ui| {
        list(ui, session);
        add(ui, session);
    });
}

fn list(ui: &mut egui::Ui, session: &mut Session) {
    let names: Vec<String> = session
        .scene()
        .bodies
        .iter()
        .map(|b| shown::name(&b.name))
        .collect();
    for (i, force) in session.world().forces().to_vec().into_iter().enumerate() {
        ui.push_id(i, |ui| {
            let mut removed = false;
            ui.horizontal(|ui| {
                let about = force.description();
                ui.label(RichText::new(say(about.title)).strong())
                    .on_hover_text(say(about.law));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    removed = ui.button(say("Remove")).clicked();
                });
            });
            if removed {
                session.remove_force(i);
            } else if let Some(force) = fields(ui, &names, force) {
                session.replace_force(i, force);
            }
            ui.add_space(4.0);
        });
    }
}

/// The fields of a force; returns the changed force if one was changed.
fn fields(ui: &mut egui::Ui, names: &[String], mut force: Force) -> Option<Force> {
    let mut changed = false;
    force.fields(|field| changed |= show_field(ui, names, field));
    changed.then_some(force)
}

/// Shows one field. Returns whether it was changed.
fn show_field(ui: &mut egui::Ui, names: &[String], field: Field<'_>) -> bool {
    let Field { title, unit, .. } = field;
    let vector = |ui: &mut egui::Ui, title, value: &mut DVec3| {
        let new = field::vector(ui, title, unit, field.meaning, *value);
        new.map(|new| *value = new).is_some()
    };
    match field.value {
        Value::Number { value, .. } => {
            let new = field::scalar(ui, title, unit, field.meaning, *value);
            new.map(|new| *value = new).is_some()
        }
        Value::Vector(value) => vector(ui, title, value),
        Value::Body(body) => one_body(ui, names, title, body),
        Value::AnyBody(body) => choose(ui, names, title, Some("every body"), body),
        Value::Bodies([first, second]) => {
            one_body(ui, names, "From", first) | one_body(ui, names, "To", second)
        }
        // Only laws from outside have it, and the window offers none.
        Value::AnyBodies(_) => false,
        Value::Point(point) => {
            maybe_points(ui, title, point, |ui, point| vector(ui, "Point", point))
        }
        Value::Points(points) => maybe_points(ui, title, points, |ui, points| {
            let [from, to] = points;
            vector(ui, "Point of the first", from) | vector(ui, "Point of the second", to)
        }),
    }
}

/// Whether a force acts at other points than positions, and at which. Returns whether this was changed.
fn maybe_points<T: Default>(
    ui: &mut egui::Ui,
    title: &str,
    points: &mut Option<T>,
    fields: impl FnOnce(&mut egui::Ui, &mut T) -> bool,
) -> bool {
    let mut has = points.is_some();
    let changed = ui.checkbox(&mut has, say(title)).changed();
    if changed {
        *points = has.then(T::default);
    }
    changed | points.as_mut().is_some_and(|points| fields(ui, points))
}

/// A choice of one body. Returns whether it was changed.
fn one_body(ui: &mut egui::Ui, names: &[String], title: &str, body: &mut usize) -> bool {
    let mut chosen = Some(*body);
    let changed = choose(ui, names, title, None, &mut chosen);
    *body = chosen.unwrap_or(*body);
    changed
}

fn choose(
    ui: &mut egui::Ui,
    names: &[String],
    title: &str,
    all: Option<&str>,
    body: &mut Option<usize>,
) -> bool {
    let before = *body;
    let name = |i: usize| names.get(i).map_or("?", String::as_str);
    ui.horizontal(|ui| {
        field::label(ui, title, "The body that the force acts on");
        let list = ComboBox::from_id_salt(title)
            .selected_text(body.map_or_else(|| say(all.unwrap_or("?")), |i| name(i).to_owned()))
            .width(ui.available_width() - 8.0)
            .height(340.0)
            .show_ui(ui, |ui| {
                if let Some(all) = all {
                    ui.selectable_value(body, None, say(all));
                }
                for i in 0..names.len() {
                    ui.selectable_value(body, Some(i), name(i));
                }
            })
            .response;
        field::named(&list, title, body.map_or(all.unwrap_or("?"), name));
    });
    *body != before
}

/// The menu of forces; one that needs a body acts on the selected one.
fn add(ui: &mut egui::Ui, session: &mut Session) {
    let bodies = session.world().len();
    let body = session.selection().unwrap_or(0);
    let other = usize::from(body == 0);
    let position = |i| session.world().position(i);
    let mut offers = FORCES.to_vec();
    for force in &mut offers {
        force.fields(|field| match field.value {
            Value::Body(acts_on) => *acts_on = body,
            Value::AnyBody(acts_on) => *acts_on = session.selection(),
            Value::Bodies(acts_on) => *acts_on = [body, other],
            Value::Number { .. }
            | Value::Vector(_)
            | Value::AnyBodies(_)
            | Value::Point(_)
            | Value::Points(_) => {}
        });
    }
    offers.retain(|force| force.bodies().all(|body| body < bodies));
    for force in &mut offers {
        match force {
            Force::Anchor { anchor, .. } => *anchor = position(body) + DVec3::Y,
            Force::Spring { rest_length, .. } => {
                *rest_length = (position(body) - position(other)).length();
            }
            // The others begin with the same numbers wherever the bodies are.
            _ => {}
        }
    }
    let mut chosen = None;
    ui.horizontal(|ui| {
        field::label(
            ui,
            "Add",
            "A new force, for the selected body where it needs one",
        );
        let list = ComboBox::from_id_salt("add force")
            .selected_text(say("a force…"))
            .width(ui.available_width() - 8.0)
            .height(340.0)
            .show_ui(ui, |ui| {
                for force in offers {
                    let about = force.description();
                    let offer = ui.selectable_label(false, say(about.title));
                    if offer.on_hover_text(say(about.law)).clicked() {
                        chosen = Some(force);
                    }
                }
            })
            .response;
        field::named(&list, "Add force", "a force…");
    });
    if let Some(force) = chosen {
        session.add_force(force);
    }
}
