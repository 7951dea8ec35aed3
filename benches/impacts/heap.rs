//! Bodies that fall and form a heap between walls, and one that lies on a mesh.

use std::sync::Arc;

use cases::scenes::{Engine, Form, GRAVITY, HALF, Item, Rapier, Scene, continuous, heap};
use sim_core::{DVec3, Mesh, Vec3};

use crate::overlap::Depths;
use crate::table::{Table, three_digits, time};
use crate::watch;
use crate::{row, short};

/// The two seconds in which bodies fall and pile up, and the two in which they settle.
const MOVING: usize = 120;
const SETTLED: usize = 120;
const WALLS: usize = 5;

/// The time after which no further steps of a run are started, s.
const BUDGET: f64 = 12.0;

fn half_of(form: &Form) -> DVec3 {
    Item::resting(form.clone(), DVec3::ZERO).half()
}

/// A cow of a thousand triangles, as long as two cubes.
fn cow() -> Form {
    let cow = cow::cow(1_000).expect("a cow of this size can be made");
    let vertices = cow.vertices.into_iter().map(|v| 0.4 * Vec3::from(v));
    let mesh = Mesh::new(vertices.collect(), cow.triangles).expect("the cow is a mesh");
    Form::Mesh(Arc::new(mesh))
}

/// The results of a run.
#[derive(Default)]
struct Run {
    /// Mean time of a step while bodies fall and pile up, and after that, s.
    moving: f64,
    settled: f64,
    worst: f64,
    steps: usize,
    /// The greatest rise of the energy in a step, and the initial energy, J.
    rise: f64,
    start: f64,
    /// The greatest depth of overlap of a body with another one or with a wall at the end of a step, m.
    depth: f64,
}

fn run(scene: &Scene, mut engine: impl Engine) -> Run {
    let energy = |engine: &dyn Engine| {
        let heights = scene.movable().map(|i| engine.position(i).y);
        engine.kinetic_energy() + GRAVITY * heights.sum::<f64>()
    };
    let depths = Depths::new(scene, WALLS);
    let mut run = Run {
        start: energy(&engine),
        settled: f64::NAN,
        ..Run::default()
    };
    let mut before = run.start;
    let mut times = Vec::new();
    let mut spent = 0.0;
    while times.len() < MOVING + SETTLED && spent < BUDGET {
        let clock = watch::now();
        watch::step(&mut engine);
        let seconds = watch::now() - clock;
        times.push(seconds);
        spent += seconds;
        run.worst = run.worst.max(seconds);
        let after = energy(&engine);
        run.rise = run.rise.max(after - before);
        before = after;
        run.depth = run.depth.max(depths.deepest(|i| engine.position(i)));
    }
    run.steps = times.len();
    let mean = |times: &[f64]| times.iter().sum::<f64>() / times.len() as f64;
    run.moving = mean(&times[..MOVING.min(times.len())]);
    if times.len() == MOVING + SETTLED {
        run.settled = mean(&times[MOVING..]);
    }
    run
}

/// Returns the tables, and the errors of our engine.
pub(crate) fn bench() -> (Vec<Table>, Vec<String>) {
    // As a test it would take a second, unoptimised a minute.
    if !watch::is_timed() || !watch::is_asked("impacts/heap") {
        return Default::default();
    }
    let mut wrong = Vec::new();
    let tables = vec![heaps(&mut wrong), on_a_mesh()];
    (tables, wrong)
}

