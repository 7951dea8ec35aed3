//! Compares naive and BVH on the running scene: the cost of one answer each way, measured on request.
//!
//! A naive answer can take seconds, so the session only describes the measurement ([`Trial`]) and accepts its result
//! later. If nothing has moved, nothing is measured again. After each measurement the next one waits for a time
//! proportional to its cost.

use std::time::Duration;

use sim_core::collide::{Placement, naive, tree};
use sim_core::{DMat3, DQuat, DVec3, World};

use super::Session;

/// The number of edge-triangle tests, a few nanoseconds each, above which the naive way is not measured.
const MOST_TESTS: u64 = 2_000_000_000;
/// A short answer is repeated until it fills this time, but no further.
const MEASURED: Duration = Duration::from_micros(100);
const MOST_ANSWERS: f64 = 10_000.0;
/// The number of such repetitions, and the time after which no further one starts.
const ROUNDS: usize = 7;
const PATIENCE: Duration = Duration::from_millis(500);
/// The least pause between two measurements, and the pause relative to the duration of a measurement.
const LEAST_REST: Duration = Duration::from_millis(200);
const REST: u32 = 3;

/// The cost of one answer in one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Pairs of boxes compared.
    pub boxes: u64,
    /// Tests of an edge with a triangle (naive), or of two triangles (BVH).
    pub tests: u64,
    /// Real time of an answer, s: the median of several means.
    pub seconds: f64,
    /// The quartiles of these means, s.
    pub spread: [f64; 2],
}

/// The costs of both ways, for one pair of bodies at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// The bodies.
    pub pair: (usize, usize),
    /// The simulated time of the comparison, s.
    pub time: f64,
    /// Whether their surfaces meet.
    pub meet: bool,
    /// Whether both ways give the same answer.
    pub agree: bool,
    /// The naive way; `None` if it would take too long.
    pub naive: Option<Cost>,
    /// The way through hierarchies.
    pub tree: Cost,
    placed: Placed,
}

/// The rotation of the second mesh in the frame of the first, and the position of its origin there, m.
type Placed = (DQuat, DVec3);

/// The pair to compare now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contest {
    /// There are fewer than two bodies with meshes, or no such pair has the selected body.
    NoPair,
    /// No two boxes overlap; the boxes of these two are nearest to each other.
    Apart(usize, usize),
    /// The boxes of these two overlap.
    Pair(usize, usize),
}

/// The state of the comparison.
#[derive(Clone, Debug, Default)]
pub struct Compare {
    /// Whether measurements are made. While off, it costs nothing.
    pub on: bool,
    last: Option<Comparison>,
    /// The number of the current or next measurement; results with other numbers are ignored.
    ticket: u64,
    under_way: bool,
    rest: Duration,
}

/// A measurement, which can run on any thread.
#[derive(Debug)]
pub struct Trial {
    world: World,
    pair: (usize, usize),
    ticket: u64,
}

/// The result of a measurement.
#[derive(Debug)]
pub struct Tried {
    figure: Option<Comparison>,
    took: Duration,
    ticket: u64,
}

impl Compare {
    /// The latest result.
    pub fn last(&self) -> Option<&Comparison> {
        self.last.as_ref().filter(|_| self.on)
    }

    /// Whether a measurement is under way.
    pub fn is_under_way(&self) -> bool {
        self.under_way
    }

    /// Discards the result and the measurement under way.
    pub(super) fn forget(&mut self) {
        self.last = None;
        self.ticket += 1;
        self.under_way = false;
    }
}

impl Trial {
    /// Runs the measurement. `stopwatch` reads real time.
    pub fn run(self, stopwatch: impl Fn() -> Duration) -> Tried {
        let began = stopwatch();
        let figure = self.measure(&stopwatch);
        Tried {
            figure,
            took: stopwatch().saturating_sub(began),
            ticket: self.ticket,
        }
    }

    fn measure(&self, stopwatch: &impl Fn() -> Duration) -> Option<Comparison> {
        let (i, j) = self.pair;
        let (first, second) = (self.world.mesh(i)?, self.world.mesh(j)?);
        let (first_tree, second_tree) = (self.world.bvh(i)?, self.world.bvh(j)?);
        let placed = placed(&self.world, i, j);
        let at = Placement::turned(placed.0, placed.1)?;
        let edges_by_faces =
            |a: &sim_core::Mesh, b: &sim_core::Mesh| (a.edges().len() * b.triangles().len()) as u64;
        let all_tests = edges_by_faces(first, second) + edges_by_faces(second, first);
        let naive = (all_tests <= MOST_TESTS).then(|| {
            let work = naive::work(first, second, at);
            let (seconds, spread) = time(stopwatch, || naive::intersect(first, second, at));
            let cost = Cost {
                boxes: work.boxes,
                tests: work.tests,
                seconds,
                spread,
            };
            (cost, work.meet)
        });
        let work = tree::work(first_tree, second_tree, at);
        let (seconds, spread) = time(stopwatch, || tree::intersect(first_tree, second_tree, at));
        Some(Comparison {
            pair: self.pair,
            time: self.world.time(),
            meet: work.meet,
            agree: naive.is_none_or(|(_, meet)| meet == work.meet),
            naive: naive.map(|(cost, _)| cost),
            tree: Cost {
                boxes: work.boxes,
                tests: work.tests,
                seconds,
                spread,
            },
            placed,
        })
    }
}

