//! The edges of a mesh, and how they connect its triangles.

use alloc::{vec, vec::Vec};

use crate::pieces::Pieces;

/// The corners and edges of a triangle that it owns: it is the first triangle that has them. Every edge and vertex has
/// exactly one owner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Owned {
    pub(crate) vertex: [bool; 3],
    pub(crate) edge: [bool; 3],
}

/// The triangles of a mesh, their edges, and properties that follow from the number of triangles at each edge:
/// everything except the positions of vertices, so that a tree can share it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Topology {
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) edges: Vec<[u32; 2]>,
    pub(crate) triangle_edges: Vec<[u32; 3]>,
    pub(crate) owned: Vec<Owned>,
    pub(crate) closed: bool,
    pub(crate) oriented: bool,
    /// Whether a path of edges leads from each vertex to every other one.
    pub(crate) connected: bool,
}

impl Topology {
    /// The topology of triangles over a number of vertices.
    pub(super) fn of(vertices: usize, triangles: Vec<[u32; 3]>) -> Topology {
        // Every side of every triangle, sorted so that the sides of one edge are adjacent.
        let mut sides: Vec<(u64, u32)> = Vec::with_capacity(3 * triangles.len());
        for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
            for (side, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
                sides.push((edge_key(from, to), (3 * triangle + side) as u32));
            }
        }
        sides.sort_unstable();

        let mut topology = Topology {
            edges: Vec::with_capacity(sides.len() / 2 + 1),
            triangle_edges: vec![[0; 3]; triangles.len()],
            owned: vertex_owners(vertices, &triangles),
            closed: true,
            oriented: true,
            connected: false,
            triangles: Vec::new(),
        };
        for run in sides.chunk_by(|x, y| x.0 == y.0) {
            let edge = topology.edges.len() as u32;
            topology
                .edges
                .push([(run[0].0 >> 32) as u32, run[0].0 as u32]);
            // The sides of one edge are in the order of their triangles.
            let first = run[0].1 as usize;
            topology.owned[first / 3].edge[first % 3] = true;
            let mut upward = 0;
            for &(_, place) in run {
                let (triangle, side) = (place as usize / 3, place as usize % 3);
                topology.triangle_edges[triangle][side] = edge;
                let corners = triangles[triangle];
                upward += usize::from(corners[side] < corners[(side + 1) % 3]);
            }
            topology.closed &= run.len() == 2;
            topology.oriented &= upward <= 1 && run.len() - upward <= 1;
        }
        topology.connected = is_connected(vertices, &topology.edges);
        topology.triangles = triangles;
        topology
    }

    /// Reverses the winding of every triangle.
    pub(super) fn reverse_winding(&mut self) {
        for [_, b, c] in &mut self.triangles {
            core::mem::swap(b, c);
        }
        for [ab, _, ca] in &mut self.triangle_edges {
            core::mem::swap(ab, ca);
        }
        for Owned { vertex, edge } in &mut self.owned {
            vertex.swap(1, 2);
            edge.swap(0, 2);
        }
    }
}

/// Orders edges by their lower vertex, then by their higher one.
fn edge_key(from: u32, to: u32) -> u64 {
    u64::from(from.min(to)) << 32 | u64::from(from.max(to))
}

fn vertex_owners(vertices: usize, triangles: &[[u32; 3]]) -> Vec<Owned> {
    let mut owned = vec![Owned::default(); triangles.len()];
    let mut seen = vec![false; vertices];
    for (corners, owned) in triangles.iter().zip(&mut owned) {
        for (&v, owned) in corners.iter().zip(&mut owned.vertex) {
            *owned = !core::mem::replace(&mut seen[v as usize], true);
        }
    }
    owned
}

fn is_connected(vertices: usize, edges: &[[u32; 2]]) -> bool {
    let mut pieces = Pieces::new(vertices);
    let joins = edges
        .iter()
        .filter(|[a, b]| pieces.join(*a as usize, *b as usize));
    joins.count() + 1 == vertices
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};

    #[test]
    fn each_edge_and_vertex_has_one_owner() {
        for mesh in [cube(), sphere(20)] {
            let mut turned = Topology::clone(mesh.topology());
            turned.reverse_winding();
            for topology in [mesh.topology(), &turned] {
                let mut vertices = vec![0; mesh.vertices().len()];
                let mut edges = vec![0; mesh.edges().len()];
                for (triangle, owned) in topology.owned.iter().enumerate() {
                    for side in 0..3 {
                        let vertex = topology.triangles[triangle][side] as usize;
                        vertices[vertex] += usize::from(owned.vertex[side]);
                        let edge = topology.triangle_edges[triangle][side] as usize;
                        edges[edge] += usize::from(owned.edge[side]);
                    }
                }
                assert!(vertices.iter().chain(&edges).all(|&owners| owners == 1));
            }
        }
    }

    #[test]
    fn pieces_and_loose_vertices_do_not_hang_together() {
        let connected =
            |vertices, triangles: &[[u32; 3]]| Topology::of(vertices, triangles.to_vec()).connected;
        assert!(cube().topology().connected && sphere(20).topology().connected);
        assert!(connected(5, &[[0, 1, 2], [2, 3, 4]]));
        assert!(connected(7, &[[5, 6, 1], [3, 4, 2], [0, 1, 2]]));
        assert!(!connected(6, &[[0, 1, 2], [3, 4, 5]]));
        assert!(!connected(4, &[[0, 1, 2]]));
    }
}
