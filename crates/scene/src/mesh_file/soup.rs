//! What the readers of mesh files hand over: triangles as written, not yet a mesh.

use glam::Vec3;

/// The most triangles one file may expand to, so that instances of instances cannot fill the
/// memory.
pub(super) const MAX_TRIANGLES: usize = 10_000_000;

/// The most vertices one file may expand to.
pub(super) const MAX_VERTICES: usize = 3 * MAX_TRIANGLES;

/// Triangles over shared vertices, in range and finite, but neither welded nor oriented.
#[derive(Debug, Default)]
pub struct Soup {
    /// Vertex positions in metres, y up.
    pub vertices: Vec<Vec3>,
    /// Corner indices into `vertices`, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices of the file that no face uses and that `vertices` leaves out.
    pub unreferenced: usize,
    /// Metres in a unit of the file, where it says so.
    pub unit: Option<f64>,
    /// The axis that is up in the file, where it says so.
    pub up_axis: Option<char>,
    /// Instances that the file scales to nothing and that are left out.
    pub flat_instances: usize,
}

/// Why a mesh file cannot be read, without its path.
#[derive(Debug)]
pub struct ReadError {
    /// The line of the file, from 1, where there is one to blame.
    pub line: Option<usize>,
    /// What is wrong and what to do about it.
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
