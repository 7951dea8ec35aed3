//! Case 4: a stable method finds the position of rest, an unstable one reports an error.

use sim_core::{Body, DVec3, Force, Method, StepError, World, WorldError};

use super::{Finding, Tried};
use crate::problems::stiff_spring::{C, G, K};
use crate::worlds;

/// The position of rest, m.
const REST: f64 = -G / K;

pub(super) fn test(method: &'static Method) -> Tried {
    // The limits were derived by hand if possible: from |1 + z λ| ≤ 1 and similar conditions.
    let limit = match method.name {
        "forward-euler" => 1e-3,
        "symplectic-euler" => (5f64.sqrt() - 1.0) * 1e-3,
        "rk4" => 2.622_542e-3,
        _ => method.stable_dt(K, C),
    };
    match limit.is_finite() {
        true => limited(method, limit),
        false => unlimited(method),
    }
}

/// The spring at its start, in a world.
pub fn world(method: &'static Method, dt: f64) -> Result<World, WorldError> {
    let body = Body {
        position: DVec3::X,
        ..Body::default()
    };
    let weight = Force::Gravity {
        acceleration: -G * DVec3::X,
    };
    worlds::under(
        worlds::settings(method, dt),
        [body],
        &[worlds::spring_to_origin(K, C), weight],
    )
}

/// A method that is stable at every step, at 60 Hz for 10 s.
fn unlimited(method: &'static Method) -> Tried {
    let mut world = world(method, 1.0 / 60.0)?;
    worlds::step(&mut world, 600)?;
    let error = (world.position(0).x / REST - 1.0).abs();
    if method.adaptive {
        let why = "its tolerance of 1e-13 m is 1e-8 of the place of rest";
        return Ok(Finding::within(error, 1e-7, why));
    }
    let why = match error {
        e if e < 1e-12 => "at rest at 60 Hz".into(),
        e => format!(
            "bounded, but damps stiff motion slowly: {:.1e} m off after 600 steps",
            e * REST.abs()
        ),
    };
    Ok(Finding::within(error, 1e-12, why))
}

/// The number of steps within which a growth of one per cent per step must be detected.
const MOST_STEPS: u64 = 50_000;

/// A method with a stability limit, on both sides of it.
fn limited(method: &'static Method, limit: f64) -> Tried {
    let mut below = world(method, 0.99 * limit)?;
    if let Err(error) = worlds::step(&mut below, 20_000) {
        anyhow::bail!("at 0.99 of its limit {limit:.4e} s: {error}");
    }
    if below.position(0).x.abs() > 1.0 {
        anyhow::bail!("grows at 0.99 of its limit {limit:.4e} s");
    }
    let Some((factor, step, error)) = reported(method, limit)? else {
        anyhow::bail!("beyond its limit {limit:.4e} s nothing is reported in {MOST_STEPS} steps");
    };
    match worlds::named_limit(&error) {
        Some(named) => Ok(Finding::within(
            (named / limit - 1.0).abs(),
            1e-3,
            format!("stable up to {limit:.4e} s; at {factor} times that step {step} says so"),
        )),
        None => Err(anyhow::anyhow!("reported without its limit: {error}")),
    }
}

/// Above the limit: the error, its step, and how far above. Methods with many stages are stable again above a narrow
/// unstable window, which may end before one per cent.
fn reported(
    method: &'static Method,
    limit: f64,
) -> Result<Option<(f64, u64, StepError)>, WorldError> {
    for factor in [1.01, 1.003] {
        let mut world = world(method, factor * limit)?;
        if let Err(error) = worlds::step(&mut world, MOST_STEPS) {
            return Ok(Some((factor, world.steps() + 1, error)));
        }
    }
    Ok(None)
}
