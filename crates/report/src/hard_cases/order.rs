//! Case 2: halving dt divides the error by 2 to the order.

use std::f64::consts::PI;

use sim_core::{DVec3, Method, Stepper, System};

use super::{Finding, Measured};

pub(super) fn test(method: &'static Method, _: &Measured<'_>) -> Finding {
    let claimed = f64::from(method.order);
    let slopes = [
        ("oscillator", slope(method, &oscillator())),
        ("drag", slope(method, &drag())),
        ("Kepler", slope(method, &kepler())),
    ];
    let mut worst: f64 = 0.0;
    let mut words = Vec::new();
    for (name, slope) in slopes {
        let Some(slope) = slope else {
            return Finding::failed(format!("{name}: it never came near"));
        };
        worst = worst.max((slope - claimed).abs());
        words.push(format!("{name} {slope:.3}"));
    }
    Finding::within(worst, 0.05, words.join(", "))
}

/// Accelerations with the motion at the start and at the end.
struct Motion {
    acceleration: fn(DVec3, DVec3) -> DVec3,
    by_velocity: bool,
    start: [DVec3; 2],
    end: [DVec3; 2],
    time: f64,
}

impl System for Motion {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn depends_on_velocity(&self) -> bool {
        self.by_velocity
    }

    fn accelerations(&self, _: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        a[0] = (self.acceleration)(x[0], v[0]);
    }
}

fn oscillator() -> Motion {
    let (sin, cos) = 2f64.sin_cos();
    Motion {
        acceleration: |x, _| -x,
        by_velocity: false,
        start: [DVec3::X, DVec3::ZERO],
        end: [cos * DVec3::X, -sin * DVec3::X],
        time: 2.0,
    }
}

fn drag() -> Motion {
    Motion {
        acceleration: |_, v| -v.length() * v,
        by_velocity: true,
        start: [DVec3::ZERO, DVec3::X],
        end: [3f64.ln() * DVec3::X, DVec3::X / 3.0],
        time: 2.0,
    }
}

/// Half an orbit, from the perihelion to the aphelion.
fn kepler() -> Motion {
    let e = 0.6f64;
    let speed = ((1.0 + e) / (1.0 - e)).sqrt();
    Motion {
        acceleration: |x, _| -x / (x.length_squared() * x.length()),
        by_velocity: false,
        start: [(1.0 - e) * DVec3::X, speed * DVec3::Y],
        end: [-(1.0 + e) * DVec3::X, -DVec3::Y / speed],
        time: PI,
    }
}

/// The error after so many steps.
fn error(method: &'static Method, motion: &Motion, steps: u32) -> Option<f64> {
    let [x, v] = motion.start;
    let mut stepper = Stepper::new(method, &[x], &[v]);
    // No error is too large for an adaptive method now: it takes each dt in one step.
    stepper.tolerance = 1e100;
    let dt = motion.time / f64::from(steps);
    for _ in 0..steps {
        stepper.step(motion, dt).ok()?;
    }
    let [end_x, end_v] = motion.end;
    let off = (stepper.position()[0] - end_x).length() + (stepper.velocity()[0] - end_v).length();
    off.is_finite().then_some(off)
}

/// An error is free of rounding from this on: a hundred times what that makes of this many steps if
/// they add up at random.
fn rounding(steps: u32) -> f64 {
    100.0 * f64::EPSILON * f64::from(steps).sqrt()
}

/// Most steps in which rounding does not add up.
const MOST_STEPS: u32 = 1 << 15;

/// `log2` of the ratio of errors at the shortest two steps that are far from rounding.
fn slope(method: &'static Method, motion: &Motion) -> Option<f64> {
    let mut last: Option<f64> = None;
    let mut slope = None;
    let mut steps = 4;
    while steps <= MOST_STEPS {
        let now = error(method, motion, steps);
        if now.is_some_and(|now| now < rounding(steps)) {
            break;
        }
        if let (Some(last), Some(now)) = (last, now) {
            slope = Some((last / now).log2());
        }
        last = now;
        steps *= 2;
    }
    slope
}
