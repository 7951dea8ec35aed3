//! Worlds for these tests.

use cases::worlds::{settings, under};
use sim_core::{Body, DVec3, Force, Method, StepError, World};

pub(crate) fn method(name: &str) -> &'static Method {
    Method::named(name).expect("a method")
}

pub(crate) fn world(method: &'static Method, dt: f64, bodies: &[Body], forces: &[Force]) -> World {
    under(settings(method, dt), bodies.iter().cloned(), forces).expect("a world")
}

pub(crate) fn point(position: DVec3, velocity: DVec3) -> Body {
    Body {
        position,
        velocity,
        ..Body::default()
    }
}

/// Steps until one fails.
pub(crate) fn failure(world: &mut World, steps: u64) -> Option<StepError> {
    (0..steps).find_map(|_| world.step().err())
}
