//! Bounding volume hierarchy over the triangles of a mesh.

mod build;
mod node;
mod ray;

use alloc::vec::Vec;
use glam::Vec3;

use crate::{Aabb, Mesh};
pub(crate) use node::{Child, MAX_DEPTH, Node, TRIANGLE, WIDTH};
pub use ray::RayHit;

/// A tree of boxes, four below each, flat in memory, with the triangles beside it in leaf order.
///
/// It holds all that a query needs, so that a query reads nothing else.
#[derive(Clone, Debug)]
pub struct Bvh {
    bounds: Aabb,
    /// The root first, children after their parents.
    nodes: Vec<Node>,
    /// Corners in leaf order: all that an answer of yes or no looks at.
    corners: Vec<[Vec3; 3]>,
    /// Beside each its place in the mesh.
    origin: Vec<Origin>,
    depth: usize,
}

/// Where a triangle is in the mesh, and what it owns: of the edges and corners that it shares
/// with others, those for which it is the first. By owners, each edge and vertex comes up once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin {
    pub(crate) face: u32,
    pub(crate) vertices: [u32; 3],
    pub(crate) edges: [u32; 3],
    pub(crate) owns_vertex: [bool; 3],
    pub(crate) owns_edge: [bool; 3],
}

impl Bvh {
    /// Builds the tree by the surface area heuristic, in O(n log n).
    pub fn build(mesh: &Mesh) -> Bvh {
        build::build(mesh)
    }

    /// How many nodes there are; triangles are not counted.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Levels of nodes above the triangles.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Expected number of boxes and triangles that a random ray through the root's box has to
    /// look at: the surface area of each relative to the root's (MacDonald, Booth 1990).
    pub fn surface_area_cost(&self) -> f64 {
        let root = self.bounds.half_area();
        if root == 0.0 {
            return self.corners.len() as f64;
        }
        self.boxes()
            .map(|(_, bounds)| bounds.half_area())
            .sum::<f64>()
            / root
    }

    /// Memory per triangle, bytes.
    pub fn bytes_per_triangle(&self) -> f64 {
        let bytes = size_of_val(&self.nodes[..])
            + size_of_val(&self.corners[..])
            + size_of_val(&self.origin[..]);
        bytes as f64 / self.corners.len() as f64
    }

    /// The least box around the mesh.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// All boxes with their level: the root's is 0, those of single triangles are not listed.
    pub fn boxes(&self) -> impl Iterator<Item = (usize, Aabb)> {
        let mut pending = alloc::vec![(0, 0, self.bounds)];
        core::iter::from_fn(move || {
            let (level, node, bounds) = pending.pop()?;
            let node = self.node(node);
            pending.extend((0..WIDTH).rev().filter_map(|lane| match node.child(lane)? {
                Child::Node(child) => Some((level + 1, child, node.bounds(lane))),
                Child::Triangle(_) => None,
            }));
            Some((level, bounds))
        })
    }

    /// The boxes of one level.
    pub fn boxes_at(&self, depth: usize) -> impl Iterator<Item = Aabb> {
        self.boxes()
            .filter_map(move |(level, bounds)| (level == depth).then_some(bounds))
    }

    pub(crate) fn node(&self, index: u32) -> &Node {
        &self.nodes[index as usize]
    }

    /// Corners of a triangle, by its place in leaf order.
    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.corners[triangle as usize]
    }

    pub(crate) fn origin(&self, triangle: u32) -> &Origin {
        &self.origin[triangle as usize]
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
        let mut pending = vec![(0, 1, bvh.bounds())];
        let mut reached = 0;
        while let Some((index, level, bounds)) = pending.pop() {
            reached += 1;
            assert!(level <= bvh.depth() && bvh.depth() <= MAX_DEPTH);
            let node = bvh.node(index);
            let mut tight = Aabb::EMPTY;
            for lane in 0..WIDTH {
                let box_of_lane = node.bounds(lane);
                match node.child(lane) {
                    Some(Child::Node(child)) => pending.push((child, level + 1, box_of_lane)),
                    Some(Child::Triangle(t)) => {
                        let face = bvh.origin(t).face as usize;
                        seen[face] += 1;
                        assert_eq!(bvh.corners(t), mesh.corners(face));
                        assert_eq!(Aabb::around(bvh.corners(t)), box_of_lane);
                    }
                    None => assert_eq!(box_of_lane, Aabb::EMPTY),
                }
                tight = tight.union(box_of_lane);
            }
            assert_eq!(tight, bounds);
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
        let owned = |owns: fn(&Origin) -> [bool; 3]| {
            let all = bvh.origin.iter().flat_map(owns);
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
        assert!(bvh.depth() < 12, "{}", bvh.depth());
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
        assert!(bvh.depth() < 16, "{}", bvh.depth());
    }
}
