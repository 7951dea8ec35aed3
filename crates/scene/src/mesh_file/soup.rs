//! The output of the readers of mesh files: triangles as written, not yet a mesh.

use glam::Vec3;

/// The most triangles to which one file may expand. This limits the memory that instances of instances can use.
pub(super) const MAX_TRIANGLES: usize = 10_000_000;

/// The most vertices to which one file may expand.
pub(super) const MAX_VERTICES: usize = 3 * MAX_TRIANGLES;

/// Triangles over shared vertices. Indices are in range and positions finite, but nothing is welded or oriented.
#[derive(Debug, Default)]
pub struct Soup {
    /// Vertex positions in metres, y up.
    pub vertices: Vec<Vec3>,
    /// Corner indices into `vertices`, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices of the file that no face uses and that `vertices` leaves out.
    pub unreferenced: usize,
    /// The unit of the file in metres, if the file states it.
    pub unit: Option<f64>,
    /// The up axis of the file, if the file states it.
    pub up_axis: Option<char>,
    /// The number of instances that were left out because the file scales them to zero.
    pub flat_instances: usize,
}

/// The reason why a mesh file cannot be read, without its path.
#[derive(Debug)]
pub struct ReadError {
    /// The line of the error, from 1, if it has one.
    pub line: Option<usize>,
    /// The error and its remedy.
    pub what: String,
}

impl ReadError {
    pub(super) fn new(what: impl Into<String>) -> ReadError {
        ReadError {
            line: None,
            what: what.into(),
        }
    }

    pub(super) fn at(line: usize, what: impl Into<String>) -> ReadError {
        ReadError {
            line: Some(line),
            what: what.into(),
        }
    }
}
