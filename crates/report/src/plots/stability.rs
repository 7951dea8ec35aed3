//! The stability map: a row a method, a column a step.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LegendEntry, LegendShape, LinePlot, ScatterPlot};
use kuva::render::figure::Figure as Picture;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot as Drawn;

use super::panel::power_of_ten;
use super::{Figure, Plot};
use crate::results::Results;
use crate::stability::{Class, DAMPINGS, Damping};

pub(super) static PLOT: Plot = Plot {
    name: "stability",
    title: "Stability map",
    about: "An oscillator of rate ω is stepped thousands of times by each dt. Stable: it dies \
            out; marginal: its amplitude stays within 1 % over half of the steps; unstable: it \
            grows. The wide bar is the limit that theory gives, from the eigenvalues of a step \
            (Hairer, Wanner 1996, Solving Ordinary Differential Equations II, sec. IV.2), the narrow \
            one that found by stepping at steps a few thousandths apart; windows of instability \
            that are narrower than a column lie between the marks. A method without bars is stable \
            at every step, or, undamped forward Euler, at none.",
    draw,
};

struct Look {
    color: &'static str,
    marker: MarkerShape,
    size: f64,
}

fn look(class: Class) -> Look {
    match class {
        Class::Stable => Look {
            color: "#0072b2",
            marker: MarkerShape::Circle,
            size: 3.2,
        },
        Class::Marginal => Look {
            color: "#e69f00",
            marker: MarkerShape::Diamond,
            size: 3.6,
        },
        Class::Unstable => Look {
            color: "#000000",
            marker: MarkerShape::Cross,
            size: 2.6,
        },
    }
}

const THEORY_COLOR: &str = "#d55e00";
const MEASURED_COLOR: &str = "#005a32";

fn draw(results: &Results) -> Vec<Figure> {
    let mut plots = Vec::new();
    let mut layouts = Vec::new();
    for damping in &DAMPINGS {
        let (drawn, titles) = panel(results, damping);
        let rows = titles.len() as f64;
        let mut layout = Layout::auto_from_plots(&drawn)
            .with_title(damping.title)
            .with_title_size(15)
            .with_x_label("step times rate, ω dt")
            .with_label_size(13)
            .with_tick_size(12)
            .with_log_x()
            .with_box_axes()
            .with_clamp_axis()
            .with_x_axis_min(0.008)
            .with_x_axis_max(125.0)
            .with_y_axis_min(-0.7)
            .with_y_axis_max(rows - 0.3)
            .with_y_tick_step(1.0)
            .with_x_tick_format(TickFormat::Custom(Arc::new(|value: f64| {
                let log = value.log10();
                match (log - log.round()).abs() < 1e-6 {
                    true => power_of_ten(log.round() as i32),
                    false => String::new(),
                }
            })));
        let is_first = plots.is_empty();
        layout = layout.with_y_tick_format(TickFormat::Custom(Arc::new(move |value: f64| {
            let row = value.round();
            let is_row = (value - row).abs() < 1e-6 && row >= 0.0;
            let title = titles.get(row as usize).filter(|_| is_row && is_first);
            title.copied().unwrap_or_default().into()
        })));
        plots.push(drawn);
        layouts.push(layout);
    }
    let mut legend: Vec<LegendEntry> = Class::ALL
        .into_iter()
        .map(|class| entry(class.name(), look(class).color, look(class).marker))
        .collect();
    let limits = [
        ("limit by theory (wide)", THEORY_COLOR),
        ("limit found (narrow)", MEASURED_COLOR),
    ];
    legend.extend(limits.map(|(label, color)| LegendEntry {
        label: label.into(),
        color: color.into(),
        shape: LegendShape::Rect,
        dasharray: None,
    }));
    let picture = Picture::new(1, 2)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_shared_legend_right_middle()
        .with_shared_legend_entries(legend)
        // The left one has the names of the methods beside it.
        .with_cell_size(405.0, 400.0)
        .with_col_width(0, 530.0);
    vec![Figure {
        name: "stability".into(),
        heading: None,
        caption: String::new(),
        svg: SvgBackend.render_scene(&picture.render()),
    }]
}

/// The marks of one damping, and the methods from the lowest row up.
fn panel(results: &Results, damping: &Damping) -> (Vec<Drawn>, Vec<&'static str>) {
    let rows = results.stability.iter();
    let rows: Vec<_> = rows
        .filter(|row| row.damping.ratio == damping.ratio)
        .rev()
        .collect();
    let mut drawn = Vec::new();
    for class in Class::ALL {
        let marks = rows.iter().enumerate().flat_map(|(y, row)| {
            let cells = row.cells.iter().filter(move |cell| cell.1 == class);
            cells.map(move |(z, _)| (*z, y as f64))
        });
        let look = look(class);
        let scatter = ScatterPlot::new()
            .with_data(marks.collect::<Vec<_>>())
            .with_color(look.color)
            .with_marker(look.marker)
            .with_size(look.size);
        drawn.push(Drawn::Scatter(scatter));
    }
    for (y, row) in rows.iter().enumerate() {
        for (limit, color, width) in [
            (row.theory, THEORY_COLOR, 4.5),
            (row.measured, MEASURED_COLOR, 1.8),
        ] {
            if (0.01..100.0).contains(&limit) {
                let bar = LinePlot::new()
                    .with_data([(limit, y as f64 - 0.42), (limit, y as f64 + 0.42)])
                    .with_color(color)
                    .with_stroke_width(width);
                drawn.push(Drawn::Line(bar));
            }
        }
    }
    (drawn, rows.iter().map(|row| row.method.title).collect())
}

fn entry(label: &str, color: &str, marker: MarkerShape) -> LegendEntry {
    LegendEntry {
        label: label.into(),
        color: color.into(),
        shape: LegendShape::Marker(marker),
        dasharray: None,
    }
}
