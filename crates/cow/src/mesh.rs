//! From the implicit surface to a triangle mesh with a wanted number of triangles.

use crate::{check::check, grid::Grid, model::Model};
use fast_surface_nets::{SurfaceNetsBuffer, ndshape::RuntimeShape, surface_nets};
use glam::Vec3;
use meshopt::SimplifyOptions;
use std::ops::RangeInclusive;

/// Numbers of triangles that [`cow`] can make.
pub const TRIANGLES: RangeInclusive<usize> = 1_000..=400_000;

/// Below this many triangles the details are too small for the triangles.
const TRIANGLES_FOR_DETAILS: usize = 3_000;

/// A box around the model, m.
const LOW: Vec3 = Vec3::new(-1.47, -0.02, -0.42);
const HIGH: Vec3 = Vec3::new(1.08, 1.73, 0.42);

/// A triangle mesh, counterclockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CowMesh {
    /// Positions, m.
    pub vertices: Vec<[f32; 3]>,
    /// Indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
}

/// Why there is no cow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CowError {
    /// The wanted number of triangles is out of range.
    #[error(
        "{0} triangles are out of range; ask for {low} to {high}",
        low = TRIANGLES.start(),
        high = TRIANGLES.end()
    )]
    Count(usize),
    /// Every attempt at simplification left a defect.
    #[error("no sound cow with {0} triangles found; ask for a slightly different number")]
    Unsound(usize),
}

/// Makes the cow with about `triangles` triangles (within 2 %).
///
/// The mesh is closed, manifold, connected, of genus 0 and free of
/// self-intersections. It faces -x with y up, is 2.46 m long, 1.70 m high
/// to the horns and 0.74 m wide, and its bounding box is centred on the origin. The same number gives the same mesh.
///
/// # Errors
///
/// [`CowError::Count`] unless [`TRIANGLES`] contains `triangles`, and
/// [`CowError::Unsound`] if no attempt passes [`check()`].
pub fn cow(triangles: usize) -> Result<CowMesh, CowError> {
    if !TRIANGLES.contains(&triangles) {
        return Err(CowError::Count(triangles));
    }
    let model = if triangles < TRIANGLES_FOR_DETAILS {
        Model::plain_cow()
    } else {
        Model::cow()
    };
    // Simplification guards against flipped triangles but not against those of
    // other parts, and rarely it pinches something thin. Another start gives
    // another order of collapses.
    for refinement in [1.0, 0.96, 0.92] {
        let fine = extract(&model, spacing(triangles) * refinement);
        for stages in 1..=3 {
            let staged = (0..stages).rev().fold(fine.clone(), |mesh, stage| {
                simplify(mesh, triangles << stage)
            });
            let mesh = centred(staged);
            let report = check(&mesh);
            let close = report.triangles.abs_diff(triangles) * 50 <= triangles;
            if close && report.is_sound() && report.euler == 2 {
                return Ok(mesh);
            }
        }
    }
    Err(CowError::Unsound(triangles))
}

/// Spacing of a grid that gives a few times `triangles`, m.
fn spacing(triangles: usize) -> f32 {
    // Surface nets make about two triangles for each cell that the surface
    // crosses: 18 m² over the square of the spacing. The bounds keep the
    // details in and the memory at some 300 MB.
    (18.0 / (4.0 * triangles as f32))
        .sqrt()
        .clamp(0.0047, 0.008)
}

/// Meshes the model's surface on a grid.
fn extract(model: &Model, spacing: f32) -> CowMesh {
    let grid = Grid::sample(model, LOW, HIGH, spacing);
    let size = grid.size.map(|n| n as u32);
    let mut nets = SurfaceNetsBuffer::default();
    surface_nets(
        &grid.values,
        &RuntimeShape::<u32, 3>::new(size),
        [0; 3],
        size.map(|n| n - 1),
        &mut nets,
    );
    CowMesh {
        vertices: nets
            .positions
            .iter()
            .map(|&p| (grid.origin + Vec3::from(p) * grid.spacing).into())
            .collect(),
        triangles: nets.indices.as_chunks().0.to_vec(),
    }
}

/// Collapses edges, moving the vertices that stay to where the error is least.
fn simplify(mut mesh: CowMesh, triangles: usize) -> CowMesh {
    let mut indices = mesh.triangles.as_flattened().to_vec();
    let count = meshopt::simplify_with_update(
        &mut indices,
        &mut mesh.vertices,
        &mut [],
        &[],
        0,
        None,
        triangles * 3,
        f32::MAX,
        SimplifyOptions::RegularizeLight,
        None,
    );
    indices.truncate(count);
    let mut renumbered = vec![u32::MAX; mesh.vertices.len()];
    let mut vertices = Vec::new();
    for i in &mut indices {
        let old = *i as usize;
        if renumbered[old] == u32::MAX {
            renumbered[old] = vertices.len() as u32;
            vertices.push(mesh.vertices[old]);
        }
        *i = renumbered[old];
    }
    CowMesh {
        vertices,
        triangles: indices.as_chunks().0.to_vec(),
    }
}

/// The mesh moved so that the centre of its bounding box is the origin.
fn centred(mut mesh: CowMesh) -> CowMesh {
    let (low, high) = mesh
        .vertices
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &v| {
            (low.min(v.into()), high.max(v.into()))
        });
    let middle = (low + high) * 0.5;
    for v in &mut mesh.vertices {
        *v = (Vec3::from(*v) - middle).into();
    }
    mesh
}
