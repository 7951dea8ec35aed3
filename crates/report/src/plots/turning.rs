//! Bodies that turn: error against cost, in free flight, of flips, of first contacts and of levers.

use cases::Verdict;
use cases::problems::Effort;
use cases::scenes::Who;
use cases::turning::contacts::Seeker;
use cases::turning::{ENGINES, racket};
use kuva::plot::LineStyle;
use kuva::plot::scatter::MarkerShape;

use super::collisions::style;
use super::panel::{self, Axis, Line, Panel};
use super::style::Style;
use super::{Figure, Plot};
use crate::results::Results;
use crate::turning::{
    ContactRun, Contacts, LeverRun, Levers, Puller, RacketRun, TumbleRun, Tumbles,
};

pub(super) static PLOT: Plot = Plot {
    name: "turning",
    title: "Bodies that turn",
    about: "Free flight, the flips of a tennis racket, times of first contact, and forces at points, each error \
            against its cost. Rapier and parry, its library of geometry, get the same bodies and motions. Free \
            flight and flips are stepped at 1/30 to 1/960 s; their cost is the time of a step times the number of \
            steps in a second of motion. Errors below 10⁻¹⁷ are drawn there. What has no error, as nothing was found \
            or a run has failed, is in the tables only. Of a first contact its time decides, also where the \
            search says of itself that it has failed, as parry's does beside times that are right.",
    draw,
};

const LEAST_ERROR: f64 = 1e-17;

fn draw(results: &Results) -> Vec<Figure> {
    let turning = &results.turning;
    let mut figures: Vec<Figure> = turning.tumbles.iter().map(of_tumbler).collect();
    figures.extend(racket::STARTS.map(|start| of_racket(&turning.rackets, start)));
    let swept = turning
        .contacts
        .iter()
        .filter(|it| it.contact.spins.len() > 1);
    figures.extend(swept.map(of_contact));
    figures.extend(turning.levers.iter().map(of_lever));
    figures
}

/// What is drawn of an error.
fn drawn(error: f64) -> Option<f64> {
    error.is_finite().then(|| error.max(LEAST_ERROR))
}

fn all(lines: &[Line]) -> impl Iterator<Item = f64> {
    lines
        .iter()
        .flat_map(|(_, points)| points.iter().map(|p| p.1))
}

fn of_tumbler(tumbles: &Tumbles) -> Figure {
    let cost = |run: &TumbleRun| run.seconds * f64::from(run.rate);
    let lines = |error: &dyn Fn(&TumbleRun) -> f64| -> Vec<Line> {
        let lines = ENGINES.iter().map(|&who| {
            let runs = tumbles.runs.iter().filter(|run| run.who == who);
            let points = runs.filter_map(|run| Some((cost(run), drawn(error(run))?)));
            (style(who), points.collect())
        });
        lines.collect()
    };
    let energy = lines(&|run| run.found.energy);
    let spin = lines(&|run| run.found.spin);
    let y = Axis::log("relative error", all(&energy).chain(all(&spin)));
    let x = Axis::log(
        "time for a second of motion, s",
        tumbles.runs.iter().map(cost),
    );
    let panel = |title: String, lines| Panel {
        title,
        x: x.clone(),
        lines,
        few_markers: false,
    };
    let time = tumbles.time;
    Figure {
        name: format!("turning-{}", tumbles.tumbler.name),
        heading: Some(tumbles.tumbler.title),
        caption: format!(
            "{} Left the greatest error of the energy in {time} s; right that of the angular velocity in the frame of \
             the body after {time} s.",
            tumbles.tumbler.about
        ),
        svg: panel::draw(
            [
                panel(format!("energy in {time} s"), energy),
                panel(format!("spin after {time} s"), spin),
            ],
            &y,
            &legend(),
        ),
    }
}

fn legend() -> Vec<Style> {
    ENGINES.iter().map(|&who| style(who)).collect()
}

fn of_racket(runs: &[RacketRun], start: f64) -> Figure {
    let runs: Vec<&RacketRun> = runs.iter().filter(|run| run.start == start).collect();
    let cost = |run: &RacketRun| run.seconds * f64::from(run.rate);
    let lines = |flip: usize| -> Vec<Line> {
        let lines = ENGINES.iter().map(|&who| {
            let runs = runs.iter().filter(|run| run.who == who);
            let points =
                runs.filter_map(|run| Some((cost(run), drawn(run.flips.error(start, flip)?)?)));
            (style(who), points.collect())
        });
        lines.collect()
    };
    let panels = [("the first flip", 0), ("the tenth flip", racket::FLIPS - 1)];
    let panels = panels.map(|(title, flip)| (title, lines(flip)));
    let y = Axis::log("error, s", panels.iter().flat_map(|(_, lines)| all(lines)));
    let x = Axis::log(
        "time for a second of motion, s",
        runs.iter().map(|run| cost(run)),
    );
    let panels = panels.map(|(title, lines)| Panel {
        title: title.into(),
        x: x.clone(),
        lines,
        few_markers: false,
    });
    let heading = "The tennis racket";
    Figure {
        name: format!("turning-racket-{}", (1.0 / start).round()),
        heading: (start == racket::STARTS[0]).then_some(heading),
        caption: format!(
            "A box of 2 × 1 × 0.5 m spins at 3 rad/s about its middle axis and at {} rad/s about its shortest side: error \
             of the times of its first and tenth flip, which by the elliptic integral are {:.2} s and {:.2} s.",
            3.0 * start,
            racket::exact(start, 0),
            racket::exact(start, racket::FLIPS - 1)
        ),
        svg: panel::draw(panels, &y, &legend()),
    }
}

