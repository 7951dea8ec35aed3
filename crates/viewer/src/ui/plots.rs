//! The plots below the picture: curves over all kept time, and work against precision.

use egui::{Color32, Rangef, RichText, Sense, Vec2b, Visuals};
use egui_plot::{
    AxisHints, GridInput, GridMark, HoverPosition, Line, LineStyle, Plot, PlotPoints, Points, VLine,
};

use super::style;
use crate::number::{self, tidy};
use crate::session::{CHARTS, Chart, Curve, RUN, Session, State};
use crate::words::say;

/// Which plots are shown.
#[derive(Default)]
pub(super) struct Plots {
    /// The plots that the user has chosen; `None` selects those that suit the scene.
    chosen: Option<[bool; CHARTS.len()]>,
    precision: bool,
}

/// The least width of a plot, points.
const LEAST_WIDTH: f32 = 150.0;

impl Plots {
    /// Shows the plots chosen side by side.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, session: &mut Session) {
        let mut shown = self.shown(session);
        ui.horizontal_wrapped(|ui| {
            for (chart, shown) in CHARTS.iter().zip(&mut shown) {
                ui.toggle_value(shown, say(chart.title))
                    .on_hover_text(say(chart.meaning));
            }
            ui.toggle_value(&mut self.precision, say("Speed against error"))
                .on_hover_text(say(
                    "Largest error so far over real time for a simulated second, a point for the \
                     run and for each variant",
                ));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                super::export::buttons(ui, self, session);
            });
        });
        if shown != self.shown(session) {
            self.chosen = Some(shown);
        }
        let chosen = CHARTS.iter().zip(shown);
        session.profiled = chosen
            .into_iter()
            .any(|(chart, shown)| shown && chart.title == "Step cost");
        self.draw(ui, session);
    }

    /// The chosen plots, or by default the energy and the most informative plot of this scene.
    fn shown(&self, session: &Session) -> [bool; CHARTS.len()] {
        self.chosen.unwrap_or_else(|| {
            let second = session.telling_chart();
            CHARTS
                .each_ref()
                .map(|chart| chart.title == "Energy" || chart.title == second)
        })
    }

    /// Draws the plots without controls.
    pub(super) fn draw(&self, ui: &mut egui::Ui, session: &mut Session) {
        let chosen: Vec<&Chart> = CHARTS
            .iter()
            .zip(self.shown(session))
            .filter_map(|(chart, shown)| shown.then_some(chart))
            .collect();
        let room = ui.available_size();
        let fit = ((room.x / LEAST_WIDTH) as usize).max(1);
        let count = (chosen.len() + usize::from(self.precision)).min(fit);
        if count == 0 {
            ui.label(RichText::new(say("Choose a plot above.")).weak());
            return;
        }
        if !session.variants().is_empty() {
            legend(ui, &session.curves(&CHARTS[0]));
        }
        let height = ui.available_height();
        ui.columns(count, |columns| {
            let mut columns = columns.iter_mut();
            if self.precision
                && let Some(ui) = columns.next_back()
            {
                precision(ui, session, height);
            }
            for (ui, chart) in columns.zip(chosen) {
                over_time(ui, chart, session, height);
            }
        });
    }
}

/// The title and unit of a plot, and the names of its curves in their colours.
fn heading(ui: &mut egui::Ui, title: &str, unit: &str, meaning: &str, curves: &[Curve]) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(8.0, 0.0);
        let title = match unit {
            "" => say(title),
            unit => format!("{}, {unit}", say(title)),
        };
        ui.label(RichText::new(title).strong())
            .on_hover_text(say(meaning));
        names(ui, curves);
    });
}

/// The reason why there is no curve.
fn note(ui: &mut egui::Ui, text: &str) {
    // Columns would justify the text.
    ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
        ui.label(RichText::new(say(text)).weak());
    });
}

/// The names of all runs, in their colours.
fn legend(ui: &mut egui::Ui, curves: &[Curve]) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(10.0, 0.0);
        names(ui, curves);
    });
}

fn names(ui: &mut egui::Ui, curves: &[Curve]) {
    for curve in curves {
        ui.label(RichText::new(say(&curve.name)).small().color(ink(
            curve.colour,
            ui.visuals(),
            style::word,
        )));
    }
}

