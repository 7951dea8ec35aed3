//! The forces of the scene: a block of fields for each, and a menu to add others.

use egui::{ComboBox, RichText};
use scene::shown;
use sim_core::{DVec3, Force};

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
                ui.label(RichText::new(say(title(&force))).strong())
                    .on_hover_text(say(law(&force)));
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
    let scalar = |ui: &mut egui::Ui, name, unit, meaning, value: &mut f64| {
        let new = field::scalar(ui, name, unit, meaning, *value);
        new.map(|new| *value = new).is_some()
    };
    let vector = |ui: &mut egui::Ui, name, unit, meaning, value: &mut DVec3| {
        let new = field::vector(ui, name, unit, meaning, *value);
        new.map(|new| *value = new).is_some()
    };
    let changed = match &mut force {
        Force::Gravity { acceleration } => {
            vector(ui, "g", "m/s²", "Acceleration of every body", acceleration)
        }
        Force::LinearDrag { body, coefficient } => {
            maybe_body(ui, names, body)
                | scalar(
                    ui,
                    "Coefficient",
                    "kg/s",
                    "c of F = -c v, from 0",
                    coefficient,
                )
        }
        Force::QuadraticDrag { body, coefficient } => {
            maybe_body(ui, names, body)
                | scalar(
                    ui,
                    "Coefficient",
                    "kg/m",
                    "c of F = -c |v| v, from 0",
                    coefficient,
                )
        }
        Force::Anchor {
            body,
            point,
            anchor,
            rest_length,
            stiffness,
            damping,
        } => {
            one_body(ui, names, "Body", body)
                | maybe_points(ui, "Tied at a point of the body", point, |ui, point| {
                    vector(ui, "Point", "m", POINT, point)
                })
                | vector(ui, "Anchor", "m", "The fixed point", anchor)
                | scalar(ui, "Stiffness", "N/m", "From 0", stiffness)
                | scalar(ui, "Damping", "kg/s", "From 0", damping)
                | scalar(
                    ui,
                    "Rest length",
                    "m",
                    "Length without force, from 0",
                    rest_length,
                )
        }
        Force::Spring {
            bodies: [first, second],
            points,
            rest_length,
            stiffness,
            damping,
        } => {
            one_body(ui, names, "From", first)
                | one_body(ui, names, "To", second)
                | maybe_points(ui, "Tied at points of the bodies", points, |ui, points| {
                    let [from, to] = points;
                    vector(ui, "Point of the first", "m", POINT, from)
                        | vector(ui, "Point of the second", "m", POINT, to)
                })
                | scalar(ui, "Stiffness", "N/m", "From 0", stiffness)
                | scalar(ui, "Damping", "kg/s", "From 0", damping)
                | scalar(
                    ui,
                    "Rest length",
                    "m",
                    "Length without force, from 0",
                    rest_length,
                )
        }
        Force::Push { body, point, force } => {
            one_body(ui, names, "Body", body)
                | vector(ui, "Point", "m", POINT, point)
                | vector(ui, "Force", "N", "The constant force at that point", force)
        }
        Force::Attraction {
            body,
            centre,
            strength,
        } => {
            maybe_body(ui, names, body)
                | vector(ui, "Centre", "m", "The point that attracts", centre)
                | scalar(ui, "Strength", "m³/s²", "G M, from 0", strength)
        }
        Force::Gravitation { constant } => {
            scalar(ui, "Constant", "m³/(kg s²)", "G, from 0", constant)
        }
        Force::Body { .. } | Force::Pair { .. } => false,
    };
    changed.then_some(force)
}

const POINT: &str = "Where the force acts, in the frame of the body's shape";

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

/// A choice of one body or every one. Returns whether it was changed.
fn maybe_body(ui: &mut egui::Ui, names: &[String], body: &mut Option<usize>) -> bool {
    choose(ui, names, "Body", Some("every body"), body)
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
    let mut offers = vec![
        Force::Gravity {
            acceleration: DVec3::new(0.0, -9.81, 0.0),
        },
        Force::LinearDrag {
            body: session.selection(),
            coefficient: 0.5,
        },
        Force::QuadraticDrag {
            body: session.selection(),
            coefficient: 0.1,
        },
        Force::Attraction {
            body: session.selection(),
            centre: DVec3::ZERO,
            strength: 1.0,
        },
        Force::Gravitation { constant: 1.0 },
    ];
    if bodies > 0 {
        offers.push(Force::Push {
            body,
            point: DVec3::ZERO,
            force: DVec3::Y,
        });
        offers.push(Force::Anchor {
            body,
            point: None,
            anchor: session.world().position(body) + DVec3::Y,
            rest_length: 1.0,
            stiffness: 10.0,
            damping: 0.0,
        });
    }
    if bodies > 1 {
        let way = session.world().position(body) - session.world().position(other);
        offers.push(Force::Spring {
            bodies: [body, other],
            points: None,
            rest_length: way.length(),
            stiffness: 10.0,
            damping: 0.0,
        });
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
                    let offer = ui.selectable_label(false, say(title(&force)));
                    if offer.on_hover_text(say(law(&force))).clicked() {
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

fn title(force: &Force) -> &'static str {
    match force {
        Force::Gravity { .. } => "Gravity",
        Force::LinearDrag { .. } => "Linear drag",
        Force::QuadraticDrag { .. } => "Quadratic drag",
        Force::Anchor { .. } => "Spring to a point",
        Force::Spring { .. } => "Spring between bodies",
        Force::Push { .. } => "Push at a point",
        Force::Attraction { .. } => "Attraction to a point",
        Force::Gravitation { .. } => "Gravitation",
        Force::Body { .. } | Force::Pair { .. } => "Custom",
    }
}

fn law(force: &Force) -> &'static str {
    match force {
        Force::Gravity { .. } => "Weight, F = m g: every body falls with the same acceleration",
        Force::LinearDrag { .. } => "F = -c v",
        Force::QuadraticDrag { .. } => "F = -c |v| v",
        Force::Anchor { .. } => "F = -k (1 - L/|d|) d - c v, with d from the point to the body",
        Force::Spring { .. } => {
            "F = k (|d| - L) + c d|d|/dt along the line d: the stretch and its rate"
        }
        Force::Push { .. } => {
            "A constant force at a point of the body, with the torque r × F about its centre of mass"
        }
        Force::Attraction { .. } => "F = -m G M / r², to the point",
        Force::Gravitation { .. } => "F = G m m / r² between every two bodies",
        Force::Body { .. } | Force::Pair { .. } => "A law from outside",
    }
}
