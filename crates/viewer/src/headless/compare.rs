//! Runs one scene in several ways and compares the results, without a window.

use std::fmt::Write;

use scene::{Scene, shown};
use serde::Serialize;
use sim_core::Settings;

use super::to_json;
use crate::errors::step_error;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Progress};
use crate::number;
use crate::session::{Halt, Runner, Sample, csv_head, csv_line, full_name};
use crate::stopwatch::Stopwatch;

/// The format of the result.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A table of the final states.
    Table,
    /// The same data as one JSON array.
    Json,
    /// Every state of every run.
    Csv,
}

/// The most runs of one command.
const MOST_RUNS: usize = 200;

/// The result of one run. Null means unknown.
#[derive(Serialize)]
struct Standing {
    run: String,
    time: f64,
    steps: u64,
    impacts: u64,
    path_error: Option<f64>,
    largest_path_error: Option<f64>,
    energy_drift: Option<f64>,
    energy_error: Option<f64>,
    seconds_per_step: Option<f64>,
    failure: Option<String>,
    positions: Vec<[f64; 3]>,
}

/// Runs the scene with each of these settings for `time`, s, and compares with the exact solution if it is known.
pub fn compare(
    scene: &Scene,
    settings: &[Settings],
    time: f64,
    form: Form,
    interrupt: &Interrupt,
) -> Result<String, Failure> {
    if settings.len() > MOST_RUNS {
        let text = format!(
            "{} runs: compare at most {MOST_RUNS} at once",
            settings.len()
        );
        return Err(Failure::Refused(text));
    }
    let world = scene.world().map_err(Failure::refused)?;
    interrupt.listen();
    let mut runs = Vec::new();
    for settings in settings {
        let runner = Runner::stepping(&world, *settings).map_err(Failure::refused)?;
        runs.push((full_name(settings), runner));
    }
    // The exact solution is sampled as often as the run with the shortest steps.
    let shortest = settings.iter().min_by(|a, b| a.dt.total_cmp(&b.dt));
    let mut finest = world.clone();
    if let Some(&settings) = shortest {
        finest.set_settings(settings).map_err(Failure::refused)?;
    }
    runs.extend(Runner::exact(&finest).map(|runner| ("exact".to_owned(), runner)));
    let mut csv = csv_head(true);
    let mut standings = Vec::new();
    let mut progress = Progress::new(runs.len() as u64);
    for (name, runner) in runs {
        if interrupt.came() {
            break;
        }
        let states = |sample: &Sample| {
            if form == Form::Csv {
                csv += &csv_line(Some(&name), sample);
            }
        };
        standings.push(follow(scene, &name, runner, time, states, interrupt));
        progress.at(standings.len() as u64);
    }
    progress.end();
    Ok(match form {
        Form::Csv => csv,
        Form::Json => to_json(&standings),
        Form::Table => table(scene, &standings),
    })
}

/// Takes the steps of one run up to the end.
fn follow(
    scene: &Scene,
    name: &str,
    mut runner: Runner,
    time: f64,
    mut note: impl FnMut(&Sample),
    interrupt: &Interrupt,
) -> Standing {
    let stopwatch = Stopwatch::start();
    let mut last = runner.snapshot(None, 0).sample;
    note(&last);
    let (mut worst, mut cost, mut impacts) = (last.error, None, 0);
    let mut failure = None;
    // Rounding may put the last step slightly after or before the time.
    let nearly = time - 1e-9 * time.abs().max(runner.world().settings().dt);
    while last.time < nearly && !interrupt.came() {
        match runner.step(&|| stopwatch.read()) {
            Ok(snapshot) => last = snapshot.sample,
            Err(Halt::Step(error)) => {
                failure = Some(step_error(scene, &error));
                break;
            }
            Err(Halt::Unknown) => {
                failure = Some("not known from here on".to_owned());
                break;
            }
        }
        note(&last);
        worst = match (worst, last.error) {
            (Some(worst), Some(error)) => Some(f64::max(worst, error)),
            (worst, error) => worst.or(error),
        };
        impacts += last.impacts;
        if let Some(took) = last.cost {
            cost = Some(cost.unwrap_or(0.0) + took);
        }
    }
    let drift = runner.drift();
    let is_exact = cost.is_none();
    let world = runner.world();
    Standing {
        run: name.to_owned(),
        time: last.time,
        steps: last.steps,
        impacts,
        path_error: last.error,
        largest_path_error: worst,
        energy_drift: drift.relative_energy.filter(|_| !is_exact),
        energy_error: drift.energy.filter(|_| !is_exact),
        seconds_per_step: cost.map(|cost| cost / last.steps.max(1) as f64),
        failure,
        positions: (0..world.len())
            .map(|i| world.position(i).to_array())
            .collect(),
    }
}

fn table(scene: &Scene, standings: &[Standing]) -> String {
    let mut text = format!("Scene  {}\n\n", shown::part(&scene.title));
    let names = standings.iter().map(|s| s.run.chars().count());
    let width = names.max().unwrap_or(0).max(4);
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{:<width$} {:>9} {:>9} {:>8} {:>11} {:>11} {:>12} {:>10} {:>11}",
        "Run",
        "time, s",
        "steps",
        "impacts",
        "error, m",
        "largest, m",
        "energy",
        "a step",
        "a second"
    );
    for s in standings {
        let none = || "-".to_owned();
        let metres = |error: Option<f64>| error.map_or_else(none, number::figure);
        let energy = match (s.energy_drift, s.energy_error) {
            (Some(relative), _) => number::error(relative),
            (None, Some(joules)) => format!("{} J", number::error(joules)),
            (None, None) => none(),
        };
        let second = s
            .seconds_per_step
            .map(|cost| cost * s.steps as f64 / s.time);
        let _ = writeln!(
            text,
            "{:<width$} {:>9} {:>9} {:>8} {:>11} {:>11} {:>12} {:>10} {:>11}",
            s.run,
            format!("{:.4}", s.time),
            s.steps,
            s.impacts,
            metres(s.path_error),
            metres(s.largest_path_error),
            energy,
            s.seconds_per_step.map_or_else(none, number::seconds),
            second.map_or_else(none, number::seconds),
        );
        if let Some(why) = &s.failure {
            let _ = writeln!(text, "  stopped: {why}");
        }
    }
    text
}
