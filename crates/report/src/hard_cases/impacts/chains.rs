//! Cases 15, 16, 17: many impacts one after the other.

use std::f64::consts::PI;

use sim_core::{DVec3, World};

use super::{DT, Finding, Tried, ULP, ball, lost, run, settings, wall, world, worst};
use crate::stopwatch;

pub(in super::super) fn galperin() -> Tried {
    let (mut wrong, mut energy): (u64, f64) = (0, 0.0);
    let (mut counts, mut time) = (Vec::new(), 0.0);
    for k in 0..=6 {
        let mut heavy = ball(0.25, 2.0 * DVec3::X, -DVec3::X);
        heavy.mass = 100f64.powi(k);
        let bodies = [
            wall(DVec3::X, DVec3::ZERO, DVec3::ZERO),
            ball(0.25, DVec3::X, DVec3::ZERO),
            heavy,
        ];
        let mut world = world(settings(DT), &bodies)?;
        let start = world.kinetic_energy();
        let (steps, seconds) = stopwatch::timed(|| (0..1200).try_for_each(|_| world.step()));
        steps?;
        time = seconds;
        wrong += world
            .impacts()
            .abs_diff((PI * 10f64.powi(k)).floor() as u64);
        energy = worst([energy, (world.kinetic_energy() / start - 1.0).abs()]);
        counts.push(world.impacts().to_string());
    }
    let why = format!(
        "{} impacts, {wrong} too few or too many; the last run takes {time:.2} s; figure: energy",
        counts.join(", ")
    );
    let figure = if wrong > 0 { f64::INFINITY } else { energy };
    Ok(Finding::within(figure, 3e-13, why))
}

/// A point between a wall and one that comes with 1 m/s from 1 m.
fn closing_walls(dt: f64) -> anyhow::Result<World> {
    let bodies = [
        wall(DVec3::X, DVec3::ZERO, DVec3::ZERO),
        wall(-DVec3::X, DVec3::X, -DVec3::X),
        ball(0.0, DVec3::ZERO, 10.0 * DVec3::X),
    ];
    Ok(world(settings(dt), &bodies)?)
}

pub(in super::super) fn walls() -> Tried {
    let mut world = closing_walls(0.9981 / 50.0)?;
    let impacts = run(&mut world, 50)?;
    let hits = impacts
        .iter()
        .filter(|impact| impact.bodies == (1, 2))
        .count();
    let returns = impacts.iter().filter(|impact| impact.bodies == (0, 2));
    let invariant = |speed: f64, time: f64| ((1.0 - time) * speed / 10.0 - 1.0).abs();
    let error = worst(returns.map(|impact| invariant(impact.speeds.0, impact.time)));
    let mut world = closing_walls(DT)?;
    let (ended, seconds) = stopwatch::timed(|| (0..70).find_map(|_| world.step().err()));
    let end = match ended {
        Some(error) => format!("then, in {seconds:.1} s: {error}"),
        None => return Ok(Finding::failed("walls go through a point without an error")),
    };
    let why = format!("{hits} hits of the moving wall by 0.9981 s; {end}");
    let figure = if hits == 2627 { error } else { f64::INFINITY };
    Ok(Finding::within(figure, 1e-11, why))
}

pub(in super::super) fn cradle() -> Tried {
    let mut figure: f64 = 0.0;
    for gap in [0.0, 1e-12, 1e-3, 0.1] {
        for arriving in [1, 2] {
            let bodies: Vec<_> = (0..5)
                .map(|i| {
                    let (start, v) = if i < arriving {
                        (-2.0, 3.0)
                    } else {
                        (0.0, 0.0)
                    };
                    let x = start + i as f64 * (1.0 + gap);
                    ball(0.5, DVec3::X * x, DVec3::X * v)
                })
                .collect();
            let mut world = world(settings(DT), &bodies)?;
            run(&mut world, 120)?;
            for i in 0..5 {
                let v = if i >= 5 - arriving { 3.0 } else { 0.0 };
                figure = worst([figure, (world.velocity(i) - DVec3::X * v).length()]);
            }
        }
    }
    let mut is_mirrored = true;
    for apart in [0.5, 0.5 + 1e-12, 0.6] {
        let bodies = [
            ball(0.5, DVec3::new(0.0, apart, 0.0), DVec3::ZERO),
            ball(0.5, -3.0 * DVec3::X, 2.0 * DVec3::X),
            ball(0.5, DVec3::new(0.0, -apart, 0.0), DVec3::ZERO),
        ];
        let mut world = world(settings(DT), &bodies)?;
        let start = world.clone();
        run(&mut world, 240)?;
        let mirror = DVec3::new(1.0, -1.0, 1.0);
        is_mirrored &= world.position(0) == world.position(2) * mirror
            && world.velocity(0) == world.velocity(2) * mirror
            && world.velocity(1).y == 0.0
            && world.velocity(0).y != 0.0
            && lost(&world, &start) <= 4.0 * ULP;
    }
    let is = if is_mirrored { "is" } else { "is not" };
    let why = format!(
        "gaps of 0, 1e-12, 1e-3 and 0.1 m, one and two arriving; figure: velocities. A symmetric \
         break {is} its own mirror image to the bit"
    );
    let figure = if is_mirrored { figure } else { f64::INFINITY };
    Ok(Finding::within(figure, 1e-14, why))
}
