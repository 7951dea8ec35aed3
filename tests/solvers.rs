//! The solvers that control their error, beside `ode_solvers`.

use std::hint::black_box;
use std::time::{Duration, Instant};

use kit::problems::{kepler, pleiades};
use ode_solvers::SVector;
use sim_core::ode::{Dop853Stages, Dopri5Stages, Pair, Solver};
use sim_core::{Dop853, Dopri5, SolveError, Tolerance};

/// What a solve has cost and reached.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    error: f64,
    evaluations: u64,
    time: Duration,
}

/// A problem `y' = f(y)` with the first `M` components of its solution at the end.
struct Problem<const N: usize> {
    name: &'static str,
    slope: fn(&[f64; N], &mut [f64; N]),
    start: [f64; N],
    time: f64,
    end: Vec<f64>,
}

impl<const N: usize> Problem<N> {
    fn error(&self, y: &[f64]) -> f64 {
        let pairs = self.end.iter().zip(y);
        pairs.map(|(end, y)| (end - y).abs()).fold(0.0, f64::max)
    }
}

#[derive(Clone, Copy)]
struct Peer<const N: usize>(fn(&[f64; N], &mut [f64; N]));

impl<const N: usize> ode_solvers::System<f64, SVector<f64, N>> for Peer<N> {
    fn system(&self, _: f64, y: &SVector<f64, N>, dy: &mut SVector<f64, N>) {
        (self.0)(&y.data.0[0], &mut dy.data.0[0]);
    }
}

/// The best of some runs, as other processes disturb the rest.
fn best(runs: u32, mut run: impl FnMut() -> Outcome) -> Outcome {
    let first = run();
    (1..runs).fold(first, |best, _| {
        let again = run();
        if again.time < best.time { again } else { best }
    })
}

fn ours<P: Pair<[f64; N]>, const N: usize>(problem: &Problem<N>, tolerance: f64) -> Outcome {
    let clock = Instant::now();
    let slope = problem.slope;
    let f = |_: f64, y: &_, dy: &mut _| slope(y, dy);
    let start = black_box(problem.start);
    let mut solver = Solver::<P, _, _>::new(f, 0.0, start, Tolerance::of(tolerance));
    solver.advance(problem.time).expect("a solution");
    Outcome {
        time: clock.elapsed(),
        error: problem.error(solver.state()),
        evaluations: solver.evaluations(),
    }
}

/// The same with a solver of `ode_solvers`, its settings being Hairer's as ours are.
macro_rules! theirs {
    ($solver:ident, $beta:expr, $least:expr, $greatest:expr, $problem:expr, $tolerance:expr) => {{
        let clock = Instant::now();
        let (problem, tolerance) = ($problem, $tolerance);
        let start = SVector::from(black_box(problem.start));
        let mut solver = ode_solvers::$solver::from_param(
            Peer(problem.slope),
            0.0,
            problem.time,
            0.0,
            start,
            tolerance,
            tolerance,
            0.9,
            $beta,
            $least,
            $greatest,
            problem.time,
            0.0,
            100_000_000,
            u32::MAX,
            ode_solvers::dop_shared::OutputType::Sparse,
        );
        let stats = solver.integrate().expect("a solution");
        Outcome {
            time: clock.elapsed(),
            error: problem.error(solver.y_out().last().expect("an end").as_slice()),
            evaluations: u64::from(stats.num_eval),
        }
    }};
}

fn compare<const N: usize>(problem: &Problem<N>, tolerance: f64) {
    let runs = 9;
    let dopri5 = (
        best(runs, || ours::<Dopri5Stages<_>, N>(problem, tolerance)),
        best(runs, || {
            theirs!(Dopri5, 0.04, 0.2, 10.0, problem, tolerance)
        }),
    );
    let dop853 = (
        best(runs, || ours::<Dop853Stages<_>, N>(problem, tolerance)),
        best(runs, || {
            theirs!(Dop853, 0.0, 0.333, 6.0, problem, tolerance)
        }),
    );
    for (name, (ours, theirs)) in [("Dopri5", dopri5), ("Dop853", dop853)] {
        println!(
            "{:<10} {name} {tolerance:.0e}  error {:.2e} / {:.2e}  evaluations {} / {}  \
             time {:.1?} / {:.1?} = {:.2}",
            problem.name,
            ours.error,
            theirs.error,
            ours.evaluations,
            theirs.evaluations,
            ours.time,
            theirs.time,
            ours.time.as_secs_f64() / theirs.time.as_secs_f64()
        );
        // The same method with the same control takes the same steps, but for rounding.
        let ratio = ours.evaluations as f64 / theirs.evaluations as f64;
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
        assert!(
            ours.error < 1.2 * theirs.error + 1e-12,
            "{ours:?} {theirs:?}"
        );
    }
}

fn kepler(eccentricity: f64) -> Problem<4> {
    let start = kepler::start(eccentricity);
    Problem {
        name: if eccentricity == 0.6 {
            "kepler 0.6"
        } else {
            "kepler 0.9"
        },
        slope: kepler_slope,
        start,
        time: 200.0 * std::f64::consts::PI,
        end: start.to_vec(),
    }
}

