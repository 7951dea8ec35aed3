//! Two panels side by side with one legend on their right.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::style::Style;

/// A line to draw: its style and its points.
pub(super) type Line = (Style, Vec<(f64, f64)>);

/// One of the panels.
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) lines: Vec<Line>,
    /// Whether each point has a marker, or some twenty of them.
    pub(super) few_markers: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) label: String,
    pub(super) range: [f64; 2],
    pub(super) is_log: bool,
}

impl Axis {
    /// From power of ten to power of ten around some positive numbers.
    pub(super) fn log(label: &str, values: impl Iterator<Item = f64>) -> Axis {
        let [mut least, mut greatest] = [f64::INFINITY, 0.0f64];
        for value in values {
            least = least.min(value);
            greatest = greatest.max(value);
        }
        if greatest == 0.0 {
            [least, greatest] = [0.1, 1.0];
        }
        let decade = |value: f64| 10f64.powi(value as i32);
        // A little room, so that a point on a border does not lie on the frame.
        let low = (0.8 * least).log10().floor();
        let high = (1.25 * greatest).log10().ceil();
        Axis {
            label: label.into(),
            range: [decade(low), decade(high)],
            is_log: true,
        }
    }
}

/// The picture as SVG. Both panels have the same y axis, logarithmic.
pub(super) fn draw(panels: [Panel; 2], y: &Axis, legend: &[Style]) -> String {
    let mut plots = Vec::new();
    let mut layouts = Vec::new();
    for panel in panels {
        let lines = panel.lines.iter();
        let drawn: Vec<Plot> = lines.flat_map(|line| drawn(line, panel.few_markers)).collect();
        let mut layout = Layout::auto_from_plots(&drawn)
            .with_title(panel.title)
            .with_title_size(15)
            .with_x_label(panel.x.label)
            .with_label_size(13)
            .with_tick_size(11)
            .with_log_y()
            .with_box_axes()
            .with_clamp_axis()
            .with_x_axis_min(panel.x.range[0])
            .with_x_axis_max(panel.x.range[1])
            .with_y_axis_min(y.range[0])
            .with_y_axis_max(y.range[1])
            .with_y_tick_format(decades(y.range));
        if panel.x.is_log {
            let format = decades(panel.x.range);
            layout = layout.with_log_x().with_x_tick_format(format);
        }
        if plots.is_empty() {
            layout = layout.with_y_label(y.label.clone());
        }
        plots.push(drawn);
        layouts.push(layout);
    }
    let entries = legend.iter().map(Style::legend).collect();
    let figure = Figure::new(1, 2)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_shared_legend_right_top()
        .with_shared_legend_entries(entries)
        .with_figure_size(1080.0, 430.0);
    SvgBackend.render_scene(&figure.render())
}

fn drawn((style, points): &Line, few_markers: bool) -> [Plot; 2] {
    let every = match few_markers {
        true => points.len().div_ceil(12).max(1),
        false => 1,
    };
    let line = LinePlot::new()
        .with_data(points.iter().copied())
        .with_color(style.color)
        .with_stroke_width(1.3)
        .with_line_style(style.line.clone());
    let markers = ScatterPlot::new()
        .with_data(points.iter().copied().step_by(every))
        .with_color(style.color)
        .with_marker(style.marker)
        .with_size(4.0);
    [Plot::Line(line), Plot::Scatter(markers)]
}

/// Labels for whole powers of ten only, and not more than some ten of them.
fn decades([low, high]: [f64; 2]) -> TickFormat {
    let count = (high / low).log10().round() as i32;
    let every = 1 + count / 9;
    TickFormat::Custom(Arc::new(move |value: f64| {
        let log = value.log10();
        let whole = log.round();
        match (log - whole).abs() < 1e-6 && whole as i32 % every == 0 {
            true => power_of_ten(whole as i32),
            false => String::new(),
        }
    }))
}

/// `10⁻⁸`
pub(super) fn power_of_ten(exponent: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁴' as u32 + digit as u32 - '4' as u32).unwrap_or(digit),
    };
    format!("10{}", exponent.to_string().chars().map(digit).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_powers_of_ten_around_the_data() {
        let axis = Axis::log("", [3e-5, 0.2].into_iter());
        assert!((axis.range[0] / 1e-5 - 1.0).abs() < 1e-12 && (axis.range[1] - 1.0).abs() < 1e-12);
        assert_eq!(power_of_ten(-16), "10⁻¹⁶");
        assert_eq!(power_of_ten(25), "10²⁵");
    }
}
