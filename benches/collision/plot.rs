//! The plot of naive against BVH and peers over the number of triangles, with two logarithmic axes.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LegendEntry, LegendPosition, LegendShape, LinePlot, LineStyle, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::growth::Series;
use crate::placements::Class;
use crate::table::time;

/// The style of a method: markers and dashes distinguish methods without colour.
struct Style {
    label: &'static str,
    color: &'static str,
    marker: MarkerShape,
    line: LineStyle,
}

/// In the order of the series. The colours differ for colour-blind eyes too (Okabe, Ito 2008, "Color
/// universal design").
const STYLES: [Style; 4] = [
    Style {
        label: "BVH",
        color: "#0072b2",
        marker: MarkerShape::Circle,
        line: LineStyle::Solid,
    },
    Style {
        label: "parry's trees, our exact test",
        color: "#009e73",
        marker: MarkerShape::Diamond,
        line: LineStyle::Dashed,
    },
    Style {
        label: "parry's query",
        color: "#e69f00",
        marker: MarkerShape::Triangle,
        line: LineStyle::DashDot,
    },
    Style {
        label: "naive",
        color: "#000000",
        marker: MarkerShape::Square,
        line: LineStyle::Dotted,
    },
];

/// The picture as SVG, a panel for each class.
pub(crate) fn naive_against_bvh(growth: &[Series]) -> String {
    let panels = [
        (Class::Near, "no contact: 1 % of the size apart"),
        (Class::Deep, "contact: at 30 % of the touching offset"),
    ];
    let plots = panels.map(|(class, _)| {
        let series = growth.iter().filter(|s| s.what == class.name());
        series
            .zip(&STYLES)
            .flat_map(|(series, style)| drawn(series, style))
            .collect::<Vec<_>>()
    });
    let layouts = panels.iter().zip(&plots).map(|((class, title), plots)| {
        let layout = Layout::auto_from_plots(plots)
            .with_title(*title)
            .with_title_size(15)
            .with_x_label("triangles of each of two cows")
            .with_log_scale()
            .with_x_axis_min(700.0)
            .with_x_axis_max(600_000.0)
            .with_y_axis_min(1e-7)
            .with_y_axis_max(1.0)
            .with_x_tick_format(TickFormat::Custom(Arc::new(decade)))
            .with_y_tick_format(TickFormat::Custom(Arc::new(|seconds| {
                time(seconds).replace(".00", "").replace(".0", "")
            })));
        match class {
            // The legend is where no line is, because a contact is found long before a second.
            Class::Deep => layout
                .with_legend_position(LegendPosition::InsideTopRight)
                .with_legend_entries(STYLES.iter().map(Style::legend).collect()),
            _ => layout
                .with_y_label("time of one answer")
                .with_y_label_offset(-12.0, 0.0),
        }
    });
    let layouts = layouts.collect();
    let figure = Figure::new(1, 2)
        .with_plots(plots.into())
        .with_layouts(layouts)
        .with_shared_y_all()
        .with_figure_size(960.0, 420.0);
    SvgBackend.render_scene(&figure.render())
}

/// The label of a tick, only for whole powers of ten; others would overlap.
fn decade(n: f64) -> String {
    match n.log10() {
        log if (log - log.round()).abs() > 1e-9 => String::new(),
        _ => format!("{},000", n / 1000.0),
    }
}

impl Style {
    fn legend(&self) -> LegendEntry {
        LegendEntry {
            label: self.label.into(),
            color: self.color.into(),
            shape: LegendShape::Marker(self.marker),
            dasharray: None,
        }
    }
}

fn drawn(series: &Series, style: &Style) -> [Plot; 2] {
    let points = || series.points.iter().copied();
    let line = LinePlot::new().with_data(points()).with_color(style.color);
    let markers = ScatterPlot::new()
        .with_data(points())
        .with_color(style.color);
    [
        Plot::Line(line.with_line_style(style.line.clone())),
        Plot::Scatter(markers.with_marker(style.marker).with_size(5.0)),
    ]
}
