//! Forces at points of turning bodies: time of a step, and error of a known final state.

use cases::problems::Effort;
use cases::turning::levers::LEVERS;
use criterion::Criterion;
use sim_core::{Method, Settings, World};

use crate::table::{Table, three_digits, time};
use crate::watch;
use crate::{row, short};

/// Methods, with the largest error allowed at 60 Hz, m.
const METHODS: [(&str, f64); 4] = [
    ("velocity-verlet", 2e-2),
    ("symplectic-4", 1e-5),
    ("rk4", 2e-3),
    ("radau5", 5e-5),
];

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "Forces at points of bodies that turn: a step of about 1/60 s, and the error of a point at the end",
        &["body", "engine", "step", "ratio", "error, m"],
    );
    let mut group = criterion.benchmark_group("impacts/levers");
    for lever in &LEVERS {
        let steps = (60.0 * lever.time()).round() as u32;
        let dt = lever.time() / f64::from(steps);
        let mut rows = Vec::new();
        for (name, most) in METHODS {
            let method = Method::named(name).expect("a method");
            let settings = Settings {
                dt,
                method,
                ..Settings::default()
            };
            let start = lever.world(settings).expect("a world");
            let id = format!("{}/{name}", lever.name);
            let step = |world: &mut World| world.step().expect("a step");
            let taken = watch::time_by(&mut group, &id, steps, || start.clone(), step);
            let Some(taken) = taken else { continue };
            let end = lever.after(method, Effort::Steps(u64::from(steps)));
            let error = (end.expect("an end") - lever.exact()).length();
            assert!(error <= most, "{}, {name}: off by {error:e} m", lever.name);
            rows.push((name, taken, error));
        }
        let id = format!("{}/rapier", lever.name);
        let step = |tied: &mut cases::turning::levers::TiedInRapier| tied.step();
        let theirs = watch::time_by(&mut group, &id, steps, || lever.rapier(dt), step);
        if let Some(theirs) = theirs {
            let end = lever.after_by_rapier(u64::from(steps));
            rows.push(("rapier 0.36", theirs, (end - lever.exact()).length()));
        }
        let first = rows.first().map_or(f64::NAN, |row| row.1);
        for (engine, seconds, error) in rows {
            let cells = [
                lever.title,
                engine,
                &time(seconds),
                &three_digits(seconds / first),
                &short(error),
            ];
            row(&mut table, &cells);
        }
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}
