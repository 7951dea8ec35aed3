//! Case 2: halving dt divides the error by two to the power of the order.

use std::f64::consts::PI;

use sim_core::{Body, DVec3, Force, Method, Stepper, System};

use super::{Finding, Tried};
use crate::worlds;

pub(super) fn test(method: &'static Method) -> Tried {
    let claimed = f64::from(method.order);
    let mut slopes = vec![
        (
            "oscillator",
            slope(method, |n| error(method, &oscillator(), n)),
        ),
        ("drag", slope(method, |n| error(method, &drag(), n))),
        ("Kepler", slope(method, |n| error(method, &kepler(), n))),
    ];
    // In a world, adaptive methods take as many partial steps as they need.
    if !method.adaptive {
        slopes.push(("drag in a world", slope(method, |n| in_world(method, n))));
    }
    let mut worst: f64 = 0.0;
    let mut words = Vec::new();
    for (name, slope) in slopes {
        let Some(slope) = slope else {
            return Ok(Finding::failed(format!("{name}: it never came near")));
        };
        worst = worst.max((slope - claimed).abs());
        words.push(format!("{name} {slope:.3}"));
    }
    let tolerance = match method.order {
        0..=4 => 0.05,
        // Rounding hides the errors at steps so short that the leading term alone matters.
        _ => 0.5,
    };
    Ok(Finding::within(worst, tolerance, words.join(", ")))
}

/// Accelerations, with the exact motion at the start and at the end.
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

/// A part of an orbit from the aphelion, where it is smooth enough for high orders to be visible above rounding.
fn kepler() -> Motion {
    let (e, time) = (0.6f64, 2.0);
    Motion {
        acceleration: |x, _| -x / (x.length_squared() * x.length()),
        by_velocity: false,
        start: on_ellipse(e, PI),
        end: on_ellipse(e, eccentric_anomaly(e, PI + time)),
        time,
    }
}

/// Position and velocity at an eccentric anomaly, with half axis 1 and `G M = 1`.
fn on_ellipse(e: f64, anomaly: f64) -> [DVec3; 2] {
    let ((sin, cos), width) = (anomaly.sin_cos(), (1.0 - e * e).sqrt());
    let rate = 1.0 / (1.0 - e * cos);
    [
        DVec3::new(cos - e, width * sin, 0.0),
        DVec3::new(-rate * sin, rate * width * cos, 0.0),
    ]
}

/// Solves Kepler's equation `E - e sin E = M` by Newton's method.
fn eccentric_anomaly(e: f64, mean: f64) -> f64 {
    (0..20).fold(mean, |anomaly, _| {
        anomaly - (anomaly - e * anomaly.sin() - mean) / (1.0 - e * anomaly.cos())
    })
}

/// The error after a number of steps.
fn error(method: &'static Method, motion: &Motion, steps: u32) -> Option<f64> {
    let [x, v] = motion.start;
    let mut stepper = Stepper::new(method, &[x], &[v]);
    // With this tolerance an adaptive method accepts every error, so it takes each dt in one step.
    stepper.tolerance = 1e100;
    let dt = motion.time / f64::from(steps);
    for _ in 0..steps {
        stepper.step(motion, dt).ok()?;
    }
    let [end_x, end_v] = motion.end;
    let off = (stepper.position()[0] - end_x).length() + (stepper.velocity()[0] - end_v).length();
    off.is_finite().then_some(off)
}

/// The error of a motion under drag, in a world.
fn in_world(method: &'static Method, steps: u32) -> Option<f64> {
    let Motion {
        start, end, time, ..
    } = drag();
    let body = Body {
        position: start[0],
        velocity: start[1],
        ..Body::default()
    };
    let force = Force::QuadraticDrag {
        body: None,
        coefficient: 1.0,
    };
    let settings = worlds::settings(method, time / f64::from(steps));
    let mut world = worlds::under(settings, [body], &[force]).ok()?;
    worlds::step(&mut world, u64::from(steps)).ok()?;
    Some((world.position(0) - end[0]).length() + (world.velocity(0) - end[1]).length())
}

/// The expected rounding error of so many steps if it accumulates like a random walk.
fn rounding(steps: u32) -> f64 {
    f64::EPSILON * f64::from(steps).sqrt()
}

/// The factor above rounding at which an error is judged: the rougher the tolerance, the smaller.
fn margin(method: &Method) -> f64 {
    match method.order {
        0..=4 => 200.0,
        _ => 30.0,
    }
}

/// The most steps in which rounding does not accumulate.
const MOST_STEPS: u32 = 1 << 15;

/// `log2` of the ratio of errors at the shortest two steps that are far from rounding.
fn slope(method: &'static Method, error: impl Fn(u32) -> Option<f64>) -> Option<f64> {
    let mut last: Option<f64> = None;
    let mut slope = None;
    let mut steps = 4;
    while steps <= MOST_STEPS {
        let now = error(steps);
        if now.is_some_and(|now| now < margin(method) * rounding(steps)) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The planet's end by Kepler's equation and by a much tighter solve are the same.
    #[test]
    fn keplers_equation_agrees_with_stepping() {
        let dop853 = Method::named("dop853").expect("it is in the table");
        let end = error(dop853, &kepler(), 64).expect("an error");
        assert!(end < 1e-13, "{end}");
    }

    #[test]
    fn a_wrong_claim_is_found_out() {
        let rk4 = Method::named("rk4").expect("it is in the table");
        let found = slope(rk4, |n| error(rk4, &oscillator(), n)).expect("a slope");
        assert!((found - 4.0).abs() < 0.05 && (found - 3.0).abs() > 0.5);
    }
}
