//! Worlds of bodies under forces.

use sim_core::{Body, DVec3, Force, Method, Settings, StepError, World, WorldError};

/// Settings of a method and a step; the error of adaptive methods is at rounding level.
pub fn settings(method: &'static Method, dt: f64) -> Settings {
    Settings {
        dt,
        method,
        tolerance: 1e-13,
        ..Settings::default()
    }
}

/// Bodies under forces.
pub fn under(
    settings: Settings,
    bodies: impl IntoIterator<Item = Body>,
    forces: &[Force],
) -> Result<World, WorldError> {
    let mut world = World::new(settings)?;
    for body in bodies {
        world.add(body)?;
    }
    for force in forces {
        world.add_force(force.clone())?;
    }
    Ok(world)
}

/// A spring with a damper from the first body to the origin.
pub fn spring_to_origin(stiffness: f64, damping: f64) -> Force {
    Force::Anchor {
        body: 0,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness,
        damping,
    }
}

/// Makes some steps.
pub fn step(world: &mut World, steps: u64) -> Result<(), StepError> {
    (0..steps).try_for_each(|_| world.step())
}

/// The largest stable `dt` named in an error.
pub fn named_limit(error: &StepError) -> Option<f64> {
    match *error {
        StepError::Unstable { stable_dt, .. } => Some(stable_dt),
        StepError::OutOfRange { stable_dt, .. } => stable_dt,
        _ => None,
    }
}
