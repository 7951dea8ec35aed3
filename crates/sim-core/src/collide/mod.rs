//! Do two meshes meet, where, and which features touch first?
//!
//! All of it is about two meshes, the second displaced by an `offset` in the first one's frame.
//! Its vertices are *placed*, `fl64(f64(v) + offset)`, the same value wherever a vertex is used
//! (a component of the offset below 2^-250 m counts as zero),
//! and every decision is exact for the placed vertices.

mod apart;
mod hit;
pub mod naive;
mod pairs;
mod plane;
pub mod predicates;
pub mod touch;
pub mod tree;

pub use hit::{Hit, Side};
pub use pairs::Level;
pub use touch::{Feature, Touch};

use glam::{DVec3, Vec3};

/// An offset as it is used: components below 2^-250 m are zero.
///
/// Placed vertices are then multiples of 2^-303, as f32 has none below 2^-149, and no product in
/// an exact decision underflows.
pub(crate) fn snap(offset: DVec3) -> DVec3 {
    let least = DVec3::splat(f64::from_bits((1023 - 250) << 52));
    DVec3::select(offset.abs().cmplt(least), DVec3::ZERO, offset)
}

/// A vertex of the second mesh in the first one's frame.
fn place(v: Vec3, offset: DVec3) -> DVec3 {
    v.as_dvec3() + offset
}
