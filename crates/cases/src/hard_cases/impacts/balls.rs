//! Cases 18, 19, 27: balls and cubes on floors, under gravity.

use sim_core::{Body, DVec3, Force, Method, Settings, Vec3, World};

use super::{
    DT, Finding, Tried, ball, builtin, cuboid, immovable, mesh, run, settings, wall, world, worst,
};

const G: f64 = 9.81;

fn on_floor(method: &'static Method, body: Body, floor: Body) -> anyhow::Result<World> {
    let settings = Settings {
        method,
        tolerance: 1e-13,
        ..settings(DT)
    };
    let mut world = world(settings, &[floor, body])?;
    world.add_force(Force::Gravity {
        acceleration: -G * DVec3::Y,
    })?;
    Ok(world)
}

fn floor() -> Body {
    wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO)
}

fn dropped(method: &'static Method, restitution: f64) -> anyhow::Result<World> {
    let point = Body {
        restitution,
        ..ball(0.0, DVec3::Y, DVec3::ZERO)
    };
    on_floor(method, point, floor())
}

/// Methods of the first order are not exact in flight.
const NOT_EXACT: &str = "it is not exact in flight";

pub(crate) fn damped(method: &'static Method) -> Tried {
    if method.order < 2 {
        return Ok(Finding::does_not_apply(NOT_EXACT));
    }
    let mut world = dropped(method, 0.8)?;
    let bounces = run(&mut world, 180)?.len();
    let error = (world.position(1).y - 0.06870746096576577).abs();
    let after = run(&mut world, 420)?.len();
    let (height, speed) = (world.position(1).y, world.velocity(1).length());
    let is_at_rest = height.abs() < 1e-9 && speed < 1e-9;
    let why = format!(
        "{bounces} bounces by 3 s and {after} more by 10 s, where it is {height:.1e} m high \
         and moves at {speed:.1e} m/s"
    );
    let is_right = bounces == 6 && is_at_rest;
    let figure = if is_right { error } else { f64::INFINITY };
    Ok(Finding::within(figure, 1e-12, why))
}

pub(crate) fn elastic(method: &'static Method) -> Tried {
    if method.order < 2 {
        return Ok(Finding::does_not_apply(NOT_EXACT));
    }
    let mut world = dropped(method, 1.0)?;
    let bounces = run(&mut world, 6000)?.len();
    let height = world.position(1).y;
    let energy = (world.kinetic_energy() + G * height) / G - 1.0;
    let why = format!("{bounces} bounces; energy is off by {:.1e}", energy.abs());
    let error = (height - 0.7215811544474912).abs();
    let figure = if bounces == 111 { error } else { f64::INFINITY };
    Ok(Finding::within(figure, 1e-11, why))
}

/// Greatest way from where it lay, m, or gain of energy, J, over 1,000 s.
pub(crate) fn resting(method: &'static Method) -> Tried {
    let cube = mesh(&builtin("cube.obj")?, 0.5 * DVec3::Y, DVec3::ZERO);
    let slab = cuboid(Vec3::new(8.0, 0.5, 8.0), -0.5 * Vec3::Y)?;
    let slab = immovable(mesh(&slab.into(), DVec3::ZERO, DVec3::ZERO));
    let (mut moved, mut gained): (f64, f64) = (0.0, 0.0);
    for (floor, seconds) in [(floor(), 1000), (slab, 100)] {
        let mut world = on_floor(method, cube.clone(), floor)?;
        for _ in 0..60 * seconds {
            world.step()?;
            let by = world.position(1) - cube.position;
            moved = worst([moved, by.length()]);
            gained = worst([gained, world.kinetic_energy() + G * by.y]);
        }
    }
    let why = format!(
        "an elastic cube on a half-space for 1,000 s and on a mesh for 100 s; it moves by \
         {moved:.1e} m and gains {gained:.1e} J"
    );
    Ok(Finding::within(worst([moved, gained / G]), 1e-9, why))
}
