//! The curves over time in the plots: their figures, runs and colours.

use sim_core::Phase;

use super::{Sample, Session, Variant};

/// The most points of a curve; longer curves keep the least and the greatest value of neighbouring points.
const MOST_POINTS: usize = 1200;
/// The colour of the run itself, sRGB.
pub const RUN: [f32; 3] = [0.93, 0.94, 0.96];
/// The colours of the parts of a figure.
const FIRST: [f32; 3] = [0.95, 0.62, 0.25];
const SECOND: [f32; 3] = [0.40, 0.68, 0.95];
const THIRD: [f32; 3] = [0.45, 0.80, 0.50];
const FOURTH: [f32; 3] = [0.88, 0.56, 0.92];

/// The part of the energy that only turning bodies have.
const TURNING: &str = "turning";

/// A plot over simulated time.
pub struct Chart {
    /// Its title.
    pub title: &'static str,
    /// The unit; may be empty.
    pub unit: &'static str,
    /// An explanation.
    pub meaning: &'static str,
    /// Whether the axis of values is logarithmic.
    pub logarithmic: bool,
    /// The figure by which runs are compared.
    main: Part,
    /// The further figures that are shown for a single run.
    parts: &'static [Part],
}

struct Part {
    name: &'static str,
    colour: [f32; 3],
    value: fn(&Sample) -> Option<f64>,
}

/// All plots, in the order in which they are offered.
pub static CHARTS: [Chart; 6] = [
    Chart {
        title: "Energy",
        unit: "J",
        meaning: "Kinetic energy, what of it is in turning, potential energy of the forces that have one, and kinetic \
                  and potential together",
        logarithmic: false,
        main: Part {
            name: "total",
            colour: RUN,
            value: |s| Some(s.kinetic + s.potential),
        },
        parts: &[
            Part {
                name: "kinetic",
                colour: FIRST,
                value: |s| Some(s.kinetic),
            },
            Part {
                name: TURNING,
                colour: THIRD,
                value: |s| s.turning,
            },
            Part {
                name: "potential",
                colour: SECOND,
                value: |s| Some(s.potential),
            },
        ],
    },
    Chart {
        title: "Path error",
        unit: "m",
        meaning: "Largest distance of a body from where it would be exactly, where that is known",
        logarithmic: true,
        main: Part {
            name: "error",
            colour: RUN,
            value: |s| s.error,
        },
        parts: &[],
    },
    Chart {
        title: "Momentum",
        unit: "kg m/s",
        meaning: "Sum of mass times velocity: its size, and its parts along x, y and z",
        logarithmic: false,
        main: Part {
            name: "size",
            colour: RUN,
            value: |s| Some(s.momentum.length()),
        },
        parts: &[
            Part {
                name: "x",
                colour: FIRST,
                value: |s| Some(s.momentum.x),
            },
            Part {
                name: "y",
                colour: THIRD,
                value: |s| Some(s.momentum.y),
            },
            Part {
                name: "z",
                colour: SECOND,
                value: |s| Some(s.momentum.z),
            },
        ],
    },
    Chart {
        title: "Angular momentum",
        unit: "kg m²/s",
        meaning: "About the origin, Σ x × m v + I ω: its size, and its parts along x, y and z. What acts along the \
                  line to the origin, or between bodies that turn, does not change it",
        logarithmic: false,
        main: Part {
            name: "size",
            colour: RUN,
            value: |s| Some(s.angular_momentum.length()),
        },
        parts: &[
            Part {
                name: "x",
                colour: FIRST,
                value: |s| Some(s.angular_momentum.x),
            },
            Part {
                name: "y",
                colour: THIRD,
                value: |s| Some(s.angular_momentum.y),
            },
            Part {
                name: "z",
                colour: SECOND,
                value: |s| Some(s.angular_momentum.z),
            },
        ],
    },
    Chart {
        title: "Step cost",
        unit: "s",
        meaning: "Real time that each step took, and of that: motion under forces (integrate), who comes \
                  near whom (broad phase), whether and when they meet (narrow phase), impulses and \
                  contacts that last (response). To time the parts makes short steps a little longer",
        logarithmic: true,
        main: Part {
            name: "step",
            colour: RUN,
            value: |s| s.cost,
        },
        parts: &[
            Part {
                name: "integrate",
                colour: THIRD,
                value: |s| s.phase(Phase::Integrate),
            },
            Part {
                name: "broad",
                colour: SECOND,
                value: |s| s.phase(Phase::Broad),
            },
            Part {
                name: "narrow",
                colour: FIRST,
                value: |s| s.phase(Phase::Narrow),
            },
            Part {
                name: "response",
                colour: FOURTH,
                value: |s| s.phase(Phase::Respond),
            },
        ],
    },
    Chart {
        title: "Contacts",
        unit: "",
        meaning: "Contacts that last (in the continuous mode), and impacts in each step",
        logarithmic: false,
        main: Part {
            name: "impacts",
            colour: RUN,
            value: |s| Some(s.impacts as f64),
        },
        parts: &[Part {
            name: "contacts",
            colour: FIRST,
            value: |s| Some(s.contacts as f64),
        }],
    },
];

/// One curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The name of the run, or of the part of its figure.
    pub name: String,
    /// sRGB, for a dark background.
    pub colour: [f32; 3],
    /// Times, s, and values; for a logarithmic chart, decimal logarithms of the values.
    pub points: Vec<[f64; 2]>,
}