fn kepler_slope(y: &[f64; 4], dy: &mut [f64; 4]) {
    let squared = y[0] * y[0] + y[1] * y[1];
    let inverse = 1.0 / (squared * squared.sqrt());
    *dy = [y[2], y[3], -y[0] * inverse, -y[1] * inverse];
}

fn pleiades() -> Problem<{ pleiades::N }> {
    Problem {
        name: "pleiades",
        slope: pleiades::slope,
        start: pleiades::START,
        time: 3.0,
        end: pleiades::END.to_vec(),
    }
}

/// Ours before theirs. The times are for a release build:
/// `cargo test --release -p tests --test solvers -- --nocapture`.
#[test]
fn the_same_evaluations_and_error_as_ode_solvers() {
    for tolerance in [1e-6, 1e-8, 1e-10, 1e-12] {
        compare(&kepler(0.6), tolerance);
        compare(&kepler(0.9), tolerance);
        compare(&pleiades(), tolerance);
    }
}

#[test]
fn dense_output_has_its_order_between_the_steps() {
    fn error<P: Pair<[f64; 2]>>(h: f64) -> f64 {
        let f = |t: f64, y: &[f64; 2], dy: &mut [f64; 2]| *dy = [y[1], -y[0] + 0.0 * t];
        let mut solver = Solver::<P, _, _>::new(f, 0.0, [1.0, 0.0], Tolerance::of(1e3));
        let (mut y, mut worst) = ([0.0; 2], 0f64);
        while solver.time() < 2.0 {
            let from = solver.time();
            solver.try_step(h);
            solver.step(10.0).expect("a step");
            for part in [0.0, 0.2, 0.5, 0.7, 1.0] {
                let t = from + part * h;
                solver.at(t, &mut y);
                worst = worst
                    .max((y[0] - t.cos()).abs())
                    .max((y[1] + t.sin()).abs());
            }
        }
        worst
    }
    // In each step a polynomial of order p leaves h^(p+1).
    let order = |coarse: f64, fine: f64| (coarse / fine).log2();
    let dopri5 = order(
        error::<Dopri5Stages<_>>(0.1),
        error::<Dopri5Stages<_>>(0.05),
    );
    let dop853 = order(
        error::<Dop853Stages<_>>(0.5),
        error::<Dop853Stages<_>>(0.25),
    );
    println!("dense output: {dopri5:.2}, {dop853:.2}");
    assert!(
        (dopri5 - 5.0).abs() < 0.2 && dop853 > 7.7,
        "{dopri5} {dop853}"
    );
}

#[test]
fn steps_have_the_order_of_their_method() {
    fn error<P: Pair<[f64; 2]>>(steps: u32) -> f64 {
        // y = (1 + t/2) cos t: the time enters beside the state.
        let f = |t: f64, y: &[f64; 2], dy: &mut [f64; 2]| *dy = [y[1], -y[0] - t.sin()];
        let mut solver = Solver::<P, _, _>::new(f, 0.0, [1.0, 0.5], Tolerance::of(1e3));
        for i in 1..=steps {
            let end = 2.0 * f64::from(i) / f64::from(steps);
            solver.try_step(2.0 / f64::from(steps));
            solver.step(end).expect("a step");
        }
        let [y, dy] = *solver.state();
        let (sin, cos) = 2f64.sin_cos();
        (y - 2.0 * cos).abs() + (dy - (0.5 * cos - 2.0 * sin)).abs()
    }
    let order = |coarse: f64, fine: f64| (coarse / fine).log2();
    let dopri5 = order(error::<Dopri5Stages<_>>(64), error::<Dopri5Stages<_>>(128));
    let dop853 = order(error::<Dop853Stages<_>>(4), error::<Dop853Stages<_>>(8));
    println!("orders: {dopri5:.3}, {dop853:.3}");
    assert!((dopri5 - 5.0).abs() < 0.05, "{dopri5}");
    assert!((dop853 - 8.0).abs() < 0.05, "{dop853}");
}

#[test]
fn solvers_go_back_and_stop_with_a_reason() {
    let growth = |_: f64, y: &[f64; 1], dy: &mut [f64; 1]| *dy = [y[0] * y[0]];
    let mut solver = Dop853::new(growth, 0.0, [1.0], Tolerance::of(1e-10));
    solver.advance(0.5).expect("a solution");
    assert!((solver.state()[0] - 2.0).abs() < 1e-8);
    solver.advance(-1.0).expect("a solution");
    assert!((solver.state()[0] - 0.5).abs() < 1e-8);
    // y = 1/(1 - t) ends at t = 1.
    let failure = solver.advance(2.0).expect_err("there is no solution");
    assert!(
        matches!(failure, SolveError::StepTooSmall { .. }),
        "{failure}"
    );
    assert!((solver.time() - 1.0).abs() < 1e-6);
    let mut solver = Dopri5::new(growth, 0.0, [1.0], Tolerance::of(1e-10));
    solver.most_steps = 3;
    let failure = solver.advance(0.9).expect_err("three steps are too few");
    assert!(matches!(failure, SolveError::TooManySteps { steps: 3, .. }));
}
