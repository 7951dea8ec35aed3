//! The cost of building a tree, and the quality of the tree.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use bvh::aabb::{Aabb as BvhBox, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::BvhNode;
use criterion::Criterion;
use nalgebra::Point3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use parry3d::bounding_volume::Aabb as ParryBox;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh as ParryBvh, BvhBuildStrategy, TraversalAction};
use sim_core::{Aabb, Bvh, Mesh};

use crate::Scope;
use crate::meshes::{Shape, Solid, Solids};
use crate::sweep::sweep;
use crate::table::{Table, three_digits, time};

/// A triangle for the crate `bvh`.
#[derive(Clone)]
pub(crate) struct BvhTriangle {
    pub(crate) corners: [Point3<f32>; 3],
    node: usize,
}

impl Bounded<f32, 3> for BvhTriangle {
    fn aabb(&self) -> BvhBox<f32, 3> {
        let [a, b, c] = &self.corners;
        BvhBox::with_bounds(a.inf(b).inf(c), a.sup(b).sup(c))
    }
}

impl BHShape<f32, 3> for BvhTriangle {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

pub(crate) fn bvh_triangles(mesh: &Mesh) -> Vec<BvhTriangle> {
    let corners = (0..mesh.triangles().len()).map(|face| mesh.corners(face));
    let triangle = |corners: [sim_core::Vec3; 3]| BvhTriangle {
        corners: corners.map(|v| Point3::from(v.to_array())),
        node: 0,
    };
    corners.map(triangle).collect()
}

pub(crate) fn obvhs_triangles(mesh: &Mesh) -> Vec<obvhs::triangle::Triangle> {
    let corners = (0..mesh.triangles().len()).map(|face| mesh.corners(face));
    let triangle = |corners: [sim_core::Vec3; 3]| {
        let [v0, v1, v2] = corners.map(|v| glam::Vec3A::from_array(v.to_array()));
        obvhs::triangle::Triangle { v0, v1, v2 }
    };
    corners.map(triangle).collect()
}

/// The builders.
#[derive(Clone, Copy)]
enum Builder {
    Ours,
    Parry(BvhBuildStrategy),
    Obvhs(BvhBuildParams),
    Bvh,
}

const BUILDERS: [(&str, Builder); 6] = [
    ("ours", Builder::Ours),
    ("parry binned", Builder::Parry(BvhBuildStrategy::Binned)),
    ("parry ploc", Builder::Parry(BvhBuildStrategy::Ploc)),
    (
        "obvhs fastest",
        Builder::Obvhs(BvhBuildParams::fastest_build()),
    ),
    (
        "obvhs medium",
        Builder::Obvhs(BvhBuildParams::medium_build()),
    ),
    ("bvh", Builder::Bvh),
];

/// The triangles in the form that a builder needs; converting them is not part of the build.
enum Input {
    Mesh,
    Obvhs(Vec<obvhs::triangle::Triangle>),
    Bvh(RefCell<Vec<BvhTriangle>>),
}

enum Tree {
    Ours(Bvh),
    Parry(ParryBvh),
    Obvhs(Bvh2),
    Bvh(bvh::bvh::Bvh<f32, 3>),
}

impl Builder {
    fn prepare(self, mesh: &Mesh) -> Input {
        match self {
            Builder::Ours | Builder::Parry(_) => Input::Mesh,
            Builder::Obvhs(_) => Input::Obvhs(obvhs_triangles(mesh)),
            Builder::Bvh => Input::Bvh(RefCell::new(bvh_triangles(mesh))),
        }
    }

