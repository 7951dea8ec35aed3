//! The tennis racket: the times at which a body that spins about its intermediate axis flips.

use kit::elliptic;
use kit::meshes::cuboid;
use sim_core::DVec3;

use super::moments;
use crate::scenes::{Form, Item, Scene, Who};

/// The initial component of the spin about the third axis, relative to that about the intermediate axis.
pub const STARTS: [f64; 2] = [0.1, 0.01];

/// The number of flips observed.
pub const FLIPS: usize = 10;

/// Half extents of the box of 1 kg, m.
const HALF: [f32; 3] = [1.0, 0.5, 0.25];

/// Spin about the intermediate axis, rad/s.
const SPIN: f64 = 3.0;

/// The times at which a run has flipped.
#[derive(Clone, Debug, Default)]
pub struct Flips {
    /// Times, s.
    pub times: Vec<f64>,
}

/// Time of a flip, s, numbered from 0: the component about the intermediate axis is 0 then.
pub fn exact(start: f64, flip: usize) -> f64 {
    let racket = elliptic::Racket::new(moments(HALF), SPIN, start * SPIN);
    (flip as f64 + 0.5) * racket.flip()
}

/// The number of steps to half a flip after the last one.
pub fn steps(start: f64, rate: u32) -> u32 {
    (0.5 * (exact(start, FLIPS - 1) + exact(start, FLIPS)) * f64::from(rate)).round() as u32
}

/// The box in a scene with so many steps per second.
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

/// Steps the scene and records every flip.
pub fn run(who: Who, start: f64, rate: u32) -> Flips {
    let scene = scene(start, rate);
    let mut engine = who.start(&scene);
    let own = |engine: &dyn crate::scenes::Engine| engine.rotation(0).inverse() * engine.spin(0);
    let mut before = own(engine.as_ref());
    let mut flips = Flips::default();
    for step in 0..steps(start, rate) {
        // After an error there are no further flips.
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
    /// The error of the time of a flip, s; `None` if there is none.
    pub fn error(&self, start: f64, flip: usize) -> Option<f64> {
        let found = self.times.get(flip)?;
        Some((found - exact(start, flip)).abs())
    }
}

/// The time within a step until the intermediate component of an angular velocity is 0, s. Euler's equations are
/// integrated from the step's start, so that only the states of an engine count, not its interpolation.
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

/// By 64 Runge-Kutta steps, exact to rounding.
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
