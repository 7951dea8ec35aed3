//! What is drawn besides the bodies.

use egui::{RichText, Slider};

use super::field;
use crate::number;
use crate::session::Session;

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        if ui
            .button("Frame")
            .on_hover_text("Look at the selected body, or at everything (F)")
            .clicked()
        {
            session.frame();
        }
        if ui
            .button("Home")
            .on_hover_text("Look as when the scene was opened (Home)")
            .clicked()
        {
            session.go_home();
        }
        let mut following = session.is_following();
        if ui
            .checkbox(&mut following, "Follow")
            .on_hover_text(
                "Let the camera go along with the selected body, or with all that moves (V)",
            )
            .changed()
        {
            session.follow(following);
        }
        ui.checkbox(&mut session.display.grid, "Ground grid");
    });
    ui.horizontal(|ui| {
        field::label(ui, "Velocity", "Blue arrows");
        ui.checkbox(&mut session.display.all_velocities, "of every body")
            .on_hover_text("Otherwise of the selected body");
    });
    ui.horizontal(|ui| {
        field::label(ui, "Arrow", "Length of a velocity arrow");
        ui.add(
            Slider::new(&mut session.display.arrow_time, 0.01..=10.0)
                .logarithmic(true)
                .suffix(" s"),
        )
        .on_hover_text("An arrow shows how far its body goes in this time");
    });
    ui.horizontal(|ui| {
        let mut trails = session.display.trails;
        if ui
            .checkbox(&mut trails, "Trails")
            .on_hover_text("Where bodies have been in the last 600 steps (T)")
            .changed()
        {
            session.show_trails(trails);
        }
        ui.checkbox(&mut session.display.ties, "Springs and centres")
            .on_hover_text("Springs as zigzags, anchors and centres of attraction as crosses");
    });
    ui.checkbox(&mut session.display.between, "Between states")
        .on_hover_text(
            "Bodies on their way from state to state, through the places of their impacts at the times of \
             these. Otherwise they jump from state to state, as they are stepped",
        );
    ui.checkbox(&mut session.display.impacts, "Impacts")
        .on_hover_text(
            "What of each body touches, in violet; points of contact with their normals, and the impulses as arrows, compared with the \
             strongest in sight. They fade within half a second of simulated time",
        );
    boxes(ui, session);
}

fn boxes(ui: &mut egui::Ui, session: &mut Session) {
    ui.checkbox(&mut session.display.bvh.shown, "Bounding volume hierarchy")
        .on_hover_text("Boxes around parts of a mesh, coloured by depth (B)");
    if !session.display.bvh.shown {
        return;
    }
    let levels = session.bvh_depth();
    let nothing = session.selection().is_none() && !session.display.bvh.every_body;
    let view = &mut session.display.bvh;
    ui.horizontal(|ui| {
        field::label(ui, "Boxes of", "Whose hierarchy is drawn");
        ui.selectable_value(&mut view.every_body, false, "selected body");
        ui.selectable_value(&mut view.every_body, true, "every body");
    });
    if nothing {
        ui.label(RichText::new("No body is selected: boxes of every body.").weak());
    }
    ui.horizontal(|ui| {
        field::label(
            ui,
            "Depth",
            "0 is the box around the whole mesh; [ and ] go up and down",
        );
        ui.add_enabled(
            !view.every_depth,
            Slider::new(&mut view.depth, 0..=levels.saturating_sub(1)),
        )
        .on_hover_text("Depth of the boxes drawn");
        ui.checkbox(&mut view.every_depth, "all");
    });
    tree(ui, session);
}

/// What the selected body's tree is like.
fn tree(ui: &mut egui::Ui, session: &Session) {
    let Some(bvh) = session.selection().and_then(|i| session.world().bvh(i)) else {
        return;
    };
    field::figure(
        ui,
        "Tree",
        "Nodes of up to four boxes, leaves of up to four triangles among them; levels of both",
        format!(
            "{} nodes, {} levels",
            number::count(bvh.node_count() as f64),
            bvh.depth()
        ),
    );
    field::figure(
        ui,
        "Cost",
        "Boxes and triangles' boxes that a random ray through the root's box is expected to meet \
         (surface area heuristic)",
        format!("{:.1} by surface area", bvh.surface_area_cost()),
    );
    field::figure(
        ui,
        "Memory",
        "Nodes, leaves, and the triangles in them",
        format!("{:.0} bytes a triangle", bvh.bytes_per_triangle()),
    );
}
