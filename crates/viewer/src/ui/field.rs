//! Rows of the panel: a label, and numbers with their unit.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::emath::Numeric;
use egui::{DragValue, RichText, Slider};
use sim_core::DVec3;

use crate::expression;
use crate::session::Notices;
use crate::words::say;

/// Width of the labels, so that values line up, in points.
const LABEL: f32 = 76.0;

/// A label of the common width; hovering shows its meaning.
pub(super) fn label(ui: &mut egui::Ui, text: &str, meaning: &str) {
    let size = egui::vec2(LABEL, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(
        size,
        egui::Layout::left_to_right(egui::Align::Center),
        |ui| {
            ui.set_min_width(LABEL);
            ui.add(egui::Label::new(say(text)).truncate())
                .on_hover_text(say(meaning));
        },
    );
}

/// A row of three numbers; returns the new value if one was changed.
pub(super) fn vector(
    ui: &mut egui::Ui,
    name: &str,
    unit: &str,
    meaning: &str,
    mut value: DVec3,
) -> Option<DVec3> {
    let mut changed = false;
    ui.horizontal(|ui| {
        label(ui, &titled(name, unit), meaning);
        ui.spacing_mut().item_spacing.x = 4.0;
        let width = (ui.available_width() - 8.0) / 3.0;
        for (axis, part) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
            changed |= number(ui, part, width)
                .on_hover_text(format!("{axis}: {}", typed(meaning)))
                .changed();
        }
    });
    changed.then_some(value)
}

/// A row of one number and its unit; returns the new value if it was changed.
pub(super) fn scalar(
    ui: &mut egui::Ui,
    name: &str,
    unit: &str,
    meaning: &str,
    mut value: f64,
) -> Option<f64> {
    let mut changed = false;
    ui.horizontal(|ui| {
        label(ui, name, meaning);
        ui.spacing_mut().item_spacing.x = 4.0;
        let width = (ui.available_width() - 8.0) / 3.0;
        changed = number(ui, &mut value, width)
            .on_hover_text(typed(meaning))
            .changed();
        if !unit.is_empty() {
            ui.label(unit);
        }
    });
    changed.then_some(value)
}

/// Gives assistive technology the name of a combo box and the chosen entry.
pub(super) fn named(list: &egui::Response, name: &str, chosen: &str) {
    list.widget_info(|| {
        let mut info = egui::WidgetInfo::labeled(egui::Role::ComboBox, list.enabled(), say(name));
        info.current_text_value = Some(say(chosen));
        info
    });
}

/// A row that only shows a value.
pub(super) fn figure(ui: &mut egui::Ui, name: &str, meaning: &str, value: impl Into<String>) {
    ui.horizontal(|ui| {
        label(ui, name, meaning);
        let value = say(value.into());
        ui.add(egui::Label::new(RichText::new(value).monospace()).truncate())
            .on_hover_text(say(meaning));
    });
}

/// The reason why the last typed text was refused.
type Refused = Option<String>;

/// Shows why the last typed text was refused, until a number is accepted.
pub(super) fn tell_refused(ctx: &egui::Context, notices: &mut Notices) {
    match ctx.data_mut(|data| data.remove_temp::<Refused>(refused_id())) {
        Some(Some(why)) => notices.error("number", why),
        Some(None) => notices.dismiss("number"),
        None => {}
    }
}

fn refused_id() -> egui::Id {
    egui::Id::unique("refused number")
}

/// Parses the typed text, including a unit, and stores the reason of a refusal.
fn read(
    typed: &str,
    unit: &str,
    range: &RangeInclusive<f64>,
    refused: &RefCell<Refused>,
) -> Option<f64> {
    let number = typed.trim().strip_suffix(unit.trim()).unwrap_or(typed);
    let number = expression::value(number);
    let why = match number {
        None => format!("\"{typed}\" is not a number: write it like 1.5, -2e-3 or 1/60."),
        Some(number) if !range.contains(&number) => {
            let [least, most] = [range.start(), range.end()].map(|end| shown(*end, 4));
            format!("\"{typed}\" is not taken here: numbers from {least} to {most} are.")
        }
        _ => return number,
    };
    refused.replace(Some(why));
    None
}

