//! Many bodies in a closed box.

use cases::scenes::{Engine, Form, HALF, Rapier, continuous, crowd};
use criterion::Criterion;
use sim_core::DVec3;

use crate::table::{Table, three_digits, time};
use crate::watch;
use crate::{row, short};

/// Relative error of the energy after some steps, the greatest distance of a body outside the box, and the number of
/// impacts, if known.
struct End {
    energy: f64,
    outside: f64,
    impacts: Option<u64>,
}

impl End {
    fn new(half_box: f64, before: f64, after: f64, positions: impl Iterator<Item = DVec3>) -> End {
        let farthest = positions.map(|p| p.abs().max_element());
        End {
            energy: (after / before - 1.0).abs(),
            outside: farthest.fold(0.0, f64::max) + HALF - half_box,
            impacts: None,
        }
    }
}

/// Numbers of bodies, of timed steps, and of steps after which errors are measured.
const SIZES: [(usize, u32, u32); 3] = [(100, 120, 600), (1_000, 60, 120), (10_000, 10, 30)];

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "Bodies in a box: a frame of 1/60 s; error of the kinetic energy at the end of the run",
        &[
            "bodies",
            "engine",
            "frame",
            "ratio",
            "energy",
            "run",
            "outside, m",
            "impacts",
        ],
    );
    let mut group = criterion.benchmark_group("impacts/crowd");
    for (count, timed, steps) in SIZES {
        // Without `--bench` everything runs once, possibly unoptimised.
        if count > 100 && !watch::is_timed() {
            continue;
        }
        for (name, form) in [("cubes", Form::Cube(HALF)), ("balls", Form::Ball(HALF))] {
            let (scene, half_box) = crowd(count, &form);
            let name = format!("{count} {name}");
            let start = continuous(&scene);
            let ours = watch::time(&mut group, &format!("{name}/ours"), timed, || start.clone());
            let theirs = watch::time(&mut group, &format!("{name}/rapier"), timed, || {
                Rapier::new(&scene)
            });
            let Some(ours) = ours else { continue };
            let walls = 6;
            let mut world = start.clone();
            let before = world.kinetic_energy();
            (0..steps).for_each(|_| watch::step(&mut world));
            let positions = (walls..world.len()).map(|i| world.position(i));
            let end = End::new(half_box, before, world.kinetic_energy(), positions);
            let impacts = world.impacts();
            let tolerance = 4e-15 * (impacts as f64).sqrt();
            assert!(
                end.energy <= tolerance,
                "{name}: energy off by {:e}",
                end.energy
            );
            assert!(end.outside <= 1e-9, "{name}: outside by {} m", end.outside);
            let impacts = Some(impacts);
            let mut ends = vec![("ours", ours, End { impacts, ..end })];
            if let Some(theirs) = theirs {
                let mut rapier = Rapier::new(&scene);
                let before = rapier.kinetic_energy();
                (0..steps).for_each(|_| watch::step(&mut rapier));
                let positions = (walls..scene.items.len()).map(|i| rapier.position(i));
                let end = End::new(half_box, before, rapier.kinetic_energy(), positions);
                ends.push(("rapier 0.36", theirs, end));
            }
            for (engine, seconds, end) in ends {
                let impacts = end.impacts.map_or("-".into(), |n| n.to_string());
                let cells = [
                    &name,
                    engine,
                    &time(seconds),
                    &three_digits(seconds / ours),
                    &short(end.energy),
                    &format!("{:.1} s", f64::from(steps) * scene.dt),
                    &short(end.outside.max(0.0)),
                    &impacts,
                ];
                row(&mut table, &cells);
            }
        }
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}
