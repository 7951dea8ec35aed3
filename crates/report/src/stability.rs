//! Which steps are stable, found by stepping.
//!
//! Near rest every motion is a sum of oscillators `x'' = -ω² x - 2 ζ ω x'`. What matters of a step
//! on one of them is `z = ω dt` alone, so `ω = 1` here and `dt = z`.

use sim_core::{DMat3, DVec3, Jacobians, METHODS, Method, Stepper, System};

use crate::scope::Scope;

/// A damping ratio to map, with its name.
#[derive(Debug)]
pub(crate) struct Damping {
    pub(crate) ratio: f64,
    pub(crate) title: &'static str,
}

/// Without damping, and with that of the stiff spring.
pub(crate) static DAMPINGS: [Damping; 2] = [
    Damping {
        ratio: 0.0,
        title: "undamped: x″ = -ω² x",
    },
    Damping {
        ratio: 0.5,
        title: "damped: x″ = -ω² x - ω x′",
    },
];

/// What becomes of the oscillator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// It dies out.
    Stable,
    /// It goes on as it is.
    Marginal,
    /// It grows, or cannot be stepped.
    Unstable,
}

impl Class {
    pub(crate) const ALL: [Class; 3] = [Class::Stable, Class::Marginal, Class::Unstable];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Class::Stable => "stable",
            Class::Marginal => "marginal",
            Class::Unstable => "unstable",
        }
    }
}

/// A method on one oscillator.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) method: &'static Method,
    pub(crate) damping: &'static Damping,
    /// Steps `z` from short to long, and what each does.
    pub(crate) cells: Vec<(f64, Class)>,
    /// The step up to which none was unstable, to a thousandth: 0 if the shortest was, infinite
    /// if none was.
    pub(crate) measured: f64,
    /// What the eigenvalues of a step say.
    pub(crate) theory: f64,
}

/// Shortest and longest step tried, as powers of ten.
const DECADES: [i32; 2] = [-2, 2];

/// Growth or decay by this factor within half of the steps is not rounding.
const CHANGE: f64 = 1.01;

/// What has shrunk to this has died out: below it tolerances and the smallest numbers are seen.
const DEAD: f64 = 1e-6;

/// Where limits are: from here to there they are looked for in steps of a few thousandths, as
/// methods of many stages first leave stability in narrow windows.
const SEARCHED: [f64; 2] = [0.5, 12.0];

pub(crate) fn measure(scope: Scope) -> Vec<Row> {
    let rows = METHODS.into_iter().flat_map(|method| {
        let row = move |damping| row(method, damping, scope);
        DAMPINGS.iter().map(row)
    });
    rows.collect()
}

fn row(method: &'static Method, damping: &'static Damping, scope: Scope) -> Row {
    // Adaptive methods take many steps within a long one; a tenth of them tells as much.
    let steps = scope.growth_steps() / if method.adaptive { 10 } else { 1 };
    let classify = |z: f64| class(method, damping.ratio, z, steps);
    let [from, to] = DECADES.map(|d| d * scope.columns_per_decade());
    let z = |column: i32| 10f64.powf(f64::from(column) / f64::from(scope.columns_per_decade()));
    let cells: Vec<(f64, Class)> = (from..=to).map(z).map(|z| (z, classify(z))).collect();
    let measured = match method.adaptive {
        true => first_unstable(cells.iter().map(|cell| cell.0), classify),
        false => first_unstable(steps_to_try(&cells, scope), classify),
    };
    Row {
        method,
        damping,
        cells,
        measured,
        theory: method.stable_dt(1.0, 2.0 * damping.ratio),
    }
}

/// The columns of the map, and many between.
fn steps_to_try(cells: &[(f64, Class)], scope: Scope) -> impl Iterator<Item = f64> {
    let [from, to] = SEARCHED;
    let columns = || cells.iter().map(|cell| cell.0);
    let before: Vec<f64> = columns().filter(|&z| z < from).collect();
    let after: Vec<f64> = columns().filter(|&z| z > to).collect();
    let factor = scope.search_factor();
    let between = std::iter::successors(Some(from), move |z| Some(z * factor));
    before
        .into_iter()
        .chain(between.take_while(move |&z| z <= to))
        .chain(after)
}

/// The step up to which none was unstable.
fn first_unstable(steps: impl Iterator<Item = f64>, classify: impl Fn(f64) -> Class) -> f64 {
    let mut last = None;
    for z in steps {
        if classify(z) == Class::Unstable {
            return last.map_or(0.0, |last| between(last, z, classify));
        }
        last = Some(z);
    }
    f64::INFINITY
}