/// Passes on the refusal of a field; an accepted value ends the last refusal.
fn settle(ui: &egui::Ui, response: &egui::Response, refused: RefCell<Refused>) {
    let refused = refused.into_inner();
    if refused.is_some() || response.changed() {
        ui.data_mut(|data| data.insert_temp(refused_id(), refused));
    }
}

/// A number that changes when typing ends rather than at each key, so that a mass of 0.5 can be typed although 0 is
/// refused.
fn number(ui: &mut egui::Ui, value: &mut f64, width: f32) -> egui::Response {
    let speed = 0.01 * value.abs().clamp(0.1, 1e9);
    let refused = RefCell::new(None);
    let all = f64::NEG_INFINITY..=f64::INFINITY;
    let response = ui.add_sized(
        [width, ui.spacing().interact_size.y],
        DragValue::new(value)
            .speed(speed)
            .max_decimals(4)
            .custom_formatter(|value, decimals| shown(value, *decimals.end()))
            .custom_parser(|typed| read(typed, "", &all, &refused))
            .update_while_editing(false),
    );
    settle(ui, &response, refused);
    response
}

/// A number in a range, dragged by factors and typed as in [`number`].
pub(super) fn within(
    ui: &mut egui::Ui,
    value: &mut f64,
    range: RangeInclusive<f64>,
    unit: &str,
) -> egui::Response {
    let refused = RefCell::new(None);
    let speed = 0.01 * *value;
    let field = DragValue::new(value)
        .speed(speed)
        .range(range.clone())
        .custom_formatter(|value, _| shown(value, 1))
        .suffix(unit)
        .custom_parser(|typed| read(typed, unit, &range, &refused))
        .update_while_editing(false);
    let response = ui.add(field);
    settle(ui, &response, refused);
    response
}

/// A slider with its number, typed as in [`number`].
pub(super) fn slider<N: Numeric>(
    ui: &mut egui::Ui,
    value: &mut N,
    range: RangeInclusive<N>,
    unit: &str,
    look: impl FnOnce(Slider<'_>) -> Slider<'_>,
) -> egui::Response {
    let refused = RefCell::new(None);
    let numbers = range.start().to_f64()..=range.end().to_f64();
    let slider = Slider::new(value, range)
        .suffix(unit)
        .custom_parser(|typed| read(typed, unit, &numbers, &refused))
        .update_while_editing(false);
    let response = ui.add(look(slider));
    settle(ui, &response, refused);
    response
}

/// A number as text that fits a field.
pub(super) fn shown(value: f64, decimals: usize) -> String {
    // Adding +0 removes the sign of -0, which is also a rounded value.
    let value = value + 0.0;
    if value.abs() >= 1e6 || value != 0.0 && value.abs() < 1e-3 {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// The meaning of a field, and how to change it.
fn typed(meaning: &str) -> String {
    format!("{}\n{}", say(meaning), say("Drag, or click to type."))
}

fn titled(name: &str, unit: &str) -> String {
    if unit.is_empty() {
        say(name)
    } else {
        format!("{}, {unit}", say(name))
    }
}

#[cfg(test)]
mod tests {
    use super::shown;

    #[test]
    fn fields_show_every_number_in_little_room() {
        let cases = [
            (1.0, "1"),
            (-0.0, "0"),
            (0.25, "0.25"),
            (100.0, "100"),
            (-12.3456789, "-12.3457"),
            (1e300, "1.00e300"),
            (6562773022.0, "6.56e9"),
            (-2e-9, "-2.00e-9"),
        ];
        for (value, text) in cases {
            assert_eq!(shown(value, 4), text);
        }
    }
}
