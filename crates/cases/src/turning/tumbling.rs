//! Free flight of bodies with different moments: energy, angular momentum and phase.

use kit::elliptic::Racket;
use kit::meshes::cuboid;
use sim_core::{DQuat, DVec3};

use super::{moments, worse};
use crate::hard_cases::Verdict;
use crate::scenes::{Engine, Form, Item, Scene, Who};

/// A box of 1 kg without forces.
#[derive(Debug)]
pub struct Tumbler {
    /// Name in tables and file names.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// The body, its spin, and the closed form.
    pub about: &'static str,
    /// Half extents, the greatest first, so that the moments are in ascending order, m.
    half: [f32; 3],
    /// Initial spin, rad/s.
    spin: DVec3,
    /// The largest error of a kind that passes.
    pub tolerance: f64,
    /// The engines that must pass at every rate; all others must fail.
    pub passed_by: &'static [Who],
}

/// All tumblers.
pub static TUMBLERS: [Tumbler; 2] = [
    Tumbler {
        name: "tumbling-box",
        title: "A box tumbles",
        about: "A box of 1 × 0.75 × 0.375 m, 1 kg, thrown with 3 rad/s about its middle axis and 4 rad/s \
                about its shortest side. The closed form of its spin is that of Jacobi's elliptic functions.",
        half: [0.5, 0.375, 0.1875],
        spin: DVec3::new(0.0, 3.0, 4.0),
        tolerance: 1e-10,
        passed_by: &[Who::Continuous],
    },
    Tumbler {
        name: "spinning-plate",
        title: "A plate spins and wobbles",
        about: "A square plate of 1 m, 1/32 m thick, 1 kg, thrown with 10 rad/s about its axis and 1 rad/s \
                across. Its spin goes about the axis of the plate at an even rate.",
        half: [0.5, 0.5, 0.015_625],
        spin: DVec3::new(1.0, 0.0, 10.0),
        tolerance: 1e-10,
        passed_by: &[Who::Continuous],
    },
];

/// The errors of a run, each relative to the start.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tumble {
    /// The greatest change of the energy.
    pub energy: f64,
    /// The greatest change of the angular momentum, a vector in the world.
    pub momentum: f64,
    /// The error of the final angular velocity in the frame of the body, that is, of the phase of the motion.
    pub spin: f64,
}

impl Tumbler {
    /// The body in a scene with so many steps per second.
    pub fn scene(&self, rate: u32) -> Scene {
        let form = Form::Mesh(cuboid(self.half));
        let body = Item {
            spin: self.spin,
            ..Item::resting(form, DVec3::ZERO)
        };
        Scene {
            turns: true,
            dt: 1.0 / f64::from(rate),
            ..Scene::new(vec![body])
        }
    }

    /// The angular velocity in the frame of the body after a time, rad/s.
    pub fn exact(&self, t: f64) -> DVec3 {
        let moments = moments(self.half);
        let DVec3 { x, y, z } = self.spin;
        if moments.x == moments.y {
            let rate = (moments.z / moments.x - 1.0) * z;
            let (sin, cos) = (rate * t).sin_cos();
            DVec3::new(x * cos - y * sin, x * sin + y * cos, z)
        } else {
            Racket::new(moments, y, z).at(t)
        }
    }

    /// Steps the scene and measures every state. Energy and momentum are computed from rotation and angular velocity,
    /// by the same formula for every engine.
    pub fn run(&self, who: Who, rate: u32, steps: u32) -> Tumble {
        let mut engine = who.start(&self.scene(rate));
        let moments = moments(self.half);
        let momentum = |rotation: DQuat, own: DVec3| rotation * (moments * own);
        let energy = |own: DVec3| 0.5 * own.dot(moments * own);
        let own = |engine: &dyn Engine| engine.rotation(0).inverse() * engine.spin(0);
        let first = (energy(self.spin), momentum(DQuat::IDENTITY, self.spin));
        let mut run = Tumble::default();
        for _ in 0..steps {
            if engine.step().is_err() {
                return Tumble::FAILED;
            }
            let own = own(engine.as_ref());
            run.energy = worse(run.energy, (energy(own) / first.0 - 1.0).abs());
            let now = momentum(engine.rotation(0), own);
            run.momentum = worse(run.momentum, (now - first.1).length() / first.1.length());
        }
        let exact = self.exact(f64::from(steps) / f64::from(rate));
        let off = (own(engine.as_ref()) - exact).length() / self.spin.length();
        run.spin = worse(off, 0.0);
        run
    }

    /// The verdict on a run.
    pub fn verdict(&self, run: &Tumble) -> Verdict {
        Verdict::of(worse(worse(run.energy, run.momentum), run.spin) <= self.tolerance)
    }

    /// The expected verdict.
    pub fn expected(&self, who: Who) -> Verdict {
        Verdict::of(self.passed_by.contains(&who))
    }
}

impl Tumble {
    /// The figures of a run that failed before its end.
    const FAILED: Tumble = Tumble {
        energy: f64::INFINITY,
        momentum: f64::INFINITY,
        spin: f64::INFINITY,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_obey_the_equations_of_euler() {
        for tumbler in &TUMBLERS {
            let moments = moments(tumbler.half);
            assert!((tumbler.exact(0.0) - tumbler.spin).length() < 1e-14);
            for i in 0..100 {
                let t = 0.37 * f64::from(i);
                let own = tumbler.exact(t);
                let slope = (tumbler.exact(t + 1e-5) - tumbler.exact(t - 1e-5)) / 2e-5;
                let law = (moments * own).cross(own) / moments;
                let off = (slope - law).length() / tumbler.spin.length_squared();
                assert!(off < 1e-8, "{} {t}: {off:e}", tumbler.name);
            }
        }
    }
}