fn style_of_seeker(who: Seeker) -> Style {
    let (color, marker, line) = match who {
        Seeker::Ours => ("#0072b2", MarkerShape::Circle, LineStyle::Solid),
        Seeker::ParryMeshes => ("#d55e00", MarkerShape::Triangle, LineStyle::Dashed),
        Seeker::ParryBoxes => ("#000000", MarkerShape::Square, LineStyle::Dotted),
    };
    Style {
        label: who.name(),
        color,
        marker,
        line,
    }
}

fn of_contact(contacts: &Contacts) -> Figure {
    let runs = &contacts.runs;
    let who: Vec<Seeker> = Seeker::ALL
        .iter()
        .copied()
        .filter(|&who| runs.iter().any(|run| run.who == who))
        .collect();
    let lines = |x: &dyn Fn(&ContactRun) -> f64| -> Vec<Line> {
        let lines = who.iter().map(|&who| {
            let runs = runs.iter().filter(|run| run.who == who);
            let points = runs.filter_map(|run| Some((x(run), drawn(run.late()?.abs())?)));
            (style_of_seeker(who), points.collect())
        });
        lines.collect()
    };
    let panel = |title: &str, label: &str, x: &dyn Fn(&ContactRun) -> f64| Panel {
        title: title.into(),
        x: Axis::log(label, runs.iter().map(x)),
        lines: lines(x),
        few_markers: false,
    };
    let title = contacts.contact.title;
    let panels = [
        panel(title, "time of an answer, s", &|run| run.seconds),
        panel("by spin", "spin, rad/s", &|run| run.spin),
    ];
    let errors = lines(&|run| run.spin);
    let y = Axis::log("error of the time, s", all(&errors));
    let left_out = match who.contains(&Seeker::ParryMeshes) {
        true => "",
        false => " A quick report does not ask parry here, which takes seconds for an answer.",
    };
    let not_drawn = who.iter().filter_map(|&who| {
        let of = runs.iter().filter(|run| run.who == who);
        let missed = of.filter(|run| run.late().is_none()).count();
        (missed > 0).then(|| format!(" {} finds none of {missed}.", who.name()))
    });
    let wrong = who.iter().filter_map(|&who| {
        let of = || runs.iter().filter(|run| run.who == who);
        let wrong = of().filter(|run| run.verdict == Verdict::Fail).count();
        (wrong > 0).then(|| format!(" {}: {wrong} of {} fail.", who.name(), of().count()))
    });
    Figure {
        name: format!("turning-{}", contacts.contact.name),
        heading: Some(contacts.contact.title),
        caption: format!(
            "{}{left_out}{}{}",
            contacts.contact.about,
            not_drawn.collect::<String>(),
            wrong.collect::<String>()
        ),
        svg: panel::draw(
            panels,
            &y,
            &who.iter()
                .map(|&who| style_of_seeker(who))
                .collect::<Vec<_>>(),
        ),
    }
}

fn of_lever(levers: &Levers) -> Figure {
    let lines = |x: &dyn Fn(&LeverRun) -> Option<f64>| -> Vec<Line> {
        let lines = Puller::all().map(|who| {
            let runs = levers.runs.iter().filter(|run| run.who == who);
            let points = runs.filter_map(|run| Some((x(run)?, drawn(*run.error.as_ref().ok()?)?)));
            let style = match who {
                Puller::Method(method) => Style::of_method(method),
                // The colour that it has elsewhere is that of a method here.
                Puller::Rapier => Style {
                    color: "#7f7f7f",
                    ..style(Who::Rapier)
                },
            };
            (style, points.collect())
        });
        lines.collect()
    };
    let dt = |run: &LeverRun| match run.effort {
        Effort::Steps(steps) => Some(levers.lever.time() / steps as f64),
        Effort::Tolerance(_) => None,
    };
    let by_time = lines(&|run| Some(run.seconds));
    let legend: Vec<Style> = by_time.iter().map(|(style, _)| style.clone()).collect();
    let y = Axis::log("error, m", all(&by_time));
    let succeeded = || levers.runs.iter().filter(|run| run.error.is_ok());
    let panels = [
        Panel {
            title: levers.lever.title.into(),
            x: Axis::log("time of a run, s", succeeded().map(|run| run.seconds)),
            lines: by_time,
            few_markers: false,
        },
        Panel {
            title: "by step".into(),
            x: Axis::log("dt, s", succeeded().filter_map(dt)),
            lines: lines(&dt),
            few_markers: false,
        },
    ];
    Figure {
        name: format!("turning-{}", levers.lever.name),
        heading: Some(levers.lever.title),
        caption: levers.lever.about.into(),
        svg: panel::draw(panels, &y, &legend),
    }
}
