//! Makes the project's cow at any resolution.
//!
//! The cow is an implicit surface ([`model`]) built from signed distance
//! functions ([`sdf`]), meshed and simplified to a wanted number of triangles
//! ([`mesh`]), validated ([`check`]) and written to a file ([`mod@write`]).
//!
//! The cow faces -x, y is up, lengths are in metres and the origin is the
//! centre of the bounding box. The same request gives the same mesh.

pub mod check;
mod grid;
pub mod mesh;
pub mod model;
mod overlap;
pub mod sdf;
pub mod write;

pub use mesh::{CowError, CowMesh, cow};
