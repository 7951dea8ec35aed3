//! Our broad phase compared with the tree in Rapier: pairs of swept boxes, step by step.

use cases::scenes::{Form, HALF, crowd};
use criterion::Criterion;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use sim_core::DVec3;

use crate::row;
use crate::table::{Table, three_digits, time};
use crate::watch;

// The library's own code, which is private there. Its tests are included but not run here.
#[allow(
    dead_code,
    unused_imports,
    reason = "planes are no part of the question"
)]
#[path = "../../crates/sim-core/src/collide/broad/mod.rs"]
mod broad;
use broad::{Broad, Swept};

/// Numbers of boxes, and of timed steps.
const SIZES: [(usize, u32); 3] = [(100, 120), (1_000, 120), (10_000, 30)];

/// The margins of the leaves of the other tree, m.
const MARGINS: [f32; 2] = [0.0, 0.1];

/// The boxes of each step, used in turn, and the number of pairs that meet in all steps so far.
struct Run<'a, T> {
    steps: &'a [Vec<Swept>],
    step: usize,
    met: u64,
    tree: T,
}

struct Parry {
    tree: Bvh,
    workspace: BvhWorkspace,
    margin: f32,
}

impl<'a, T> Run<'a, T> {
    fn new(steps: &'a [Vec<Swept>], tree: T) -> Run<'a, T> {
        let (step, met) = (0, 0);
        Run {
            steps,
            step,
            met,
            tree,
        }
    }

    fn next(&mut self) -> &'a [Swept] {
        self.step += 1;
        &self.steps[(self.step - 1) % self.steps.len()]
    }
}

impl Run<'_, (Broad, Vec<usize>)> {
    fn step(&mut self) {
        let boxes = self.next();
        let (broad, bodies) = &mut self.tree;
        broad.fill(bodies, |body| boxes[body], |_| None);
        broad.each_pair(|_, _| self.met += 1);
    }
}

impl Run<'_, Parry> {
    fn step(&mut self) {
        let boxes = self.next();
        let Parry {
            tree,
            workspace,
            margin,
        } = &mut self.tree;
        for (index, swept) in (0..).zip(boxes) {
            tree.insert_or_update_partially(aabb(swept), index, *margin);
        }
        tree.optimize_incremental(workspace);
        tree.refit(workspace);
        tree.traverse_bvtt_single_tree::<false>(workspace, &mut |i, j| {
            self.met += u64::from(meet(&boxes[i as usize], &boxes[j as usize]));
        });
    }
}

fn aabb(swept: &Swept) -> Aabb {
    let corner = |v: DVec3| Vector::new(v.x as f32, v.y as f32, v.z as f32);
    Aabb::new(corner(swept.min), corner(swept.max))
}

fn meet(one: &Swept, other: &Swept) -> bool {
    one.min.cmple(other.max).all() && other.min.cmple(one.max).all()
}

/// The swept boxes of a crowd of cubes in each step, if the cubes pass through each other.
fn boxes(count: usize, steps: u32) -> Vec<Vec<Swept>> {
    let (scene, half_box) = crowd(count, &Form::Cube(HALF));
    let half_box = half_box - HALF;
    let mut cubes: Vec<(DVec3, DVec3)> = scene.items[6..]
        .iter()
        .map(|item| (item.position, item.velocity))
        .collect();
    let step = |_| {
        let swept = cubes.iter_mut().enumerate().map(|(body, (x, v))| {
            for axis in 0..3 {
                if x[axis].abs() > half_box {
                    v[axis] = -v[axis].abs() * x[axis].signum();
                }
            }
            let from = *x;
            *x += scene.dt * *v;
            Swept {
                min: from.min(*x) - HALF,
                max: from.max(*x) + HALF,
                body,
            }
        });
        swept.collect()
    };
    (0..steps).map(step).collect()
}

pub(crate) fn bench(criterion: &mut Criterion) -> Option<Table> {
    let mut table = Table::new(
        "Broad phase: pairs of swept boxes in a step",
        &["boxes", "pairs a step", "tree", "step", "ratio"],
    );
    let mut group = criterion.benchmark_group("impacts/broad");
    for (count, timed) in SIZES {
        let steps = boxes(count, timed);
        let bodies: Vec<usize> = (0..count).collect();
        let ours = || Run::new(&steps, (Broad::default(), bodies.clone()));
        let theirs = |margin| {
            let leaves = steps[0].iter().map(aabb).enumerate();
            let tree = Parry {
                tree: Bvh::from_iter(BvhBuildStrategy::Binned, leaves),
                workspace: BvhWorkspace::default(),
                margin,
            };
            Run::new(&steps, tree)
        };
        let mut known = ours();
        steps.iter().for_each(|_| known.step());
        let mut times = vec![(
            "ours".to_string(),
            watch::time_by(&mut group, &format!("{count}/ours"), timed, ours, |run| {
                run.step()
            }),
        )];
        for margin in MARGINS {
            let mut run = theirs(margin);
            steps.iter().for_each(|_| run.step());
            // Without a margin it rounds boxes to f32, some of them inwards.
            let lost = known.met.abs_diff(run.met);
            assert!(lost as f64 <= 1e-5 * known.met as f64, "{margin}: {lost}");
            let name = format!("parry, margin {margin} m");
            let id = format!("{count}/parry-{margin}");
            times.push((
                name,
                watch::time_by(&mut group, &id, timed, || theirs(margin), |run| run.step()),
            ));
        }
        let Some(first) = times[0].1 else { continue };
        for (name, seconds) in times {
            let Some(seconds) = seconds else { continue };
            let cells = [
                &count.to_string(),
                &(known.met / u64::from(timed)).to_string(),
                &name,
                &time(seconds),
                &three_digits(seconds / first),
            ];
            row(&mut table, &cells.map(String::as_str));
        }
    }
    group.finish();
    (!table.rows.is_empty()).then_some(table)
}
