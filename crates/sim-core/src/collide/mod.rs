//! Whether two meshes meet, where, and which features touch first.
//!
//! All functions take two meshes, the second one placed in the first one's frame ([`Placement`]),
//! and every decision is exact for the placed vertices.

mod apart;
mod ball;
mod broad;
mod closest;
mod cuboid_mesh;
mod cuboids;
mod deep;
mod form;
mod hit;
pub mod moving;
pub mod naive;
mod pairs;
mod parabola;
mod placement;
mod plane;
pub mod predicates;
mod solid;
mod sweep;
pub mod touch;
pub mod tree;
mod triple;
pub mod turning;

pub use ball::{BallTouch, ball_meets, ball_touch};
pub(crate) use ball::{is_told_by_axis, nearest};
pub(crate) use broad::{BoxTree, Broad, Front, Swept};
pub use closest::Part;
pub(crate) use closest::{Closest, closest, closest_to_point};
pub(crate) use deep::stay_in_each_other;
pub(crate) use form::{
    Contact, Form, MOST_NORMALS, first_contact, is_turned, meet, parting_normals, reach,
};
pub use hit::{Hit, Side};
pub use pairs::Level;
pub(crate) use parabola::{Parabola, first_on_parabola, has_roots};
pub use placement::Placement;
pub(crate) use placement::snap;
pub use solid::{Place, contains, each_in_box, locate, segment_meets};
pub(crate) use sweep::{Curve, stay_apart};
pub use touch::{Feature, Touch};

/// The cost of deciding whether two meshes meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    /// The answer.
    pub meet: bool,
    /// Pairs of boxes compared; if a mesh is a box, that box with the boxes of the other mesh.
    pub boxes: u64,
    /// Tests of triangles. In the naive search a test is of an edge against a triangle, through trees of two
    /// triangles, or of one triangle against a mesh that is a box.
    pub tests: u64,
}
