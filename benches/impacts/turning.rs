//! Turning bodies: time of a step, and error of the energy.

use cases::scenes::{Engine, Form, HALF, Item, Rapier, Scene, continuous, crowd};
use criterion::Criterion;
use kit::meshes::{builtin, cuboid};
use sim_core::{DVec3, Vec3};

use crate::table::{Table, three_digits, time};
use crate::watch;
use crate::{row, short};

struct Case {
    name: &'static str,
    scene: Scene,
    /// The number of timed steps, and of steps after which the energy is compared.
    timed: u32,
    steps: u32,
    /// The largest relative error allowed for our engine; infinite if impacts dissipate energy.
    most: f64,
}

/// One body approaches along a direction with 10 m/s and spins with 5 rad/s; the other one is at rest.
fn hit(forms: [Form; 2], from: f64) -> Scene {
    let way = DVec3::new(1.0, 0.05, 0.1).normalize();
    let [first, second] = forms;
    let still = Item::resting(first, DVec3::ZERO);
    let spin = DVec3::new(3.0, 4.0, 0.0);
    let coming = Item {
        spin,
        ..Item::new(second, -from * way, 10.0 * way)
    };
    turning(Scene::new(vec![still, coming]))
}

fn turning(scene: Scene) -> Scene {
    Scene {
        turns: true,
        ..scene
    }
}

/// Eight cubes in two layers of two by two, which fall into a bin.
fn bin() -> Scene {
    let walls = [DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z, DVec3::Y];
    let mut items: Vec<Item> = walls
        .into_iter()
        .map(|normal| {
            let away = if normal.y > 0.0 { 0.0 } else { 0.8 };
            Item::new(Form::Wall(normal), -away * normal, DVec3::ZERO)
        })
        .collect();
    for k in 0..8_u32 {
        let side = |bit: u32| if k >> bit & 1 == 0 { -0.4 } else { 0.4 };
        let place = DVec3::new(side(0), 0.6 + 0.9 * f64::from(k >> 2), side(1));
        let spin = DVec3::new(0.5 * side(2), 0.7 * side(1), 0.9 * side(0));
        items.push(Item {
            spin,
            ..Item::resting(Form::Cube(0.25), place)
        });
    }
    Scene {
        restitution: 0.2,
        ..turning(Scene::falling(items))
    }
}

/// A cow that falls on her feet, spinning.
fn spinning_cow() -> Scene {
    let floor = Item::new(Form::Wall(DVec3::Y), DVec3::ZERO, DVec3::ZERO);
    let cow = Item {
        spin: DVec3::new(3.0, 4.0, 0.0),
        ..Item::new(Form::Mesh(builtin("cow.obj")), 5.0 * DVec3::Y, DVec3::ZERO)
    };
    Scene {
        restitution: 0.3,
        ..turning(Scene::falling(vec![floor, cow]))
    }
}

fn cases() -> [Case; 6] {
    let cow = || Form::Mesh(builtin("cow.obj"));
    let brick = Item {
        spin: DVec3::new(1.0, 2.0, 3.0),
        ..Item::new(
            Form::Mesh(cuboid(Vec3::new(0.5, 0.25, 1.0))),
            DVec3::ZERO,
            DVec3::X,
        )
    };
    let case = |name, scene, timed, steps, most| Case {
        name,
        scene,
        timed,
        steps,
        most,
    };
    [
        case(
            "a free brick",
            turning(Scene::new(vec![brick])),
            600,
            6_000,
            1e-13,
        ),
        case(
            "cube on cow, 5 rad/s",
            hit([cow(), Form::Cube(0.5)], 5.0),
            60,
            60,
            1e-13,
        ),
        case(
            "cow on cow, 5 rad/s",
            hit([cow(), cow()], 6.0),
            60,
            60,
            1e-13,
        ),
        case(
            "100 cubes in a box",
            turning(crowd(100, &Form::Cube(HALF)).0),
            120,
            600,
            1e-13,
        ),
        case("8 cubes in a bin", bin(), 120, 120, f64::INFINITY),
        case(
            "a cow falls, spinning",
            spinning_cow(),
            600,
            600,
            f64::INFINITY,
        ),
    ]
}

/// Kinetic and potential energy.
fn energy(engine: &dyn Engine, scene: &Scene) -> f64 {
    let heights = scene
        .movable()
        .map(|i| scene.gravity.dot(engine.position(i)));
    engine.kinetic_energy() - heights.sum::<f64>()
}

/// The final error of the energy, and the greatest error of a step, relative to the start.
fn errors(mut engine: impl Engine, case: &Case) -> (f64, f64) {
    let start = energy(&engine, &case.scene);
    let (mut before, mut gained) = (start, 0.0_f64);
    for _ in 0..case.steps {
        watch::step(&mut engine);
        let after = energy(&engine, &case.scene);
        gained = gained.max(after - before);
        before = after;
    }
    ((before - start) / start.abs(), gained / start.abs())
}

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "Bodies that turn: a step of 1/60 s; what the energy is off by at the end, and the most that a step \
         brings, relative",
        &["scene", "engine", "step", "ratio", "energy", "gained"],
    );
    let mut group = criterion.benchmark_group("impacts/turning");
    for case in &cases() {
        let start = continuous(&case.scene);
        let ours = watch::time(
            &mut group,
            &format!("{}/ours", case.name),
            case.timed,
            || start.clone(),
        );
        let theirs = watch::time(
            &mut group,
            &format!("{}/rapier", case.name),
            case.timed,
            || Rapier::new(&case.scene),
        );
        let Some(ours) = ours else { continue };
        let (end, gained) = errors(start, case);
        assert!(
            end.abs() <= case.most,
            "{}: energy off by {end:e}",
            case.name
        );
        let mut rows = vec![("ours", ours, end, gained)];
        if let Some(theirs) = theirs {
            let (end, gained) = errors(Rapier::new(&case.scene), case);
            rows.push(("rapier 0.36", theirs, end, gained));
        }
        for (engine, seconds, end, gained) in rows {
            let cells = [
                case.name,
                engine,
                &time(seconds),
                &three_digits(seconds / ours),
                &short(end),
                &short(gained),
            ];
            row(&mut table, &cells);
        }
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}
