//! Naive against BVH on the running scene: what one answer costs each way, measured on request.
//!
//! A naive answer can take seconds, so the session only says what is to be measured ([`Trial`]) and
//! takes the figure in when it comes. Where nothing has moved, nothing is measured again; and
//! measuring rests for a while after each figure, in proportion to what the figure has cost.

use std::time::Duration;

use sim_core::collide::{naive, tree};
use sim_core::{DVec3, World};

use super::Session;

/// Tests of an edge with a triangle, a few nanoseconds each, beyond which the naive way is not tried.
const MOST_TESTS: u64 = 2_000_000_000;
/// A short answer is given again until this much time has gone by, and the mean is taken.
const MEASURED: Duration = Duration::from_micros(500);
/// The least time between two measurements, and the rest after one, in its own duration.
const LEAST_REST: Duration = Duration::from_millis(200);
const REST: u32 = 3;

/// What one answer costs one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Pairs of boxes compared.
    pub boxes: u64,
    /// Tests of an edge with a triangle (naive), or of two triangles (BVH).
    pub tests: u64,
    /// Real time of an answer, s.
    pub seconds: f64,
}

/// Both ways, on one pair of bodies at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// The bodies.
    pub pair: (usize, usize),
    /// Simulated time at which they were so, s.
    pub time: f64,
    /// Whether their surfaces meet.
    pub meet: bool,
    /// The naive way; none where it would take too long.
    pub naive: Option<Cost>,
    /// Through hierarchies.
    pub tree: Cost,
    offset: DVec3,
}

/// What there is to compare now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contest {
    /// Fewer than two bodies with meshes, or none with the selected one.
    NoPair,
    /// No two boxes overlap.
    Apart,
    /// These two.
    Pair(usize, usize),
}

/// Comparing, on or off.
#[derive(Clone, Debug, Default)]
pub struct Compare {
    /// Whether anything is measured. Off, it costs nothing.
    pub on: bool,
    last: Option<Comparison>,
    /// The measurement under way, or else to come; results of others are ignored.
    ticket: u64,
    under_way: bool,
    rest: Duration,
}

/// A measurement to do on any thread.
#[derive(Debug)]
pub struct Trial {
    world: World,
    pair: (usize, usize),
    ticket: u64,
}

/// A measurement that was done.
#[derive(Debug)]
pub struct Tried {
    figure: Option<Comparison>,
    took: Duration,
    ticket: u64,
}

impl Compare {
    /// The latest figure.
    pub fn last(&self) -> Option<&Comparison> {
        self.last.as_ref().filter(|_| self.on)
    }

    /// Whether a figure is on its way.
    pub fn is_under_way(&self) -> bool {
        self.under_way
    }

    /// Forgets the figure, and the one on its way.
    pub(super) fn forget(&mut self) {
        self.last = None;
        self.ticket += 1;
        self.under_way = false;
    }
}

impl Trial {
    /// Measures. `stopwatch` reads real time.
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
        let offset = self.world.position(j) - self.world.position(i);
        let edges_by_faces =
            |a: &sim_core::Mesh, b: &sim_core::Mesh| (a.edges().len() * b.triangles().len()) as u64;
        let all_tests = edges_by_faces(first, second) + edges_by_faces(second, first);
        let naive = (all_tests <= MOST_TESTS).then(|| {
            let work = naive::work(first, second, offset);
            Cost {
                boxes: work.boxes,
                tests: work.tests,
                seconds: mean(stopwatch, || naive::intersect(first, second, offset)),
            }
        });
        let work = tree::work(first_tree, second_tree, offset);
        Some(Comparison {
            pair: self.pair,
            time: self.world.time(),
            meet: work.meet,
            naive,
            tree: Cost {
                boxes: work.boxes,
                tests: work.tests,
                seconds: mean(stopwatch, || {
                    tree::intersect(first_tree, second_tree, offset)
                }),
            },
            offset,
        })
    }
}

/// Mean time of an answer, s.
fn mean(stopwatch: &impl Fn() -> Duration, answer: impl Fn() -> bool) -> f64 {
    // What comes first pays for cold caches.
    let began = stopwatch();
    std::hint::black_box(answer());
    let first = stopwatch().saturating_sub(began);
    if first > MEASURED {
        return first.as_secs_f64();
    }
    let (began, mut answers) = (stopwatch(), 0);
    loop {
        std::hint::black_box(answer());
        answers += 1;
        let time = stopwatch().saturating_sub(began);
        if time > MEASURED || answers == 200 {
            return time.as_secs_f64() / f64::from(answers);
        }
    }
}

impl Session {
    /// Which two bodies are compared: of those whose boxes overlap, and of which one is selected
    /// if any body is, the two with the most triangles.
    pub fn contest(&self) -> Contest {
        let world = &self.world;
        let solid: Vec<usize> = (0..world.len())
            .filter(|&i| world.mesh(i).is_some())
            .collect();
        let (mut contest, mut most) = (Contest::NoPair, 0);
        for (n, &i) in solid.iter().enumerate() {
            for &j in &solid[n + 1..] {
                if self.selection.is_some_and(|s| s != i && s != j) {
                    continue;
                }
                let size = |i| world.mesh(i).map_or(0, |mesh| mesh.triangles().len());
                let size = size(i) + size(j);
                if boxes_overlap(world, i, j) {
                    if size > most {
                        (contest, most) = (Contest::Pair(i, j), size);
                    }
                } else if contest == Contest::NoPair {
                    contest = Contest::Apart;
                }
            }
        }
        contest
    }

    /// Lets `elapsed` real time pass; the measurement that is due then, if one is.
    pub fn trial_due(&mut self, elapsed: Duration) -> Option<Trial> {
        if !self.compare.on {
            return None;
        }
        self.compare.rest = self.compare.rest.saturating_sub(elapsed);
        if self.compare.under_way || !self.compare.rest.is_zero() || !self.wants_trial() {
            return None;
        }
        let Contest::Pair(i, j) = self.contest() else {
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

    /// Takes in a figure; one from before a reset or another scene is ignored.
    pub fn accept_trial(&mut self, tried: Tried) {
        if tried.ticket != self.compare.ticket {
            return;
        }
        self.compare.under_way = false;
        self.compare.rest = (tried.took * REST).max(LEAST_REST);
        self.compare.last = tried.figure;
    }

    /// Gives up the measurement under way.
    pub fn drop_trial(&mut self) {
        self.compare.forget();
        self.compare.on = false;
    }

    /// Whether the figure is of another moment than now.
    pub fn wants_trial(&self) -> bool {
        let Contest::Pair(i, j) = self.contest() else {
            return false;
        };
        let offset = self.world.position(j) - self.world.position(i);
        let last = self.compare.last.as_ref();
        self.compare.on && last.is_none_or(|last| last.pair != (i, j) || last.offset != offset)
    }
}

fn boxes_overlap(world: &World, i: usize, j: usize) -> bool {
    let (Some(first), Some(second)) = (world.mesh(i), world.mesh(j)) else {
        return false;
    };
    let offset = world.position(j) - world.position(i);
    let centres = second.bounds().centre() + offset - first.bounds().centre();
    let reach = first.bounds().half_extent() + second.bounds().half_extent();
    centres.abs().cmple(reach).all()
}
