//! Messages over the picture, until they are dismissed.

use egui::{Area, Button, Frame, RichText, Stroke};

use super::style;
use crate::number;
use crate::session::{Remedy, Session};
use crate::words::say;

/// Translates a message line by line, because each line is a text of its own.
fn lines(text: &str) -> String {
    let lines: Vec<String> = text.lines().map(say).collect();
    lines.join("\n")
}

pub(super) fn show(ctx: &egui::Context, over: egui::Rect, session: &mut Session) {
    let (mut dismissed, mut agreed) = (None, None);
    Area::new(egui::Id::unique("notices"))
        .order(egui::Order::Foreground)
        .fixed_pos(over.left_top() + egui::vec2(10.0, 10.0))
        .show(ctx, |ui| {
            for notice in session.notices().iter() {
                let colour = if notice.error {
                    style::RED.of(ui.visuals())
                } else {
                    style::GREEN.of(ui.visuals())
                };
                Frame::popup(ui.style())
                    .stroke(Stroke::new(1.0, colour))
                    .show(ui, |ui| {
                        ui.set_max_width((over.width() - 60.0).clamp(160.0, 560.0));
                        ui.horizontal(|ui| {
                            let close = Button::new(RichText::new("✖").color(colour)).frame(false);
                            if ui.add(close).on_hover_text(say("Dismiss")).clicked() {
                                dismissed = Some(notice.about);
                            }
                            ui.add(egui::Label::new(lines(&notice.text)).wrap());
                        });
                        let text = match notice.remedy {
                            None => return,
                            Some(Remedy::Rate(rate)) => {
                                format!("Reset, and step at {} Hz", number::count(rate))
                            }
                            Some(Remedy::Collision(_)) => {
                                "Reset, and look within the step".to_owned()
                            }
                        };
                        if ui.button(say(text)).clicked() {
                            agreed = notice.remedy;
                        }
                    });
            }
        });
    if let Some(remedy) = agreed {
        session.reset();
        match remedy {
            Remedy::Rate(rate) => session.set_rate(rate),
            Remedy::Collision(how) => session.set_collision(how),
        }
    }
    if let Some(about) = dismissed {
        session.notices().dismiss(about);
    }
}
