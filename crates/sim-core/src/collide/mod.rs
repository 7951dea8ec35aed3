//! Do two meshes meet, where, and which features touch first?
//!
//! All of it is about two meshes, the second one placed in the first one's frame ([`Placement`]),
//! and every decision is exact for the placed vertices.

mod apart;
mod hit;
pub mod naive;
mod pairs;
mod placement;
mod plane;
pub mod predicates;
mod solid;
pub mod touch;
pub mod tree;

pub use hit::{Hit, Side};
pub use pairs::Level;
pub use placement::Placement;
pub(crate) use placement::snap;
pub use solid::{Place, contains, each_in_box, locate, segment_meets};
pub use touch::{Feature, Touch};
