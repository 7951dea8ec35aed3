//! Case 3: over a thousand periods, an oscillator keeps the amplitude that theory predicts for its method.
//!
//! One step is a matrix `M = (a b; c d)`. With complex eigenvalues it multiplies the quadratic form
//! `c x² + (d - a) x v - b v²` by its determinant, which theory gives.

use std::f64::consts::PI;

use sim_core::{Body, DVec3, Method, World, WorldError};

use super::{Finding, Tried};
use crate::worlds;

pub(super) fn test(method: &'static Method) -> Tried {
    // At 60 Hz RK4 and similar methods lose too little to test their formulas.
    let dt = match method.name {
        "forward-euler" | "backward-euler" | "symplectic-euler" => 1.0 / 60.0,
        _ => 0.2,
    };
    let steps = (2000.0 * PI / dt).round();
    if method.adaptive {
        let mut world = world(method, dt, DVec3::X, DVec3::ZERO)?;
        worlds::step(&mut world, steps as u64)?;
        let (x, v, t) = (world.position(0).x, world.velocity(0).x, world.time());
        let error = (x - t.cos()).abs().max((v + t.sin()).abs());
        let why = "no discrete solution of its own: measured against the exact one";
        return Ok(Finding::within(error, 1e-8, why));
    }
    let column = |x: f64, v: f64| -> anyhow::Result<[f64; 2]> {
        let mut world = world(method, dt, x * DVec3::X, v * DVec3::X)?;
        world.step()?;
        Ok([world.position(0).x, world.velocity(0).x])
    };
    let ([a, c], [b, d]) = (column(1.0, 0.0)?, column(0.0, 1.0)?);
    let form = |x: f64, v: f64| c * x * x + (d - a) * x * v - b * v * v;
    // The logarithm of the determinant.
    let (log_determinant, formula) = match method.name {
        "forward-euler" => ((dt * dt).ln_1p(), "√(1 + dt²) a step"),
        "backward-euler" => (-(dt * dt).ln_1p(), "1/√(1 + dt²) a step"),
        "rk4" => (
            (-dt.powi(6) / 72.0 + dt.powi(8) / 576.0).ln_1p(),
            "√(1 - dt⁶/72 + dt⁸/576) a step",
        ),
        _ if method.symplectic => (0.0, "kept, without drift"),
        _ => ((a * d - b * c - 1.0).ln_1p(), "that of its own first step"),
    };
    let mut world = world(method, dt, DVec3::X, DVec3::ZERO)?;
    worlds::step(&mut world, steps as u64)?;
    let (x, v) = (world.position(0).x, world.velocity(0).x);
    let amplitude = (form(x, v) / form(1.0, 0.0)).abs().sqrt();
    let exact = (0.5 * steps * log_determinant).exp();
    let tolerance = match method.symplectic {
        true => 1e-13,
        false => 1e-10,
    };
    let why = format!("amplitude {amplitude:.5e} at dt = {dt:.4}: {formula}");
    Ok(Finding::within(
        (amplitude / exact - 1.0).abs(),
        tolerance,
        why,
    ))
}

/// A body of 1 kg on a spring of 1 N/m, in a world.
pub fn world(method: &'static Method, dt: f64, x: DVec3, v: DVec3) -> Result<World, WorldError> {
    let body = Body {
        position: x,
        velocity: v,
        ..Body::default()
    };
    worlds::under(
        worlds::settings(method, dt),
        [body],
        &[worlds::spring_to_origin(1.0, 0.0)],
    )
}
