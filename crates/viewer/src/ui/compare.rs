//! Naive against BVH: the cost of an answer each way, for bodies near each other now.

use egui::{Grid, RichText};
use scene::shown;

use super::style;
use crate::number;
use crate::session::{Comparison, Contest, Cost, Session};
use crate::words::say;

pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    ui.checkbox(&mut session.compare.on, say("Measure"))
        .on_hover_text(say(
            "Ask both ways whether the two bodies meet, now and then, on a thread of its own. \
             Off, it costs nothing.",
        ));
    descent(ui, session);
    if !session.compare.on {
        return;
    }
    let name = |i: usize| shown::name(&session.scene().bodies[i].name);
    let now = match session.contest() {
        Contest::NoPair if session.selection().is_some() => {
            "The selected body has no other to meet.".to_owned()
        }
        Contest::NoPair => "It takes two bodies with meshes.".to_owned(),
        Contest::Apart(i, j) => format!("The boxes of {} and {} are apart.", name(i), name(j)),
        Contest::Pair(i, j) => format!("The boxes of {} and {} overlap.", name(i), name(j)),
    };
    ui.label(RichText::new(say(now)).weak());
    match session.compare.last() {
        Some(last) => table(ui, session, last),
        None if session.compare.is_under_way() => {
            ui.label(RichText::new(say("Measuring…")).weak());
        }
        None => {}
    }
}

/// The descent through both trees, level by level.
fn descent(ui: &mut egui::Ui, session: &mut Session) {
    let mut shown = session.display.descent.is_some();
    if ui
        .checkbox(&mut shown, say("Show the descent"))
        .on_hover_text(say(
            "Boxes that are compared level by level, in orange those that meet and come into \
             question for the next level. Of the two bodies that are measured",
        ))
        .changed()
    {
        (session.display.descent, session.display.pair) = (shown.then_some(0), None);
    }
    if shown {
        ui.horizontal(|ui| {
            ui.label(say("Level"));
            if ui.button("◀").on_hover_text(say("One level up")).clicked() {
                session.step_descent(-1);
            }
            if ui
                .button("▶")
                .on_hover_text(say("One level down (N)"))
                .clicked()
            {
                session.step_descent(1);
            }
            ui.add_space(8.0);
            ui.label(say("Pair"));
            let hint = "The comparison before (J)";
            if ui.button("◀").on_hover_text(say(hint)).clicked() {
                session.step_pair(-1);
            }
            let hint =
                "The next comparison (K): one pair of boxes after the other, as a search goes";
            if ui.button("▶").on_hover_text(say(hint)).clicked() {
                session.step_pair(1);
            }
        });
    }
    let Some(shown) = session.display.descent else {
        return;
    };
    if let Some(shown) = session.display.pair {
        ui.label(RichText::new(say(pair_text(session, shown))).weak());
        return;
    }
    let levels = session.descent();
    let last = levels.len().saturating_sub(1);
    let text = match levels.get(shown.min(last)) {
        None => "It takes two bodies with meshes.".to_owned(),
        Some(level) => format!(
            "Level {} of {last}. Pairs of boxes compared: {}; that meet: {}.",
            shown.min(last),
            number::count(level.compared as f64),
            number::count(level.meeting as f64)
        ),
    };
    ui.label(RichText::new(say(text)).weak());
}

/// The description of a comparison in the descent.
fn pair_text(session: &mut Session, shown: usize) -> String {
    let pairs = session.pairs();
    let shown = shown.min(pairs.len().saturating_sub(1));
    let Some(pair) = pairs.get(shown) else {
        return "It takes two bodies with meshes.".to_owned();
    };
    let (now, all) = (
        number::count(shown as f64 + 1.0),
        number::count(pairs.len() as f64),
    );
    let below = pair.below;
    match pair.meet {
        false => {
            format!("Pair {now} of {all}: the boxes are apart, and all in them is left out.")
        }
        true if below == 0 => {
            format!("Pair {now} of {all}: two leaves meet, and their triangles are tested.")
        }
        true => format!(
            "Pair {now} of {all}: the boxes meet, and {below} pairs of boxes in them come next."
        ),
    }
}

