//! Cases 18, 19, 27: balls and cubes on floors, under gravity.

use kit::bodies::{ball, immovable, mesh_body, wall};
use kit::meshes::{boxes, cube};
use kit::worlds::{GRAVITY, add_gravity, precise, run, world_of};
use sim_core::{Body, DVec3, Method, Settings, Vec3, World};

use super::{DT, Finding, Tried, worst};

/// A body above a floor, under gravity.
pub fn on_floor(method: &'static Method, dt: f64, body: Body, floor: Body) -> World {
    let settings = Settings {
        method,
        ..precise(dt)
    };
    let mut world = world_of(settings, [floor, body]);
    add_gravity(&mut world, -GRAVITY * DVec3::Y);
    world
}

/// The half-space below y = 0.
pub fn floor() -> Body {
    wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO)
}

/// A point, dropped from 1 m.
pub fn dropped(method: &'static Method, dt: f64, restitution: f64) -> World {
    let point = Body {
        restitution,
        ..ball(0.0, DVec3::Y, DVec3::ZERO)
    };
    on_floor(method, dt, point, floor())
}

/// Time, from 0, of bounce `n` (from 1), and the speed after it.
fn bounce(n: i32, restitution: f64) -> (f64, f64) {
    let fall = (2.0 / GRAVITY).sqrt();
    let flights: f64 = (1..n).map(|i| 2.0 * fall * restitution.powi(i)).sum();
    (fall + flights, GRAVITY * fall * restitution.powi(n))
}

/// The reason why methods of the first order fail.
const NOT_EXACT: &str = "it is not exact in flight";

pub(crate) fn damped(method: &'static Method) -> Tried {
    if method.order < 2 {
        return Ok(Finding::does_not_apply(NOT_EXACT));
    }
    let mut figure: f64 = 0.0;
    let mut words = Vec::new();
    for dt in [DT, 1.0 / 240.0] {
        let mut world = dropped(method, dt, 0.8);
        let bounces = run(&mut world, (3.0 / dt).round() as u64)?;
        let errors = (1..).zip(&bounces).map(|(n, impact)| {
            let (time, speed) = bounce(n, 0.8);
            worst([(impact.time - time).abs(), (impact.speeds.1 - speed).abs()])
        });
        let height = (world.position(1).y - 0.06870746096576577).abs();
        figure = worst([figure, height, worst(errors)]);
        // The infinitely many bounces end at 4.0637 s.
        let after = run(&mut world, (7.0 / dt).round() as u64)?.len();
        let (height, speed) = (world.position(1).y, world.velocity(1).length());
        let is_at_rest = height.abs() < 1e-9 && speed < 1e-9;
        let is_right = bounces.len() == 6 && after < 10_000 && is_at_rest;
        figure = worst([figure, if is_right { 0.0 } else { f64::INFINITY }]);
        words.push(format!(
            "{} bounces by 3 s at dt = {dt:.4}, and {after} more by 10 s, where it is {height:.1e} m \
             high and moves at {speed:.1e} m/s",
            bounces.len()
        ));
    }
    Ok(Finding::within(figure, 1e-12, words.join("; ")))
}

pub(crate) fn elastic(method: &'static Method) -> Tried {
    if method.order < 2 {
        return Ok(Finding::does_not_apply(NOT_EXACT));
    }
    let mut world = dropped(method, DT, 1.0);
    let bounces = run(&mut world, 6000)?.len();
    let height = world.position(1).y;
    // Methods other than those that are exact in free fall round at each step.
    let energy = ((world.kinetic_energy() + GRAVITY * height) / GRAVITY - 1.0).abs();
    let why = format!("{bounces} bounces; energy is off by {energy:.1e}");
    let error = (height - 0.7215811544474912).abs();
    let is_right = bounces == 111 && energy < 1e-13;
    let figure = if is_right { error } else { f64::INFINITY };
    Ok(Finding::within(figure, 1e-11, why))
}

/// The greatest displacement from the initial position, m, or gain of energy, J, over 1,000 s.
pub(crate) fn resting(method: &'static Method) -> Tried {
    let cube = mesh_body(&cube(0.5), 0.5 * DVec3::Y, DVec3::ZERO);
    let slab = boxes(&[[Vec3::new(-8.0, -1.0, -8.0), Vec3::new(8.0, 0.0, 8.0)]]);
    let slab = immovable(mesh_body(&slab, DVec3::ZERO, DVec3::ZERO));
    let (mut moved, mut gained): (f64, f64) = (0.0, 0.0);
    for (floor, seconds) in [(floor(), 1000), (slab, 100)] {
        let mut world = on_floor(method, DT, cube.clone(), floor);
        for _ in 0..60 * seconds {
            world.step()?;
            let by = world.position(1) - cube.position;
            moved = worst([moved, by.length()]);
            gained = worst([gained, world.kinetic_energy() + GRAVITY * by.y]);
        }
    }
    let why = format!(
        "an elastic cube on a half-space for 1,000 s and on a mesh for 100 s; it moves by \
         {moved:.1e} m and gains {gained:.1e} J"
    );
    Ok(Finding::within(worst([moved, gained / GRAVITY]), 1e-9, why))
}
