//! The picture, and the actions of the mouse on it.

use egui::{Align2, Color32, CornerRadius, Key, PointerButton, Pos2, Rect, Sense, TextureId};

use scene::shown;
use sim_core::DVec3;

use super::handles::Handles;
use super::style;
use crate::session::Session;
use crate::words::say;

/// Rotation of the camera by a drag across the whole height of the picture, radians.
const TURN: f64 = 4.0;
/// The speed of flight, in distances to the target per second of real time, and the longest frame that counts, s.
const FLIGHT: f64 = 1.0;
const LONGEST_FRAME: f32 = 0.1;
/// The most names shown at a time.
const MOST_NAMES: usize = 300;
/// The relative change of the zoom per point of wheel travel.
const ZOOM: f64 = 0.003;
/// Width of the arrows beside their scales, points.
const ARROW: f32 = 26.0;

/// Shows the picture in the remaining area; returns its rectangle, in points.
pub(super) fn show(
    ui: &mut egui::Ui,
    handles: &mut Handles,
    session: &mut Session,
    picture: TextureId,
) -> Rect {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    ui.painter().image(picture, rect, whole, Color32::WHITE);
    if rect.width() < 1.0 || rect.height() < 1.0 {
        return rect;
    }
    let aspect = f64::from(rect.width() / rect.height());
    if response.clicked_by(PointerButton::Primary)
        && let Some(at) = response.interact_pointer_pos()
    {
        let (origin, direction) = ray(rect, at, aspect, session);
        session.pick(origin, direction);
    }
    // Before the handles, which are drawn over the picture.
    let held = pull(ui, &response, aspect, session);
    if !held && !fly(ui, &response, session) {
        drag(ui, &response, session);
    }
    if response.hovered() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        let factor = (ZOOM * f64::from(scroll)).exp() * f64::from(pinch);
        // No redraw is needed while the wheel does not move.
        if factor != 1.0
            && let Some(at) = response.hover_pos()
        {
            let at = (at - rect.center()) / rect.size();
            let [x, y] = [2.0 * f64::from(at.x), -2.0 * f64::from(at.y)];
            session.camera.zoom_at(factor, x, y, aspect);
        }
    }
    handles.show(ui, rect, aspect, session);
    number_axes(ui, rect, aspect, session);
    name_bodies(ui, rect, aspect, session);
    tell_scales(ui, rect, session);
    point_out(ui, rect, aspect, session);
    offer_drop(ui, rect);
    rect
}

/// The ray through a point of the picture.
fn ray(rect: Rect, at: Pos2, aspect: f64, session: &Session) -> (DVec3, DVec3) {
    let at = (at - rect.center()) / rect.size();
    let [x, y] = [2.0 * f64::from(at.x), -2.0 * f64::from(at.y)];
    session.camera.ray(x, y, aspect)
}

/// Pulls a body if a drag with Ctrl began on it. Returns whether a body is held.
fn pull(ui: &egui::Ui, response: &egui::Response, aspect: f64, session: &mut Session) -> bool {
    let place = response.interact_pointer_pos();
    if let Some(at) = place.filter(|_| response.dragged_by(PointerButton::Primary)) {
        let press = ui.input(|i| i.pointer.press_origin()).unwrap_or(at);
        let ctrl = ui.input(|i| i.modifiers.command);
        if response.drag_started() && ctrl {
            let (origin, direction) = ray(response.rect, press, aspect, session);
            session.take_hold(origin, direction);
        }
        if session.is_pulling() {
            let (origin, direction) = ray(response.rect, at, aspect, session);
            session.pull(origin, direction);
        }
    } else {
        session.let_go();
    }
    session.is_pulling()
}

/// Flies while the right button and keys are pressed. Returns whether it does.
fn fly(ui: &egui::Ui, response: &egui::Response, session: &mut Session) -> bool {
    let held = response.is_pointer_button_down_on();
    let way = ui.input(|i| {
        let axis = |more: Key, less: Key| {
            f64::from(i8::from(i.key_down(more)) - i8::from(i.key_down(less)))
        };
        let way = DVec3::new(
            axis(Key::D, Key::A),
            axis(Key::E, Key::Q),
            axis(Key::W, Key::S),
        );
        let flies = held && i.pointer.secondary_down() && way != DVec3::ZERO;
        flies.then(|| FLIGHT * f64::from(i.stable_dt.min(LONGEST_FRAME)) * way)
    });
    let Some(way) = way else { return false };
    session.camera.fly(way);
    let moved = response.drag_delta() / response.rect.height();
    session
        .camera
        .look(TURN * f64::from(moved.x), -TURN * f64::from(moved.y));
    ui.ctx().request_repaint();
    true
}

