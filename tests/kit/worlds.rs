//! Worlds of bodies.

use std::borrow::Borrow;

use sim_core::{Body, Collision, DVec3, Force, Impact, Settings, Shape, StepError, World};

use crate::bodies::at;

/// The acceleration of gravity, m/s².
pub const GRAVITY: f64 = 9.81;

/// A world of bodies.
pub fn world_of(settings: Settings, bodies: impl IntoIterator<Item = impl Borrow<Body>>) -> World {
    let mut world = World::new(settings).expect("settings");
    for body in bodies {
        world.add(body.borrow().clone()).expect("a body");
    }
    world
}

/// Settings for impacts that are exact to rounding: the continuous mode and velocity Verlet, which is exact in free
/// flight. The tolerance is for methods with error control.
pub fn precise(dt: f64) -> Settings {
    Settings {
        dt,
        collision: Collision::Continuous,
        tolerance: 1e-13,
        ..Settings::default()
    }
}

/// A world of bodies with the usual settings.
pub fn world(bodies: impl IntoIterator<Item = impl Borrow<Body>>) -> World {
    world_of(Settings::default(), bodies)
}

/// Makes all bodies fall.
pub fn add_gravity(world: &mut World, acceleration: DVec3) {
    world
        .add_force(Force::Gravity { acceleration })
        .expect("gravity");
}

/// Sets the number of steps per second.
pub fn set_rate(world: &mut World, rate: f64) {
    let settings = Settings {
        dt: 1.0 / rate,
        ..*world.settings()
    };
    world.set_settings(settings).expect("settings");
}

/// Makes some steps.
pub fn step(world: &mut World, steps: u64) {
    for _ in 0..steps {
        world.step().expect("a step");
    }
}

/// Makes some steps, and returns their impacts.
pub fn run(world: &mut World, steps: u64) -> Result<Vec<Impact>, StepError> {
    let mut impacts = Vec::new();
    for _ in 0..steps {
        world.step_reporting(&mut impacts)?;
    }
    Ok(impacts)
}

/// The pairs of shapes that meet at the present positions, determined by a new world.
pub fn meeting(world: &World, settings: Settings) -> Vec<(usize, usize)> {
    let bodies = (0..world.len()).map(|i| Body {
        shape: world.shape(i).cloned(),
        position: world.position(i),
        kind: world.kind(i),
        ..Body::default()
    });
    world_of(settings, bodies).overlapping().to_vec()
}

/// Whether two shapes meet; the second one is at an offset from the first.
pub fn meet(first: &Shape, second: &Shape, offset: DVec3) -> bool {
    let pair = world([at(first, DVec3::ZERO), at(second, offset)]);
    !pair.overlapping().is_empty()
}
