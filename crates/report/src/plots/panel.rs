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

/// Logarithms are taken here and drawn on an even axis, as the library's own logarithmic axes end at
/// 1e-10.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) label: String,
    /// Least and greatest value, or power of ten if the axis is logarithmic.
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
        // A little room, so that a point on a border does not lie on the frame.
        let low = (0.8 * least).log10().floor();
        let high = (1.25 * greatest).log10().ceil();
        Axis {
            label: label.into(),
            range: [low, high],
            is_log: true,
        }
    }

    fn place(&self, value: f64) -> f64 {
        match self.is_log {
            true => value.log10().clamp(self.range[0], self.range[1]),
            false => value,
        }
    }

    /// Decades from one label to the next.
    fn tick_step(&self) -> f64 {
        let [low, high] = self.range;
        match self.is_log {
            true => 1.0 + ((high - low) / 9.0).floor(),
            false => (high - low) / 5.0,
        }
    }
}

/// The picture as SVG. Both panels have the same y axis.
pub(super) fn draw(panels: [Panel; 2], y: &Axis, legend: &[Style]) -> String {
    let mut plots = Vec::new();
    let mut layouts = Vec::new();
    for panel in panels {
        let lines = panel.lines.iter();
        let drawn: Vec<Plot> = lines.flat_map(|line| drawn(line, &panel, y)).collect();
        let mut layout = Layout::auto_from_plots(&drawn)
            .with_title(panel.title)
            .with_title_size(15)
            .with_x_label(panel.x.label.clone())
            .with_label_size(13)
            .with_tick_size(11)
            .with_box_axes()
            .with_clamp_axis()
            .with_x_axis_min(panel.x.range[0])
            .with_x_axis_max(panel.x.range[1])
            .with_x_tick_step(panel.x.tick_step())
            .with_y_axis_min(y.range[0])
            .with_y_axis_max(y.range[1])
            .with_y_tick_step(y.tick_step())
            .with_y_tick_format(powers_of_ten());
        if panel.x.is_log {
            layout = layout.with_x_tick_format(powers_of_ten());
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
        .with_shared_legend_right_middle()
        .with_shared_legend_entries(entries)
        .with_figure_size(1080.0, 430.0);
    SvgBackend.render_scene(&figure.render())
}

fn drawn((style, points): &Line, panel: &Panel, y: &Axis) -> [Plot; 2] {
    let every = match panel.few_markers {
        true => points.len().div_ceil(12).max(1),
        false => 1,
    };
    let placed: Vec<(f64, f64)> = points
        .iter()
        .map(|point| (panel.x.place(point.0), y.place(point.1)))
        .collect();
    let line = LinePlot::new()
        .with_data(placed.iter().copied())
        .with_color(style.color)
        .with_stroke_width(1.3)
        .with_line_style(style.line.clone());
    let markers = ScatterPlot::new()
        .with_data(placed.iter().copied().step_by(every))
        .with_color(style.color)
        .with_marker(style.marker)
        .with_size(4.0);
    [Plot::Line(line), Plot::Scatter(markers)]
}

fn powers_of_ten() -> TickFormat {
    TickFormat::Custom(Arc::new(|exponent: f64| {
        power_of_ten(exponent.round() as i32)
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
    format!(
        "10{}",
        exponent.to_string().chars().map(digit).collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_powers_of_ten_around_the_data() {
        let axis = Axis::log("", [3e-5, 0.2].into_iter());
        assert_eq!(axis.range, [-5.0, 0.0]);
        assert_eq!(axis.place(1e-3), -3.0);
        assert_eq!(power_of_ten(-16), "10⁻¹⁶");
        assert_eq!(power_of_ten(25), "10²⁵");
    }
}
