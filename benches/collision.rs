//! Do two meshes meet? Naive against BVH, and what building the BVH costs. Every answer is checked.
//!
//! Placements: *hit*, the second mesh 30 % closer than where it first touches on its way up; *miss*, 1 %
//! farther, where boxes overlap (horns are higher than backs) and surfaces do not.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sim_core::collide::{naive, touch, tree};
use sim_core::{Bvh, DVec3, Mesh, Vec3};

/// The naive test of two large cows takes minutes; pairs of more tests than this go without it.
const MOST_NAIVE_TESTS: usize = 300_000_000;

fn cow(triangles: usize) -> Mesh {
    let cow = cow::cow(triangles).expect("a cow of this size can be made");
    let vertices = cow.vertices.into_iter().map(Vec3::from_array).collect();
    Mesh::new(vertices, cow.triangles).expect("the cow is a mesh")
}

fn cube() -> Mesh {
    (*scene::mesh_file::builtin("cube.obj").expect("the cube is built in")).clone()
}

struct Pair {
    name: String,
    first: Mesh,
    second: Mesh,
}

impl Pair {
    /// Displacement at which the second mesh, rising from below on a slanted line, first touches.
    fn touching(&self, first: &Bvh, second: &Bvh) -> DVec3 {
        let from = DVec3::new(1.0, -10.0, 0.5);
        let touch = touch::first_touch(first, second, from, -from).expect("they meet on the way");
        from * (1.0 - touch.time)
    }

    fn naive_tests(&self) -> usize {
        self.first.edges().len() * self.second.triangles().len()
            + self.second.edges().len() * self.first.triangles().len()
    }
}

fn pairs() -> impl Iterator<Item = Pair> {
    [1_000, 6_000, 25_000, 100_000].into_iter().flat_map(|n| {
        let cow = cow(n);
        [("cube", cube()), ("cow", cow.clone())].map(|(other, first)| Pair {
            name: format!("{other}-cow/{n}"),
            first,
            second: cow.clone(),
        })
    })
}

fn intersect(c: &mut Criterion) {
    for pair in pairs() {
        let (first, second) = (Bvh::build(&pair.first), Bvh::build(&pair.second));
        let touching = pair.touching(&first, &second);
        for (placement, offset) in [("hit", 0.7 * touching), ("miss", 1.01 * touching)] {
            let truth = placement == "hit";
            let mut group = c.benchmark_group(format!("{placement}/{}", pair.name));
            group.bench_function("bvh", |b| {
                b.iter(|| assert_eq!(tree::intersect(&first, &second, black_box(offset)), truth));
            });
            if pair.naive_tests() <= MOST_NAIVE_TESTS {
                group.throughput(Throughput::Elements(pair.naive_tests() as u64));
                group.sample_size(10).bench_function("naive", |b| {
                    b.iter(|| {
                        let meet = naive::intersect(&pair.first, &pair.second, black_box(offset));
                        assert_eq!(meet, truth);
                    });
                });
            }
            group.finish();
        }
    }
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    for n in [1_000, 6_000, 25_000, 100_000, 400_000] {
        let cow = cow(n);
        group.throughput(Throughput::Elements(cow.triangles().len() as u64));
        group.bench_with_input(BenchmarkId::from_parameter(n), &cow, |b, cow| {
            b.iter(|| Bvh::build(black_box(cow)));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = intersect, build
}
criterion_main!(benches);
