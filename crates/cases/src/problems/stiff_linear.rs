//! A fast and a slow decay, coupled.

use sim_core::{DMat3, DVec3, Jacobians, System};

use super::{Card, FirstOrder, Problem};

/// `y' = A y` with the eigenvalues -1 along (1, 1) and -10⁶ along (1, -1). As a motion, the state is the velocity.
#[derive(Clone, Debug)]
pub(super) struct StiffLinear;

const SLOW: f64 = -1.0;
const FAST: f64 = -1e6;
/// The entries of `A` on and off its diagonal.
const SAME: f64 = 0.5 * (SLOW + FAST);
const OTHER: f64 = 0.5 * (SLOW - FAST);

pub(super) fn problem() -> Problem<StiffLinear, 2> {
    let end = (-1f64).exp();
    Problem {
        card: Card {
            name: "stiff-linear",
            title: "Stiff linear system",
            about: "y′ = A y with eigenvalues -1 and -10⁶ from (2, 0) for 1 s. Exact end: \
                    (1/e, 1/e).",
            error: "component",
            time: 1.0,
            steps: [8, 1 << 21],
            frames: 60,
            is_stiff: true,
        },
        equations: StiffLinear,
        position: vec![DVec3::ZERO],
        velocity: vec![2.0 * DVec3::X],
        exact: vec![end, end],
        scale: 1.0,
    }
}

impl System for StiffLinear {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, _: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        let v = v[0];
        a[0] = DVec3::new(SAME * v.x + OTHER * v.y, OTHER * v.x + SAME * v.y, 0.0);
    }

    fn jacobians(&self, _: f64, _: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        let columns = [
            DVec3::new(SAME, OTHER, 0.0),
            DVec3::new(OTHER, SAME, 0.0),
            DVec3::ZERO,
        ];
        out[0] = Jacobians {
            position: DMat3::ZERO,
            velocity: DMat3::from_cols(columns[0], columns[1], columns[2]),
        };
    }
}

impl FirstOrder<2> for StiffLinear {
    fn slope(&self, y: &[f64; 2], dy: &mut [f64; 2]) {
        *dy = [SAME * y[0] + OTHER * y[1], OTHER * y[0] + SAME * y[1]];
    }

    fn slope_along(&self, _: &[f64; 2], d: &[f64; 2], out: &mut [f64; 2]) {
        self.slope(d, out);
    }

    fn state(_: &[DVec3], v: &[DVec3]) -> [f64; 2] {
        [v[0].x, v[0].y]
    }
}