fn drag(ui: &egui::Ui, response: &egui::Response, session: &mut Session) {
    if !response.dragged() {
        return;
    }
    let moved = response.drag_delta() / response.rect.height();
    let (dx, dy) = (f64::from(moved.x), f64::from(moved.y));
    if response.dragged_by(PointerButton::Middle) || ui.input(|i| i.modifiers.shift) {
        session.camera.pan(-dx, dy);
        ui.set_cursor_icon(egui::CursorIcon::Move);
    } else {
        session.camera.orbit(-TURN * dx, TURN * dy);
        ui.set_cursor_icon(egui::CursorIcon::Grabbing);
    }
}

/// Writes names above bodies: that of the selected one, or all names that do not overlap.
fn name_bodies(ui: &egui::Ui, rect: Rect, aspect: f64, session: &Session) {
    let selected = session.selection();
    let others =
        (0..session.world().len()).filter(|&i| session.display.names && Some(i) != selected);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let painter = ui.painter().with_clip_rect(rect);
    let mut taken: Vec<Rect> = Vec::new();
    for body in selected.into_iter().chain(others).take(MOST_NAMES) {
        let Some(at) = place(rect, aspect, session, session.top(body)) else {
            continue;
        };
        let colour = match Some(body) == selected {
            true => style::BLUE.over_picture(),
            false => Color32::WHITE,
        };
        let name = shown::name(&session.scene().bodies[body].name);
        let text = painter.layout_no_wrap(name, font.clone(), colour);
        let place = Align2::CENTER_BOTTOM.anchor_size(at - egui::vec2(0.0, 6.0), text.size());
        if !rect.intersects(place) || taken.iter().any(|other| other.intersects(place)) {
            continue;
        }
        taken.push(place);
        painter.rect_filled(
            place.expand2(egui::vec2(5.0, 1.0)),
            CornerRadius::same(4),
            style::OVER_PICTURE,
        );
        painter.galley(place.min, text, colour);
    }
}

/// The position of a point in the window.
pub(super) fn place(rect: Rect, aspect: f64, session: &Session, point: DVec3) -> Option<Pos2> {
    let [x, y] = session.camera.project(point, aspect)?;
    Some(rect.center() + 0.5 * egui::vec2(x as f32, -y as f32) * rect.size())
}

/// Writes letters and numbers, m, on the axes, unless a body is in front of them.
fn number_axes(ui: &egui::Ui, rect: Rect, aspect: f64, session: &Session) {
    if !session.display.grid || !session.display.numbers {
        return;
    }
    let painter = ui.painter().with_clip_rect(rect);
    let small = egui::TextStyle::Small.resolve(ui.style());
    let letter = egui::TextStyle::Heading.resolve(ui.style());
    let mut taken: Vec<Rect> = Vec::new();
    let mut write = |point, text: String, font: &egui::FontId, colour: Color32| {
        let Some(at) = place(rect, aspect, session, point) else {
            return;
        };
        let text = painter.layout_no_wrap(text, font.clone(), colour);
        let area = Align2::CENTER_TOP.anchor_size(at + egui::vec2(0.0, 3.0), text.size());
        let covered = taken.iter().any(|other| other.intersects(area));
        if !rect.contains_rect(area) || covered {
            return;
        }
        if session.hides(point, ray(rect, at, aspect, session)) {
            return;
        }
        taken.push(area);
        let ground = area.expand2(egui::vec2(2.0, 0.0));
        painter.rect_filled(ground, CornerRadius::same(3), style::OVER_AXES);
        painter.galley(area.min, text, colour);
    };
    for axis in session.axis_marks() {
        let [red, green, blue] = axis.colour.map(|part| (255.0 * part) as u8);
        let colour = Color32::from_rgb(red, green, blue);
        write(axis.place, axis.letter.to_owned(), &letter, colour);
        for (point, value) in axis.marks {
            write(point, crate::number::tidy(value), &small, style::AXIS_INK);
        }
    }
}

