//! The figures of a loaded mesh.

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
    /// Triangles left out because they have no area.
    pub degenerate_triangles: usize,
    /// Triangles left out because an earlier one has the same corners.
    pub duplicate_triangles: usize,
    /// Vertices left out because no triangle uses them.
    pub unreferenced_vertices: usize,
    /// Triangles flipped because a closed mesh was oriented inwards: all or none.
    pub flipped_triangles: usize,
    /// Instances left out because the file scales them to zero.
    pub flat_instances: usize,
    /// Edges of one triangle only.
    pub boundary_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Connected components, by common vertices.
    pub components: usize,
    /// Whether every edge belongs to exactly two triangles.
    pub closed: bool,
    /// Whether the two triangles at each common edge traverse it in opposite directions.
    pub oriented: bool,
    /// The enclosed volume of a closed and oriented mesh, m³.
    pub volume: Option<f64>,
    /// Size along x, y and z, m.
    pub extent: [f64; 3],
    /// The unit of the file in metres, if the file states it.
    pub unit: Option<f64>,
    /// The up axis of the file, if the file states it.
    pub up_axis: Option<char>,
}

impl LoadedMesh {
    /// The figures of the mesh and of its repairs.
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

/// The number of components: one for each vertex, minus one for each edge that joins two components.
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
        // Path halving, which shortens later searches.
        let above = parent[parent[vertex as usize] as usize];
        parent[vertex as usize] = above;
        vertex = above;
    }
    vertex
}
