//! The selected body: its place in the set-up and its physics.

use egui::RichText;
use scene::{SceneShape, shown};
use sim_core::DVec3;

use super::field;
use super::handles::Handles;
use crate::number;
use crate::session::{Session, State};
use crate::words::say;

pub(super) fn show(ui: &mut egui::Ui, handles: &mut Handles, session: &mut Session) {
    let (Some(i), Some(body)) = (session.selection(), session.selected()) else {
        ui.label(RichText::new(say("Click a body in the picture or in the list.")).weak());
        return;
    };
    let (shape, rotation, scale) = (body.shape.clone(), body.rotation, body.scale);
    let obstacle = cannot_turn(&shape);
    heading(ui, session, i);
    handles.choose(ui, session);

    let world = session.world();
    let (position, velocity) = (world.origin(i), world.velocity(i));
    let spin = world.turns(i).then(|| world.spin(i));
    let (force, mass) = (world.force(i), world.mass(i));
    let immovable = !world.kind(i).is_movable();
    let (restitution, friction) = (world.restitution(i), world.friction(i));
    let layout = session.state() == State::Layout;
    let place = match shape {
        SceneShape::Mesh(_) => "Where the mesh's origin is",
        SceneShape::Sphere { .. } => "Where the centre is",
        SceneShape::HalfSpace { .. } => "A point of its plane",
    };
    if let Some(value) = field::vector(ui, "Position", "m", place, position) {
        session.set_position(value);
    }
    ui.add_enabled_ui(layout, |ui| match shape {
        SceneShape::Mesh(_) => turned(ui, session, rotation, scale),
        SceneShape::Sphere { radius } => {
            let value = field::scalar(ui, "Radius", "m", "Radius of the sphere", radius);
            if let Some(radius) = value {
                session.set_shape(SceneShape::Sphere { radius });
            }
        }
        SceneShape::HalfSpace { normal } => {
            let meaning = "Direction out of the half-space, of any length but 0";
            if let Some(normal) = field::vector(ui, "Normal", "", meaning, normal) {
                session.set_shape(SceneShape::HalfSpace { normal });
            }
        }
    })
    .response
    .on_disabled_hover_text(say("Part of the layout: Reset first"));
    if let Some(value) = field::vector(ui, "Velocity", "m/s", "Velocity v = dx/dt", velocity) {
        session.set_velocity(value);
    }
    turning(ui, session, spin, obstacle);
    ui.add_enabled_ui(!immovable, |ui| {
        let meaning = "Constant force on the body, F = m a";
        if let Some(value) = field::vector(ui, "Force", "N", meaning, force) {
            session.set_force(value);
        }
    })
    .response
    .on_disabled_hover_text(say(
        "Nothing moves it: it stands still or keeps its velocity",
    ));
    mass_and_restitution(ui, session, (mass, immovable), restitution);
    let meaning = "Coefficient of friction µ from 0, smooth, to inf, which never slips: the force \
                   along a contact is at most µ times that across it, |F_t| ≤ µ F_n; of two bodies \
                   √(µ₁ µ₂) counts, 0 where one is smooth";
    if let Some(value) = field::scalar(ui, "Friction", "", meaning, friction) {
        session.set_friction(value);
    }
    ui.horizontal(|ui| {
        ui.add_enabled_ui(layout, |ui| {
            if ui
                .button(say("Duplicate"))
                .on_hover_text(say("Add a copy beside everything else"))
                .on_disabled_hover_text(say("Reset first: physics has begun"))
                .clicked()
            {
                session.duplicate_selected();
            }
            if ui
                .button(say("Delete"))
                .on_hover_text(say("Take the body out of the scene (Delete)"))
                .on_disabled_hover_text(say("Reset first: physics has begun"))
                .clicked()
            {
                session.delete_selected();
            }
        });
        if !layout {
            ui.label(RichText::new(say("Edits last until Reset.")).weak());
        }
    });
}

fn turned(ui: &mut egui::Ui, session: &mut Session, rotation: DVec3, scale: DVec3) {
    let meaning = "Turn about the fixed axes x, then y, then z";
    if let Some(value) = field::vector(ui, "Rotation", "°", meaning, rotation) {
        session.set_rotation(value);
    }
    let meaning = "Stretch along the body's own axes; not 0";
    if let Some(value) = field::vector(ui, "Scale", "", meaning, scale) {
        session.set_scale(value);
    }
}

/// The reason why a shape cannot rotate, if it cannot.
fn cannot_turn(shape: &SceneShape) -> Option<&'static str> {
    match shape {
        SceneShape::HalfSpace { .. } => Some("A half-space cannot turn"),
        SceneShape::Mesh(mesh) if !mesh.mesh().is_closed() => {
            Some("Its mesh is open, so that it has no inertia: give `inertia` in the scene file")
        }
        SceneShape::Mesh(_) | SceneShape::Sphere { .. } => None,
    }
}

