//! Boxes of bodies at rest, for many queries.

use super::{rows::Rows, volume::Swept};

/// A tree of boxes.
#[derive(Debug)]
pub(crate) struct BoxTree(Rows);

impl BoxTree {
    /// Over the boxes of some bodies.
    pub(crate) fn of(bodies: &[usize], swept: impl Fn(usize) -> Swept) -> BoxTree {
        let mut rows = Rows::default();
        rows.fill(bodies, false, swept);
        BoxTree(rows)
    }

    /// Visits bodies, the nearest ones early. `near` tells from a box how near what is in it is at least, and
    /// infinity for what is not to be visited; `visit` takes a body and returns how near others have to be.
    pub(crate) fn visit(
        &self,
        near: impl Fn(&Swept) -> f64,
        limit: f64,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        self.0.visit_near(&near, limit, &mut visit);
    }
}
