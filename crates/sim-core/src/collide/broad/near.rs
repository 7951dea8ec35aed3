//! Boxes of bodies at rest, for many queries.

use super::{rows::Rows, volume::Swept};

/// A tree of boxes.
#[derive(Debug)]
pub(crate) struct BoxTree(Rows);

impl BoxTree {
    /// A tree over the boxes of some bodies.
    pub(crate) fn of(bodies: &[usize], swept: impl Fn(usize) -> Swept) -> BoxTree {
        let mut rows = Rows::default();
        rows.fill(bodies, false, swept);
        BoxTree(rows)
    }

    /// Visits bodies, near ones early. `near` returns a lower bound on the distance for the contents of a box, and
    /// infinity for a box to skip. `visit` receives a body and returns the limit for the next ones.
    pub(crate) fn visit(
        &self,
        near: impl Fn(&Swept) -> f64,
        limit: f64,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        self.0.visit_near(&near, limit, &mut visit);
    }
}
