//! Two bodies touch and move together, and a third hits one of them: the impulse passes through.

use kit::bodies::body;
use kit::random::Random;
use sim_core::{DVec3, Shape};

use crate::scenes::{judge, step, world};
use crate::shapes::cube;

/// Three equal bodies in a row: the first hits the second, which touches the third. The first gets the velocity of the
/// others, and the third gets that of the first.
fn case(random: &mut Random) -> Option<Result<(), String>> {
    let axis = random.pick(&DVec3::AXES);
    let along = random.pick(&[axis, -axis]);
    // Out of line, by less than an edge length.
    let aside = |random: &mut Random| match random.below(3) {
        0 => DVec3::ZERO,
        1 => random.pick(&[0.25, -0.3, 0.5]) * DVec3::new(along.z, along.x, along.y),
        _ => 0.45 * random.vector().reject_from(along),
    };
    let is_ball = random.one_in(4);
    let shape = match is_ball {
        true => Shape::Sphere { radius: 0.5 },
        false => cube(0.5),
    };
    let mut shift = || if is_ball { DVec3::ZERO } else { aside(random) };
    let shifts = [shift(), DVec3::ZERO, shift()];
    let gap = random.pick(&[0.0, 2.3e-16, 4.6e-16, 1e-15, 1e-14]) * random.from(0.5, 2.0);
    let middle = 0.1 * random.whole(-40, 40) as f64;
    let way = 0.01 * random.whole(1, 9) as f64;
    let (common, speed) = (random.whole(-3, 3) as f64, random.whole(1, 4) as f64);
    let dt = random.pick(&[0.1, 1.0 / 16.0, 1.0 / 60.0]);
    let places = [middle - 1.0 - way, middle, middle + 1.0 + gap];
    let speeds = [common + speed, common, common];
    let bodies = (0..3).map(|i| body(&shape, places[i] * along + shifts[i], speeds[i] * along));
    let mut world = world(dt, bodies.collect());
    if !world.overlapping().is_empty() {
        return None;
    }
    let hit = way / speed;
    let kept = world.kinetic_energy();
    let verdict = (|| {
        for _ in 0..(hit / dt) as u64 + 2 {
            step(&mut world)?;
        }
        let time = world.time();
        let end = [
            places[0] + way + common * time,
            places[1] + common * time,
            places[2] + common * time + speed * (time - hit),
        ];
        let left = [common, common, common + speed];
        for i in 0..3 {
            let off = (world.position(i) - shifts[i] - end[i] * along).length();
            let wrong = (world.velocity(i) - left[i] * along).length();
            if off > 1e-10 || wrong > 1e-10 {
                return Err(format!("body {i} is {off:e} m and {wrong:e} m/s off"));
            }
        }
        let change = (world.kinetic_energy() / kept - 1.0).abs();
        match change <= 1e-12 {
            true => Ok(()),
            false => Err(format!("energy off by {change:e}")),
        }
    })();
    let scene =
        || format!("places {places:?} shifts {shifts:?} speeds {speeds:?} along {along} dt {dt}");
    Some(verdict.map_err(|what| format!("{what}: {}", scene())))
}

#[test]
fn blows_go_through_rows_in_touch() {
    judge(400, case);
}
