//! Rows of the panel: a label, and numbers with their unit.

use egui::{DragValue, RichText};
use sim_core::DVec3;

/// Width of the labels, so that values line up, in points.
const LABEL: f32 = 76.0;

/// A label of the common width, with what it means on hovering.
pub(super) fn label(ui: &mut egui::Ui, text: &str, meaning: &str) {
    let size = egui::vec2(LABEL, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(
        size,
        egui::Layout::left_to_right(egui::Align::Center),
        |ui| {
            ui.set_min_width(LABEL);
            ui.add(egui::Label::new(text).truncate())
                .on_hover_text(meaning);
        },
    );
}

/// A row of three numbers; the new value if one was changed.
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
                .on_hover_text(format!("{axis}: {meaning}\nDrag, or click to type."))
                .changed();
        }
    });
    changed.then_some(value)
}

/// A row of one number; the new value if it was changed.
pub(super) fn scalar(
    ui: &mut egui::Ui,
    name: &str,
    unit: &str,
    meaning: &str,
    mut value: f64,
) -> Option<f64> {
    let mut changed = false;
    ui.horizontal(|ui| {
        label(ui, &titled(name, unit), meaning);
        ui.spacing_mut().item_spacing.x = 4.0;
        let width = (ui.available_width() - 8.0) / 3.0;
        changed = number(ui, &mut value, width)
            .on_hover_text(format!("{meaning}\nDrag, or click to type."))
            .changed();
    });
    changed.then_some(value)
}

/// A row that only shows a value.
pub(super) fn figure(ui: &mut egui::Ui, name: &str, meaning: &str, value: impl Into<String>) {
    ui.horizontal(|ui| {
        label(ui, name, meaning);
        ui.add(egui::Label::new(RichText::new(value).monospace()).truncate())
            .on_hover_text(meaning);
    });
}

/// A number that changes when typing ends rather than at each key, so that a mass of 0.5 can be
/// typed although 0 is refused.
fn number(ui: &mut egui::Ui, value: &mut f64, width: f32) -> egui::Response {
    let speed = 0.01 * value.abs().clamp(0.1, 1e9);
    ui.add_sized(
        [width, ui.spacing().interact_size.y],
        DragValue::new(value)
            .speed(speed)
            .max_decimals(4)
            .update_while_editing(false),
    )
}

fn titled(name: &str, unit: &str) -> String {
    if unit.is_empty() {
        name.to_owned()
    } else {
        format!("{name}, {unit}")
    }
}