impl Session {
    /// The curves of a chart: of the run with its parts, or of the run and its variants.
    pub fn curves(&self, chart: &Chart) -> Vec<Curve> {
        let samples = self.playback().samples();
        let curve = |name: &str, part: &Part| Curve {
            name: name.to_owned(),
            colour: part.colour,
            points: thinned(points(chart, part, samples.clone())),
        };
        if self.variants().is_empty() {
            let turns = samples.clone().any(|s| s.turning.is_some());
            let parts = chart
                .parts
                .iter()
                .filter(|part| turns || part.name != TURNING);
            let parts = parts.chain([&chart.main]);
            return parts.map(|part| curve(part.name, part)).collect();
        }
        let (own, names) = self.variant_names();
        let variants = self.variants().iter().zip(names);
        let others = variants.filter_map(|(variant, name)| {
            let samples = variant.record().map(|snapshot| &snapshot.sample);
            let points = thinned(points(chart, &chart.main, samples));
            let colour = on_dark(variant.colour);
            // The exact solution has no error and no cost.
            (points.len() > 1).then_some(Curve {
                name,
                colour,
                points,
            })
        });
        // The run itself is drawn last, on top.
        let mut curves: Vec<Curve> = others.collect();
        curves.push(curve(&own, &chart.main));
        curves
    }

    /// The title of the most informative chart besides the energy: of rotation if bodies rotate, else of errors if they
    /// are known, else of motion.
    pub fn telling_chart(&self) -> &'static str {
        let mut samples = self.playback().samples();
        match samples.any(|sample| sample.error.is_some()) {
            _ if super::turns(self.world()) => "Angular momentum",
            true => "Path error",
            false => "Momentum",
        }
    }

    /// Work against precision: for the run and each variant the decimal logarithms of the real time per simulated
    /// second, s, and of the error, m. Runs for which one of the two is 0 or unknown are left out.
    pub fn work_precision(&self) -> Vec<Curve> {
        let (own, names) = self.variant_names();
        let dt = self.world().settings().dt;
        let costs: Vec<f64> = self.playback().samples().filter_map(|s| s.cost).collect();
        let load = costs.iter().sum::<f64>() / (costs.len() as f64 * dt);
        let errors = self.playback().samples().filter_map(|s| s.error);
        let point = |load: Option<f64>, error: Option<f64>| {
            let both = [load?.log10(), error?.log10()];
            both.iter().all(|part| part.is_finite()).then_some(both)
        };
        let curve = |name: String, colour: [f32; 3], at: Option<[f64; 2]>| Curve {
            name,
            colour,
            points: at.into_iter().collect(),
        };
        let of = |(variant, name): (&Variant, String)| {
            let at = point(variant.load(), variant.worst);
            curve(name, on_dark(variant.colour), at)
        };
        let variants = self.variants().iter().zip(names).map(of);
        let run = curve(own, RUN, point(Some(load), errors.reduce(f64::max)));
        variants
            .chain([run])
            .filter(|c| !c.points.is_empty())
            .collect()
    }

    /// The table of all runs that the plots show, as CSV.
    pub fn csv(&self) -> String {
        let (own, names) = self.variant_names();
        let named = !self.variants().is_empty();
        let mut text = super::csv_head(named);
        for sample in self.playback().samples() {
            text += &super::csv_line(named.then_some(&own), sample);
        }
        for (variant, name) in self.variants().iter().zip(&names) {
            for snapshot in variant.record() {
                text += &super::csv_line(Some(name), &snapshot.sample);
            }
        }
        text
    }
}

fn points<'a>(
    chart: &Chart,
    part: &Part,
    samples: impl Iterator<Item = &'a Sample>,
) -> Vec<[f64; 2]> {
    let point = |sample: &Sample| {
        let value = (part.value)(sample)?;
        let value = if chart.logarithmic {
            value.log10()
        } else {
            value
        };
        value.is_finite().then_some([sample.time, value])
    };
    samples.filter_map(point).collect()
}

/// Reduces a curve to at most [`MOST_POINTS`] points: of neighbours it keeps the least and the greatest, in their
/// order.
fn thinned(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if points.len() <= MOST_POINTS {
        return points;
    }
    let together = points.len().div_ceil(MOST_POINTS / 2);
    let mut kept = Vec::with_capacity(MOST_POINTS);
    for few in points.chunks(together) {
        let by_value = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
        let (least, most) = (few.iter().min_by(by_value), few.iter().max_by(by_value));
        if let (Some(&least), Some(&most)) = (least, most) {
            kept.push(if least[0] <= most[0] { least } else { most });
            if least[0] != most[0] {
                kept.push(if least[0] <= most[0] { most } else { least });
            }
        }
    }
    kept
}

/// Lightens a colour for a light background so that it suits a dark one.
pub fn on_dark(colour: [f32; 3]) -> [f32; 3] {
    let [red, green, blue] = colour;
    let light = 0.3 * red + 0.59 * green + 0.11 * blue;
    let lift = (0.62 - light).max(0.0) / (1.0 - light);
    colour.map(|part| part + lift * (1.0 - part))
}

#[cfg(test)]
mod tests {
    use super::thinned;

    #[test]
    fn thinning_keeps_extremes_and_order() {
        let mut points: Vec<[f64; 2]> = (0..10_000).map(|n| [f64::from(n), 0.0]).collect();
        (points[1234][1], points[7000][1]) = (5.0, -7.0);
        let few = thinned(points);
        assert!(few.len() <= 1200 && few.is_sorted_by(|a, b| a[0] < b[0]));
        assert!(few.contains(&[1234.0, 5.0]) && few.contains(&[7000.0, -7.0]));
    }
}
