//! The settings of what is drawn besides the bodies.

use egui::RichText;

use super::field;
use crate::number;
use crate::session::{Session, Side, turns};
use crate::words::say;

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        if ui
            .button(say("Frame"))
            .on_hover_text(say("Look at the selected body, or at everything (F)"))
            .clicked()
        {
            session.frame();
        }
        if ui
            .button(say("Home view"))
            .on_hover_text(say("Look as when the scene was opened (Home)"))
            .clicked()
        {
            session.go_home();
        }
        let mut following = session.is_following();
        if ui
            .checkbox(&mut following, say("Follow"))
            .on_hover_text(say(
                "Let the camera go along with the selected body, or with all that moves (V)",
            ))
            .changed()
        {
            session.follow(following);
        }
    });
    ui.horizontal(|ui| {
        for (name, side) in [
            ("Front", Side::Front),
            ("Right", Side::Right),
            ("Top", Side::Top),
        ] {
            if ui
                .button(say(name))
                .on_hover_text(say("Look from there (1, 2, 3)"))
                .clicked()
            {
                session.look_from(side);
            }
        }
        ui.checkbox(&mut session.camera.parallel, say("Parallel"))
            .on_hover_text(say(
                "No perspective: far things are as large as near ones (O)",
            ));
    });
    ui.horizontal(|ui| {
        let display = &mut session.display;
        ui.checkbox(&mut display.grid, say("Ground grid"));
        ui.add_enabled_ui(display.grid, |ui| {
            ui.checkbox(&mut display.numbers, say("Numbers"))
                .on_hover_text(say("Letters and numbers on the axes, in m"));
        });
        ui.checkbox(&mut display.names, say("Names"))
            .on_hover_text(say(
                "The names of all bodies, not of the selected one alone (M)",
            ));
        ui.checkbox(&mut display.wireframe, say("Edges"))
            .on_hover_text(say("The edges of all meshes (W)"));
    });
    ui.horizontal(|ui| {
        field::label(ui, "Velocity", "Blue arrows");
        ui.checkbox(&mut session.display.all_velocities, say("of every body"))
            .on_hover_text(say("Otherwise of the selected body"));
    });
    ui.horizontal(|ui| {
        field::label(ui, "Arrow", "Length of a velocity arrow");
        let time = &mut session.display.arrow_time;
        field::slider(ui, time, 0.01..=10.0, " s", |slider| {
            slider.logarithmic(true)
        })
        .on_hover_text(say("An arrow shows how far its body goes in this time"));
    });
    ui.horizontal(|ui| {
        field::label(ui, "Forces", "Red arrows");
        ui.checkbox(&mut session.display.forces, say("shown"))
            .on_hover_text(say(
                "The sum of all forces on each body, without those of contacts",
            ));
        ui.add_enabled_ui(session.display.forces, |ui| {
            ui.spacing_mut().slider_width = 70.0;
            let metres = &mut session.display.arrow_metres;
            field::slider(ui, metres, 1e-4..=10.0, " m/N", |slider| {
                slider.logarithmic(true)
            })
            .on_hover_text(say("Length of an arrow for each newton"));
        });
    });
    if turns(session.world()) {
        spins(ui, session);
    }
    ui.horizontal(|ui| {
        let mut trails = session.display.trails;
        if ui
            .checkbox(&mut trails, say("Trails"))
            .on_hover_text(say("Where bodies have been in the last 10 s, or the last 600 steps where these take longer (T)"))
            .changed()
        {
            session.show_trails(trails);
        }
        ui.checkbox(&mut session.display.ties, say("Springs and centres"))
            .on_hover_text(say(
                "Springs as zigzags, anchors and centres of attraction as crosses",
            ));
    });
    ui.checkbox(&mut session.display.between, say("Between states"))
        .on_hover_text(say(
            "Bodies on their way from state to state, through the places of their impacts at the times of \
             these. Otherwise they jump from state to state, as they are stepped",
        ));
    ui.checkbox(&mut session.display.rest, say("Grey at rest"))
        .on_hover_text(say("Bodies that stand still are grey"));
    ui.checkbox(&mut session.display.impacts, say("Impacts"))
        .on_hover_text(say(
            "What of each body touches, in violet; points of contact with their normals, and the impulses as \
             arrows, compared with the strongest in sight. They fade within half a second of simulated time",
        ));
    boxes(ui, session);
}

/// Arrows of angular velocity and angular momentum.
fn spins(ui: &mut egui::Ui, session: &mut Session) {
    let display = &mut session.display;
    ui.horizontal(|ui| {
        field::label(ui, "Turning", "Green and dark red arrows");
        ui.checkbox(&mut display.spins, say("of every body that turns"))
            .on_hover_text(say(
                "Angular velocity ω along the axis, which is drawn too: seen from the tip the body turns \
                 counterclockwise. And angular momentum L = I ω. Otherwise of the selected body",
            ));
    });
    let rows = [
        (
            "  ω",
            &mut display.spin_metres,
            " m s/rad",
            "Length of an arrow for each rad/s of angular velocity",
        ),
        (
            "  L",
            &mut display.momentum_metres,
            " m/(kg m²/s)",
            "Length of an arrow for each kg m²/s of angular momentum",
        ),
    ];
    for (name, scale, unit, meaning) in rows {
        ui.horizontal(|ui| {
            field::label(ui, name, meaning);
            // The sliders are narrower because the units are long.
            ui.spacing_mut().slider_width = 100.0;
            field::slider(ui, scale, 1e-4..=1e3, unit, |slider| {
                slider.logarithmic(true)
            })
            .on_hover_text(say(meaning));
        });
    }
}

fn boxes(ui: &mut egui::Ui, session: &mut Session) {
    ui.checkbox(
        &mut session.display.bvh.shown,
        say("Bounding volume hierarchy"),
    )
    .on_hover_text(say("Boxes around parts of a mesh, coloured by depth (B)"));
    if !session.display.bvh.shown {
        return;
    }
    let levels = session.bvh_depth();
    let nothing = session.selection().is_none() && !session.display.bvh.every_body;
    let view = &mut session.display.bvh;
    ui.horizontal(|ui| {
        field::label(ui, "Boxes of", "Whose hierarchy is drawn");
        ui.selectable_value(&mut view.every_body, false, say("selected body"));
        ui.selectable_value(&mut view.every_body, true, say("every body"));
    });
    if nothing {
        ui.label(RichText::new(say("No body is selected: boxes of every body.")).weak());
    }
    ui.horizontal(|ui| {
        field::label(
            ui,
            "Depth",
            "0 is the box around the whole mesh; [ and ] go up and down",
        );
        let deepest = levels.saturating_sub(1);
        ui.add_enabled_ui(!view.every_depth, |ui| {
            field::slider(ui, &mut view.depth, 0..=deepest, "", |slider| slider)
                .on_hover_text(say("Depth of the boxes drawn"));
        });
        ui.checkbox(&mut view.every_depth, say("all"));
    });
    tree(ui, session);
}

/// Figures of the selected body's tree.
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