/// Where stability ends between a step that is stable and one that is not.
fn between(mut stable: f64, mut unstable: f64, classify: impl Fn(f64) -> Class) -> f64 {
    while unstable / stable > 1.0005 {
        let middle = (stable * unstable).sqrt();
        match classify(middle) {
            Class::Unstable => unstable = middle,
            _ => stable = middle,
        }
    }
    stable
}

/// Compares the greatest size in the last tenth of the steps with that in the tenth before half.
fn class(method: &'static Method, damping: f64, z: f64, steps: u32) -> Class {
    let oscillator = Oscillator { damping };
    let Some(size) = size(method, &oscillator, z) else {
        return Class::Unstable;
    };
    let mut stepper = Stepper::new(method, &[DVec3::X], &[DVec3::ZERO]);
    let (half, tenth) = (steps / 2, steps / 10);
    let (mut before, mut after) = (0.0f64, 0.0f64);
    for step in 0..steps {
        if stepper.step(&oscillator, z).is_err() {
            return Class::Unstable;
        }
        let size = size.of(&stepper);
        if size.is_nan() || size > 1e100 {
            return Class::Unstable;
        }
        if (half - tenth..half).contains(&step) {
            before = before.max(size);
        }
        if step >= steps - tenth {
            after = after.max(size);
        }
    }
    if after < DEAD || after * CHANGE < before {
        Class::Stable
    } else if after > CHANGE * before {
        Class::Unstable
    } else {
        Class::Marginal
    }
}

/// How large a motion is: `√(p x² + q x v + r v²)`.
///
/// With the square of `x` and of `v` alone a motion that turns on an ellipse would seem to grow
/// where its steps fall on the same few places for long. A step `(a b; c d)` with complex
/// eigenvalues multiplies `c x² + (d - a) x v - b v²` by its determinant and turns nothing else.
struct Size {
    p: f64,
    q: f64,
    r: f64,
}

impl Size {
    fn of(&self, stepper: &Stepper) -> f64 {
        let (x, v) = (stepper.position()[0].x, stepper.velocity()[0].x);
        (self.p * x * x + self.q * x * v + self.r * v * v).sqrt()
    }
}

/// The size that a step scales; with real eigenvalues or a step that varies, the plain one.
fn size(method: &'static Method, oscillator: &Oscillator, z: f64) -> Option<Size> {
    let step = |x: f64, v: f64| {
        let mut stepper = Stepper::new(method, &[x * DVec3::X], &[v * DVec3::X]);
        let done = stepper.step(oscillator, z);
        done.ok()
            .map(|()| [stepper.position()[0].x, stepper.velocity()[0].x])
    };
    let ([a, c], [b, d]) = (step(1.0, 0.0)?, step(0.0, 1.0)?);
    let definite = (d - a) * (d - a) + 4.0 * b * c < 0.0;
    let plain = Size {
        p: 1.0,
        q: 0.0,
        r: 1.0,
    };
    Some(match definite && !method.adaptive {
        // In units in which it is 1 at the start.
        true => Size {
            p: 1.0,
            q: (d - a) / c,
            r: -b / c,
        },
        false => plain,
    })
}

struct Oscillator {
    damping: f64,
}

impl System for Oscillator {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn depends_on_velocity(&self) -> bool {
        self.damping != 0.0
    }

    fn accelerations(&self, _: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        a[0] = -x[0] - 2.0 * self.damping * v[0];
    }

    fn jacobians(&self, _: f64, _: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        out[0] = Jacobians {
            position: -DMat3::IDENTITY,
            velocity: DMat3::from_diagonal(DVec3::splat(-2.0 * self.damping)),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(name: &str, damping: usize) -> f64 {
        let method = Method::named(name).expect("a method");
        row(method, &DAMPINGS[damping], Scope::Full).measured
    }

    /// Limits from the eigenvalues of a step, worked out by hand: `|1 - z²| ≤ 1`-like conditions.
    #[test]
    fn stepping_finds_the_limits_of_theory() {
        assert_eq!(limit("forward-euler", 0), 0.0);
        assert!((limit("forward-euler", 1) - 1.0).abs() < 2e-3);
        assert!((limit("symplectic-euler", 0) - 2.0).abs() < 2e-3);
        assert!((limit("symplectic-euler", 1) - (5f64.sqrt() - 1.0)).abs() < 2e-3);
        assert!((limit("rk4", 0) - 8f64.sqrt()).abs() < 3e-3);
        assert_eq!(limit("backward-euler", 0), f64::INFINITY);
        // A window that is 1 % wide.
        let kahan_li = Method::named("symplectic-8").expect("a method");
        let theory = kahan_li.stable_dt(1.0, 0.0);
        assert!((limit("symplectic-8", 0) / theory - 1.0).abs() < 2e-3);
    }
}