/// Whether the body is a turning body, and its spin; or the reason why it cannot rotate.
fn turning(
    ui: &mut egui::Ui,
    session: &mut Session,
    spin: Option<DVec3>,
    obstacle: Option<&'static str>,
) {
    let layout = session.state() == State::Layout;
    let why = match layout {
        true => obstacle.unwrap_or_default(),
        false => "Part of the layout: Reset first",
    };
    let mut turns = spin.is_some();
    let can = layout && (turns || obstacle.is_none());
    let switch = egui::Checkbox::new(&mut turns, say("Turns"));
    let changed = ui
        .add_enabled(can, switch)
        .on_hover_text(say(
            "It turns about its centre of mass, and impacts turn it",
        ))
        .on_disabled_hover_text(say(why))
        .changed();
    if changed {
        session.set_turns(turns);
    }
    let Some(spin) = spin else { return };
    let meaning = "Angular velocity ω about the axes of the world";
    if let Some(value) = field::vector(ui, "Spin", "rad/s", meaning, spin) {
        session.set_spin(value);
    }
    let Some(i) = session.selection() else { return };
    let world = session.world();
    let three = |v: DVec3| [v.x, v.y, v.z].map(number::figure).join("  ");
    let meaning = "Angular momentum about the centre of mass, L = I ω, kg m²/s, along the axes of the world. In \
                   free flight it stays, while ω need not";
    field::figure(ui, "L, kg m²/s", meaning, three(world.angular_momentum(i)));
    if let Some(inertia) = world.inertia(i) {
        let meaning = "Principal moments of inertia, kg m²: how hard it is to turn the body about its three own \
                       axes. About the one with the middle moment no turning lasts";
        field::figure(ui, "I, kg m²", meaning, three(inertia.moments()));
    }
}

fn mass_and_restitution(
    ui: &mut egui::Ui,
    session: &mut Session,
    (mass, mut immovable): (f64, bool),
    restitution: f64,
) {
    let is_half_space = session
        .selected()
        .is_some_and(|body| matches!(body.shape, SceneShape::HalfSpace { .. }));
    ui.horizontal(|ui| {
        if !immovable {
            if let Some(value) = field::scalar(ui, "Mass", "kg", "Mass, above 0", mass) {
                session.set_mass(value);
            }
        } else {
            field::label(ui, "Mass", "An immovable body needs none");
        }
        let changed = ui
            .add_enabled(
                !is_half_space,
                egui::Checkbox::new(&mut immovable, say("Immovable")),
            )
            .on_hover_text(say(
                "Nothing moves it: it stands still or keeps its velocity",
            ))
            .on_disabled_hover_text(say(
                "Half-spaces always are: they stand still or keep their velocity",
            ))
            .changed();
        if changed {
            session.set_immovable(immovable);
        }
    });
    ui.horizontal(|ui| {
        let meaning = "Part e of the approaching speed that is left after an impact, v' = -e v along \
                       the normal; of the two bodies' the lesser one counts";
        field::label(ui, "Restitution", meaning);
        let mut value = restitution;
        let slider = field::slider(ui, &mut value, 0.0..=1.0, "", |slider| {
            slider.max_decimals(3)
        });
        if slider.on_hover_text(say(meaning)).changed() {
            session.set_restitution(value);
        }
    });
}

/// The name as a field: Enter or leaving the field accepts the new name.
fn rename(ui: &mut egui::Ui, session: &mut Session, i: usize) {
    let now = session.scene().bodies[i].name.clone();
    let id = ui.scope_id().with(("name", i));
    let typed = ui.data(|data| data.get_temp::<String>(id));
    let mut text = typed.unwrap_or_else(|| shown::name(&now));
    let edit = egui::TextEdit::singleline(&mut text)
        .id(id.with("field"))
        .font(egui::TextStyle::Button)
        .desired_width(150.0);
    let edit = ui.add(edit).on_hover_text(say("Name of the body"));
    if edit.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        if text != shown::name(&now) {
            session.rename_selected(&text);
        }
    } else if edit.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
}

/// Colour, name and shape.
fn heading(ui: &mut egui::Ui, session: &mut Session, i: usize) {
    let mut colour = session.colour(i).map(|part| (255.0 * part).round() as u8);
    ui.horizontal(|ui| {
        if egui::color_picker::color_edit_button_srgb(ui, &mut colour)
            .on_hover_text(say("Colour of the body"))
            .changed()
        {
            session.set_colour(colour.map(|part| f32::from(part) / 255.0));
        }
        rename(ui, session, i);
        let mut seen = !session.is_hidden(i);
        if ui
            .checkbox(&mut seen, say("Shown"))
            .on_hover_text(say(
                "Whether it is in the picture; it moves and collides all the same",
            ))
            .changed()
        {
            session.hide(i, !seen);
        }
    });
    ui.horizontal(|ui| {
        let body = &session.scene().bodies[i];
        let about = match &body.shape {
            SceneShape::Mesh(mesh) => {
                let triangles = mesh.mesh().triangles().len();
                format!("{}, {triangles} triangles", shown::name(mesh.name()))
            }
            SceneShape::Sphere { .. } => "sphere".to_owned(),
            SceneShape::HalfSpace { .. } => "half-space".to_owned(),
        };
        ui.add(egui::Label::new(RichText::new(say(about)).weak()).truncate());
    });
}
