//! Handles on the selected body: three knobs, one for each axis, that move, rotate or scale it.

use egui::{Color32, Pos2, Rect, Sense, Stroke, Vec2};
use scene::SceneShape;
use sim_core::DVec3;

use super::viewport::place;
use crate::session::{Session, State};
use crate::words::say;

/// Length of a handle, in distances of the camera, and size of its knob, points.
const LENGTH: f64 = 0.16;
const KNOB: f32 = 6.0;
/// The length on the screen, points, below which an axis is too foreshortened to be dragged along.
const SHORTEST: f32 = 10.0;
/// Degrees per point of a drag, and change of the logarithm of a scale per point.
const TURN: f64 = 0.5;
const STRETCH: f64 = 0.01;

/// The operation of the handles.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Tool {
    #[default]
    Move,
    Turn,
    Stretch,
}

/// The handles, and their present operation.
#[derive(Default)]
pub(super) struct Handles {
    tool: Tool,
}

impl Handles {
    /// A row to choose the operation of the handles.
    pub(super) fn choose(&mut self, ui: &mut egui::Ui, session: &Session) {
        let Some(body) = session.selected() else {
            return;
        };
        let is_mesh = matches!(body.shape, SceneShape::Mesh(_));
        let is_sphere = matches!(body.shape, SceneShape::Sphere { .. });
        let layout = session.state() == State::Layout;
        ui.horizontal(|ui| {
            for (tool, name, meaning, offered) in [
                (
                    Tool::Move,
                    "Move",
                    "Handles to move the body along the axes",
                    true,
                ),
                (
                    Tool::Turn,
                    "Turn",
                    "Handles to turn the body about the axes",
                    layout && is_mesh,
                ),
                (
                    Tool::Stretch,
                    "Stretch",
                    "Handles to stretch the body along its axes",
                    layout && (is_mesh || is_sphere),
                ),
            ] {
                let choice = egui::Button::selectable(self.tool == tool, say(name));
                let choice = ui.add_enabled(offered, choice).on_hover_text(say(meaning));
                if choice.clicked() {
                    self.tool = tool;
                }
                if !offered && self.tool == tool {
                    self.tool = Tool::Move;
                }
            }
        });
    }

    /// Draws the handles over the picture and applies their drags; none while physics runs.
    pub(super) fn show(&self, ui: &egui::Ui, rect: Rect, aspect: f64, session: &mut Session) {
        let (Some(body), false) = (session.selection(), session.state() == State::Running) else {
            return;
        };
        let middle = session.middle(body);
        let Some(from) = place(rect, aspect, session, middle) else {
            return;
        };
        let length = LENGTH * session.camera.distance;
        let axes = [
            ("x", DVec3::X, Color32::from_rgb(200, 40, 40)),
            ("y", DVec3::Y, Color32::from_rgb(30, 140, 60)),
            ("z", DVec3::Z, Color32::from_rgb(40, 80, 210)),
        ];
        for (index, (name, axis, colour)) in axes.into_iter().enumerate() {
            let Some(to) = place(rect, aspect, session, middle + length * axis) else {
                continue;
            };
            if (to - from).length() < SHORTEST || !rect.contains(to) {
                continue;
            }
            let knob = Rect::from_center_size(to, Vec2::splat(3.0 * KNOB));
            let id = ui.scope_id().with(("handle", index));
            let response = ui.interact(knob, id, Sense::drag());
            let text = match self.tool {
                Tool::Move => format!("Move along {name}"),
                Tool::Turn => format!("Turn about {name}"),
                Tool::Stretch => format!("Stretch along {name}"),
            };
            response
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, say(&text)));
            let held = response.hovered() || response.dragged();
            self.draw(ui, rect, [from, to], colour, held);
            if response.dragged() {
                self.drag(
                    response.drag_delta(),
                    to - from,
                    length,
                    index,
                    axis,
                    session,
                );
            }
            if held {
                response.on_hover_text(say(&text));
            }
        }
    }

    fn draw(&self, ui: &egui::Ui, rect: Rect, [from, to]: [Pos2; 2], colour: Color32, held: bool) {
        let painter = ui.painter().with_clip_rect(rect);
        let size = if held { 1.35 * KNOB } else { KNOB };
        painter.line_segment(
            [from, to],
            Stroke::new(if held { 3.0 } else { 2.0 }, colour),
        );
        let rim = Stroke::new(1.5, Color32::WHITE);
        match self.tool {
            Tool::Move => {
                let along = (to - from).normalized();
                let corners = [1.6 * along, along.rot90(), -along.rot90()];
                let corners = corners.map(|corner| to + size * corner).to_vec();
                painter.add(egui::Shape::convex_polygon(corners, colour, rim));
            }
            Tool::Turn => {
                painter.circle(to, size, Color32::WHITE, Stroke::new(3.0, colour));
            }
            Tool::Stretch => {
                let square = Rect::from_center_size(to, Vec2::splat(1.8 * size));
                painter.rect(square, 1.0, colour, rim, egui::StrokeKind::Outside);
            }
        }
    }

    /// Applies a drag by so many points of a handle that appears as `seen` on the screen and is `length` m long.
    fn drag(
        &self,
        by: Vec2,
        seen: Vec2,
        length: f64,
        index: usize,
        axis: DVec3,
        session: &mut Session,
    ) {
        let points = f64::from(by.dot(seen.normalized()));
        if points == 0.0 {
            return;
        }
        let (Some(i), Some(body)) = (session.selection(), session.selected()) else {
            return;
        };
        match (self.tool, body.shape.clone()) {
            (Tool::Move, _) => {
                let way = points / f64::from(seen.length()) * length;
                session.set_position(session.world().origin(i) + way * axis);
            }
            (Tool::Turn, _) => session.set_rotation(body.rotation + TURN * points * axis),
            (Tool::Stretch, SceneShape::Sphere { radius }) => {
                let radius = radius * (STRETCH * points).exp();
                session.set_shape(SceneShape::Sphere { radius });
            }
            (Tool::Stretch, _) => {
                let mut scale = body.scale;
                scale[index] *= (STRETCH * points).exp();
                session.set_scale(scale);
            }
        }
    }
}
