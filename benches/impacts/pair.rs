//! Two bodies head on: impacts found over sub-step phases, and the time of a step averaged over flight and contact.

use cases::scenes::{Engine, Form, Pair, Rapier, Scene, continuous, world};
use criterion::Criterion;
use kit::meshes::builtin;
use sim_core::{Collision, DVec3, World};

use crate::table::{Table, three_digits, time};
use crate::watch;
use crate::{row, short};

const PHASES: u32 = 16;
const SPEEDS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
/// The number of steps from the start to the impact, and in all.
const BEFORE: u32 = 30;
const STEPS: u32 = 60;

fn pairs() -> [(&'static str, Pair); 3] {
    let (cube, cow) = (Form::Cube(0.5), Form::Mesh(builtin("cow.obj")));
    let pair = |first: &Form, second: &Form| {
        let forms = [first.clone(), second.clone()];
        Pair::new(forms, DVec3::new(1.0, 0.05, 0.1))
    };
    [
        ("cube, cube", pair(&cube, &cube)),
        ("cow, cube", pair(&cow, &cube)),
        ("cow, cow", pair(&cow, &cow)),
    ]
}

/// The scene in which they touch at a phase of a step.
fn scene(pair: &Pair, speed: f64, phase: f64) -> Scene {
    pair.scene(speed, (f64::from(BEFORE) + phase) / 60.0)
}

/// The results over all phases at a speed.
#[derive(Clone, Copy, Default)]
struct Found {
    /// The number of phases in which the body at rest was set in motion.
    impacts: u32,
    /// Largest relative error of the kinetic energy.
    energy: f64,
}

impl Found {
    fn add(&mut self, speed: f64, at_rest: DVec3, energy: f64) {
        self.impacts += u32::from(at_rest.length() > 1e-3 * speed);
        let error = (energy / (0.5 * speed * speed) - 1.0).abs();
        self.energy = self.energy.max(error);
    }

    fn cell(self) -> String {
        format!("{}/{PHASES} {}", self.impacts, short(self.energy))
    }
}

fn found(pair: &Pair, speed: f64, of: impl Fn(&Scene) -> (DVec3, f64)) -> Found {
    let mut found = Found::default();
    for phase in 0..PHASES {
        let scene = scene(pair, speed, f64::from(phase) / f64::from(PHASES));
        let (at_rest, energy) = of(&scene);
        found.add(speed, at_rest, energy);
    }
    found
}

fn discrete(scene: &Scene) -> World {
    world(scene, Collision::Bvh, "velocity-verlet")
}

fn end(mut engine: impl Engine) -> (DVec3, f64) {
    (0..STEPS).for_each(|_| watch::step(&mut engine));
    (engine.velocity(0), engine.kinetic_energy())
}

/// Ours finds every impact and keeps the energy to 1e-14.
fn assert_right(pair: &str, speed: f64, found: Found) {
    let is_right = found.impacts == PHASES && found.energy <= 1e-14;
    assert!(is_right, "{pair} at {speed}: {}", found.cell());
}

type Of = fn(&Scene) -> (DVec3, f64);

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "Head on: step at 10 m/s over flight and impact; impacts found and the largest error of \
         the kinetic energy over 16 phases",
        &[
            "pair", "engine", "step", "ratio", "1 m/s", "10 m/s", "100 m/s", "1000 m/s",
        ],
    );
    let mut group = criterion.benchmark_group("impacts/pair");
    for (name_of_pair, pair) in &pairs() {
        let scene = scene(pair, 10.0, 0.37);
        let worlds = [continuous(&scene), discrete(&scene)];
        let id = |engine: &str| format!("{name_of_pair}/{engine}");
        let times = [
            watch::time(&mut group, &id("continuous"), STEPS, || worlds[0].clone()),
            watch::time(&mut group, &id("discrete"), STEPS, || worlds[1].clone()),
            watch::time(&mut group, &id("rapier"), STEPS, || Rapier::new(&scene)),
            watch::time(&mut group, &id("rapier, edges fixed"), STEPS, || {
                Rapier::with_internal_edges_fixed(&scene)
            }),
        ];
        let engines: [(&str, Of); 4] = [
            ("continuous", |scene| end(continuous(scene))),
            ("discrete", |scene| end(discrete(scene))),
            ("rapier 0.36", |scene| end(Rapier::new(scene))),
            ("rapier, edges fixed", |scene| {
                end(Rapier::with_internal_edges_fixed(scene))
            }),
        ];
        for ((name, of), seconds) in engines.into_iter().zip(times) {
            let Some((seconds, ours)) = seconds.zip(times[0]) else {
                continue;
            };
            let results = SPEEDS.map(|speed| found(pair, speed, of));
            if name == "continuous" {
                for (speed, found) in SPEEDS.into_iter().zip(results) {
                    assert_right(name_of_pair, speed, found);
                }
            }
            let cells = results.map(Found::cell);
            let ratio = three_digits(seconds / ours);
            let mut line = vec![
                (*name_of_pair).to_owned(),
                name.into(),
                time(seconds),
                ratio,
            ];
            line.extend(cells);
            row(
                &mut table,
                &line.iter().map(String::as_str).collect::<Vec<_>>(),
            );
        }
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}
