//! Bounding volume hierarchy over the triangles of a mesh.

mod build;
mod cuboid;
mod grid;
mod node;
mod ray;
mod short;
mod slabs;
mod split;
mod support;

use alloc::{boxed::Box, sync::Arc, vec::Vec};

use crate::{Aabb, Mesh, mesh::Topology};
pub(crate) use cuboid::Cuboid;
pub(crate) use node::{Boxes, LEAF, MAX_DEPTH, Node, Triangles, WIDTH};
pub use ray::RayHit;
pub(crate) use slabs::Slabs;

/// A tree of boxes, four below each node, stored in flat arrays; each leaf has up to four triangles.
///
/// It has all data that a query needs; it shares the edges and vertices of triangles with the mesh.
#[derive(Clone, Debug)]
pub struct Bvh {
    bounds: Aabb,
    /// Code of the root, the first node.
    root: u32,
    count: usize,
    /// Nodes and leaves, parents before their children.
    nodes: Vec<Node>,
    /// The slabs of each node.
    slabs: Vec<Slabs>,
    /// The triangles of each leaf.
    triangles: Vec<Triangles>,
    /// The topology of the mesh, shared with it.
    topology: Arc<Topology>,
    /// The box that the mesh is, if it is one.
    cuboid: Option<Box<Cuboid>>,
    depth: usize,
}

impl Bvh {
    /// Builds the tree by the surface area heuristic, in O(n log n).
    pub fn build(mesh: &Mesh) -> Bvh {
        build::build(mesh)
    }

    /// The number of nodes, including leaves.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The number of levels of nodes and leaves.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// The expected number of boxes (of nodes, leaves and triangles) that a random ray through the root's box meets:
    /// the sum of their surface areas relative to the root's (MacDonald, Booth 1990).
    pub fn surface_area_cost(&self) -> f64 {
        let root = self.bounds.half_area();
        if root == 0.0 {
            return self.count as f64;
        }
        // Empty lanes repeat a triangle, which counts once.
        let leaves = (0..)
            .zip(&self.nodes)
            .filter(|&(i, node)| node.child[0] == i | LEAF);
        let triangles = leaves.flat_map(|(_, leaf)| {
            let area = |lane| Aabb::around(self.triangles(leaf).corners(lane)).half_area();
            leaf.lanes().map(area)
        });
        let nodes = self.boxes().map(|(_, bounds)| bounds.half_area());
        nodes.chain(triangles).sum::<f64>() / root
    }

    /// Memory per triangle, bytes, without the data that the tree shares with its mesh.
    pub fn bytes_per_triangle(&self) -> f64 {
        let bytes = size_of_val(&self.nodes[..])
            + size_of_val(&self.slabs[..])
            + size_of_val(&self.triangles[..]);
        bytes as f64 / self.count as f64
    }

    /// The least box around the mesh.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// All boxes with their level: the root's is 0; boxes of single triangles are not listed.
    pub fn boxes(&self) -> impl Iterator<Item = (usize, Aabb)> {
        let mut pending = alloc::vec![(0, self.root, self.bounds)];
        core::iter::from_fn(move || {
            let (level, code, bounds) = pending.pop()?;
            if code & LEAF == 0 {
                let node = self.node(code);
                let child = |lane| (level + 1, node.child[lane], node.boxes.bounds(lane));
                pending.extend(node.lanes().map(child));
            }
            Some((level, bounds))
        })
    }

    /// The boxes of one level.
    pub fn boxes_at(&self, depth: usize) -> impl Iterator<Item = Aabb> {
        self.boxes()
            .filter_map(move |(level, bounds)| (level == depth).then_some(bounds))
    }

    /// Whether the mesh is closed ([`Mesh::is_closed`]).
    pub fn is_closed(&self) -> bool {
        self.topology.closed
    }

    pub(crate) fn root(&self) -> u32 {
        self.root
    }

    /// A leaf.
    pub(crate) fn first_leaf(&self) -> &Node {
        let mut code = self.root;
        while code & LEAF == 0 {
            code = self.node(code).child[0];
        }
        self.node(code)
    }

    /// The node or leaf with a code.
    #[inline(always)]
    pub(crate) fn node(&self, code: u32) -> &Node {
        &self.nodes[(code & !LEAF) as usize]
    }

    /// The slabs of a node or leaf.
    #[inline(always)]
    pub(crate) fn slabs(&self, code: u32) -> &Slabs {
        &self.slabs[(code & !LEAF) as usize]
    }

    /// The triangles of a leaf.
    #[inline(always)]
    pub(crate) fn triangles(&self, leaf: &Node) -> &Triangles {
        &self.triangles[leaf.triangles as usize]
    }

    pub(crate) fn cuboid(&self) -> Option<&Cuboid> {
        self.cuboid.as_deref()
    }

