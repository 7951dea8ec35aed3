//! A harmonic oscillator for a long time.

use std::f64::consts::PI;

use sim_core::{DMat3, DVec3, Jacobians, System};

use super::{Card, FirstOrder, Problem};

/// `x'' = -x`, state `(x, x')`.
#[derive(Clone, Debug)]
pub(super) struct Oscillator;

pub(super) fn problem() -> Problem<Oscillator, 2> {
    Problem {
        card: Card {
            name: "oscillator",
            title: "Oscillator, 1,000 periods",
            about: "x″ = -x from 1 m at rest for 2000 π s. Exact end: back at the start.",
            error: "position or velocity, m or m/s",
            time: 2000.0 * PI,
            steps: [8_000, 8_000 << 11],
            frames: 1000,
            is_stiff: false,
        },
        equations: Oscillator,
        position: vec![DVec3::X],
        velocity: vec![DVec3::ZERO],
        exact: vec![1.0, 0.0],
        scale: 1.0,
    }
}

impl System for Oscillator {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, x: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        a[0] = -x[0];
    }

    fn jacobians(&self, _: f64, _: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        out[0] = Jacobians {
            position: -DMat3::IDENTITY,
            velocity: DMat3::ZERO,
        };
    }
}

impl FirstOrder<2> for Oscillator {
    fn slope(&self, y: &[f64; 2], dy: &mut [f64; 2]) {
        *dy = [y[1], -y[0]];
    }

    fn slope_along(&self, _: &[f64; 2], d: &[f64; 2], out: &mut [f64; 2]) {
        *out = [d[1], -d[0]];
    }

    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; 2] {
        [x[0].x, v[0].x]
    }
}
