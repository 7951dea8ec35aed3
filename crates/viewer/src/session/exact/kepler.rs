//! A body attracted by one centre: ellipse, parabola or hyperbola, in universal variables.
//!
//! With `α = 2/r₀ - v₀²/μ` and the universal anomaly `χ`, `dχ/dt = √μ / r`, one equation holds for all three:
//! `√μ t = σ₀ χ² C(z) + (1 - α r₀) χ³ S(z) + r₀ χ` with `σ₀ = r₀·v₀/√μ` and `z = α χ²`, in the Stumpff functions C and
//! S (Bate, Mueller, White 1971, ch. 4). The right side has the slope `r > 0`, so it has exactly one root, which is
//! bracketed.

use sim_core::DVec3;

/// The number of halvings after which a bracket of doubles cannot shrink further.
const HALVINGS: u32 = 1100;

/// Position and velocity from the centre after `time`, s, for the initial `place`, m, and `velocity`, m/s, under the
/// attraction `strength / r²`, with `strength` in m³/s². `None` if the body falls straight into the centre, or if
/// numbers leave their range.
pub(super) fn at(
    place: DVec3,
    velocity: DVec3,
    strength: f64,
    time: f64,
) -> Option<(DVec3, DVec3)> {
    let r0 = place.length();
    let turn = place.cross(velocity).length();
    let straight = turn <= 1e-12 * r0 * velocity.length();
    if straight || !turn.is_finite() {
        return None;
    }
    let root = strength.sqrt();
    let alpha = 2.0 / r0 - velocity.length_squared() / strength;
    let sigma = place.dot(velocity) / root;
    // Whole revolutions of an ellipse are removed.
    let time = if alpha > 0.0 {
        time % (std::f64::consts::TAU / (root * alpha * alpha.sqrt()))
    } else {
        time
    };
    let late = |chi: f64| {
        let (c, s) = stumpff(alpha * chi * chi);
        let chi2 = chi * chi;
        (sigma * chi2 * c + (1.0 - alpha * r0) * chi2 * chi * s + r0 * chi) / root - time
    };
    let slope = |chi: f64| {
        let z = alpha * chi * chi;
        let (c, s) = stumpff(z);
        (chi * chi * c + sigma * chi * (1.0 - z * s) + r0 * (1.0 - z * c)) / root
    };
    let mut low = 0.0;
    let mut high = if alpha > 0.0 {
        std::f64::consts::TAU / alpha.sqrt()
    } else {
        let mut high = root * time / r0 + 1e-300;
        while late(high) < 0.0 {
            high *= 2.0;
        }
        high
    };
    let mut chi = (root * time / r0).clamp(low, high);
    for _ in 0..HALVINGS {
        let error = late(chi);
        if error > 0.0 {
            high = chi;
        } else {
            low = chi;
        }
        let newton = chi - error / slope(chi);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - chi).abs() <= f64::EPSILON * chi.abs() {
            break;
        }
        chi = next;
    }
    let chi2 = chi * chi;
    let z = alpha * chi2;
    let (c, s) = stumpff(z);
    let f = 1.0 - chi2 / r0 * c;
    let g = time - chi2 * chi / root * s;
    let there = f * place + g * velocity;
    let r = there.length();
    let f_slope = root / (r * r0) * chi * (z * s - 1.0);
    let g_slope = 1.0 - chi2 / r * c;
    let moving = f_slope * place + g_slope * velocity;
    (there.is_finite() && moving.is_finite()).then_some((there, moving))
}

/// The Stumpff functions (1 - cos √z)/z and (√z - sin √z)/√z³, and their continuations for z up to 0.
fn stumpff(z: f64) -> (f64, f64) {
    if z.abs() < 0.1 {
        // The series up to z⁶; further terms are below rounding.
        let mut c = 0.0;
        let mut s = 0.0;
        for n in (0..8).rev() {
            let n = f64::from(n);
            c = (1.0 - z * c) / ((2.0 * n + 1.0) * (2.0 * n + 2.0));
            s = (1.0 - z * s) / ((2.0 * n + 2.0) * (2.0 * n + 3.0));
        }
        (c, s)
    } else if z > 0.0 {
        let root = z.sqrt();
        let half = (0.5 * root).sin();
        (2.0 * half * half / z, (root - root.sin()) / (z * root))
    } else {
        let root = (-z).sqrt();
        let half = (0.5 * root).sinh();
        (-2.0 * half * half / z, (root.sinh() - root) / (-z * root))
    }
}