    pub(crate) fn topology(&self) -> &Topology {
        &self.topology
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};
    use crate::test_random::Random;
    use alloc::vec;
    use glam::{DQuat, DVec3, Vec3};

    /// Checks that every triangle is in one leaf, that every box contains all below it, and that no level is too deep.
    fn check(mesh: &Mesh) -> Bvh {
        let bvh = Bvh::build(mesh);
        let mut seen = vec![0; mesh.triangles().len()];
        let mut pending = vec![(bvh.root(), 1, bvh.bounds())];
        let mut reached = 0;
        while let Some((code, level, bounds)) = pending.pop() {
            reached += 1;
            assert!(level <= bvh.depth() && bvh.depth() <= MAX_DEPTH);
            let node = bvh.node(code);
            for lane in node.lanes() {
                let inner = node.boxes.bounds(lane);
                if code & LEAF == 0 {
                    assert!(node.count >= 2);
                    pending.push((node.child[lane], level + 1, inner));
                    continue;
                }
                let (face, corners) = (
                    bvh.triangles(node).face[lane],
                    bvh.triangles(node).corners(lane),
                );
                seen[face as usize] += 1;
                assert_eq!(corners, mesh.corners(face as usize));
                assert!(
                    holds(inner, Aabb::around(corners)) && holds(bounds, Aabb::around(corners))
                );
            }
            let unused = node.count as usize..WIDTH;
            assert!(
                unused
                    .into_iter()
                    .all(|lane| node.boxes.half[0][lane] == f32::NEG_INFINITY)
            );
        }
        assert!(seen.iter().all(|&n| n == 1));
        assert_eq!(reached, bvh.node_count());
        assert_eq!(bvh.boxes().count(), reached);
        assert_eq!(
            (0..bvh.depth())
                .map(|d| bvh.boxes_at(d).count())
                .sum::<usize>(),
            reached
        );
        bvh
    }

    fn holds(outer: Aabb, inner: Aabb) -> bool {
        outer.union(inner) == outer
    }

