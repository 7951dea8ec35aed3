//! The tennis racket: when a body that spins about its middle axis turns over.

use kit::elliptic;
use kit::meshes::cuboid;
use sim_core::DVec3;

use super::moments;
use crate::scenes::{Form, Item, Scene, Who};

/// How far the spin is from the middle axis at the start: parts of it about the third axis.
pub const STARTS: [f64; 2] = [0.1, 0.01];

/// Flips that are waited for.
pub const FLIPS: usize = 10;

/// Half extents of the box of 1 kg, m.
const HALF: [f32; 3] = [1.0, 0.5, 0.25];

/// About the middle axis, rad/s.
const SPIN: f64 = 3.0;

/// When a run has turned over.
#[derive(Clone, Debug, Default)]
pub struct Flips {
    /// Times, s.
    pub times: Vec<f64>,
}

/// Time of a flip, s, the first one of number 0: when the component about the middle axis is 0.
pub fn exact(start: f64, flip: usize) -> f64 {
    let racket = elliptic::Racket::new(moments(HALF), SPIN, start * SPIN);
    (flip as f64 + 0.5) * racket.flip()
}

/// Steps to half a flip after the last one.
pub fn steps(start: f64, rate: u32) -> u32 {
    (0.5 * (exact(start, FLIPS - 1) + exact(start, FLIPS)) * f64::from(rate)).round() as u32
}

/// The box in a scene of so many steps a second.
pub fn scene(start: f64, rate: u32) -> Scene {
    let body = Item {
        spin: SPIN * DVec3::new(0.0, 1.0, start),
        ..Item::resting(Form::Mesh(cuboid(HALF)), DVec3::ZERO)
    };
    Scene {
        turns: true,
        dt: 1.0 / f64::from(rate),
        ..Scene::new(vec![body])
    }
}

/// Steps and notes every flip.
pub fn run(who: Who, start: f64, rate: u32) -> Flips {
    let scene = scene(start, rate);
    let mut engine = who.start(&scene);
    let own = |engine: &dyn crate::scenes::Engine| engine.rotation(0).inverse() * engine.spin(0);
    let mut before = own(engine.as_ref());
    let mut flips = Flips::default();
    for step in 0..steps(start, rate) {
        // What fails has no more flips.
        if engine.step().is_err() {
            break;
        }
        let after = own(engine.as_ref());
        if before.y != 0.0 && before.y * after.y <= 0.0 {
            let within = until_zero(before, scene.dt);
            flips.times.push(f64::from(step) / f64::from(rate) + within);
        }
        before = after;
    }
    flips
}

impl Flips {
    /// How far a flip is from its time, s; `None` if there is none.
    pub fn error(&self, start: f64, flip: usize) -> Option<f64> {
        let found = self.times.get(flip)?;
        Some((found - exact(start, flip)).abs())
    }
}

/// The time within a step until the middle component of an angular velocity is 0, s. The equations of Euler are
/// solved from the step's start, so that an engine answers for its states and not for what is between them.
fn until_zero(spin: DVec3, dt: f64) -> f64 {
    let mut t = 0.5 * dt;
    for _ in 0..20 {
        let there = after(spin, t);
        t = (t - there.y / slope(there).y).clamp(0.0, dt);
    }
    t
}

fn slope(spin: DVec3) -> DVec3 {
    let moments = moments(HALF);
    (moments * spin).cross(spin) / moments
}

/// By 64 steps of Runge and Kutta, to rounding.
fn after(mut spin: DVec3, t: f64) -> DVec3 {
    let h = t / 64.0;
    for _ in 0..64 {
        let a = slope(spin);
        let b = slope(spin + 0.5 * h * a);
        let c = slope(spin + 0.5 * h * b);
        let d = slope(spin + h * c);
        spin += h / 6.0 * (a + 2.0 * (b + c) + d);
    }
    spin
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flip_within_a_step_is_found_to_rounding() {
        let racket = elliptic::Racket::new(moments(HALF), SPIN, 0.1 * SPIN);
        let flip = exact(0.1, 0);
        for early in [0.001, 0.02, 0.033] {
            let within = until_zero(racket.at(flip - early), 1.0 / 30.0);
            assert!((within - early).abs() < 1e-13, "{within} {early}");
        }
    }

    #[test]
    fn what_does_not_flip_has_no_error() {
        let none = Flips::default();
        assert_eq!(none.error(0.1, 0), None);
    }
}
