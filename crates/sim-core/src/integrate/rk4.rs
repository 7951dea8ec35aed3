//! The classical Runge-Kutta method of order four.

use glam::DVec3;

use super::Method;

pub(super) static METHOD: Method = Method {
    name: "rk4",
    title: "Classical RK4",
    order: 4,
    stability: "stable while ω dt < 2.83: an oscillator loses energy slowly",
    source: "Kutta 1901; Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I, sec. II.1",
    step: |before, after, forces, dt| {
        after.fill(before, forces, |x, v, a| step(x, v, dt, |_, _| a));
    },
};

/// One step under the acceleration `a(x, v)`.
fn step(x: DVec3, v: DVec3, dt: f64, a: impl Fn(DVec3, DVec3) -> DVec3) -> (DVec3, DVec3) {
    let half = 0.5 * dt;
    let (v1, a1) = (v, a(x, v));
    let (v2, a2) = (v + half * a1, a(x + half * v1, v + half * a1));
    let (v3, a3) = (v + half * a2, a(x + half * v2, v + half * a2));
    let (v4, a4) = (v + dt * a3, a(x + dt * v3, v + dt * a3));
    (
        x + dt / 6.0 * (v1 + 2.0 * (v2 + v3) + v4),
        v + dt / 6.0 * (a1 + 2.0 * (a2 + a3) + a4),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error on x'' = -x from (1, 0) after one second.
    fn error(steps: u32) -> f64 {
        let dt = 1.0 / f64::from(steps);
        let (mut x, mut v) = (DVec3::X, DVec3::ZERO);
        for _ in 0..steps {
            (x, v) = step(x, v, dt, |x, _| -x);
        }
        (x.x - libm::cos(1.0))
            .abs()
            .max((v.x + libm::sin(1.0)).abs())
    }

    #[test]
    fn the_stages_reach_order_four_on_an_oscillator() {
        let order = libm::log2(error(32) / error(64));
        assert!((order - 4.0).abs() < 0.05, "{order}");
    }

    #[test]
    fn velocity_dependent_forces_enter_every_stage() {
        // v' = -v from 1: one step is the Taylor polynomial of exp(-dt) to dt^4.
        let dt = 0.5;
        let (_, v) = step(DVec3::ZERO, DVec3::X, dt, |_, v| -v);
        let taylor = 1.0 - dt + dt * dt / 2.0 - dt * dt * dt / 6.0 + dt * dt * dt * dt / 24.0;
        assert!((v.x - taylor).abs() < 1e-15);
    }
}
