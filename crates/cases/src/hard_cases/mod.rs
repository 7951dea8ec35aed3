//! Hard cases with known outcomes: figure, tolerance, verdict, and why.
//!
//! A case is a file here and a row in [`CASES`], which lists the methods that fail it; every other method must pass.

mod ballistic;
mod clock;
mod impacts;
mod input;
mod kepler;
mod order;
pub mod oscillator;
mod pleiades;
mod stiff_linear;
pub mod stiff_spring;

use std::num::NonZero;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use sim_core::{METHODS, Method};

pub use impacts::{balls, chains, meshes, symmetry};

/// A case, the methods tried on it, and the expected outcome.
pub struct Case {
    /// The number, from 1, without gaps.
    pub number: u8,
    /// Name in tables.
    pub title: &'static str,
    /// The expected outcome and its tolerance.
    pub outcome: &'static str,
    /// Names of the methods that fail; all others pass.
    fails: &'static [&'static str],
    /// Names of the methods to which the case does not apply.
    spares: &'static [&'static str],
    test: Test,
}

/// The finding of a case, or the error that stopped it.
type Tried = anyhow::Result<Finding>;

enum Test {
    /// Each method is tried.
    Methods(fn(&'static Method) -> Tried),
    /// The case is the same for all methods.
    Once(fn() -> Tried),
}

/// The result of a case.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The figure that decides, in the unit of the tolerance.
    pub figure: Option<f64>,
    /// The largest figure that passes.
    pub tolerance: Option<f64>,
    /// The verdict.
    pub verdict: Verdict,
    /// An explanation.
    pub why: String,
}

/// The verdict on a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The figure is within the tolerance.
    Pass,
    /// The figure is not within the tolerance, or there is none.
    Fail,
    /// The case requires a property that the method does not claim.
    DoesNotApply,
}

impl Verdict {
    /// The verdict of a test.
    pub(crate) fn of(passes: bool) -> Verdict {
        match passes {
            true => Verdict::Pass,
            false => Verdict::Fail,
        }
    }

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Pass => "pass",
            Verdict::Fail => "FAIL",
            Verdict::DoesNotApply => "does not apply",
        }
    }
}

impl Finding {
    /// Passes if the figure is within the tolerance.
    fn within(figure: f64, tolerance: f64, why: impl Into<String>) -> Finding {
        let verdict = Verdict::of(figure <= tolerance);
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

/// The result of a case for one method, or for all together.
pub struct Outcome {
    /// The case.
    pub case: &'static Case,
    /// The method; `None` if the case does not depend on it.
    pub method: Option<&'static Method>,
    /// The result.
    pub finding: Finding,
}

impl Outcome {
    /// Whether the verdict is the one in the case's row.
    pub fn is_expected(&self) -> bool {
        self.finding.verdict == self.case.expected(self.method)
    }
}

impl Case {
    /// The methods to try: each one, or `None` once for all.
    pub fn methods(&self) -> impl Iterator<Item = Option<&'static Method>> + use<> {
        let is_each = matches!(self.test, Test::Methods(_));
        let methods = METHODS.into_iter().filter(move |_| is_each).map(Some);
        methods.chain((!is_each).then_some(None))
    }

    /// Tries the case, with a method if it depends on one.
    pub fn attempt(&'static self, method: Option<&'static Method>) -> Outcome {
        let tried = match (&self.test, method) {
            (Test::Methods(test), Some(method)) => test(method),
            (Test::Once(test), None) => test(),
            _ => Ok(Finding::does_not_apply("it is tried in another way")),
        };
        Outcome {
            case: self,
            method,
            finding: tried.unwrap_or_else(|error| Finding::failed(error.to_string())),
        }
    }

    /// The expected verdict.
    pub fn expected(&self, method: Option<&'static Method>) -> Verdict {
        let is_in = |names: &[&str]| method.is_some_and(|method| names.contains(&method.name));
        match (is_in(self.fails), is_in(self.spares)) {
            (true, _) => Verdict::Fail,
            (_, true) => Verdict::DoesNotApply,
            _ => Verdict::Pass,
        }
    }
}

/// Tries all cases with all methods, on all processors; the results are in order.
pub fn attempt_all() -> Vec<Outcome> {
    let tasks: Vec<(&'static Case, Option<&'static Method>)> = CASES
        .iter()
        .flat_map(|case| case.methods().map(move |method| (case, method)))
        .collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(&(case, method)) = tasks.get(index) else {
                return done;
            };
            done.push((index, case.attempt(method)));
        }
    };
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let mut outcomes: Vec<(usize, Outcome)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let outcomes = workers.into_iter().map(|worker| worker.join());
        outcomes
            .flat_map(|outcomes| outcomes.unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    });
    outcomes.sort_by_key(|&(index, _)| index);
    outcomes.into_iter().map(|(_, outcome)| outcome).collect()
}

