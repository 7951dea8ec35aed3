//! Sweeps of step length and tolerance: what each run has cost and reached.

use cases::problems::{Card, Effort, End, Solve};
use cases::solvers::{SOLVERS, Solver};
use sim_core::{METHODS, Method};

use crate::scope::Scope;
use crate::stopwatch;

/// Who has solved a problem.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Who {
    Method(&'static Method),
    Solver(&'static Solver),
}

impl Who {
    /// Everybody, the methods first.
    pub(crate) fn all() -> impl Iterator<Item = Who> {
        let methods = METHODS.into_iter().map(Who::Method);
        methods.chain(SOLVERS.iter().map(Who::Solver))
    }

    /// Name in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Who::Method(method) => method.name,
            Who::Solver(solver) => solver.name,
        }
    }
}

/// All that has been tried with one problem.
#[derive(Debug)]
pub(crate) struct Diagram {
    pub(crate) card: Card,
    pub(crate) series: Vec<Series>,
}

/// The runs of one of them, from cheap to dear.
#[derive(Debug)]
pub(crate) struct Series {
    pub(crate) who: Who,
    pub(crate) runs: Vec<Run>,
    /// Why dearer runs were not tried.
    pub(crate) ended: &'static str,
}

#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) effort: Effort,
    pub(crate) outcome: Result<Point, String>,
}

/// A run that succeeded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) error: f64,
    /// Time of one run, s.
    pub(crate) seconds: f64,
    pub(crate) evaluations: u64,
    pub(crate) jacobians: u64,
}

impl Series {
    pub(crate) fn points(&self) -> impl Iterator<Item = Point> {
        self.runs.iter().filter_map(|run| run.outcome.clone().ok())
    }
}

impl Diagram {
    pub(crate) fn by_name(&self, name: &str) -> Option<&Series> {
        self.series.iter().find(|series| series.who.name() == name)
    }
}

/// An error from which on nothing of the answer, of size 1, is left.
const LARGEST_ERROR: f64 = 1.0;

/// An error below which more steps may not help any more.
const ROUNDING: f64 = 1e-9;

/// Sweeps everybody over a problem, without times that mean anything yet.
pub(crate) fn diagram(problem: &dyn Solve, scope: Scope) -> Diagram {
    Diagram {
        card: problem.card().clone(),
        series: Who::all().map(|who| sweep(problem, who, scope)).collect(),
    }
}

fn solve(problem: &dyn Solve, who: Who, effort: Effort, count: bool) -> Result<End, String> {
    match (who, effort) {
        (Who::Method(method), _) => problem.by_method(method, effort, count),
        (Who::Solver(solver), Effort::Tolerance(tolerance)) => problem.by_solver(solver, tolerance),
        (Who::Solver(_), Effort::Steps(_)) => Err("it chooses its steps".into()),
    }
}

/// Times all runs that have succeeded: repeats all of them in turn, and again. What else the
/// machine does for a while then slows one sample of many runs, not all samples of one.
pub(crate) fn time(
    problems: &[Box<dyn Solve>],
    diagrams: &mut [Diagram],
    scope: Scope,
    mut progress: impl FnMut(usize),
) {
    let mut timed: Vec<(&dyn Solve, Who, &mut Run, Vec<f64>)> = Vec::new();
    for (problem, diagram) in problems.iter().zip(diagrams) {
        for series in &mut diagram.series {
            let who = series.who;
            let succeeded = series.runs.iter_mut().filter(|run| run.outcome.is_ok());
            timed.extend(succeeded.map(|run| (problem.as_ref(), who, run, Vec::new())));
        }
    }
    for pass in 0..scope.repeats() {
        progress(pass + 1);
        for (problem, who, run, samples) in &mut timed {
            let rough = run.outcome.as_ref().map_or(0.0, |point| point.seconds);
            let solve = || solve(*problem, *who, run.effort, false);
            samples.push(stopwatch::sample(rough, solve));
        }
    }
    for (.., run, mut samples) in timed {
        if let Ok(point) = &mut run.outcome {
            point.seconds = stopwatch::middle(&mut samples);
        }
    }
}

fn tolerances(scope: Scope) -> Vec<Effort> {
    let exponents = scope.tolerance_exponents();
    exponents
        .map(|n| Effort::Tolerance(10f64.powi(-n)))
        .collect()
}

fn step_counts(card: &Card, scope: Scope) -> Vec<Effort> {
    let [fewest, most] = card.steps;
    let counts = std::iter::successors(Some(fewest), |n| Some(n * scope.step_factor()));
    counts
        .take_while(|&n| n <= most)
        .map(Effort::Steps)
        .collect()
}

fn sweep(problem: &dyn Solve, who: Who, scope: Scope) -> Series {
    let efforts = match who {
        Who::Method(method) if !method.adaptive => step_counts(problem.card(), scope),
        _ => tolerances(scope),
    };
    let mut runs: Vec<Run> = Vec::new();
    let mut ended = "the sweep is complete";
    let mut last_error = f64::INFINITY;
    for effort in efforts {
        let (end, cost) = stopwatch::timed(|| solve(problem, who, effort, true));
        let end = end.and_then(refuse_nonsense);
        let outcome = end.map(|end| Point {
            error: end.error,
            seconds: cost,
            evaluations: end.evaluations,
            jacobians: end.jacobians,
        });
        let error = outcome.as_ref().map_or(f64::INFINITY, |point| point.error);
        runs.push(Run { effort, outcome });
        if cost > scope.dearest_run() {
            ended = "the next run would take too long";
            break;
        }
        if error < ROUNDING && error > 0.7 * last_error {
            ended = "rounding is reached";
            break;
        }
        last_error = error;
    }
    Series { who, runs, ended }
}

fn refuse_nonsense(end: End) -> Result<End, String> {
    match end.error {
        error if error < LARGEST_ERROR => Ok(end),
        error if error.is_finite() => {
            Err(format!("nothing of the answer is left: error {error:.1e}"))
        }
        _ => Err("beyond all numbers".into()),
    }
}
