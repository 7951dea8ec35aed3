//! Runs scenes for minutes or days and checks them after each step.
//!
//! Each scene gets an equal part of the time. An `Invariant` must hold after each step; the first violation ends the
//! soak with an error. A scene that ends, for example when walls close on a body, starts again.
//! walls close on a body, starts again.

use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Duration;

use scene::{SCENES, Scene, shown};
use sim_core::{Force, StepError, World};

use crate::errors;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::number;
use crate::session::{Drift, Reference};
use crate::stopwatch::Stopwatch;

/// The relative rounding errors allowed: of the energy, where its gain is multiplied by the square root of the number
/// of steps; and of the momentum, relative to all momentum that bodies have and exchange in a step.
const ROUNDING: f64 = 1e-12;

/// A condition that must hold after each step, and the message if it does not.
struct Invariant {
    broken: fn(&Scene, &World, &Step) -> Option<String>,
}

/// The changes of a step, and of all steps before it.
struct Step {
    since_start: Drift,
    alone: Drift,
    /// Sum of the impulses of its impacts, N s.
    impulses: f64,
}

const INVARIANTS: [Invariant; 4] = [
    Invariant {
        broken: |scene, world, _| {
            let is_lost = |&body: &usize| {
                !(world.position(body).is_finite() && world.velocity(body).is_finite())
            };
            let lost = (0..world.len()).find(is_lost)?;
            Some(format!(
                "{} is at {}",
                name(scene, lost),
                world.position(lost)
            ))
        },
    },
    Invariant {
        broken: |scene, world, _| {
            let (i, j) = *world.meeting().first()?;
            Some(format!("{} and {} overlap", name(scene, i), name(scene, j)))
        },
    },
    // Under varying forces a method has errors of its own.
    Invariant {
        broken: |_, world, step| {
            let drift = &step.since_start;
            let is_exact = world.settings().method.order > 1
                && world
                    .forces()
                    .iter()
                    .all(|force| matches!(force, Force::Gravity { .. }));
            let gained = drift
                .relative_energy
                .filter(|_| is_exact && !drift.driven)?;
            let most = ROUNDING * (world.steps() as f64).sqrt();
            (gained > most).then(|| format!("energy has grown by {gained:e} of it"))
        },
    },
    // Each exchange is rounded relative to itself and to the momenta that it changes. Each step is tested on its own:
    // if errors were allowed to accumulate, any error would be allowed in the end.
    Invariant {
        broken: |_, world, step| {
            let error = step.alone.momentum?;
            let after: f64 = (0..world.len())
                .filter(|&body| world.kind(body).is_movable())
                .map(|body| world.mass(body) * world.velocity(body).length())
                .sum();
            let exchanged = step.alone.pushes + after + step.impulses;
            (error > ROUNDING * exchanged).then(|| {
                format!("momentum is off by {error:e} kg m/s, of {exchanged:e} that the step had")
            })
        },
    },
];

fn name(scene: &Scene, body: usize) -> String {
    format!("body {}", shown::name(&scene.bodies[body].name))
}