/// Shows in a corner the kinds of arrows in the picture and their scales.
fn tell_scales(ui: &egui::Ui, rect: Rect, session: &Session) {
    let scales = session.scales();
    let font = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter().with_clip_rect(rect);
    let texts: Vec<_> = scales
        .iter()
        .map(|scale| {
            let text = format!("{}  {}", say(scale.name), say(&scale.text));
            painter.layout_no_wrap(text, font.clone(), Color32::WHITE)
        })
        .collect();
    let size = |of: fn(egui::Vec2) -> f32| texts.iter().map(move |text| of(text.size()));
    let (width, height) = (
        size(|s| s.x).fold(0.0, f32::max),
        size(|s| s.y).sum::<f32>(),
    );
    let margin = egui::vec2(6.0, 4.0);
    let room = egui::vec2(ARROW + width, height) + 2.0 * margin;
    // Not if it would cover too much of the picture.
    if texts.is_empty() || room.x > 0.5 * rect.width() || room.y > 0.3 * rect.height() {
        return;
    }
    let corner = rect.left_bottom() + egui::vec2(8.0, -8.0 - room.y);
    let back = Rect::from_min_size(corner, room);
    painter.rect_filled(back, CornerRadius::same(4), style::OVER_PICTURE);
    let mut at = corner + margin;
    for (scale, text) in scales.iter().zip(texts) {
        let middle = at + egui::vec2(0.0, 0.5 * text.size().y);
        let colour = style::word(scale.colour, &egui::Visuals::dark());
        let line = egui::Stroke::new(2.0, colour);
        painter.arrow(middle, egui::vec2(ARROW - 8.0, 0.0), line);
        let below = text.size().y;
        painter.galley(at + egui::vec2(ARROW, 0.0), text, Color32::WHITE);
        at.y += below;
    }
}

/// Indicates at the border the directions of bodies that are out of view, with their names.
fn point_out(ui: &egui::Ui, rect: Rect, aspect: f64, session: &Session) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter().with_clip_rect(rect);
    let mut taken: Vec<Rect> = Vec::new();
    for out in session.out_of_view(aspect) {
        let [x, y] = out.towards.map(|part| part as f32);
        let way = egui::vec2(x, -y);
        // From the middle to slightly inside the border.
        let half = 0.5 * rect.size() - egui::vec2(16.0, 16.0);
        let tip = rect.center() + way * (half.x / way.x.abs()).min(half.y / way.y.abs());
        let along = (way * rect.size()).normalized();
        let across = along.rot90();
        let [red, green, blue] = session.colour(out.body).map(|part| (255.0 * part) as u8);
        let colour = Color32::from_rgb(red, green, blue);
        painter.add(egui::Shape::convex_polygon(
            vec![tip + 9.0 * along, tip + 7.0 * across, tip - 7.0 * across],
            colour,
            egui::Stroke::new(1.0, Color32::from_gray(60)),
        ));
        let body = &session.scene().bodies[out.body];
        let text = painter.layout_no_wrap(shown::name(&body.name), font.clone(), Color32::WHITE);
        let middle = tip - along * (12.0 + 0.5 * text.size().x * along.x.abs());
        let place = Align2::CENTER_CENTER.anchor_size(middle, text.size());
        let place = place.translate(rect.shrink(4.0).intersect(place).center() - place.center());
        if taken.iter().any(|other| other.intersects(place)) {
            continue;
        }
        taken.push(place);
        let back = place.expand2(egui::vec2(4.0, 1.0));
        painter.rect_filled(back, CornerRadius::same(4), style::OVER_PICTURE);
        painter.galley(place.min, text, Color32::WHITE);
    }
}

/// Shows the effect of dropping files that are dragged over the window.
fn offer_drop(ui: &egui::Ui, rect: Rect) {
    if ui.input(|i| i.raw.hovered_files.is_empty()) {
        return;
    }
    ui.painter()
        .rect_filled(rect, CornerRadius::ZERO, Color32::from_black_alpha(160));
    ui.painter().text(
        rect.center(),
        Align2::CENTER_CENTER,
        say("Drop a mesh to add it, or a scene (.toml) or a run (.run) to open it"),
        egui::TextStyle::Heading.resolve(ui.style()),
        Color32::WHITE,
    );
}
