//! A heavy block drives a light one against a wall: floor(π 10^k) impacts. Engines that step have
//! nothing to say here.

use criterion::Criterion;
use sim_core::{Body, BodyKind, DVec3, Settings, Shape, World};

use crate::table::{Table, time};
use crate::watch::{self, Engine};
use crate::{row, short};

const STEPS: u32 = 1200;

fn world(k: i32) -> World {
    let mut world = World::new(Settings::default()).expect("settings");
    let ball = |mass, x, v| Body {
        shape: Some(Shape::Sphere { radius: 0.25 }),
        position: DVec3::X * x,
        velocity: DVec3::X * v,
        mass,
        ..Body::default()
    };
    let wall = Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::X }),
        kind: BodyKind::Static,
        ..Body::default()
    };
    for body in [wall, ball(1.0, 1.0, 0.0), ball(100f64.powi(k), 2.0, -1.0)] {
        world.add(body).expect("a body");
    }
    world
}

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "Galperin's blocks: 20 s in 1,200 steps",
        &["mass ratio", "impacts", "run", "an impact", "energy"],
    );
    let mut group = criterion.benchmark_group("impacts/galperin");
    for k in 0..=5 {
        let start = world(k);
        let step = watch::time(&mut group, &format!("100^{k}"), STEPS, || start.clone());
        let Some(step) = step else { continue };
        let mut world = start;
        let before = world.kinetic_energy();
        (0..STEPS).for_each(|_| Engine::step(&mut world));
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
