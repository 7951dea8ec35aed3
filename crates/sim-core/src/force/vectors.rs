//! What the laws share. With `n = d/|d|` and `P = n nᵀ`, the derivatives are `∂|d|/∂d = nᵀ` and
//! `∂n/∂d = (I - P)/|d|`, so that
//!
//! ```text
//! spring       ∂/∂d [k (|d| - L) n] = k (P + (1 - L/|d|)(I - P))
//! damper       ∂/∂d [c (n·w) n]     = c/|d| (n wᵀ(I - P) + (n·w)(I - P)),   ∂/∂w = c P
//! attraction   ∂/∂d [μ d/|d|³]      = μ/|d|³ (I - 3 P)
//! drag         ∂/∂v [c |v| v]       = c |v| (I + P_v)
//! ```
//!
//! (Witkin, Baraff 1997, "Physically based modeling", ch. C and E.)

use glam::{DMat3, DVec3};

use crate::Jacobians;

/// `k (|d| - L) n`; without a rest length it is linear and needs no direction.
pub(super) fn spring(stiffness: f64, rest_length: f64, d: DVec3) -> DVec3 {
    if rest_length == 0.0 {
        return stiffness * d;
    }
    let far = length(d);
    if far == 0.0 {
        return DVec3::ZERO;
    }
    stiffness * (1.0 - rest_length / far) * d
}

pub(super) fn spring_slope(stiffness: f64, rest_length: f64, d: DVec3) -> DMat3 {
    let far = length(d);
    if rest_length == 0.0 || far == 0.0 {
        return DMat3::from_diagonal(DVec3::splat(stiffness));
    }
    let n = d / far;
    let radial = outer(n, n);
    stiffness * (radial + (1.0 - rest_length / far) * (DMat3::IDENTITY - radial))
}

pub(super) fn spring_energy(stiffness: f64, rest_length: f64, d: DVec3) -> f64 {
    let stretch = length(d) - rest_length;
    0.5 * stiffness * stretch * stretch
}

/// The part of `w` along `d`. At `d = 0` it is all of `w`, because bodies that pass through each other move along the
/// line through them.
pub(super) fn along(d: DVec3, w: DVec3) -> DVec3 {
    direction(d).map_or(w, |n| dot(n, w) * n)
}

/// The derivatives of `along` with respect to `d` and `w`.
pub(super) fn along_slopes(d: DVec3, w: DVec3) -> (DMat3, DMat3) {
    let Some(n) = direction(d) else {
        return (DMat3::ZERO, DMat3::IDENTITY);
    };
    let radial = outer(n, n);
    let across = DMat3::IDENTITY - radial;
    let slope = outer(n, across * w) + dot(n, w) * across;
    (slope * (1.0 / length(d)), radial)
}

/// `d / |d|³`; infinite or NaN at 0, which the world reports.
#[inline]
pub(super) fn inverse_square(d: DVec3) -> DVec3 {
    let squared = dot(d, d);
    d / (squared * libm::sqrt(squared))
}

pub(super) fn inverse_square_slope(d: DVec3) -> DMat3 {
    let far = length(d);
    let n = d / far;
    (1.0 / (far * far * far)) * (DMat3::IDENTITY - 3.0 * outer(n, n))
}

#[inline]
pub(super) fn dot(a: DVec3, b: DVec3) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline]
pub(super) fn length(d: DVec3) -> f64 {
    libm::sqrt(dot(d, d))
}

pub(super) fn direction(d: DVec3) -> Option<DVec3> {
    let far = length(d);
    (far > 0.0).then(|| d / far)
}

/// `a bᵀ`.
pub(super) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Central differences of a force. The step is about the cube root of the rounding unit, at which the errors of
/// rounding and of the third derivative are equal.
pub(super) fn differences(x: DVec3, v: DVec3, force: impl Fn(DVec3, DVec3) -> DVec3) -> Jacobians {
    let step = |at: DVec3| 6e-6 * (1.0 + at.abs().max_element());
    let (hx, hv) = (step(x), step(v));
    let slope =
        |dx: DVec3, dv: DVec3, h: f64| (force(x + dx, v + dv) - force(x - dx, v - dv)) / (2.0 * h);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let [px, py, pz] = axes.map(|axis| slope(hx * axis, DVec3::ZERO, hx));
    let [vx, vy, vz] = axes.map(|axis| slope(DVec3::ZERO, hv * axis, hv));
    Jacobians {
        position: DMat3::from_cols(px, py, pz),
        velocity: DMat3::from_cols(vx, vy, vz),
    }
}