    fn build(self, mesh: &Mesh, input: &Input) -> Tree {
        match (self, input) {
            (Builder::Ours, _) => Tree::Ours(Bvh::build(mesh)),
            (Builder::Parry(strategy), _) => {
                let boxes = (0..mesh.triangles().len()).map(|face| {
                    let bounds = Aabb::around(mesh.corners(face));
                    let [min, max] =
                        [bounds.min, bounds.max].map(|v| Vector::from_array(v.to_array()));
                    (face, ParryBox::new(min, max))
                });
                Tree::Parry(ParryBvh::from_iter(strategy, boxes))
            }
            (Builder::Obvhs(preset), Input::Obvhs(triangles)) => Tree::Obvhs(build_bvh2_from_tris(
                triangles,
                preset,
                &mut Duration::default(),
            )),
            (Builder::Bvh, Input::Bvh(triangles)) => {
                Tree::Bvh(bvh::bvh::Bvh::build(&mut triangles.borrow_mut()[..]))
            }
            _ => unreachable!("a builder is given what it prepared"),
        }
    }
}

impl Tree {
    /// The expected number of boxes and triangles tested with a random ray through the root's box: the area of each
    /// node times the number of its items, divided by the root's area.
    ///
    /// Our tree does not store the boxes of single triangles; they are computed from the mesh.
    fn cost(&self, mesh: &Mesh) -> f64 {
        let sum: f64 = match self {
            Tree::Ours(bvh) => {
                let below = bvh.node_count() + mesh.triangles().len() - 1;
                let children = below as f64 / bvh.node_count() as f64;
                let inner: f64 = bvh.boxes().map(|(_, bounds)| bounds.half_area()).sum();
                let faces = 0..mesh.triangles().len();
                let triangles = faces.map(|face| Aabb::around(mesh.corners(face)).half_area());
                children * inner + triangles.sum::<f64>()
            }
            Tree::Parry(bvh) => {
                let mut sum = 2.0 * mesh.bounds().half_area();
                bvh.traverse(|node| {
                    let holds = if node.is_leaf() { 1.0 } else { 2.0 };
                    sum += holds * f64::from(node.aabb().half_area());
                    TraversalAction::Continue
                });
                sum
            }
            Tree::Obvhs(bvh) => {
                let (mut sum, mut pending) = (0.0, vec![0]);
                while let Some(index) = pending.pop() {
                    let node = &bvh.nodes[index as usize];
                    if !node.is_leaf() {
                        pending.extend([node.first_index, node.first_index + 1]);
                    }
                    let holds = if node.is_leaf() { node.prim_count } else { 2 };
                    sum += f64::from(holds) * f64::from(node.aabb().half_area());
                }
                sum
            }
            Tree::Bvh(bvh) => {
                let area = |bounds: &BvhBox<f32, 3>| f64::from(bounds.surface_area()) / 2.0;
                let holds = |node: usize| if bvh.nodes[node].is_leaf() { 1.0 } else { 2.0 };
                let of_children = bvh.nodes.iter().map(|node| match node {
                    BvhNode::Leaf { .. } => 0.0,
                    BvhNode::Node {
                        child_l_index,
                        child_l_aabb,
                        child_r_index,
                        child_r_aabb,
                        ..
                    } => {
                        holds(*child_l_index) * area(child_l_aabb)
                            + holds(*child_r_index) * area(child_r_aabb)
                    }
                });
                2.0 * mesh.bounds().half_area() + of_children.sum::<f64>()
            }
        };
        sum / mesh.bounds().half_area()
    }

    /// Memory per triangle of the tree and of the triangles that a query reads, bytes.
    fn bytes(&self, mesh: &Mesh) -> f64 {
        let triangles = mesh.triangles().len();
        let bytes = match self {
            Tree::Ours(bvh) => return bvh.bytes_per_triangle(),
            Tree::Parry(bvh) => {
                bvh.total_memory_size()
                    + size_of_val(mesh.vertices())
                    + size_of_val(mesh.triangles())
            }
            Tree::Obvhs(bvh) => {
                size_of_val(&bvh.nodes[..])
                    + size_of_val(&bvh.primitive_indices[..])
                    + triangles * size_of::<obvhs::triangle::Triangle>()
            }
            Tree::Bvh(bvh) => size_of_val(&bvh.nodes[..]) + triangles * size_of::<BvhTriangle>(),
        };
        bytes as f64 / triangles as f64
    }
}

/// The build of one mesh by one builder.
pub(crate) struct Build {
    pub(crate) builder: &'static str,
    pub(crate) shape: Shape,
    pub(crate) time: f64,
    cost: f64,
    bytes: f64,
}

/// Builds cows of every size, and the knot.
pub(crate) fn bench(c: &mut Criterion, solids: &Solids, scope: Scope) -> Vec<Build> {
    let cows = [1_000, 6_000, 25_000, 100_000, 400_000].map(Shape::Cow);
    let shapes = cows.into_iter().chain([Shape::Knot(124_000)]);
    let mut builds = Vec::new();
    for shape in shapes.filter(|shape| shape.triangles() <= scope.largest) {
        let mut group = c.benchmark_group(format!("build/{}", shape.name()));
        for (name, builder) in BUILDERS {
            let make = || {
                let solid = solids.get(shape);
                let input = builder.prepare(&solid.mesh);
                vec![(solid, input)]
            };
            let build = |(solid, input): &(Rc<Solid>, Input)| builder.build(&solid.mesh, input);
            let Some(swept) = sweep(&mut group, name, make, build) else {
                continue;
            };
            let case = &swept.cases[0];
            let tree = build(case);
            builds.push(Build {
                builder: name,
                shape,
                time: swept.times[0],
                cost: tree.cost(&case.0.mesh),
                bytes: tree.bytes(&case.0.mesh),
            });
        }
        group.finish();
    }
    builds
}

pub(crate) fn table(builds: &[Build]) -> Table {
    let mut table = Table::new(
        "Build, freeing included; cost: boxes and triangles that a random ray is tested with",
        &[
            "mesh",
            "builder",
            "time",
            "to ours",
            "ns a triangle",
            "cost",
            "bytes a triangle",
        ],
    );
    for build in builds {
        let ours = builds
            .iter()
            .find(|b| b.shape == build.shape && b.builder == "ours");
        table.rows.push(vec![
            build.shape.name(),
            build.builder.into(),
            time(build.time),
            ours.map_or("-".into(), |ours| {
                format!("x{}", three_digits(build.time / ours.time))
            }),
            three_digits(build.time * 1e9 / build.shape.triangles() as f64),
            three_digits(build.cost),
            three_digits(build.bytes),
        ]);
    }
    table
}
