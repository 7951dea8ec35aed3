//! Bodies stacked without gaps, with sizes that are no sums of powers of two: none moves.

use kit::bodies::{body, immovable, wall};
use kit::random::Random;
use kit::worlds::{GRAVITY, add_gravity};
use sim_core::{Body, DVec3, Shape, Vec3};

use crate::scenes::{energy, judge, step, world};
use crate::shapes::{cube, sheet};

fn case(random: &mut Random) -> Option<Result<(), String>> {
    let half = 0.05 * random.whole(1, 24) as f64;
    let count = random.whole(2, 10);
    let shape = match random.below(3) {
        0 => Shape::Sphere { radius: half },
        _ => cube(half as f32),
    };
    // A decimal number, or the f32 of its vertices.
    let side = match random.one_in(2) {
        true => 2.0 * half,
        false => 2.0 * f64::from(half as f32),
    };
    let floor = match random.one_in(2) {
        true => wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO),
        false => {
            let wide = 8.0 * half as f32;
            let floor = sheet(Vec3::new(wide, 0.0, wide), Vec3::new(-wide, 0.0, wide));
            immovable(body(&floor, DVec3::ZERO, DVec3::ZERO))
        }
    };
    let restitution = random.pick(&[0.0, 0.3, 1.0]);
    let places: Vec<DVec3> = (0..count)
        .map(|i| DVec3::Y * (side * (0.5 + i as f64)))
        .collect();
    let stacked = places.iter().map(|&at| body(&shape, at, DVec3::ZERO));
    let bodies = [floor].into_iter().chain(stacked);
    let bodies = bodies.map(|body| Body {
        restitution,
        ..body
    });
    let mut world = world(1.0 / 60.0, bodies.collect());
    add_gravity(&mut world, DVec3::Y * -GRAVITY);
    let verdict = (|| {
        let mut before = f64::INFINITY;
        for _ in 0..20 {
            step(&mut world)?;
            let now = energy(&world, GRAVITY);
            if now > before + 1e-12 * now.abs() {
                return Err(format!("energy grows by {:e}", now - before));
            }
            before = now;
        }
        if !world.overlapping().is_empty() {
            return Err(format!("{:?} are taken to overlap", world.overlapping()));
        }
        for (i, at) in places.iter().enumerate() {
            let off = (world.position(i + 1) - *at).length();
            // Without gaps up to the rounding of the vertices.
            if off > 1e-6 * half * count as f64 {
                return Err(format!("body {i} is {off:e} m off"));
            }
        }
        Ok(())
    })();
    let is_ball = matches!(shape, Shape::Sphere { .. });
    let scene = || format!("{count} of half {half}, side {side}, balls {is_ball}, e {restitution}");
    Some(verdict.map_err(|what| format!("{what}: {}", scene())))
}

#[test]
fn flush_stacks_stand() {
    judge(150, case);
}
