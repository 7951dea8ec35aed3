//! Energy and angular momentum of a planet, orbit after orbit.

use cases::drift::Orbit;

use super::panel::{self, Axis, Line, Panel};
use super::style::Style;
use super::{Figure, Plot};
use crate::results::Results;

pub(super) static PLOT: Plot = Plot {
    name: "drift",
    title: "Drift of energy and momentum",
    about: "A planet on an ellipse of eccentricity 0.6 at 1,000 steps an orbit, in a world under \
            a force of attraction: the greatest relative error of energy and of angular momentum \
            within each orbit. What rises drifts; what is level does not, however large it is. \
            Adaptive methods hold a tolerance of 1e-9 in each step. Errors below 10⁻¹⁷ are drawn \
            there.",
    draw,
};

const LEAST_ERROR: f64 = 1e-17;

fn draw(results: &Results) -> Vec<Figure> {
    let lines = |error: &dyn Fn(&Orbit) -> f64| -> Vec<Line> {
        let lines = results.drifts.iter().map(|drift| {
            let orbits = drift.planet.orbits.iter().enumerate();
            let points = orbits.map(|(i, orbit)| (1.0 + i as f64, error(orbit).max(LEAST_ERROR)));
            (Style::of_method(drift.method), points.collect())
        });
        lines.collect()
    };
    let energy = lines(&|orbit| orbit.energy);
    let spin = lines(&|orbit| orbit.angular_momentum);
    let all = energy.iter().chain(&spin);
    let values = all.flat_map(|(_, points)| points.iter().map(|p| p.1));
    // An energy error of a thousand is as good as one of one.
    let y = Axis::log("relative error", values.map(|error| error.min(1e3)));
    let orbits = results.drifts.iter().map(|d| d.planet.orbits.len()).max();
    let x = Axis {
        label: "orbits".into(),
        range: [0.0, orbits.unwrap_or(1) as f64],
        is_log: false,
    };
    let legend: Vec<Style> = energy.iter().map(|(style, _)| style.clone()).collect();
    let panels = [("energy", energy), ("angular momentum", spin)].map(|(title, lines)| Panel {
        title: title.into(),
        x: x.clone(),
        lines,
        few_markers: true,
    });
    let failures = results.drifts.iter().filter_map(|drift| {
        let failure = drift.planet.failure.as_ref()?;
        Some(format!(
            "{} ends in orbit {}: {failure}.",
            drift.method.title,
            drift.planet.orbits.len() + 1
        ))
    });
    vec![Figure {
        name: "drift".into(),
        heading: None,
        caption: failures.collect::<Vec<_>>().join(" "),
        svg: panel::draw(panels, &y, &legend),
    }]
}