    fn soup(corners: impl Iterator<Item = [Vec3; 3]>) -> Mesh {
        let vertices: Vec<Vec3> = corners.flatten().collect();
        let n = vertices.len() as u32 / 3;
        Mesh::new(
            vertices,
            (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        )
        .unwrap()
    }

    #[test]
    fn trees_hold_their_mesh() {
        check(&cube());
        let bvh = check(&sphere(60));
        assert!(bvh.depth() < 12, "{}", bvh.depth());
    }

    /// The corners of all triangles below a code, and the number of leaves that have them.
    fn below(bvh: &Bvh, code: u32) -> (Vec<Vec3>, u32) {
        let node = bvh.node(code);
        let of_lane = |lane| match code & LEAF {
            0 => below(bvh, node.child[lane]),
            _ => (bvh.triangles(node).corners(lane).to_vec(), 0),
        };
        let join = |(mut all, leaves): (Vec<Vec3>, u32), (more, others)| {
            all.extend::<Vec<Vec3>>(more);
            (all, leaves + others)
        };
        let is_leaf = u32::from(code & LEAF != 0);
        node.lanes().map(of_lane).fold((vec![], is_leaf), join)
    }

    #[test]
    fn slabs_hold_what_their_boxes_do() {
        let turned = DQuat::from_rotation_y(0.3) * DQuat::from_rotation_x(0.2);
        // Half of a flat ball, because it lies on no axis.
        let ball = sphere(60);
        let at = |v: u32| ball.vertices()[v as usize];
        let is_above = |corners: &[u32; 3]| corners.iter().all(|&v| at(v).y > 0.0);
        let half = ball.triangles().iter().copied().filter(is_above).collect();
        for away in [0.0, 1e3] {
            let flat = |v: &Vec3| turned * (v.as_dvec3() * DVec3::new(1.0, 0.01, 0.3)) + away;
            let vertices = ball.vertices().iter().map(|v| flat(v).as_vec3()).collect();
            let bvh = Bvh::build(&Mesh::new(vertices, Vec::clone(&half)).unwrap());
            let inner = (0..)
                .zip(&bvh.nodes)
                .filter(|(i, node)| node.child[0] != i | LEAF);
            let mut thinnest: f32 = 1.0;
            for (code, node, lane) in
                inner.flat_map(|(i, node)| node.lanes().map(move |l| (i, node, l)))
            {
                let slabs = bvh.slabs(code);
                let normal = Vec3::from_array(slabs.normal.map(|axis| axis[lane])).as_dvec3();
                let (middle, half) = (slabs.middle[lane], slabs.half[lane]);
                let (corners, leaves) = below(&bvh, node.child[lane]);
                for corner in corners {
                    let height = normal.dot(corner.as_dvec3()) as f32;
                    let slack = corner.abs().max_element() / (1 << 19) as f32;
                    assert!((height - middle).abs() <= half + slack);
                }
                let size = node.boxes.bounds(lane).half_extent().max_element() as f32;
                if leaves > slabs::FEW_LEAVES {
                    thinnest = thinnest.min(half / size);
                }
            }
            assert!(thinnest < 0.1, "{thinnest}");
        }
    }

    #[test]
    fn any_input_makes_a_tree() {
        let t = [Vec3::ZERO, Vec3::X, Vec3::Y];
        check(&soup([t].into_iter()));
        check(&soup([t, t].into_iter()));
        check(&soup([t; 1000].into_iter()));
        // All centres equal, all sizes different.
        check(&soup((1..500).map(|i| {
            t.map(|v| (v - Vec3::new(0.5, 0.5, 0.0)) * i as f32)
        })));
        check(&soup((0..500).map(|_| [Vec3::ONE; 3])));
        check(&soup((0..500).map(|i| [Vec3::X * i as f32; 3])));
        check(&soup(
            (0..100).map(|i| t.map(|v| v * 1e-38 + Vec3::Y * i as f32 * 1e-38)),
        ));
        check(&soup(
            (0..100).map(|i| t.map(|v| v * 1e38 + Vec3::Y * i as f32 * 2e36)),
        ));
        // Each triangle is twice as far as the last: the surface area would split off one triangle at a time.
        let row = (0..120).map(|i| t.map(|v| (v + 1.0) * libm::exp2f(i as f32 - 60.0)));
        check(&soup(row));
    }

    /// The cost of a binary tree whose planes are the best across any axis, without bins, in boxes met (see
    /// `surface_area_cost`).
    fn swept_cost(mut boxes: Vec<Aabb>) -> f64 {
        let around = |boxes: &[Aabb]| boxes.iter().fold(boxes[0], |all, &b| all.union(b));
        let root = around(&boxes).half_area();
        let mut cost = 0.0;
        let mut pending = vec![(0, boxes.len())];
        while let Some((start, end)) = pending.pop() {
            let run = &mut boxes[start..end];
            if run.len() <= WIDTH {
                cost += run.iter().map(Aabb::half_area).sum::<f64>() / root;
            }
            cost += around(run).half_area() / root;
            if run.len() <= WIDTH {
                continue;
            }
            let mut best = (f64::INFINITY, 0, 0);
            for axis in 0..3 {
                run.sort_by(|a, b| (a.min + a.max)[axis].total_cmp(&(b.min + b.max)[axis]));
                let mut right = vec![0.0; run.len()];
                let mut all = run[run.len() - 1];
                for i in (1..run.len()).rev() {
                    all = all.union(run[i]);
                    right[i] = all.half_area() * (run.len() - i) as f64;
                }
                let mut all = run[0];
                for i in 1..run.len() {
                    all = all.union(run[i - 1]);
                    let cost = all.half_area() * i as f64 + right[i];
                    if cost < best.0 {
                        best = (cost, axis, i);
                    }
                }
            }
            let (_, axis, at) = best;
            run.sort_by(|a, b| (a.min + a.max)[axis].total_cmp(&(b.min + b.max)[axis]));
            pending.extend([(start, start + at), (start + at, end)]);
        }
        cost
    }

    /// A tree with four children for each node has half of the levels, so it has fewer boxes to meet.
    #[test]
    fn trees_are_as_good_as_slowly_built_ones() {
        let mut random = Random(1);
        // Long thin triangles in any direction.
        let needles = soup((0..5000).map(|_| {
            let [at, along, across] = [0; 3].map(|_| random.in_unit_cube().as_vec3());
            [at, at + 0.3 * (along - 0.5), at + 0.01 * (across - 0.5)]
        }));
        for (mesh, factor) in [(sphere(60), 0.68), (needles, 0.72)] {
            let boxes = (0..mesh.triangles().len()).map(|i| Aabb::around(mesh.corners(i)));
            let (ours, slow) = (
                Bvh::build(&mesh).surface_area_cost(),
                swept_cost(boxes.collect()),
            );
            assert!(
                ours < factor * slow,
                "{ours} against {slow}: {}",
                ours / slow
            );
        }
    }

    /// Three triangles in a leaf of four lanes: the areas of all boxes by hand.
    #[test]
    fn the_cost_counts_each_triangle_once() {
        let t = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let bvh = Bvh::build(&soup(
            (0..3).map(|i| t.map(|v| v + 10.0 * Vec3::X * i as f32)),
        ));
        // Root and only leaf 21 by 1, triangles 1 by 1.
        assert!((bvh.surface_area_cost() - (21.0 + 3.0) / 21.0).abs() < 1e-12);
    }

    #[test]
    fn a_million_triangles_in_a_line() {
        let t = [Vec3::ZERO, Vec3::X * 0.5, Vec3::Y];
        let bvh = check(&soup(
            (0..1_000_000).map(|i| t.map(|v| v + Vec3::X * i as f32)),
        ));
        assert!(bvh.depth() < 16, "{}", bvh.depth());
    }
}