/// The time of an answer, s: the median of several means, and their quartiles.
fn time(stopwatch: &impl Fn() -> Duration, answer: impl Fn() -> bool) -> (f64, [f64; 2]) {
    // The first answer is slowed by cold caches. It counts only if there is no time for another.
    let (began, first) = timed(stopwatch, &answer, 1);
    let answers = if first < MEASURED {
        let fits = MEASURED.as_secs_f64() / first.as_secs_f64().max(1e-9);
        fits.clamp(1.0, MOST_ANSWERS) as u32
    } else {
        1
    };
    let mut means = Vec::new();
    while means.len() < ROUNDS && stopwatch().saturating_sub(began) <= PATIENCE {
        means.push(timed(stopwatch, &answer, answers).1.as_secs_f64());
    }
    means.sort_by(f64::total_cmp);
    let quarter = means.len() / 4;
    match means.len() {
        0 => (first.as_secs_f64(), [first.as_secs_f64(); 2]),
        count => (
            means[count / 2],
            [means[quarter], means[count - 1 - quarter]],
        ),
    }
}

/// The start of a series of answers, and the mean time of each.
fn timed(
    stopwatch: &impl Fn() -> Duration,
    answer: &impl Fn() -> bool,
    answers: u32,
) -> (Duration, Duration) {
    let began = stopwatch();
    for _ in 0..answers {
        std::hint::black_box(answer());
    }
    (began, stopwatch().saturating_sub(began) / answers)
}

impl Session {
    /// The pair to compare: of the bodies whose boxes overlap, the two with the most triangles; if no boxes overlap,
    /// the two nearest. If a body is selected, it is one of the two.
    pub fn contest(&self) -> Contest {
        let world = &self.world;
        let solid: Vec<usize> = (0..world.len())
            .filter(|&i| world.mesh(i).is_some())
            .collect();
        let (mut contest, mut most, mut nearest) = (Contest::NoPair, 0, f64::INFINITY);
        for (n, &i) in solid.iter().enumerate() {
            for &j in &solid[n + 1..] {
                if self.selection.is_some_and(|s| s != i && s != j) {
                    continue;
                }
                let size = |i| world.mesh(i).map_or(0, |mesh| mesh.triangles().len());
                let size = size(i) + size(j);
                let gap = boxes_gap(world, i, j);
                if gap <= 0.0 && size > most {
                    (contest, most) = (Contest::Pair(i, j), size);
                } else if most == 0 && gap < nearest {
                    (contest, nearest) = (Contest::Apart(i, j), gap);
                }
            }
        }
        contest
    }

    /// Advances real time by `elapsed`. Returns the measurement that is due, if there is one.
    pub fn trial_due(&mut self, elapsed: Duration) -> Option<Trial> {
        if !self.compare.on {
            return None;
        }
        self.compare.rest = self.compare.rest.saturating_sub(elapsed);
        if self.compare.under_way || !self.compare.rest.is_zero() || !self.wants_trial() {
            return None;
        }
        let (Contest::Pair(i, j) | Contest::Apart(i, j)) = self.contest() else {
            return None;
        };
        self.world.build_bvhs();
        self.compare.ticket += 1;
        self.compare.under_way = true;
        Some(Trial {
            world: self.world.clone(),
            pair: (i, j),
            ticket: self.compare.ticket,
        })
    }

    /// Accepts a result; a result from before a reset or of another scene is ignored.
    pub fn accept_trial(&mut self, tried: Tried) {
        if tried.ticket != self.compare.ticket {
            return;
        }
        self.compare.under_way = false;
        self.compare.rest = (tried.took * REST).max(LEAST_REST);
        self.compare.last = tried.figure;
    }

    /// Discards the measurement under way.
    pub fn drop_trial(&mut self) {
        self.compare.forget();
        self.compare.on = false;
    }

    /// Whether a measurement is wanted: comparing is on, and the last result is not of the present pair and placement.
    pub fn wants_trial(&self) -> bool {
        let (Contest::Pair(i, j) | Contest::Apart(i, j)) = self.contest() else {
            return false;
        };
        let now = ((i, j), placed(&self.world, i, j));
        let last = self.compare.last.as_ref();
        self.compare.on && last.is_none_or(|last| (last.pair, last.placed) != now)
    }
}

pub(super) fn placed(world: &World, i: usize, j: usize) -> Placed {
    let back = world.rotation(i).inverse();
    let apart = world.origin(j) - world.origin(i);
    (back * world.rotation(j), back * apart)
}

/// Distance between two boxes along the axis where it is greatest, m; at most 0 if they overlap.
fn boxes_gap(world: &World, i: usize, j: usize) -> f64 {
    let (Some(first), Some(second)) = (world.mesh(i), world.mesh(j)) else {
        return f64::INFINITY;
    };
    // The bounding boxes of both meshes as they are rotated.
    let [(middle, half), (other, other_half)] = [(first, i), (second, j)].map(|(mesh, i)| {
        let turned = DMat3::from_quat(world.rotation(i));
        let bounds = mesh.bounds();
        let middle = world.origin(i) + turned * bounds.centre();
        (middle, turned.abs() * bounds.half_extent())
    });
    ((other - middle).abs() - (half + other_half)).max_element()
}