/// The results of a scene.
#[derive(Default)]
struct Soaked {
    steps: u64,
    runs: u64,
    impacts: u64,
    energy: f64,
    momentum: f64,
    /// Mean time of a step in the first and in the last tenth, s.
    early: Mean,
    late: Mean,
    /// Resident memory after the first tenth and at the end, bytes, if the system reports it.
    memory: [Option<u64>; 2],
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: u64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn value(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}

/// Runs scenes for a number of minutes in all, and returns a report.
pub fn run(
    scenes: &[(String, Scene)],
    minutes: f64,
    interrupt: &Interrupt,
) -> Result<String, Failure> {
    interrupt.listen();
    let part = Duration::try_from_secs_f64(60.0 * minutes / scenes.len() as f64)
        .map_err(|_| Failure::Refused("--minutes: must be below 1e17".to_owned()))?;
    let mut text = format!(
        "{:<16} {:>11} {:>11} {:>5} {:>9} {:>9} {:>9} {:>9} {:>9}\n",
        "scene", "steps", "impacts", "runs", "energy", "momentum", "early", "late", "memory"
    );
    for (index, (name, scene)) in scenes.iter().enumerate() {
        if interrupt.came() {
            break;
        }
        let soaked = soak(name, scene, part, interrupt).inspect_err(|_| {
            // The results of the previous scenes are printed at once; a failure to print is harmless.
            if index > 0 {
                let _ = std::io::stdout().write_all(text.as_bytes());
            }
        })?;
        let memory = match soaked.memory {
            [Some(before), Some(after)] => {
                format!("{:+} KiB", (after as i64 - before as i64) / 1024)
            }
            _ => "-".to_owned(),
        };
        let _ = writeln!(
            text,
            "{name:<16} {:>11} {:>11} {:>5} {:>9} {:>9} {:>9} {:>9} {memory:>9}",
            soaked.steps,
            soaked.impacts,
            soaked.runs,
            number::error(soaked.energy),
            number::error(soaked.momentum),
            number::seconds(soaked.early.value()),
            number::seconds(soaked.late.value()),
        );
    }
    Ok(text)
}

/// The scenes of an argument: one, or the whole gallery.
pub fn gallery() -> Result<Vec<(String, Scene)>, Failure> {
    let all = SCENES.iter().map(|entry| {
        let scene = entry.scene().map_err(Failure::refused)?;
        Ok((entry.name.to_owned(), scene))
    });
    all.collect()
}

fn soak(
    name: &str,
    scene: &Scene,
    part: Duration,
    interrupt: &Interrupt,
) -> Result<Soaked, Failure> {
    let mut soaked = Soaked::default();
    let stopwatch = Stopwatch::start();
    while stopwatch.read() < part && !interrupt.came() {
        let mut world = scene.world().map_err(Failure::refused)?;
        let reference = Reference::of(&world);
        let mut impacts = Vec::new();
        soaked.runs += 1;
        while stopwatch.read() < part && !interrupt.came() {
            let before = Reference::of(&world);
            impacts.clear();
            let watch = Stopwatch::start();
            match world.step_reporting(&mut impacts) {
                Ok(()) => {}
                // The expected end of scenes with closing walls.
                Err(StepError::Squeezed { .. }) if world.steps() > 0 => break,
                Err(error) => return Err(Failure::Run(errors::step_error(scene, &error))),
            }
            let seconds = watch.read().as_secs_f64();
            let step = Step {
                since_start: reference.drift(&world),
                alone: before.drift(&world),
                impulses: impacts.iter().map(|impact| impact.impulse.abs()).sum(),
            };
            for invariant in &INVARIANTS {
                if let Some(what) = (invariant.broken)(scene, &world, &step) {
                    let number = world.steps();
                    return Err(Failure::Run(format!("{name}: after step {number} {what}")));
                }
            }
            let drift = &step.since_start;
            soaked.note(drift, seconds, stopwatch.read().div_duration_f64(part));
        }
        soaked.impacts += world.impacts();
    }
    soaked.memory[1] = resident();
    Ok(soaked)
}

impl Soaked {
    /// Records a step: its duration, and the fraction of the whole time at which it was taken.
    fn note(&mut self, drift: &Drift, seconds: f64, part: f64) {
        self.steps += 1;
        self.energy = self.energy.max(drift.relative_energy.unwrap_or(0.0).abs());
        self.momentum = self.momentum.max(drift.relative_momentum.unwrap_or(0.0));
        if part < 0.1 {
            self.early.add(seconds);
        } else if self.memory[0].is_none() {
            self.memory[0] = resident();
        }
        if part > 0.9 {
            self.late.add(seconds);
        }
    }
}

/// Resident memory of the process, bytes.
fn resident() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}
