//! Two bodies head on, at rest and coming: impacts found over sub-step phases, and the time of a
//! step averaged over flight and contact.

use std::sync::Arc;

use criterion::Criterion;
use sim_core::collide::touch::first_touch;
use sim_core::{Bvh, Collision, DVec3, Mesh, World};

use crate::rapier::Rapier;
use crate::scene::{Form, Item, Scene, builtin, item};
use crate::table::{Table, three_digits, time};
use crate::watch::{self, Engine};
use crate::{ours, row, short};

const PHASES: u32 = 16;
const SPEEDS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
/// Steps from the start to the impact, and in all.
const BEFORE: u32 = 30;
const STEPS: u32 = 60;

/// The second one comes along `way` and touches at `touching`.
struct Pair {
    name: &'static str,
    forms: [Form; 2],
    way: DVec3,
    touching: DVec3,
}

impl Pair {
    fn new(name: &'static str, [first, second]: [&Arc<Mesh>; 2], forms: [Form; 2]) -> Pair {
        let way = DVec3::new(1.0, 0.05, 0.1).normalize();
        let (from, motion) = (-16.0 * way, 32.0 * way);
        let touch = first_touch(&Bvh::build(first), &Bvh::build(second), from, motion);
        let touching = from + touch.expect("they meet").time * motion;
        Pair {
            name,
            forms,
            way,
            touching,
        }
    }

    fn scene(&self, speed: f64, phase: f64) -> Scene {
        let [first, second] = self.forms.clone();
        let dt = 1.0 / 60.0;
        let velocity = speed * self.way;
        let gap = velocity * dt * (f64::from(BEFORE) + phase);
        let still = Item {
            is_bullet: false,
            ..item(first, DVec3::ZERO, DVec3::ZERO)
        };
        Scene::new(vec![still, item(second, self.touching - gap, velocity)])
    }
}

fn pairs() -> [Pair; 3] {
    let (cube, cow) = (builtin("cube.obj"), builtin("cow.obj"));
    let (a_cube, a_cow) = (Form::Cube(0.5), Form::Mesh(cow.clone()));
    [
        Pair::new(
            "cube, cube",
            [&cube, &cube],
            [a_cube.clone(), a_cube.clone()],
        ),
        Pair::new("cow, cube", [&cow, &cube], [a_cow.clone(), a_cube]),
        Pair::new("cow, cow", [&cow, &cow], [a_cow.clone(), a_cow]),
    ]
}

/// What came out over all phases at a speed.
#[derive(Clone, Copy, Default)]
struct Found {
    /// Phases in which the body at rest was set in motion.
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
        let scene = pair.scene(speed, f64::from(phase) / f64::from(PHASES));
        let (at_rest, energy) = of(&scene);
        found.add(speed, at_rest, energy);
    }
    found
}

fn end_of_ours(scene: &Scene, collision: Collision) -> (DVec3, f64) {
    let mut world = ours::world(scene, collision, "velocity-verlet");
    (0..STEPS).for_each(|_| Engine::step(&mut world));
    (world.velocity(0), world.kinetic_energy())
}

fn end_of_rapier(mut rapier: Rapier) -> (DVec3, f64) {
    (0..STEPS).for_each(|_| rapier.step());
    (rapier.velocity(0), rapier.kinetic_energy())
}

/// Ours finds every impact and keeps the energy to 1e-14.
fn assert_right(pair: &Pair, speed: f64, found: Found) {
    let is_right = found.impacts == PHASES && found.energy <= 1e-14;
    assert!(is_right, "{} at {speed}: {}", pair.name, found.cell());
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
    for pair in &pairs() {
        let scene = pair.scene(10.0, 0.37);
        let world = |collision| -> World { ours::world(&scene, collision, "velocity-verlet") };
        let (continuous, discrete) = (world(Collision::Continuous), world(Collision::Bvh));
        let id = |engine: &str| format!("{}/{engine}", pair.name);
        let times = [
            watch::time(&mut group, &id("continuous"), STEPS, || continuous.clone()),
            watch::time(&mut group, &id("discrete"), STEPS, || discrete.clone()),
            watch::time(&mut group, &id("rapier"), STEPS, || Rapier::new(&scene)),
            watch::time(&mut group, &id("rapier, edges fixed"), STEPS, || {
                Rapier::with_internal_edges_fixed(&scene)
            }),
        ];
        let engines: [(&str, Of); 4] = [
            ("continuous", |scene| {
                end_of_ours(scene, Collision::Continuous)
            }),
            ("discrete", |scene| end_of_ours(scene, Collision::Bvh)),
            ("rapier 0.36", |scene| end_of_rapier(Rapier::new(scene))),
            ("rapier, edges fixed", |scene| {
                end_of_rapier(Rapier::with_internal_edges_fixed(scene))
            }),
        ];
        for ((name, of), seconds) in engines.into_iter().zip(times) {
            let Some((seconds, ours)) = seconds.zip(times[0]) else {
                continue;
            };
            let results = SPEEDS.map(|speed| found(pair, speed, of));
            if name == "continuous" {
                for (speed, found) in SPEEDS.into_iter().zip(results) {
                    assert_right(pair, speed, found);
                }
            }
            let cells = results.map(Found::cell);
            let ratio = three_digits(seconds / ours);
            let mut line = vec![pair.name.to_owned(), name.into(), time(seconds), ratio];
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
