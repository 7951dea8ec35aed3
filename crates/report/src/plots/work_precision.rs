//! Error against time and evaluations: a curve further down and left is better.

use super::panel::{self, Axis, Line, Panel};
use super::style::Style;
use super::{Figure, Plot};
use crate::results::Results;
use crate::runs::{Diagram, Point, Series, Who};

pub(super) static PLOT: Plot = Plot {
    name: "work-precision",
    title: "Work and precision",
    about: "Error achieved at the end against the time of a run and against evaluations of the \
            right-hand side, both axes logarithmic: what is further down and to the left is \
            better. Each marker is a run: of methods with a fixed step one with half of the \
            step before, of adaptive ones one with a tenth of the tolerance. Jacobians of \
            implicit methods are counted in the table only. Methods are stepped over x″ = a(t, x, \
            v); solvers, which choose their steps over the whole time, over the same problem as \
            y′ = f(t, y). Errors below 10⁻¹⁷ are drawn there. Runs that failed, or whose error is \
            1 or more, are listed below the figures.",
    draw,
};

/// Where errors of nothing are drawn.
const LEAST_ERROR: f64 = 1e-17;

fn draw(results: &Results) -> Vec<Figure> {
    results.diagrams.iter().flat_map(of_problem).collect()
}

fn of_problem(diagram: &Diagram) -> [Figure; 2] {
    let card = &diagram.card;
    let is_method = |series: &Series| matches!(series.who, Who::Method(_));
    // What explicit solvers of stiff problems must be compared with.
    let is_stiff_method = |series: &Series| match series.who {
        Who::Method(method) => {
            card.is_stiff && !method.adaptive && method.stable_dt(1.0, 1.0).is_infinite()
        }
        Who::Solver(_) => true,
    };
    let methods = figure(
        diagram,
        format!("{}-methods", card.name),
        "methods",
        is_method,
    );
    let solvers = figure(
        diagram,
        format!("{}-solvers", card.name),
        "solvers beside peers",
        is_stiff_method,
    );
    [
        Figure {
            heading: Some(card.title),
            caption: card.about.into(),
            ..methods
        },
        Figure {
            caption: match card.is_stiff {
                true => "Solvers and peers, with the methods that are stable at every step.".into(),
                false => "Solvers and peers, on the axes of the figure above.".into(),
            },
            ..solvers
        },
    ]
}

fn figure(
    diagram: &Diagram,
    name: String,
    who: &str,
    is_drawn: impl Fn(&Series) -> bool,
) -> Figure {
    let card = &diagram.card;
    let everything = || diagram.series.iter().flat_map(Series::points);
    let y = Axis::log(
        &format!("error ({})", card.error),
        everything().map(|p| p.error.max(LEAST_ERROR)),
    );
    let time = Axis::log("time of a run, s", everything().map(|p| p.seconds));
    let evaluations = Axis::log(
        "evaluations of the right-hand side",
        everything().map(|p| p.evaluations as f64),
    );
    let drawn: Vec<&Series> = diagram.series.iter().filter(|s| is_drawn(s)).collect();
    let lines = |x: &dyn Fn(Point) -> f64| -> Vec<Line> {
        let lines = drawn.iter().map(|series| {
            let points = series.points().map(|p| (x(p), p.error.max(LEAST_ERROR)));
            (style(series.who), points.collect())
        });
        lines.collect()
    };
    let panels = [
        Panel {
            title: format!("{}: {who}", card.title),
            lines: lines(&|p| p.seconds),
            x: time,
            few_markers: false,
        },
        Panel {
            title: "by evaluations".into(),
            lines: lines(&|p| p.evaluations as f64),
            x: evaluations,
            few_markers: false,
        },
    ];
    let legend: Vec<Style> = drawn.iter().map(|series| style(series.who)).collect();
    Figure {
        name,
        heading: None,
        caption: String::new(),
        svg: panel::draw(panels, &y, &legend),
    }
}

fn style(who: Who) -> Style {
    match who {
        Who::Method(method) => Style::of_method(method),
        Who::Solver(solver) => Style::of_solver(solver),
    }
}