fn table(ui: &mut egui::Ui, session: &Session, last: &Comparison) {
    Grid::new("compare")
        .num_columns(4)
        .min_col_width(58.0)
        .spacing([12.0, 3.0])
        .show(ui, |ui| {
            for title in ["", "Naive", "BVH", "Ratio"] {
                ui.label(RichText::new(say(title)).strong());
            }
            ui.end_row();
            row(
                ui,
                last,
                "Tests",
                TESTS,
                |cost| cost.tests as f64,
                number::count,
            );
            row(
                ui,
                last,
                "Boxes",
                BOXES,
                |cost| cost.boxes as f64,
                number::count,
            );
            row(ui, last, "Time", TIME, |cost| cost.seconds, number::seconds);
            ui.label(say("Spread")).on_hover_text(say(SPREAD));
            let spread = |cost: &Cost| {
                let [least, most] = cost.spread;
                format!(
                    "±{:.0} %",
                    50.0 * (most - least) / cost.seconds.max(f64::MIN_POSITIVE)
                )
            };
            ui.monospace(last.naive.as_ref().map_or_else(|| "-".to_owned(), spread));
            ui.monospace(spread(&last.tree));
            ui.label("");
            ui.end_row();
        });
    if last.naive.is_none() {
        ui.label(
            RichText::new(say("These meshes are too large for the naive way."))
                .color(style::AMBER.of(ui.visuals())),
        )
        .on_hover_text(say("It would take many seconds for one answer."));
    }
    let (i, j) = last.pair;
    let bodies = &session.scene().bodies;
    let (Some(first), Some(second)) = (bodies.get(i), bodies.get(j)) else {
        return;
    };
    let age = session.world().time() - last.time;
    let when = if age > 0.0 {
        format!("{age:.2} s ago")
    } else {
        "now".to_owned()
    };
    let [first, second] = [first, second].map(|body| shown::name(&body.name));
    let text = match last.meet {
        true => format!("{first} and {second} meet, as of {when}."),
        false => format!("{first} and {second} do not meet, as of {when}."),
    };
    if last.agree {
        ui.label(RichText::new(say(text)).weak())
            .on_hover_text(say("Both ways agree. The age is simulated time."));
    } else {
        let text = "The two ways disagree. This is a fault of the program: please report it.";
        ui.label(RichText::new(say(text)).color(style::RED.of(ui.visuals())));
    }
}

const TESTS: &str =
    "Naive: an edge with a triangle. BVH: two triangles whose boxes meet. Until the first hit.";
const BOXES: &str = "Pairs of boxes compared";
const TIME: &str = "Real time of one answer: the median of up to seven times, of short answers each the mean of up to 10,000";
const SPREAD: &str = "Half of what the middle half of these times lie between";

fn row(
    ui: &mut egui::Ui,
    last: &Comparison,
    title: &str,
    meaning: &str,
    value: fn(&Cost) -> f64,
    text: fn(f64) -> String,
) {
    ui.label(say(title)).on_hover_text(say(meaning));
    let tree = value(&last.tree);
    let naive = last.naive.as_ref().map(value);
    let none = || "-".to_owned();
    ui.monospace(naive.map_or_else(none, text));
    ui.monospace(text(tree));
    let ratio = naive.map(|naive| naive / tree);
    let ratio = ratio.filter(|ratio| ratio.is_finite() && *ratio > 0.0);
    ui.monospace(ratio.map_or_else(none, |ratio| {
        if ratio < 10.0 {
            format!("{ratio:.1}")
        } else {
            number::count(ratio)
        }
    }));
    ui.end_row();
}
