//! A spring that comes to rest within hundredths of a second and then stays at rest.

use sim_core::{DMat3, DVec3, Jacobians, System};

use super::{Card, FirstOrder, Problem};

/// `x'' = -k x - c x' - g`, state `(x, x')`.
#[derive(Clone, Debug)]
pub(super) struct StiffSpring;

/// Stiffness per mass, 1/s².
pub(crate) const K: f64 = 1e6;
/// Damping per mass, 1/s.
pub(crate) const C: f64 = 1e3;
/// Weight per mass, m/s².
pub(crate) const G: f64 = 9.81;

pub(super) fn problem() -> Problem<StiffSpring, 2> {
    Problem {
        card: Card {
            name: "stiff-spring",
            title: "Stiff spring",
            about: "x″ = -10⁶ x - 10³ x′ - 9.81 from 1 m at rest for 10 s. Exact end: at rest at \
                    -9.81e-6 m, where it has been since 0.1 s. Explicit methods must take steps \
                    of milliseconds to stay there.",
            error: "position, relative to the place of rest",
            time: 10.0,
            steps: [8, 1 << 22],
            frames: 600,
            is_stiff: true,
        },
        equations: StiffSpring,
        position: vec![DVec3::X],
        velocity: vec![DVec3::ZERO],
        exact: vec![-G / K],
        scale: G / K,
    }
}

impl System for StiffSpring {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        a[0] = -K * x[0] - C * v[0] - G * DVec3::X;
    }

    fn jacobians(&self, _: f64, _: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        out[0] = Jacobians {
            position: DMat3::from_diagonal(DVec3::splat(-K)),
            velocity: DMat3::from_diagonal(DVec3::splat(-C)),
        };
    }
}

impl FirstOrder<2> for StiffSpring {
    fn slope(&self, y: &[f64; 2], dy: &mut [f64; 2]) {
        *dy = [y[1], -K * y[0] - C * y[1] - G];
    }

    fn slope_along(&self, _: &[f64; 2], d: &[f64; 2], out: &mut [f64; 2]) {
        *out = [d[1], -K * d[0] - C * d[1]];
    }

    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; 2] {
        [x[0].x, v[0].x]
    }
}
