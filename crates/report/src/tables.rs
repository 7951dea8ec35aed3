//! The tables of the page.

use cases::problems::Effort;
use cases::turning::racket::FLIPS;
use cases::{CASES, Outcome, Verdict};
use sim_core::METHODS;

use crate::results::Results;
use crate::runs::{Diagram, Point, Series, Who};
use crate::table::{Table, seconds, short};
use crate::turning::ContactRun;

/// All, for the files.
pub(crate) fn all(results: &Results) -> Vec<Table> {
    vec![
        methods(),
        least_errors(results),
        runs(results),
        sweeps(results),
        failed_runs(results),
        beside_peers(results),
        drift(results),
        stability(results),
        matrix(results),
        hard_cases(results),
        contact(results),
        collisions(results),
        bounces(results),
        resting(results),
        tumbling(results),
        racket(results),
        first_contacts(results),
        levers(results),
    ]
}

/// What is compared.
pub(crate) fn methods() -> Table {
    let head = ["method", "title", "order", "stability", "source"];
    let mut table = Table::new("methods", "Methods", &head);
    for m in METHODS {
        table.rows.push(vec![
            m.name.into(),
            m.title.into(),
            m.order.to_string(),
            m.stability.into(),
            m.source.into(),
        ]);
    }
    table
}

fn effort(effort: Effort) -> String {
    match effort {
        Effort::Steps(steps) => format!("{steps} steps"),
        Effort::Tolerance(tolerance) => format!("tolerance {tolerance:.0e}"),
    }
}

/// The least error that everybody has reached, and how long that took.
pub(crate) fn least_errors(results: &Results) -> Table {
    let mut head = vec!["who"];
    head.extend(results.diagrams.iter().map(|diagram| diagram.card.title));
    let title = "Least error of each sweep, and the time of that run";
    let mut table = Table::new("least-errors", title, &head);
    for who in Who::all() {
        let mut row = vec![who.name().to_owned()];
        for diagram in &results.diagrams {
            let points = diagram
                .by_name(who.name())
                .into_iter()
                .flat_map(Series::points);
            let best = points.min_by(|a, b| a.error.total_cmp(&b.error));
            row.push(best.map_or("none".into(), |best| {
                format!("{} in {}", short(best.error), seconds(best.seconds))
            }));
        }
        table.rows.push(row);
    }
    table
}

/// Every run that succeeded.
pub(crate) fn runs(results: &Results) -> Table {
    let head = [
        "problem",
        "who",
        "effort",
        "error",
        "time, s",
        "evaluations",
        "Jacobians",
    ];
    let mut table = Table::new("work-precision", "Every run", &head);
    for diagram in &results.diagrams {
        for series in &diagram.series {
            for run in &series.runs {
                let Ok(point) = &run.outcome else { continue };
                table.rows.push(vec![
                    diagram.card.name.into(),
                    series.who.name().into(),
                    effort(run.effort),
                    format!("{:.3e}", point.error),
                    format!("{:.3e}", point.seconds),
                    point.evaluations.to_string(),
                    point.jacobians.to_string(),
                ]);
            }
        }
    }
    table
}

/// How many runs each sweep has, and why not more.
pub(crate) fn sweeps(results: &Results) -> Table {
    let head = ["problem", "who", "runs", "of these failed", "ended because"];
    let mut table = Table::new("sweeps", "Every sweep", &head);
    for diagram in &results.diagrams {
        for series in &diagram.series {
            table.rows.push(vec![
                diagram.card.name.into(),
                series.who.name().into(),
                series.runs.len().to_string(),
                (series.runs.len() - series.points().count()).to_string(),
                series.ended.into(),
            ]);
        }
    }
    table
}

/// Every run that did not: those that follow each other in a sweep as one row.
pub(crate) fn failed_runs(results: &Results) -> Table {
    let head = [
        "problem",
        "who",
        "runs",
        "from",
        "to",
        "why, the last of them",
    ];
    let title = "Runs that failed, or whose error is 1 or more";
    let mut table = Table::new("failed-runs", title, &head);
    for diagram in &results.diagrams {
        for series in &diagram.series {
            for group in series
                .runs
                .chunk_by(|a, b| a.outcome.is_err() && b.outcome.is_err())
            {
                let (first, last) = (&group[0], &group[group.len() - 1]);
                let Err(why) = &last.outcome else { continue };
                table.rows.push(vec![
                    diagram.card.title.into(),
                    series.who.name().into(),
                    group.len().to_string(),
                    effort(first.effort),
                    effort(last.effort),
                    why.clone(),
                ]);
            }
        }
    }
    table
}

