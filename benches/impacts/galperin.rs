//! A heavy block drives a light one against a wall: floor(π 10^k) impacts. Engines with fixed steps cannot be compared
//! here.

use cases::hard_cases::chains::galperin;
use criterion::Criterion;

use crate::table::{Table, time};
use crate::watch;
use crate::{row, short};

const STEPS: u32 = 1200;

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "Galperin's blocks: 20 s in 1,200 steps",
        &["mass ratio", "impacts", "run", "an impact", "energy"],
    );
    let mut group = criterion.benchmark_group("impacts/galperin");
    for k in 0..=5 {
        let start = galperin(k, 0.25);
        let step = watch::time(&mut group, &format!("100^{k}"), STEPS, || start.clone());
        let Some(step) = step else { continue };
        let mut world = start;
        let before = world.kinetic_energy();
        (0..STEPS).for_each(|_| watch::step(&mut world));
        let exact = (std::f64::consts::PI * 10f64.powi(k)).floor() as u64;
        assert_eq!(world.impacts(), exact, "mass ratio 100^{k}");
        let error = (world.kinetic_energy() / before - 1.0).abs();
        assert!(error <= 3e-13, "energy off by {error:e}");
        let run = step * f64::from(STEPS);
        let cells = [
            &format!("100^{k}"),
            &exact.to_string(),
            &time(run),
            &time(run / exact as f64),
            &short(error),
        ];
        row(&mut table, &cells.map(String::as_str));
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}
