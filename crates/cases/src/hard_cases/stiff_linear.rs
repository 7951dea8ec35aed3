//! Case 5: a decay within a microsecond together with one within a second.

use sim_core::{
    Body, BodyLaw, BodyMotion, DMat3, DVec3, Force, Jacobians, Law, Method, StepError, World,
    WorldError,
};

use super::{Finding, Tried};
use crate::worlds;

/// A drag force given by a matrix.
#[derive(Debug)]
struct MatrixDrag(DMat3);

impl BodyLaw for MatrixDrag {
    fn force(&self, at: &BodyMotion) -> DVec3 {
        self.0 * at.velocity
    }

    fn jacobians(&self, _: &BodyMotion) -> Jacobians {
        Jacobians {
            position: DMat3::ZERO,
            velocity: self.0,
        }
    }
}

const FAST: f64 = 1e6;

/// Numbers of steps for the second. Backward Euler is L-stable and has an answer at each of them.
fn steps(method: &Method) -> &'static [u32] {
    match method.name {
        "backward-euler" => &[100, 10, 1000],
        _ => &[100],
    }
}

pub(super) fn test(method: &'static Method) -> Tried {
    let mut findings = Vec::new();
    for &steps in steps(method) {
        findings.push(in_steps(method, steps)?);
    }
    let worst = findings
        .into_iter()
        .reduce(|worst, other| match other.figure > worst.figure {
            true => other,
            false => worst,
        });
    worst.ok_or_else(|| anyhow::anyhow!("it was not run"))
}

fn in_steps(method: &'static Method, steps: u32) -> Tried {
    let dt = 1.0 / f64::from(steps);
    let (world, outcome) = run(method, steps)?;
    let v = world.velocity(0);
    let off = |slow: f64, fast: f64| {
        let exact = [slow + fast, slow - fast];
        (v.x - exact[0]).abs().max((v.y - exact[1]).abs())
    };
    Ok(match outcome {
        Err(error) => reported(method, &error),
        Ok(()) => match own_factor(method) {
            Some(factor) => {
                let power = |rate: f64| factor(-rate * dt).powi(steps as i32);
                let left = power(FAST).abs();
                let why = match left {
                    left if left < 1e-12 => "its own discrete solution".into(),
                    left => format!(
                        "its own discrete solution, in which {left:.2} of the fast part is left: \
                         stable, but no answer"
                    ),
                };
                Finding::within(off(power(1.0), power(FAST)), 1e-12, why)
            }
            None => {
                let left = 0.5 * (v.x - v.y).abs();
                let why = match left {
                    left if left < 1e-8 => "against the exact end".into(),
                    left => format!("it does not grow, but {left:.2} of the fast part is left"),
                };
                Finding::within(off((-1f64).exp(), 0.0), 1e-9, why)
            }
        },
    })
}

fn run(method: &'static Method, steps: u32) -> Result<(World, Result<(), StepError>), WorldError> {
    let (same, other) = (0.5 * (-1.0 - FAST), 0.5 * (-1.0 + FAST));
    let matrix = DMat3::from_cols(
        DVec3::new(same, other, 0.0),
        DVec3::new(other, same, 0.0),
        DVec3::ZERO,
    );
    let body = Body {
        velocity: 2.0 * DVec3::X,
        ..Body::default()
    };
    let force = Force::Body {
        body: None,
        law: Law::new(MatrixDrag(matrix)),
    };
    let settings = worlds::settings(method, 1.0 / f64::from(steps));
    let mut world = worlds::under(settings, [body], &[force])?;
    let outcome = worlds::step(&mut world, u64::from(steps));
    Ok((world, outcome))
}

/// The amplification factor of a step of `y' = λ y`, as a function of `z = λ dt`.
fn own_factor(method: &Method) -> Option<fn(f64) -> f64> {
    match method.name {
        "backward-euler" => Some(|z| 1.0 / (1.0 - z)),
        // Half a kick before and half a kick after the drift are the trapezoidal rule here.
        "implicit-midpoint" | "velocity-verlet" => Some(|z| (2.0 + z) / (2.0 - z)),
        _ => None,
    }
}

/// An error passes if the method is unstable there and the limit that it names is the true one.
fn reported(method: &Method, error: &StepError) -> Finding {
    // The limit of |1 + z| ≤ 1, and the point where RK4's polynomial leaves the unit circle on the real axis.
    let limit = match method.name {
        "forward-euler" | "symplectic-euler" => Some(2.0 / FAST),
        "rk4" => Some(2.785_293_563_4 / FAST),
        _ => None,
    };
    match (limit, worlds::named_limit(error)) {
        (Some(limit), Some(named)) => Finding::within(
            (named / limit - 1.0).abs(),
            1e-3,
            format!("says that {named:.4e} s would do"),
        ),
        _ => Finding::failed(error.to_string()),
    }
}
