//! Cases 15, 16, 17: many impacts in succession.

use std::f64::consts::PI;

use kit::bodies::{ball, wall};
use kit::worlds::{precise, run, world_of};
use sim_core::{Body, DVec3, World};

use super::{DT, Finding, Tried, ULP, lost, motions, worst};

/// A wall, a block at rest, and an approaching block of 100^k times its mass; `radius` in m.
pub fn galperin(k: i32, radius: f64) -> World {
    let heavy = Body {
        mass: 100f64.powi(k),
        ..ball(radius, 2.0 * DVec3::X, -DVec3::X)
    };
    let light = ball(radius, DVec3::X, DVec3::ZERO);
    let wall = wall(DVec3::X, DVec3::ZERO, DVec3::ZERO);
    world_of(precise(DT), [wall, light, heavy])
}

/// Steps until the blocks have separated for good, and checks the number of impacts and the energy after that.
pub(crate) fn digits_of_pi() -> Tried {
    let (mut wrong, mut energy): (u64, f64) = (0, 0.0);
    let mut counts = Vec::new();
    let most = if cfg!(debug_assertions) { 5 } else { 6 };
    for (k, radius) in (0..=most)
        .map(|k| (k, 0.25))
        .chain((0..5).map(|k| (k, 0.0)))
    {
        let mut world = galperin(k, radius);
        let start = world.kinetic_energy();
        (0..1200).try_for_each(|_| world.step())?;
        let (light, heavy) = (world.velocity(1).x, world.velocity(2).x);
        let have_parted = 0.0 <= light && light <= heavy;
        let exact = (PI * 10f64.powi(k)).floor() as u64;
        wrong += world.impacts().abs_diff(exact) + u64::from(!have_parted);
        energy = worst([energy, (world.kinetic_energy() / start - 1.0).abs()]);
        counts.push(world.impacts().to_string());
    }
    let why = format!(
        "{} impacts of blocks and of points, {wrong} too few or too many; figure: energy",
        counts.join(", ")
    );
    let figure = if wrong > 0 { f64::INFINITY } else { energy };
    Ok(Finding::within(figure, 3e-13, why))
}

/// A point between a wall at rest and one that approaches with 1 m/s from 1 m.
///
/// The wall's position is 1 - t. Hit n occurs when 1 - t = 10 / (2n + 9) and changes the speed to v = 10 + 2n. The
/// point is back at the fixed wall when 1 - t = 10 / v.
pub fn closing_walls(dt: f64) -> World {
    let bodies = [
        wall(DVec3::X, DVec3::ZERO, DVec3::ZERO),
        wall(-DVec3::X, DVec3::X, -DVec3::X),
        ball(0.0, DVec3::ZERO, 10.0 * DVec3::X),
    ];
    world_of(precise(dt), bodies)
}

pub(crate) fn walls() -> Tried {
    let mut world = closing_walls(0.9981 / 50.0);
    let impacts = run(&mut world, 50)?;
    let moving = impacts.iter().filter(|impact| impact.bodies == (1, 2));
    let hits = moving.clone().count();
    let invariant = |speed: f64, time: f64| ((1.0 - time) * speed / 10.0 - 1.0).abs();
    let in_time = impacts
        .iter()
        .map(|impact| invariant(impact.speeds.0, impact.time));
    let speeds = (1..).zip(moving).map(|(n, impact)| {
        let v = 2.0 * f64::from(n) + 9.0;
        (impact.speeds.0 / v - 1.0).abs()
    });
    let error = worst(in_time.chain(speeds));
    // Infinitely many hits occur before t = 1: the step must fail and not hang.
    let mut world = closing_walls(DT);
    let end = match (0..70).find_map(|_| world.step().err()) {
        Some(error) => format!("then: {error}"),
        None => return Ok(Finding::failed("walls go through a point without an error")),
    };
    let is_between = (0.0..=1.0).contains(&world.position(2).x);
    let why = format!("{hits} hits of the moving wall by 0.9981 s; {end}");
    let is_right = hits == 2627 && is_between;
    let figure = if is_right { error } else { f64::INFINITY };
    Ok(Finding::within(figure, 1e-11, why))
}

/// Balls of radius 1/2 m in a row on the x axis; the first `arriving` move with 3 m/s.
pub fn cradle(gap: f64, arriving: usize) -> World {
    let balls = (0..5).map(|i| {
        let (start, speed) = if i < arriving {
            (-2.0, 3.0)
        } else {
            (0.0, 0.0)
        };
        let x = start + i as f64 * (1.0 + gap);
        ball(0.5, x * DVec3::X, speed * DVec3::X)
    });
    world_of(precise(DT), balls)
}

/// As many balls leave as arrive, and a symmetric break stays symmetric.
pub(crate) fn newton() -> Tried {
    let mut figure: f64 = 0.0;
    for gap in [0.0, 1e-12, 1e-3, 0.1] {
        for arriving in [1, 2] {
            let mut world = cradle(gap, arriving);
            let start = world.clone();
            run(&mut world, 120)?;
            for i in 0..5 {
                let v = if i >= 5 - arriving { 3.0 } else { 0.0 };
                figure = worst([figure, (world.velocity(i) - DVec3::X * v).length()]);
            }
            figure = worst([figure, lost(&world, &start)]);
        }
    }
    let broken = broken_mirrors()?;
    let why = format!(
        "gaps of 0, 1e-12, 1e-3 and 0.1 m, one and two arriving; figure: velocities, energy and \
         momentum. Of 16 symmetric breaks {broken} are not their own mirror images to the bit"
    );
    let figure = if broken > 0 { f64::INFINITY } else { figure };
    Ok(Finding::within(figure, 1e-14, why))
}

/// One ball hits two that lie side by side. Returns the number of final states, over orders of the bodies, that are not
/// symmetric or have lost energy.
fn broken_mirrors() -> anyhow::Result<u32> {
    let mut broken = 0;
    for (apart, radius) in [(0.5, 0.5), (0.5 + 1e-12, 0.5), (0.6, 0.5), (0.9, 0.625)] {
        for order in [[0, 1, 2], [1, 0, 2], [2, 1, 0], [1, 2, 0]] {
            let balls = [
                ball(radius, -3.0 * DVec3::X, 2.0 * DVec3::X),
                ball(radius, apart * DVec3::Y, DVec3::ZERO),
                ball(radius, -apart * DVec3::Y, DVec3::ZERO),
            ];
            let mut world = world_of(precise(DT), order.map(|i| balls[i].clone()));
            let start = world.clone();
            run(&mut world, 240)?;
            let motions = motions(&world);
            let place = |ball| order.iter().position(|&o| o == ball).unwrap_or(0);
            let [cue, up, down] = [0, 1, 2].map(|ball| motions[place(ball)]);
            let mirror = DVec3::new(1.0, -1.0, 1.0);
            let mirrored = |(x, v): (DVec3, DVec3)| (x * mirror, v * mirror);
            let is_right = up == mirrored(down)
                && cue == mirrored(cue)
                && up.1.y > 0.1
                && lost(&world, &start) <= 4.0 * ULP;
            broken += u32::from(!is_right);
        }
    }
    Ok(broken)
}
