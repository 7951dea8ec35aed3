//! What is to be known of a mesh that has been loaded.

use sim_core::Mesh;

use super::LoadedMesh;

/// Figures of a loaded mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Vertices merged into an earlier one at the same position.
    pub welded_vertices: usize,
    /// Triangles left out as they have no area.
    pub degenerate_triangles: usize,
    /// Triangles left out as an earlier one has the same corners.
    pub duplicate_triangles: usize,
    /// Vertices left out as no triangle uses them.
    pub unreferenced_vertices: usize,
    /// Triangles turned over, as a closed mesh was wound inward: all or none.
    pub flipped_triangles: usize,
    /// Instances left out as the file scales them to nothing.
    pub flat_instances: usize,
    /// Edges of one triangle only.
    pub boundary_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Pieces that hang together by vertices.
    pub components: usize,
    /// Whether every edge belongs to exactly two triangles.
    pub closed: bool,
    /// Whether triangles with a common edge run along it in opposite directions.
    pub oriented: bool,
    /// The enclosed volume, m³, of a closed and oriented mesh.
    pub volume: Option<f64>,
    /// Size along x, y and z, m.
    pub extent: [f64; 3],
    /// Metres in a unit of the file, where it says so.
    pub unit: Option<f64>,
    /// The axis that is up in the file, where it says so.
    pub up_axis: Option<char>,
}

impl LoadedMesh {
    /// The figures of the mesh and of how it was read.
    pub fn report(&self) -> MeshReport {
        let (mesh, repairs) = (&self.mesh, &self.repairs);
        let mut triangles_at = vec![0_u32; mesh.edges().len()];
        for &edge in mesh.triangle_edges().iter().flatten() {
            triangles_at[edge as usize] += 1;
        }
        let edges = |wanted: fn(u32) -> bool| {
            let counts = triangles_at.iter();
            counts.filter(|&&count| wanted(count)).count()
        };
        let flipped = repairs.reversed_winding;
        MeshReport {
            vertices: mesh.vertices().len(),
            triangles: mesh.triangles().len(),
            welded_vertices: repairs.welded_vertices,
            degenerate_triangles: repairs.degenerate_triangles,
            duplicate_triangles: repairs.duplicate_triangles,
            unreferenced_vertices: repairs.unreferenced_vertices,
            flipped_triangles: if flipped { mesh.triangles().len() } else { 0 },
            flat_instances: self.flat_instances,
            boundary_edges: edges(|count| count == 1),
            non_manifold_edges: edges(|count| count > 2),
            components: components(mesh),
            closed: mesh.is_closed(),
            oriented: mesh.is_oriented(),
            volume: mesh.volume(),
            extent: (2.0 * mesh.bounds().half_extent()).to_array(),
            unit: self.unit,
            up_axis: self.up_axis,
        }
    }
}

/// How many pieces there are: one for each vertex, less one for each edge that joins two.
fn components(mesh: &Mesh) -> usize {
    let mut parent: Vec<u32> = (0..mesh.vertices().len() as u32).collect();
    let mut pieces = parent.len();
    for &[a, b] in mesh.edges() {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        if a != b {
            parent[a.max(b) as usize] = a.min(b);
            pieces -= 1;
        }
    }
    pieces
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        // Halves the way for who comes next.
        let above = parent[parent[vertex as usize] as usize];
        parent[vertex as usize] = above;
        vertex = above;
    }
    vertex
}