/// Errors at which solvers are compared, and the problems that have them.
const GOALS: [f64; 2] = [1e-4, 1e-6];

/// Our solvers and their peers at equal error.
pub(crate) fn beside_peers(results: &Results) -> Table {
    let head = [
        "problem",
        "error",
        "who",
        "time",
        "evaluations",
        "time, sim-core = 1",
    ];
    let title = "Time and evaluations at equal error, between the runs on both sides of it";
    let mut table = Table::new("beside-peers", title, &head);
    for diagram in &results.diagrams {
        for goal in GOALS {
            for pair in ["Dopri5", "Dop853", "Radau5"] {
                let ours = at_error(diagram, &format!("sim_core::{pair}"), goal);
                let lowercase = pair.to_lowercase();
                for name in [
                    format!("sim_core::{pair}"),
                    format!("ode_solvers::{pair}"),
                    format!("differential_equations::{lowercase}"),
                ] {
                    let Some((time, evaluations)) = at_error(diagram, &name, goal) else {
                        continue;
                    };
                    table.rows.push(vec![
                        diagram.card.title.into(),
                        format!("{goal:.0e}"),
                        name,
                        seconds(time),
                        format!("{evaluations:.0}"),
                        ours.map_or("".into(), |(our, _)| format!("{:.2}", time / our)),
                    ]);
                }
            }
        }
    }
    table
}

/// Time and evaluations for an error, on the straight line in logarithms between the last two
/// neighbours that have it between them.
fn at_error(diagram: &Diagram, who: &str, goal: f64) -> Option<(f64, f64)> {
    let points: Vec<Point> = diagram.by_name(who)?.points().collect();
    let pair = points
        .windows(2)
        .rfind(|p| p[0].error > goal && p[1].error <= goal)?;
    let (above, below) = (pair[0], pair[1]);
    let along = (above.error / goal).ln() / (above.error / below.error.max(1e-300)).ln();
    let between = |a: f64, b: f64| a * (b / a).powf(along);
    Some((
        between(above.seconds, below.seconds),
        between(above.evaluations as f64, below.evaluations as f64),
    ))
}

pub(crate) fn drift(results: &Results) -> Table {
    let head = [
        "method",
        "orbits",
        "energy, greatest",
        "energy, slope an orbit",
        "angular momentum, greatest",
        "momentum of the Pleiades, 3 s",
    ];
    let title = "Relative drift: Kepler e = 0.6 at 1,000 steps an orbit, Pleiades at dt = 1 ms";
    let mut table = Table::new("drift", title, &head);
    for drift in &results.drifts {
        let planet = &drift.planet;
        let spins = planet.orbits.iter().map(|orbit| orbit.angular_momentum);
        let spin = spins.fold(0.0, f64::max);
        table.rows.push(vec![
            drift.method.title.into(),
            match &planet.failure {
                Some(_) => format!("{}, then it fails", planet.orbits.len()),
                None => planet.orbits.len().to_string(),
            },
            short(planet.energy()),
            short(planet.energy_slope()),
            short(spin),
            drift.pleiades.clone().map_or_else(|error| error, short),
        ]);
    }
    table
}

pub(crate) fn stability(results: &Results) -> Table {
    let head = [
        "method",
        "damping ratio",
        "largest stable ω dt, measured",
        "by theory",
        "they agree",
    ];
    let title = "Largest stable step, and what Method::stable_dt says";
    let mut table = Table::new("stability", title, &head);
    let limit = |z: f64| match z {
        0.0 => "none".into(),
        z if z.is_infinite() => "every".into(),
        z => format!("{z:.4}"),
    };
    for row in &results.stability {
        let measured = match row.measured {
            z if z.is_infinite() => "all up to 100".into(),
            z => limit(z),
        };
        let agree = row.measured == row.theory || (row.measured / row.theory - 1.0).abs() < 2e-3;
        table.rows.push(vec![
            row.method.title.into(),
            row.damping.ratio.to_string(),
            measured,
            limit(row.theory),
            match agree {
                true => "yes, to 0.2 %".into(),
                false => "NO".into(),
            },
        ]);
    }
    table
}

fn cell(outcome: &Outcome) -> String {
    let finding = &outcome.finding;
    match (finding.verdict, finding.figure) {
        (Verdict::Pass | Verdict::Fail, Some(figure)) => {
            format!("{} {}", finding.verdict.name(), short(figure))
        }
        (verdict, _) => verdict.name().into(),
    }
}