/// The colour of a run; the run itself has the contrast of text, in either theme.
fn ink(colour: [f32; 3], visuals: &Visuals, other: fn([f32; 3], &Visuals) -> Color32) -> Color32 {
    match colour == RUN {
        true => visuals.strong_text_color(),
        false => other(colour, visuals),
    }
}

fn plot<'a>(id: &str, height: f32, logarithmic: bool) -> Plot<'a> {
    let plot = Plot::new(id.to_owned())
        .height(height.max(40.0))
        .show_grid(true)
        .grid_color(Color32::from_gray(110))
        .set_margin_fraction(egui::vec2(0.01, 0.08))
        .allow_boxed_zoom(false)
        .sense(Sense::click_and_drag())
        .custom_y_axes(vec![y_axis(logarithmic)]);
    if logarithmic {
        plot.y_grid_spacer(powers)
    } else {
        plot.y_grid_spacer(|input| round(input, 5.0))
    }
}

/// An axis with a number at each of its few lines.
fn y_axis<'a>(logarithmic: bool) -> AxisHints<'a> {
    AxisHints::new_y()
        .min_thickness(44.0)
        .label_spacing(Rangef::new(12.0, 18.0))
        .formatter(move |mark, range| axis_text(mark, range, logarithmic))
}

fn over_time(ui: &mut egui::Ui, chart: &Chart, session: &mut Session, height: f32) {
    let top = ui.cursor().top();
    let curves = session.curves(chart);
    let alone = session.variants().is_empty();
    let named = if alone { &curves[..] } else { &[] };
    heading(ui, chart.title, chart.unit, chart.meaning, named);
    let height = height - (ui.cursor().top() - top);
    if curves.iter().all(|curve| curve.points.len() < 2) {
        let why = match session.state() {
            _ if session.playback().len() < 2 => "Start, and curves grow here.",
            _ if chart.title == "Path error" => match session.path_error() {
                None => "The exact path is not known here.",
                // 0 has no logarithm.
                Some(0.0) => "The error is 0: every body is where it would be exactly.",
                Some(_) => "Nothing yet.",
            },
            _ => "Nothing yet.",
        };
        note(ui, why);
        return;
    }
    let group = egui::Id::unique("time of the plots");
    let [first, last] = session.playback().span();
    let logarithmic = chart.logarithmic;
    let unit = chart.unit;
    let plot = plot(chart.title, height, logarithmic)
        .link_axis(group, Vec2b::new(true, false))
        .link_cursor(group, Vec2b::new(true, false))
        .x_grid_spacer(|input| round(input, 3.0))
        .custom_x_axes(vec![
            AxisHints::new_x()
                .label_spacing(Rangef::new(30.0, 45.0))
                .formatter(|mark, range| match is_at(*range.end(), mark, range) {
                    // The label would be cut off.
                    true => String::new(),
                    false => format!("{} s", tidy(mark.value)),
                }),
        ])
        .include_x(first)
        .include_x(last.max(first + 1e-9))
        .label_formatter(move |hover| {
            let HoverPosition::NearDataPoint {
                plot_name,
                position,
                ..
            } = hover
            else {
                return None;
            };
            let value = if logarithmic {
                10_f64.powf(position.y)
            } else {
                position.y
            };
            let value = number::figure(value);
            Some(format!("{plot_name}\n{value} {unit}\n{:.4} s", position.x))
        });
    let plot = match flat(&curves) {
        // The range must not shrink to rounding errors.
        Some((value, size)) if !logarithmic => plot.include_y(value - size).include_y(value + size),
        _ => plot,
    };
    // Rounding errors lie at the bottom, below a nanometre.
    let plot = match chart.title {
        "Path error" => plot.include_y(-9.0),
        _ => plot,
    };
    let now = session.shown_time();
    let visuals = ui.visuals().clone();
    let shown = plot.show(ui, |plot| {
        for curve in &curves {
            let points = PlotPoints::from(curve.points.clone());
            let line = Line::new(say(&curve.name), points).color(ink(
                curve.colour,
                &visuals,
                style::curve,
            ));
            plot.line(line.width(1.8));
        }
        plot.vline(
            VLine::new("", now)
                .color(style::BLUE.of(&visuals))
                .width(1.2)
                .style(LineStyle::Solid)
                .allow_hover(false),
        );
    });
    if shown.response.clicked()
        && session.state() != State::Layout
        && let Some(at) = shown.response.interact_pointer_pos()
    {
        let time = shown.transform.value_from_position(at).x;
        session.go_to(session.playback().nearest(time));
    }
}

