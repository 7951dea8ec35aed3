//! The selected body: its place in the set-up and its physics.

use egui::RichText;

use super::field;
use crate::session::{Session, State};

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    let (Some(i), Some(body)) = (session.selection(), session.selected()) else {
        ui.label(RichText::new("Click a body in the picture or in the list.").weak());
        return;
    };
    let (rotation, scale) = (body.rotation, body.scale);
    heading(ui, session, i);

    let world = session.world();
    let (position, velocity) = (world.position(i), world.velocity(i));
    let (force, mass) = (world.force(i), world.mass(i));
    let layout = session.state() == State::Layout;
    if let Some(value) = field::vector(ui, "Position", "m", "Where the mesh's origin is", position)
    {
        session.set_position(value);
    }
    ui.add_enabled_ui(layout, |ui| {
        if let Some(value) = field::vector(
            ui,
            "Rotation",
            "°",
            "Turn about the fixed axes x, then y, then z",
            rotation,
        ) {
            session.set_rotation(value);
        }
        if let Some(value) = field::vector(
            ui,
            "Scale",
            "",
            "Stretch along the body's own axes; not 0",
            scale,
        ) {
            session.set_scale(value);
        }
    })
    .response
    .on_disabled_hover_text("Part of the layout: Reset first");
    if let Some(value) = field::vector(ui, "Velocity", "m/s", "Velocity", velocity) {
        session.set_velocity(value);
    }
    if let Some(value) = field::vector(ui, "Force", "N", "Constant force on the body", force) {
        session.set_force(value);
    }
    if let Some(value) = field::scalar(ui, "Mass", "kg", "Mass, above 0", mass) {
        session.set_mass(value);
    }
    ui.horizontal(|ui| {
        ui.add_enabled_ui(layout, |ui| {
            if ui
                .button("Duplicate")
                .on_hover_text("Add a copy beside everything else")
                .on_disabled_hover_text("Reset first: physics has begun")
                .clicked()
            {
                session.duplicate_selected();
            }
            if ui
                .button("Delete")
                .on_hover_text("Take the body out of the scene (Delete)")
                .on_disabled_hover_text("Reset first: physics has begun")
                .clicked()
            {
                session.delete_selected();
            }
        });
        if !layout {
            ui.label(RichText::new("Edits last until Reset.").weak());
        }
    });
}

/// Colour, name and mesh.
fn heading(ui: &mut egui::Ui, session: &mut Session, i: usize) {
    let mut colour = session.colour(i).map(|part| (255.0 * part).round() as u8);
    ui.horizontal(|ui| {
        if egui::color_picker::color_edit_button_srgb(ui, &mut colour)
            .on_hover_text("Colour of the body")
            .changed()
        {
            session.set_colour(colour.map(|part| f32::from(part) / 255.0));
        }
        let body = &session.scene().bodies[i];
        ui.add(egui::Label::new(RichText::new(&body.name).strong()).truncate());
        let triangles = session
            .world()
            .mesh(i)
            .map_or(0, |mesh| mesh.triangles().len());
        let about = format!("{}, {triangles} triangles", body.mesh.name());
        ui.add(egui::Label::new(RichText::new(about).weak()).truncate());
    });
}
