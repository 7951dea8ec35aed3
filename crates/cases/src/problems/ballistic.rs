//! A throw without air.

use sim_core::{DVec3, Jacobians, System};

use super::{Card, FirstOrder, Problem};

/// `x'' = (0, -1)`, state `(x, y, x', y')`.
#[derive(Clone, Debug)]
pub(super) struct Ballistic;

pub(super) fn problem() -> Problem<Ballistic, 4> {
    Problem {
        card: Card {
            name: "ballistic",
            title: "Ballistic flight",
            about: "x″ = (0, -1) m/s² from (-4, 0) m with (2, 2) m/s for 4 s. Exact end: (4, 0). \
                    Every method is exact here or off by a multiple of dt.",
            error: "position, m",
            time: 4.0,
            steps: [16, 1 << 22],
            frames: 1,
            is_stiff: false,
        },
        equations: Ballistic,
        position: vec![DVec3::new(-4.0, 0.0, 0.0)],
        velocity: vec![DVec3::new(2.0, 2.0, 0.0)],
        exact: vec![4.0, 0.0],
        scale: 1.0,
    }
}

impl System for Ballistic {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, _: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        a[0] = -DVec3::Y;
    }

    fn jacobians(&self, _: f64, _: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        out[0] = Jacobians::ZERO;
    }
}

impl FirstOrder<4> for Ballistic {
    fn slope(&self, y: &[f64; 4], dy: &mut [f64; 4]) {
        *dy = [y[2], y[3], 0.0, -1.0];
    }

    fn slope_along(&self, _: &[f64; 4], d: &[f64; 4], out: &mut [f64; 4]) {
        *out = [d[2], d[3], 0.0, 0.0];
    }

    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; 4] {
        [x[0].x, x[0].y, v[0].x, v[0].y]
    }
}