/// Case by method. What does not depend on the method is said once, beside the case.
pub(crate) fn matrix(results: &Results) -> Table {
    let mut head = vec!["case", "what", "any method"];
    head.extend(METHODS.iter().map(|method| method.title));
    let mut table = Table::new("hard-case-matrix", "Hard cases by method", &head);
    for case in &CASES {
        let of_case = || {
            results
                .cases
                .iter()
                .filter(|o| o.case.number == case.number)
        };
        let of = |method| of_case().find(|o| o.method == method).map(cell);
        let mut row = vec![case.number.to_string(), case.title.to_owned()];
        row.push(of(None).unwrap_or_default());
        row.extend(METHODS.map(|method| of(Some(method)).unwrap_or_default()));
        table.rows.push(row);
    }
    table
}

/// The same with tolerance and reason.
pub(crate) fn hard_cases(results: &Results) -> Table {
    let head = [
        "case",
        "what",
        "method",
        "figure",
        "tolerance",
        "verdict",
        "expected",
        "why",
    ];
    let mut table = Table::new("hard-cases", "Hard cases, one by one", &head);
    for outcome in &results.cases {
        let finding = &outcome.finding;
        table.rows.push(vec![
            outcome.case.number.to_string(),
            outcome.case.title.into(),
            outcome.method.map_or("any", |method| method.title).into(),
            finding.figure.map(short).unwrap_or_default(),
            finding.tolerance.map(short).unwrap_or_default(),
            finding.verdict.name().into(),
            outcome.case.expected(outcome.method).name().into(),
            finding.why.clone(),
        ]);
    }
    table
}

pub(crate) fn contact(results: &Results) -> Table {
    let head = ["meshes", "they meet", "naive", "BVH", "ratio", "both right"];
    let title = "Do two meshes meet? Time of one answer";
    let mut table = Table::new("contact", title, &head);
    let yes_or_no = |is: bool| if is { "yes" } else { "no" };
    for row in &results.contact {
        table.rows.push(vec![
            row.pair.clone(),
            yes_or_no(row.meet).into(),
            seconds(row.naive),
            seconds(row.bvh),
            format!("{:.0}", row.naive / row.bvh),
            yes_or_no(row.right).into(),
        ]);
    }
    table
}

/// Every run with a collision.
pub(crate) fn collisions(results: &Results) -> Table {
    let head = [
        "scene",
        "speed, m/s",
        "rate, Hz",
        "who",
        "impact time, s",
        "end, of the way",
        "energy",
        "time of a step",
    ];
    let title = "Collisions: errors and time of a step";
    let mut table = Table::new("collisions", title, &head);
    for scene in &results.collisions.scenes {
        for run in &scene.runs {
            table.rows.push(vec![
                scene.name.into(),
                run.speed.to_string(),
                run.rate.to_string(),
                run.who.name().into(),
                run.found.time.map_or("no impact".into(), short),
                short(run.found.error),
                short(run.found.energy),
                seconds(run.seconds),
            ]);
        }
    }
    table
}

/// Bounces by method.
pub(crate) fn bounces(results: &Results) -> Table {
    let head = ["method", "dt, s", "impact time, s", "energy"];
    let title = "Three bounces under gravity: errors by method";
    let mut table = Table::new("bounces", title, &head);
    for bounce in &results.collisions.bounces {
        table.rows.push(vec![
            bounce.method.name.into(),
            format!("1/{:.0}", 1.0 / bounce.dt),
            bounce.time.map_or("not three".into(), short),
            short(bounce.energy),
        ]);
    }
    table
}

/// Every run in which bodies lie, slide or pile up.
pub(crate) fn resting(results: &Results) -> Table {
    let head = [
        "scene",
        "rate, Hz",
        "who",
        "error",
        "overlap, m",
        "energy rises by",
        "bundling takes",
        "time of a step",
    ];
    let title = "Friction, stacks and heaps: errors and mean time of a step";
    let mut table = Table::new("resting", title, &head);
    for scene in &results.resting {
        for run in &scene.runs {
            table.rows.push(vec![
                scene.name.into(),
                run.rate.to_string(),
                run.who.name().into(),
                short(run.found.error),
                short(run.found.overlap),
                short(run.found.rise),
                run.found.bundled.map_or("–".into(), short),
                seconds(run.seconds),
            ]);
        }
    }
    table
}

