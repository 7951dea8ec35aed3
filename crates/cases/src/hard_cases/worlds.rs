//! Worlds of one body, as the cases need them.

use sim_core::{Body, DVec3, Force, Method, Settings, StepError, World, WorldError};

/// A body of 1 kg under some forces.
pub(super) fn of_one(
    method: &'static Method,
    dt: f64,
    body: Body,
    forces: &[Force],
) -> Result<World, WorldError> {
    let settings = Settings {
        dt,
        method,
        tolerance: 1e-13,
        ..Settings::default()
    };
    let mut world = World::new(settings)?;
    world.add(body)?;
    for force in forces {
        world.add_force(force.clone())?;
    }
    Ok(world)
}

/// A spring to the origin with a damper.
pub(super) fn spring(stiffness: f64, damping: f64) -> Force {
    Force::Anchor {
        body: 0,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness,
        damping,
    }
}

pub(super) fn step(world: &mut World, steps: u64) -> Result<(), StepError> {
    (0..steps).try_for_each(|_| world.step())
}

/// The largest stable `dt` that an error names.
pub(super) fn named_limit(error: &StepError) -> Option<f64> {
    match *error {
        StepError::Unstable { stable_dt, .. } => Some(stable_dt),
        StepError::OutOfRange { stable_dt, .. } => stable_dt,
        _ => None,
    }
}
