//! Hard cases with known outcomes: figure, tolerance, verdict, and why.
//!
//! A case is a line in [`CASES`], one that is measured also a file here.

mod ballistic;
mod clock;
mod input;
mod kepler;
mod order;
mod oscillator;
mod pleiades;
mod stiff_linear;
mod stiff_spring;
mod worlds;

use sim_core::{METHODS, Method};

use crate::drift::Drift;
use crate::runs::Diagram;

/// A case and who is tried on it.
pub(crate) struct Case {
    pub(crate) number: u8,
    pub(crate) title: &'static str,
    /// What must come out, and how exactly.
    pub(crate) outcome: &'static str,
    test: Test,
}

enum Test {
    /// Each method for itself.
    Methods(fn(&'static Method, &Measured<'_>) -> Finding),
    /// Something that is the same for all of them.
    Once(fn() -> Finding),
    /// Collisions, by issues to come.
    NotYet,
}

/// What other parts of the report have found already.
pub(crate) struct Measured<'a> {
    pub(crate) diagrams: &'a [Diagram],
    pub(crate) drifts: &'a [Drift],
}

/// What came out.
#[derive(Clone, Debug)]
pub(crate) struct Finding {
    /// The number that decides, in the unit of the tolerance.
    pub(crate) figure: Option<f64>,
    /// The largest figure that passes.
    pub(crate) tolerance: Option<f64>,
    pub(crate) verdict: Verdict,
    pub(crate) why: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Pass,
    Fail,
    /// The case asks for what this method does not claim.
    DoesNotApply,
    NotMeasured,
}

impl Verdict {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Verdict::Pass => "pass",
            Verdict::Fail => "FAIL",
            Verdict::DoesNotApply => "does not apply",
            Verdict::NotMeasured => "not yet measured",
        }
    }
}

impl Finding {
    /// Passes if the figure is within the tolerance.
    fn within(figure: f64, tolerance: f64, why: impl Into<String>) -> Finding {
        let verdict = match figure <= tolerance {
            true => Verdict::Pass,
            false => Verdict::Fail,
        };
        Finding {
            figure: Some(figure),
            tolerance: Some(tolerance),
            verdict,
            why: why.into(),
        }
    }

    fn failed(why: impl Into<String>) -> Finding {
        Finding {
            figure: None,
            tolerance: None,
            verdict: Verdict::Fail,
            why: why.into(),
        }
    }

    fn does_not_apply(why: impl Into<String>) -> Finding {
        Finding {
            verdict: Verdict::DoesNotApply,
            ..Finding::failed(why)
        }
    }
}

/// A case by a method, or by all at once.
pub(crate) struct Outcome {
    pub(crate) case: &'static Case,
    /// `None`: it does not depend on the method.
    pub(crate) method: Option<&'static Method>,
    pub(crate) finding: Finding,
}

/// Tries all cases.
pub(crate) fn measure(measured: &Measured<'_>) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    for case in &CASES {
        let mut add = |method, finding| {
            outcomes.push(Outcome {
                case,
                method,
                finding,
            });
        };
        match case.test {
            Test::Methods(test) => {
                for method in METHODS {
                    add(Some(method), test(method, measured));
                }
            }
            Test::Once(test) => add(None, test()),
            Test::NotYet => {
                let finding = Finding::failed("collisions are measured by the benchmarks so far");
                let verdict = Verdict::NotMeasured;
                add(None, Finding { verdict, ..finding });
            }
        }
    }
    outcomes
}

const fn case(number: u8, title: &'static str, outcome: &'static str, test: Test) -> Case {
    Case {
        number,
        title,
        outcome,
        test,
    }
}

