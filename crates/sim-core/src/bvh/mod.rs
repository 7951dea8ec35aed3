//! Bounding volume hierarchy over the triangles of a mesh.

mod build;
mod ray;

use alloc::vec::Vec;
use glam::Vec3;

use crate::{Aabb, Mesh};
pub use ray::RayHit;

/// A binary tree of boxes, flat in memory, with the triangles beside it in leaf order.
///
/// It holds all that a query needs, so that a query reads nothing else.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    depth: usize,
}

/// A box and what is below it: two nodes side by side, or a run of triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) bounds: Aabb,
    /// First of the two children, or first triangle.
    first: u32,
    /// Triangles of a leaf; 0 for an inner node.
    count: u32,
}

/// A triangle with what it owns: of the edges and corners it shares with others, those for
/// which it is the first in the mesh. Tested by owners, each edge and vertex comes up once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) corners: [Vec3; 3],
    pub(crate) face: u32,
    pub(crate) vertices: [u32; 3],
    pub(crate) edges: [u32; 3],
    pub(crate) owns_vertex: [bool; 3],
    pub(crate) owns_edge: [bool; 3],
}

/// No path from the root has more nodes, whatever the input (see `build`).
pub(crate) const MAX_DEPTH: usize = 64;

impl Bvh {
    /// Builds the tree by the surface area heuristic, in O(n log n).
    pub fn build(mesh: &Mesh) -> Bvh {
        build::build(mesh)
    }

    /// How many nodes there are, leaves included.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Levels of the tree; 1 when the root is a leaf.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Expected cost of a random ray against that of one triangle: the surface area of every
    /// node relative to the root's, weighted by the work there (MacDonald, Booth 1990).
    pub fn surface_area_cost(&self) -> f64 {
        let root = self.nodes[0].bounds.half_area();
        if root == 0.0 {
            return self.triangles.len() as f64;
        }
        let work = |n: &Node| n.bounds.half_area() * f64::from(n.count.max(1));
        self.nodes.iter().map(work).sum::<f64>() / root
    }

    /// Memory per triangle, bytes.
    pub fn bytes_per_triangle(&self) -> f64 {
        let bytes = size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..]);
        bytes as f64 / self.triangles.len() as f64
    }

    /// All boxes with their level, the root's being 0.
    pub fn boxes(&self) -> impl Iterator<Item = (usize, Aabb)> {
        let mut pending = alloc::vec![(0, 0)];
        core::iter::from_fn(move || {
            let (level, node) = pending.pop()?;
            let node = &self.nodes[node];
            if !node.is_leaf() {
                let [left, right] = node.children();
                pending.extend([(level + 1, right), (level + 1, left)]);
            }
            Some((level, node.bounds))
        })
    }

    /// The boxes of one level.
    pub fn boxes_at(&self, depth: usize) -> impl Iterator<Item = Aabb> {
        self.boxes()
            .filter_map(move |(level, bounds)| (level == depth).then_some(bounds))
    }

    pub(crate) fn node(&self, index: usize) -> &Node {
        &self.nodes[index]
    }

    pub(crate) fn leaf(&self, node: &Node) -> &[Triangle] {
        &self.triangles[node.first as usize..][..node.count as usize]
    }
}

impl Node {
    pub(crate) fn is_leaf(&self) -> bool {
        self.count > 0
    }

    pub(crate) fn children(&self) -> [usize; 2] {
        [self.first as usize, self.first as usize + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};
    use alloc::vec;

    /// Every triangle in one leaf, every box around what is below it, no level too deep.
    fn check(mesh: &Mesh) -> Bvh {
        let bvh = Bvh::build(mesh);
        let mut seen = vec![0; mesh.triangles().len()];
        let mut pending = vec![(0, 1, None::<Aabb>)];
        let mut reached = 0;
        while let Some((index, level, parent)) = pending.pop() {
            reached += 1;
            let node = bvh.node(index);
            assert!(level <= bvh.depth() && bvh.depth() <= MAX_DEPTH);
            if let Some(parent) = parent {
                assert_eq!(parent.union(node.bounds), parent);
            }
            if node.is_leaf() {
                let mut tight = Aabb::EMPTY;
                for t in bvh.leaf(node) {
                    seen[t.face as usize] += 1;
                    assert_eq!(t.corners, mesh.corners(t.face as usize));
                    tight = tight.union(Aabb::around(t.corners));
                }
                assert_eq!(tight, node.bounds);
            } else {
                pending.extend(node.children().map(|c| (c, level + 1, Some(node.bounds))));
            }
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
        // Each edge and vertex has one owner.
        let owned = |owns: fn(&Triangle) -> [bool; 3]| {
            let all = bvh.triangles.iter().flat_map(owns);
            all.filter(|&o| o).count()
        };
        assert_eq!(owned(|t| t.owns_edge), mesh.edges().len());
        assert_eq!(owned(|t| t.owns_vertex), mesh.vertices().len());
        bvh
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
        assert!(bvh.depth() < 30, "{}", bvh.depth());
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
        // Each twice as far as the last: area would split off one triangle at a time.
        let row = (0..120).map(|i| t.map(|v| (v + 1.0) * libm::exp2f(i as f32 - 60.0)));
        check(&soup(row));
    }

    #[test]
    fn a_million_triangles_in_a_line() {
        let t = [Vec3::ZERO, Vec3::X * 0.5, Vec3::Y];
        let bvh = check(&soup(
            (0..1_000_000).map(|i| t.map(|v| v + Vec3::X * i as f32)),
        ));
        assert!(bvh.depth() < 40, "{}", bvh.depth());
    }
}
