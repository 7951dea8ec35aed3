//! Collisions: error against the time of a step and against speed; bounces by method.

use cases::scenes::Who;
use kuva::plot::LineStyle;
use kuva::plot::scatter::MarkerShape;

use super::panel::{self, Axis, Line, Panel};
use super::style::Style;
use super::{Figure, Plot};
use crate::collisions::{RATE, Run, SPEED, Scenes};
use crate::results::Results;

pub(super) static PLOT: Plot = Plot {
    name: "collisions",
    title: "Speed against error for collisions",
    about: "Error of where bodies end, relative to the way of the faster one, against the time of \
            a step, over steps of 1/30 to 1/960 s; and against the speed at which they meet, at \
            60 Hz. Continuous collisions, discrete ones through BVHs, and Rapier with its \
            continuous detection, as its documentation advises. All without friction and \
            rotation, elastic. Errors below 10⁻¹⁷ are drawn there. Time of the first impact and \
            energy are in the table.",
    draw,
};

const LEAST_ERROR: f64 = 1e-17;

fn draw(results: &Results) -> Vec<Figure> {
    let scenes = results.collisions.scenes.iter().map(of_scene);
    scenes.chain([of_methods(results)]).collect()
}

pub(super) fn style(who: Who) -> Style {
    let (color, marker, line) = match who {
        Who::Continuous => ("#0072b2", MarkerShape::Circle, LineStyle::Solid),
        Who::Discrete => ("#009e73", MarkerShape::Square, LineStyle::DashDot),
        Who::Rapier => ("#d55e00", MarkerShape::Triangle, LineStyle::Dashed),
    };
    Style {
        label: who.name(),
        color,
        marker,
        line,
    }
}

fn of_scene(scene: &Scenes) -> Figure {
    let error = |run: &Run| run.found.error.max(LEAST_ERROR);
    let fastest = scene.runs.iter().map(|run| run.speed).fold(0.0, f64::max);
    let speed = SPEED.min(fastest);
    let lines = |is_drawn: &dyn Fn(&Run) -> bool, x: &dyn Fn(&Run) -> f64| -> Vec<Line> {
        let lines = Who::ALL.iter().map(|&who| {
            let runs = scene.runs.iter().filter(|run| run.who == who);
            let points = runs
                .filter(|run| is_drawn(run))
                .map(|run| (x(run), error(run)));
            (style(who), points.collect())
        });
        lines.collect()
    };
    let y = Axis::log("error of the end, of the way", scene.runs.iter().map(error));
    let times = scene.runs.iter().map(|run| run.seconds);
    let left = Panel {
        title: scene.title.into(),
        x: Axis::log("time of a step, s", times),
        lines: lines(&|run| run.speed == speed, &|run| run.seconds),
        few_markers: false,
    };
    // A ball that falls has one speed only, so its other panel is over the step.
    let right = match fastest > speed {
        true => Panel {
            title: "by speed, at 60 Hz".into(),
            x: Axis::log("speed, m/s", scene.runs.iter().map(|run| run.speed)),
            lines: lines(&|run| run.rate == RATE, &|run| run.speed),
            few_markers: false,
        },
        false => Panel {
            title: "by step".into(),
            x: Axis::log("dt, s", scene.runs.iter().map(dt)),
            lines: lines(&|_| true, &dt),
            few_markers: false,
        },
    };
    let styles: Vec<Style> = Who::ALL.iter().map(|&who| style(who)).collect();
    Figure {
        name: format!("collisions-{}", scene.name),
        heading: Some(scene.title),
        caption: scene.about.into(),
        svg: panel::draw([left, right], &y, &styles),
    }
}

fn dt(run: &Run) -> f64 {
    1.0 / f64::from(run.rate)
}

/// Impact times and energy of a bouncing ball against dt.
fn of_methods(results: &Results) -> Figure {
    let bounces = &results.collisions.bounces;
    let line = |method, error: &dyn Fn(&crate::collisions::Bounce) -> Option<f64>| -> Line {
        let own = bounces.iter().filter(|bounce| bounce.method == method);
        let points = own.filter_map(|b| Some((b.dt, error(b)?.max(LEAST_ERROR))));
        (Style::of_method(method), points.collect())
    };
    let times: Vec<Line> = sim_core::METHODS
        .map(|m| line(m, &|bounce| bounce.time))
        .into();
    let energies: Vec<Line> = sim_core::METHODS
        .map(|m| line(m, &|bounce| Some(bounce.energy)))
        .into();
    let errors = times.iter().chain(&energies).flat_map(|(_, points)| points);
    let y = Axis::log("error, s and relative", errors.map(|point| point.1));
    let x = Axis::log("dt, s", bounces.iter().map(|bounce| bounce.dt));
    let panel = |title: &str, lines| Panel {
        title: title.into(),
        x: x.clone(),
        lines,
        few_markers: false,
    };
    let panels = [
        panel("time of the first three bounces", times),
        panel("energy", energies),
    ];
    Figure {
        name: "collisions-methods".into(),
        heading: Some("Bounces by method"),
        caption:
            "A point dropped from 1 m on a floor, continuous collisions: largest error of the \
                  times of three impacts, and largest change of the energy in 2.5 s. Ways are \
                  followed as the method makes them, not along chords, so that methods that are \
                  exact for parabolas find impacts to rounding at every dt; Euler methods are late \
                  or early by their own error."
                .into(),
        svg: panel::draw(panels, &y, &sim_core::METHODS.map(Style::of_method)),
    }
}