pub(crate) static CASES: [Case; 29] = [
    case(
        1,
        "ballistic",
        "x″ = (0, -1) for 4 s, at 5, 30, 60 and 240 Hz: the end is off by (2 - 4 f) dt, with the \
         method's own f (0 forward, 1 backward and symplectic Euler, 1/2 all others), and by \
         nothing else",
        Test::Methods(ballistic::test),
    ),
    case(
        2,
        "order of convergence",
        "the slope of error over dt is the order, on an oscillator, on drag and on Kepler e = \
         0.6, to 0.05; to half an order above the fourth, where rounding leaves no shorter steps. \
         Figure: the worst difference. Adaptive methods are held to one step per dt",
        Test::Methods(order::test),
    ),
    case(
        3,
        "oscillator, 1,000 periods",
        "the amplitude is that of the method's discrete solution, relative; symplectic methods \
         keep a quadratic form of their own. Adaptive methods: the end, at tolerance 1e-13",
        Test::Methods(oscillator::test),
    ),
    case(
        4,
        "stiff damped spring",
        "x″ = -10⁶ x - 10³ x′ - 9.81. Stable at every step: at rest at -9.81e-6 m after 10 s at \
         60 Hz, relative. Otherwise: bounded at 0.99 of the largest stable dt, and reported at \
         1.01 with that dt; figure: the reported dt's relative error",
        Test::Methods(stiff_spring::test),
    ),
    case(
        5,
        "stiff linear",
        "y′ = A y, eigenvalues -1 and -10⁶, for 1 s at dt = 0.01. Stable there: the method's own \
         discrete solution where it is known in closed form, else (1/e, 1/e). Otherwise: \
         reported, with the largest stable dt where theory names it",
        Test::Methods(stiff_linear::test),
    ),
    case(
        6,
        "Kepler, 100 orbits",
        "e = 0.6 at 1,000 steps an orbit. Symplectic: the energy error has no slope over the \
         orbits, to 1e-14 or a millionth of itself; all others: it stays below the tolerance",
        Test::Methods(kepler::test),
    ),
    case(
        7,
        "Pleiades, T = 3",
        "14 end positions as published; figure: the least error of the work-precision diagram, \
         whose sweeps end with the first run that takes a tenth of a second",
        Test::Methods(pleiades::test),
    ),
    case(
        8,
        "accumulator",
        "steps taken are floor(total / dt) over a million frames; a stall is capped and reported; \
         a step that is none is refused; figure: what is wrong",
        Test::Once(clock::test),
    ),
    case(
        9,
        "head-on pair",
        "exact exchange, 16 of 16 phases",
        Test::NotYet,
    ),
    case(10, "both bodies fast", "a bounce", Test::NotYet),
    case(
        11,
        "cube and cow, cow and cow",
        "momentum, energy, time of impact",
        Test::NotYet,
    ),
    case(
        12,
        "concavity",
        "a peg passes its channel untouched",
        Test::NotYet,
    ),
    case(
        13,
        "thin wall",
        "the velocity is turned round",
        Test::NotYet,
    ),
    case(
        14,
        "mass ratio 1 to 10¹²",
        "the two-body formula",
        Test::NotYet,
    ),
    case(
        15,
        "Galperin's blocks",
        "floor(π 10^k) impacts",
        Test::NotYet,
    ),
    case(16, "closing walls", "v = 10 + 2 n", Test::NotYet),
    case(
        17,
        "Newton's cradle",
        "only the last ball leaves",
        Test::NotYet,
    ),
    case(
        18,
        "bouncing ball, e = 0.8",
        "6 bounces by 3 s",
        Test::NotYet,
    ),
    case(
        19,
        "bouncing ball, e = 1",
        "111 bounces by 100 s",
        Test::NotYet,
    ),
    case(
        20,
        "symmetries",
        "scaled, mirrored, reordered, reversed",
        Test::NotYet,
    ),
    case(21, "far from the origin", "as at the origin", Test::NotYet),
    case(22, "grazing", "decided exactly", Test::NotYet),
    case(23, "start in overlap", "no energy added", Test::NotYet),
    case(24, "rollback", "positions as before the step", Test::NotYet),
    case(25, "independence of dt", "the same impacts", Test::NotYet),
    case(
        26,
        "100 cubes in a box",
        "energy constant, none outside",
        Test::NotYet,
    ),
    case(27, "resting contact", "does not move", Test::NotYet),
    case(
        28,
        "bad input",
        "NaN, infinity, masses and steps that are none, broken meshes: an error that names the \
         field, and the world as it was; figure: inputs of which that is not true",
        Test::Once(input::test),
    ),
    case(29, "determinism", "the same bits", Test::NotYet),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_numbered_without_a_gap() {
        let numbers: Vec<u8> = CASES.iter().map(|case| case.number).collect();
        assert_eq!(numbers, (1..=29).collect::<Vec<u8>>());
    }

    #[test]
    fn a_figure_that_is_no_number_does_not_pass() {
        assert_eq!(Finding::within(f64::NAN, 1.0, "").verdict, Verdict::Fail);
        assert_eq!(Finding::within(1.0, 1.0, "").verdict, Verdict::Pass);
    }
}