/// Work against precision, one point for each run.
fn precision(ui: &mut egui::Ui, session: &Session, height: f32) {
    let top = ui.cursor().top();
    let runs = session.work_precision();
    let meaning = "Down and to the left is better: less error in less time";
    heading(ui, "Speed against error", "", meaning, &[]);
    let height = height - (ui.cursor().top() - top);
    if runs.is_empty() {
        note(ui, "Needs a run whose exact path is known.");
        return;
    }
    let visuals = ui.visuals().clone();
    plot("precision", height, true)
        .custom_x_axes(vec![
            AxisHints::new_x()
                .label(say("s per simulated second"))
                .formatter(|mark, range| axis_text(mark, range, true)),
        ])
        .custom_y_axes(vec![y_axis(true).label(say("largest error, m"))])
        .x_grid_spacer(powers)
        .set_margin_fraction(egui::vec2(0.15, 0.15))
        .label_formatter(|hover| match hover {
            HoverPosition::NearDataPoint {
                plot_name,
                position,
                ..
            } => Some(say(format!(
                "{plot_name}\nerror {} m\n{} for a second",
                number::figure(10_f64.powf(position.y)),
                number::seconds(10_f64.powf(position.x))
            ))),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for run in &runs {
                let points = PlotPoints::from(run.points.clone());
                let points = Points::new(say(&run.name), points).radius(5.0);
                plot.points(points.color(ink(run.colour, &visuals, style::curve)));
            }
        });
}

/// If all values are equal up to rounding: that value, and the range to show around it.
fn flat(curves: &[Curve]) -> Option<(f64, f64)> {
    let values = || curves.iter().flat_map(|c| c.points.iter().map(|p| p[1]));
    let (least, most) = (values().reduce(f64::min)?, values().reduce(f64::max)?);
    let size = least.abs().max(most.abs());
    let shown = if size > 0.0 { 1e-6 * size } else { 1.0 };
    (most - least < shown).then_some((0.5 * (least + most), shown))
}

/// At most about `most` grid lines, at round numbers.
fn round(input: GridInput, most: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let least = ((high - low) / most).max(f64::MIN_POSITIVE);
    let power = 10_f64.powf(least.log10().floor());
    let times = [1.0, 2.0, 5.0, 10.0].into_iter();
    let step = times.map(|n| n * power).find(|step| *step >= least);
    let step_size = step.unwrap_or(least);
    let first = (low / step_size).ceil();
    (0..20)
        .map(|n| (first + f64::from(n)) * step_size)
        .take_while(|value| *value <= high)
        .map(|value| GridMark { value, step_size })
        .collect()
}

/// Grid lines at whole powers of ten, as many as fit; if there are few, also at 2 and 5 times these.
fn powers(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    if high - low < 2.5 {
        let decades = (low.floor() as i64..=high.ceil() as i64).take(4);
        let marks = decades.flat_map(|n| [1.0_f64, 2.0, 5.0].map(|part| n as f64 + part.log10()));
        return marks
            .filter(|value| (low..=high).contains(value))
            .map(|value| GridMark {
                value,
                step_size: 1.0,
            })
            .collect();
    }
    let step = (8.0 * input.base_step_size)
        .max((high - low) / 6.0)
        .ceil()
        .max(1.0);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last.min(first + 100))
        .map(|n| GridMark {
            value: n as f64 * step,
            step_size: step,
        })
        .collect()
}

/// Whether a mark is at an end of its axis.
fn is_at(end: f64, mark: GridMark, range: &std::ops::RangeInclusive<f64>) -> bool {
    (mark.value - end).abs() < 0.03 * (range.end() - range.start())
}

fn axis_text(mark: GridMark, range: &std::ops::RangeInclusive<f64>, logarithmic: bool) -> String {
    if logarithmic {
        return format!("{:.0e}", 10_f64.powf(mark.value));
    }
    // The label would overlap the one of the other axis.
    if is_at(*range.start(), mark, range) {
        return String::new();
    }
    let size = range.start().abs().max(range.end().abs());
    if mark.value == 0.0 || (1e-3..1e5).contains(&size) {
        tidy(mark.value)
    } else {
        format!("{:.1e}", mark.value)
    }
}
