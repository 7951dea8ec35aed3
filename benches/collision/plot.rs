//! The picture of naive against BVH and peers, over triangles, both axes logarithmic.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LegendEntry, LegendShape, LinePlot, LineStyle, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::growth::Series;
use crate::placements::Class;
use crate::table::time;

/// How each method in turn is drawn: told apart by marker and dashes where there is no colour, and
/// by colours that differ for colour-blind eyes (Okabe, Ito 2008, "Color universal design").
const STYLES: [(&str, MarkerShape, LineStyle); 4] = [
    ("#0072b2", MarkerShape::Circle, LineStyle::Solid),
    ("#009e73", MarkerShape::Diamond, LineStyle::Dashed),
    ("#e69f00", MarkerShape::Triangle, LineStyle::DashDot),
    ("#000000", MarkerShape::Square, LineStyle::Dotted),
];

/// The picture as SVG, a panel for each class.
pub(crate) fn naive_against_bvh(growth: &[Series]) -> String {
    let panels = [
        (Class::Near, "no contact: 1 % of the size apart"),
        (Class::Deep, "contact: at 30 % of the touching offset"),
    ];
    let of_class = |class: Class| growth.iter().filter(move |s| s.what == class.name());
    let plots = panels.map(|(class, _)| {
        let series = of_class(class).zip(STYLES);
        series
            .flat_map(|(series, style)| drawn(series, style))
            .collect::<Vec<_>>()
    });
    let layouts = panels.iter().zip(&plots).map(|((_, title), plots)| {
        Layout::auto_from_plots(plots)
            .with_title(*title)
            .with_x_label("triangles of each cow")
            .with_y_label("time of one answer")
            .with_log_scale()
            .with_y_axis_min(1e-7)
            .with_y_axis_max(1.0)
            .with_x_tick_format(TickFormat::Custom(Arc::new(|n| format!("{n}"))))
            .with_y_tick_format(TickFormat::Custom(Arc::new(time)))
    });
    let layouts = layouts.collect();
    let legend = of_class(Class::Near)
        .zip(STYLES)
        .map(|(series, (color, marker, _))| LegendEntry {
            label: series.method.clone(),
            color: color.into(),
            shape: LegendShape::Marker(marker),
            dasharray: None,
        });
    let figure = Figure::new(1, 2)
        .with_plots(plots.into())
        .with_layouts(layouts)
        .with_shared_y_all()
        .with_shared_legend_entries(legend.collect())
        .with_shared_legend_bottom()
        .with_figure_size(960.0, 480.0);
    SvgBackend.render_scene(&figure.render())
}

fn drawn(series: &Series, (color, marker, line): (&str, MarkerShape, LineStyle)) -> [Plot; 2] {
    let points = || series.points.iter().copied();
    [
        Plot::Line(
            LinePlot::new()
                .with_data(points())
                .with_color(color)
                .with_line_style(line),
        ),
        Plot::Scatter(
            ScatterPlot::new()
                .with_data(points())
                .with_color(color)
                .with_marker(marker)
                .with_size(5.0),
        ),
    ]
}
