//! Friction, stacks and heaps: error against the time and the length of a step.

use super::collisions::style;
use super::panel::{self, Axis, Line, Panel};
use super::{Figure, Plot};
use crate::resting::{ENGINES, Resting, Run};
use crate::results::Results;

pub(super) static PLOT: Plot = Plot {
    name: "resting",
    title: "Speed against error for what lies, slides and piles up",
    about: "Error of what friction and contacts do, against the mean time of a step and against its \
            length, from 1/30 to 1/960 s, beside Rapier with rotations locked. Bodies of 1 kg and \
            0.5 m that keep nothing of the speed at which they meet. Errors below 10⁻¹⁷ are drawn \
            there. Overlaps, the most that the energy rises in a step, and what bundled contacts take \
            of it are in the table.",
    draw,
};

const LEAST_ERROR: f64 = 1e-17;

fn draw(results: &Results) -> Vec<Figure> {
    results.resting.iter().map(of_scene).collect()
}

fn of_scene(scene: &Resting) -> Figure {
    let error = |run: &Run| run.found.error.max(LEAST_ERROR);
    let lines = |x: &dyn Fn(&Run) -> f64| -> Vec<Line> {
        let lines = ENGINES.into_iter().map(|who| {
            let runs = scene.runs.iter().filter(|run| run.who == who);
            (style(who), runs.map(|run| (x(run), error(run))).collect())
        });
        lines.collect()
    };
    let seconds = |run: &Run| run.seconds;
    let dt = |run: &Run| 1.0 / f64::from(run.rate);
    let panel = |title: &str, label: &str, x: &dyn Fn(&Run) -> f64| Panel {
        title: title.into(),
        x: Axis::log(label, scene.runs.iter().map(x)),
        lines: lines(x),
        few_markers: false,
    };
    let y = Axis::log(scene.error, scene.runs.iter().map(error));
    let panels = [
        panel(scene.title, "time of a step, s", &seconds),
        panel("by step", "dt, s", &dt),
    ];
    Figure {
        name: format!("resting-{}", scene.name),
        heading: Some(scene.title),
        caption: scene.about.into(),
        svg: panel::draw(panels, &y, &ENGINES.map(style)),
    }
}