const fn case(number: u8, title: &'static str, outcome: &'static str, test: Test) -> Case {
    Case {
        number,
        title,
        outcome,
        fails: &[],
        spares: &[],
        test,
    }
}

impl Case {
    const fn failed_by(mut self, methods: &'static [&'static str]) -> Case {
        self.fails = methods;
        self
    }

    const fn sparing(mut self, methods: &'static [&'static str]) -> Case {
        self.spares = methods;
        self
    }
}

/// The methods that are not exact in flight.
const FIRST_ORDER: &[&str] = &["forward-euler", "backward-euler", "symplectic-euler"];

/// All cases, by number.
pub static CASES: [Case; 29] = [
    case(
        1,
        "ballistic",
        "x″ = (0, -1) for 4 s, at 5, 30, 60 and 240 Hz: the end is off by (2 - 4 f) dt, with the \
         method's own f (0 forward, 1 backward and symplectic Euler, 1/2 all others), and by \
         nothing else, whether a constant force, gravity or the method's own step makes it fall; figure: what is left, in parts of 1e-13 m and rounding",
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
    )
    .failed_by(&["symplectic-4", "symplectic-8"]),
    case(
        6,
        "Kepler, 100 orbits",
        "e = 0.6 at 1,000 steps an orbit. Symplectic: the energy error has no slope over the \
         orbits, to 1e-14 or a millionth of itself; all others: it stays below the tolerance",
        Test::Methods(kepler::test),
    )
    .failed_by(&["forward-euler", "backward-euler"]),
    case(
        7,
        "Pleiades, T = 3",
        "14 end positions as published; figure: the least error of a sweep of steps or tolerances \
         that ends with the first run of 200,000 evaluations, of which a product with the Jacobian is four",
        Test::Methods(pleiades::test),
    )
    .failed_by(&[
        "forward-euler",
        "backward-euler",
        "symplectic-euler",
        "rk4",
        "velocity-verlet",
        "implicit-midpoint",
        "symplectic-4",
        "radau5",
    ]),
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
        "cubes, spheres and points of equal masses, 1e-3 to 1e6 m/s, 16 phases of a step: velocities are exchanged to 4u, positions right to 1e-12 v dt and rounding; figure: the worst error in parts of that",
        Test::Once(impacts::pairs::head_on),
    ),
    case(
        10,
        "both bodies fast",
        "±200 m/s, down to cubes of 0.2 m, 16 phases: as before",
        Test::Once(impacts::pairs::both_fast),
    ),
    case(
        11,
        "cube and cow, cow and cow",
        "1 to 1,000 m/s, 16 phases, three directions: every impact found, its time to 1e-12, energy and momentum to 1e-14, never meeting; figure: the worst in parts of that",
        Test::Once(impacts::meshes::cube_and_cow),
    ),
    case(
        12,
        "concavity",
        "a peg passes its channel with a clearance of 1e-6 m, its velocity the same to the bit, and a wider one does not; figure: what goes wrong",
        Test::Once(impacts::meshes::concavity),
    ),
    case(
        13,
        "thin wall",
        "1e-3 to 1e6 m/s upon a half-space, a plate of 1 mm and a sheet, 16 phases: the velocity is turned round; figure as in the head-on pair",
        Test::Once(impacts::pairs::thin_wall),
    ),
    case(
        14,
        "mass ratio 1 to 10¹²",
        "the two-body formula, either body coming, 16 phases; figure as in the head-on pair",
        Test::Once(impacts::pairs::mass_ratio),
    ),
    case(
        15,
        "Galperin's blocks",
        "floor(π 10^k) impacts for k = 0 to 6 (5 in debug builds); energy to 3e-13, relative",
        Test::Once(impacts::chains::digits_of_pi),
    ),
    case(
        16,
        "closing walls",
        "2,627 hits by 0.9981 s, L v = 10 m²/s at each return, relative; then an error, not a hang",
        Test::Once(impacts::chains::walls),
    ),
    case(
        17,
        "Newton's cradle",
        "as many balls leave as arrive, at their speed; a symmetric break is its own mirror image",
        Test::Once(impacts::chains::newton),
    ),
    case(
        18,
        "bouncing ball, e = 0.8",
        "6 bounces and a height of 0.06870746096576577 m at 3 s; at rest at 10 s",
        Test::Methods(impacts::balls::damped),
    )
    .sparing(FIRST_ORDER),
    case(
        19,
        "bouncing ball, e = 1",
        "111 bounces and a height of 0.7215811544474912 m at 100 s",
        Test::Methods(impacts::balls::elastic),
    )
    .sparing(FIRST_ORDER),
    case(
        20,
        "symmetries",
        "scaled by powers of two and mirrored to the bit; bodies reordered, all moving and time reversed, in parts of what is allowed",
        Test::Once(impacts::symmetry::symmetries),
    ),
    case(
        21,
        "far from the origin",
        "as at the origin: velocities to the bit, positions to the rounding there and twice what bodies are kept apart by; figure: parts of 12 u of the distance",
        Test::Once(impacts::pairs::far_away),
    ),
    case(
        22,
        "grazing",
        "1e-12 m decide; ties are the same in every order of bodies; figure: what goes wrong",
        Test::Once(impacts::meshes::grazing),
    ),
    case(
        23,
        "start in overlap",
        "no energy is added in any step, to 4u, and what moves parts",
        Test::Once(impacts::meshes::overlap),
    ),
    case(
        24,
        "rollback",
        "discrete mode: after a step with a hit positions are those before it, to the bit",
        Test::Once(impacts::crowd::rollback),
    ),
    case(
        25,
        "independence of dt",
        "the same impacts in the same order, and the same end",
        Test::Once(impacts::symmetry::any_dt),
    ),
    case(
        26,
        "100 cubes in a box",
        "energy to 1e-15 by the root of impacts after 10 s and 1,000 s, none outside or in another",
        Test::Once(impacts::crowd::cubes),
    ),
    case(
        27,
        "resting contact",
        "an elastic cube on a floor under gravity does not move and gains no energy",
        Test::Methods(impacts::balls::resting),
    ),
    case(
        28,
        "bad input",
        "NaN, infinity, masses and steps that are none, broken meshes: an error that names the \
         field, and the world as it was; figure: inputs of which that is not true",
        Test::Once(input::test),
    ),
    case(
        29,
        "determinism",
        "the same bits in every run; figure: runs that differ",
        Test::Once(impacts::symmetry::same_bits),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exceptions_are_methods_that_are_tried() {
        for case in &CASES {
            for name in case.fails.iter().chain(case.spares) {
                let is_tried = case.methods().flatten().any(|method| method.name == *name);
                assert!(is_tried, "{}: {name}", case.title);
            }
        }
    }

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