fn heaps(wrong: &mut Vec<String>) -> Table {
    let mut table = Table::new(
        "Heaps: a step in the 2 s in which bodies of 1 kg fall and come together, and in the 2 s after that",
        &[
            "bodies",
            "restitution",
            "friction",
            "engine",
            "falling",
            "ratio",
            "of a body",
            "after that",
            "longest",
            "energy at the start, J",
            "rises by, J",
            "overlap, m",
            "simulated",
        ],
    );
    let (ball, cube, cow) = (Form::Ball(HALF), Form::Cube(HALF), cow());
    for (name, form, count, side, restitution, friction) in [
        ("balls", &ball, 30, 3, 0.0, 0.0),
        ("balls", &ball, 30, 3, 0.3, 0.0),
        ("balls", &ball, 30, 3, 0.7, 0.0),
        ("balls", &ball, 30, 3, 0.0, 0.3),
        ("balls", &ball, 30, 3, 0.3, 0.3),
        ("balls", &ball, 100, 4, 0.0, 0.0),
        ("balls", &ball, 100, 4, 0.0, 0.3),
        ("balls", &ball, 100, 4, 0.3, 0.3),
        ("cubes", &cube, 100, 4, 0.0, 0.0),
        ("cubes", &cube, 100, 4, 0.3, 0.3),
        ("cows", &cow, 100, 4, 0.0, 0.0),
        ("cows", &cow, 100, 4, 0.3, 0.3),
        ("balls", &ball, 1_000, 10, 0.3, 0.3),
        ("cubes", &cube, 1_000, 10, 0.3, 0.3),
    ] {
        let name = format!("{count} {name}");
        let scene = heap(form, count, side, restitution, friction);
        let ours = run(&scene, continuous(&scene));
        let what = format!("{name}, restitution {restitution}, friction {friction}");
        if ours.rise > 1e-12 * ours.start {
            wrong.push(format!("{what}: energy up by {:e} J", ours.rise));
        }
        if ours.depth > 1e-15 {
            wrong.push(format!("{what}: {:e} m in each other", ours.depth));
        }
        let theirs = run(&scene, Rapier::with_internal_edges_fixed(&scene));
        let first = ours.moving;
        for (engine, run) in [("ours", ours), ("rapier 0.36", theirs)] {
            let cells = [
                &name,
                &restitution.to_string(),
                &friction.to_string(),
                engine,
                &time(run.moving),
                &three_digits(run.moving / first),
                &time(run.moving / count as f64),
                &time(run.settled),
                &time(run.worst),
                &format!("{:.0}", run.start),
                &short(run.rise.max(0.0)),
                &short(run.depth.max(0.0)),
                &format!("{:.1} s", run.steps as f64 * scene.dt),
            ];
            row(&mut table, &cells);
        }
    }
    table
}

/// A square floor of so many by so many squares of two triangles each, 20 m wide, level or hilly.
fn floor(squares: u32, height: f32) -> Arc<Mesh> {
    let place = |i: u32, j: u32| {
        let at = |k: u32| (k as f32 / squares as f32 - 0.5) * 20.0;
        let hills = (1.3 * at(i)).sin() * (1.1 * at(j)).cos();
        Vec3::new(at(i), height * hills, at(j))
    };
    let side = squares + 1;
    let vertices = (0..side * side).map(|k| place(k / side, k % side));
    let triangles = (0..squares * squares).flat_map(|k| {
        let corner = k / squares * side + k % squares;
        let [a, b, c, d] = [corner, corner + 1, corner + side + 1, corner + side];
        [[a, b, c], [a, c, d]]
    });
    Arc::new(Mesh::new(vertices.collect(), triangles.collect()).expect("a floor"))
}

/// The number of steps until the body lies, and that of timed steps.
const LANDING: usize = 120;
const LYING: usize = 300;

fn on_a_mesh() -> Table {
    let mut table = Table::new(
        "One body on a mesh of 20,000 triangles: a step",
        &["what", "ours", "rapier 0.36", "ratio"],
    );
    let (level, hilly) = (floor(100, 0.0), floor(100, 0.3));
    for (name, mesh, form, velocity, friction) in [
        ("a cube at rest", &level, Form::Cube(HALF), 0.0, 0.8),
        ("a ball at rest", &level, Form::Ball(HALF), 0.0, 0.8),
        ("a cow at rest", &level, cow(), 0.0, 0.8),
        (
            "a cube at rest on hills",
            &hilly,
            Form::Cube(HALF),
            0.0,
            2.0,
        ),
        (
            "a ball at rest on hills",
            &hilly,
            Form::Ball(HALF),
            0.0,
            2.0,
        ),
        ("a cube that slides", &level, Form::Cube(HALF), 1.0, 0.0),
        ("a ball that slides", &level, Form::Ball(HALF), 1.0, 0.0),
    ] {
        let above = half_of(&form).y + 0.31;
        let body = Item {
            velocity: velocity * DVec3::new(0.8, 0.0, 0.6),
            ..Item::resting(form, DVec3::new(0.13, above, 0.07))
        };
        let ground = Item::resting(Form::Ground(mesh.clone()), DVec3::ZERO);
        let scene = Scene {
            restitution: 0.0,
            friction,
            may_sleep: true,
            ..Scene::falling(vec![ground, body])
        };
        let ours = lying(continuous(&scene));
        let theirs = lying(Rapier::with_internal_edges_fixed(&scene));
        let cells = [
            name,
            &time(ours),
            &time(theirs),
            &three_digits(theirs / ours),
        ];
        row(&mut table, &cells);
    }
    table
}

/// Mean time of a step after landing, s.
fn lying(mut engine: impl Engine) -> f64 {
    (0..LANDING).for_each(|_| watch::step(&mut engine));
    let clock = watch::now();
    (0..LYING).for_each(|_| watch::step(&mut engine));
    (watch::now() - clock) / LYING as f64
}