/// Every run of a body in free flight.
pub(crate) fn tumbling(results: &Results) -> Table {
    let head = [
        "body",
        "rate, Hz",
        "who",
        "motion, s",
        "energy, greatest",
        "angular momentum, greatest",
        "spin at the end",
        "time of a step",
    ];
    let title = "Bodies that tumble freely: relative errors and time of a step";
    let mut table = Table::new("tumbling", title, &head);
    for tumbles in &results.turning.tumbles {
        for run in &tumbles.runs {
            table.rows.push(vec![
                tumbles.tumbler.title.into(),
                run.rate.to_string(),
                run.who.name().into(),
                tumbles.time.to_string(),
                short(run.found.energy),
                short(run.found.momentum),
                short(run.found.spin),
                seconds(run.seconds),
            ]);
        }
    }
    table
}

/// Every run of the tennis racket.
pub(crate) fn racket(results: &Results) -> Table {
    let head = [
        "starts off the axis by",
        "rate, Hz",
        "who",
        "first flip, s",
        "tenth flip, s",
        "flips, of 10",
        "time of a step",
    ];
    let title = "The tennis racket: errors of the times of flips and time of a step";
    let mut table = Table::new("racket", title, &head);
    for run in &results.turning.rackets {
        let error = |flip| {
            run.flips
                .error(run.start, flip)
                .map_or("none".into(), short)
        };
        table.rows.push(vec![
            run.start.to_string(),
            run.rate.to_string(),
            run.who.name().into(),
            error(0),
            error(FLIPS - 1),
            run.flips.times.len().to_string(),
            seconds(run.seconds),
        ]);
    }
    table
}

/// How far an answer is from the first contact.
fn late(run: &ContactRun) -> String {
    match (run.late(), run.exact, run.found.time) {
        (Some(late), ..) if late.is_nan() => "no number".into(),
        (Some(0.0), ..) => "0".into(),
        (Some(late), ..) if late > 0.0 => format!("{} late", short(late)),
        (Some(late), ..) => format!("{} early", short(-late)),
        (None, Some(_), _) => "missed".into(),
        (None, None, Some(_)) => "found one".into(),
        (None, None, None) => "none, rightly".into(),
    }
}

/// Every search for a first contact.
pub(crate) fn first_contacts(results: &Results) -> Table {
    let head = [
        "meshes",
        "spin, rad/s",
        "who",
        "they meet at, s",
        "error, s",
        "verdict",
        "time of an answer",
    ];
    let title = "First contacts of what turns: errors and time of an answer; an answer passes that is right to 1e-9 s";
    let mut table = Table::new("first-contacts", title, &head);
    for contacts in &results.turning.contacts {
        for run in &contacts.runs {
            let doubt = match run.found.has_failed {
                true => ", status: failed",
                false => "",
            };
            table.rows.push(vec![
                contacts.contact.title.into(),
                format!("{:.4}", run.spin)
                    .trim_end_matches('0')
                    .trim_end_matches('.')
                    .into(),
                run.who.name().into(),
                run.exact
                    .map_or("never".into(), |time| format!("{time:.6}")),
                late(run) + doubt,
                run.verdict.name().into(),
                seconds(run.seconds),
            ]);
        }
    }
    table
}

/// Every run with a force at a point.
pub(crate) fn levers(results: &Results) -> Table {
    let head = ["body", "who", "effort", "error, m", "time of a run"];
    let title = "Forces at points: error of a point at the end and time of a run";
    let mut table = Table::new("levers", title, &head);
    for levers in &results.turning.levers {
        for run in &levers.runs {
            table.rows.push(vec![
                levers.lever.title.into(),
                run.who.name().into(),
                effort(run.effort),
                run.error.clone().map_or_else(|why| why, short),
                seconds(run.seconds),
            ]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use cases::turning::contacts::{Found, Seeker};

    use super::*;

    #[test]
    fn a_miss_and_a_ghost_are_no_figures() {
        let cell = |exact, time| {
            late(&ContactRun {
                who: Seeker::Ours,
                spin: 1.0,
                exact,
                found: Found {
                    time,
                    has_failed: false,
                },
                verdict: Verdict::Fail,
                seconds: 1.0,
            })
        };
        assert_eq!(cell(Some(0.5), Some(0.625)), "1.2e-1 late");
        assert_eq!(cell(Some(0.5), Some(0.25)), "2.5e-1 early");
        assert_eq!(cell(Some(0.5), Some(0.5)), "0");
        assert_eq!(cell(Some(0.5), None), "missed");
        assert_eq!(cell(None, Some(0.5)), "found one");
        assert_eq!(cell(None, None), "none, rightly");
        // What is no number is not praised.
        assert_eq!(cell(Some(0.5), Some(f64::NAN)), "no number");
    }
}
