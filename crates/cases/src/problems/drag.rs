//! A body under quadratic drag.

use sim_core::{DMat3, DVec3, Jacobians, System};

use super::{Card, FirstOrder, Problem};

/// `x'' = -|x'| x'`, state `(x, x')`.
#[derive(Clone, Debug)]
pub(super) struct Drag;

const TIME: f64 = 10.0;

pub(super) fn problem() -> Problem<Drag, 2> {
    Problem {
        card: Card {
            name: "drag",
            title: "Quadratic drag",
            about: "x″ = -|x′| x′ from 0 m with 1 m/s for 10 s. Exact: x = ln(1 + t), here ln 11.",
            error: "position, m",
            time: TIME,
            steps: [8, 1 << 22],
            frames: 1,
            is_stiff: false,
        },
        equations: Drag,
        position: vec![DVec3::ZERO],
        velocity: vec![DVec3::X],
        exact: vec![TIME.ln_1p()],
        scale: 1.0,
    }
}

impl System for Drag {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, _: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        a[0] = -v[0].length_squared().sqrt() * v[0];
    }

    fn jacobians(&self, _: f64, _: &[DVec3], v: &[DVec3], out: &mut [Jacobians]) {
        let v = v[0];
        let speed = v.length_squared().sqrt();
        // |v| (1 + n nᵀ) with the direction n, which is undefined at rest.
        let along = match speed {
            0.0 => DMat3::ZERO,
            _ => DMat3::from_cols(v.x * v, v.y * v, v.z * v) * (1.0 / speed),
        };
        out[0] = Jacobians {
            position: DMat3::ZERO,
            velocity: -(DMat3::from_diagonal(DVec3::splat(speed)) + along),
        };
    }
}

impl FirstOrder<2> for Drag {
    fn slope(&self, y: &[f64; 2], dy: &mut [f64; 2]) {
        *dy = [y[1], -y[1].abs() * y[1]];
    }

    fn slope_along(&self, y: &[f64; 2], d: &[f64; 2], out: &mut [f64; 2]) {
        *out = [d[1], -2.0 * y[1].abs() * d[1]];
    }

    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; 2] {
        [x[0].x, v[0].x]
    }
}
