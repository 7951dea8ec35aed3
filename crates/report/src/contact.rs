//! Naive against BVH contact: do two meshes meet?

use std::hint::black_box;
use std::sync::Arc;

use sim_core::collide::{naive, touch, tree};
use sim_core::{Bvh, DVec3, Mesh};

use crate::scope::Scope;
use crate::stopwatch;

/// One question and what each way of answering it takes.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) pair: String,
    /// Whether they meet.
    pub(crate) meet: bool,
    /// Time of one answer, s.
    pub(crate) naive: f64,
    pub(crate) bvh: f64,
    /// Whether both answers are right.
    pub(crate) right: bool,
}

/// Cube and cow, cow and cow, 30 % closer than where they first touch and 1 % farther.
pub(crate) fn measure(scope: Scope) -> Vec<Row> {
    let (Some(cube), Some(cow)) = (builtin("cube.obj"), builtin("cow.obj")) else {
        return Vec::new();
    };
    let pairs = [("cube", &cube, &cow), ("cow", &cow, &cow)];
    let rows = pairs.into_iter().flat_map(|(name, first, second)| {
        let (tree, other) = (Bvh::build(first), Bvh::build(second));
        let triangles = second.triangles().len();
        let from = DVec3::new(1.0, -10.0, 0.5);
        let touching = touch::first_touch(&tree, &other, from, -from);
        let touching = touching.map(|touch| from * (1.0 - touch.time));
        let placements = touching.map(|at| [(0.7 * at, true), (1.01 * at, false)]);
        let rows = placements.into_iter().flatten().map(|(offset, meet)| {
            let naive = || naive::intersect(first, second, black_box(offset));
            let bvh = || tree::intersect(&tree, &other, black_box(offset));
            Row {
                pair: format!("{name}, cow of {triangles} triangles"),
                meet,
                right: naive() == meet && bvh() == meet,
                naive: stopwatch::median(scope.repeats(), naive),
                bvh: stopwatch::median(scope.repeats(), bvh),
            }
        });
        rows.collect::<Vec<_>>()
    });
    rows.collect()
}

fn builtin(name: &str) -> Option<Arc<Mesh>> {
    scene::mesh_file::builtin(name)
}
