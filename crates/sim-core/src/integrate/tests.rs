//! What every method of the table claims, measured.

use glam::DVec3;
use std::println;

use super::*;

/// A system of one body from its acceleration.
struct One<F: Fn(f64, DVec3, DVec3) -> DVec3>(F);

impl<F: Fn(f64, DVec3, DVec3) -> DVec3> System for One<F> {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn accelerations(&self, t: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        a[0] = (self.0)(t, x[0], v[0]);
    }
}

fn run<S: System>(
    method: &'static Method,
    system: &S,
    (x, v): (DVec3, DVec3),
    time: f64,
    steps: u32,
) -> (DVec3, DVec3) {
    let mut stepper = Stepper::new(method, &[x], &[v]);
    for _ in 0..steps {
        stepper.step(system, time / f64::from(steps)).unwrap();
    }
    (stepper.position()[0], stepper.velocity()[0])
}

#[test]
fn show_orders() {
    for method in METHODS.into_iter().filter(|m| !m.adaptive) {
        let osc = One(|_, x, _| -x);
        let exact = DVec3::new(libm::cos(2.0), -libm::sin(2.0), 0.0);
        let drag = One(|_, _, v: DVec3| -v.length() * v);
        let damped = One(|_, x: DVec3, v: DVec3| -x * x.length_squared() - 0.5 * v * v.length());
        let best = |s: &dyn Fn(u32) -> DVec3| s(4096);
        for k in 1..8 {
            let n = 1u32 << k;
            let o = |n| {
                let (x, v) = run(method, &osc, (DVec3::X, DVec3::ZERO), 2.0, n);
                (x.x - exact.x).abs().max((v.x - exact.y).abs())
            };
            let d = |n| {
                let (x, v) = run(method, &drag, (DVec3::ZERO, DVec3::X), 2.0, n);
                (x.x - libm::log(3.0)).abs().max((v.x - 1.0 / 3.0).abs())
            };
            println!(
                "{} {n} osc {:.2e} {:.3} drag {:.2e} {:.3}",
                method.name,
                o(n),
                libm::log2(o(n) / o(2 * n)),
                d(n),
                libm::log2(d(n) / d(2 * n))
            );
        }
        println!(
            "{} stable {:.6} {:.6e}",
            method.name,
            method.stable_dt(1.0, 0.0),
            method.stable_dt(1e6, 1e3)
        );
        let _ = (&damped, &best);
    }
}
