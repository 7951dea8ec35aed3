//! Connected components, by union-find.

use alloc::vec::Vec;

/// Union-find (Galler, Fischer 1964, "An improved equivalence algorithm") with path halving (Tarjan, van
/// Leeuwen 1984).
pub(crate) struct Pieces {
    parent: Vec<u32>,
}

impl Pieces {
    /// Each element is a component of its own.
    pub(crate) fn new(count: usize) -> Pieces {
        Pieces {
            parent: (0..count as u32).collect(),
        }
    }

    /// The first element in the component of an element.
    pub(crate) fn first(&mut self, of: usize) -> usize {
        let (parent, mut at) = (&mut self.parent, of);
        while parent[at] as usize != at {
            parent[at] = parent[parent[at] as usize];
            at = parent[at] as usize;
        }
        at
    }

    /// Joins the components of two elements; returns whether they were different.
    pub(crate) fn join(&mut self, one: usize, other: usize) -> bool {
        let (one, other) = (self.first(one), self.first(other));
        self.parent[one.max(other)] = one.min(other) as u32;
        one != other
    }
}

/// A number for each pair of bodies; pairs connected by movable bodies have the same number.
pub(crate) fn ties(
    pairs: impl Iterator<Item = (usize, usize)> + Clone,
    bodies: usize,
    is_movable: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let mut pieces = Pieces::new(bodies);
    for (i, j) in pairs.clone() {
        if is_movable(i) && is_movable(j) {
            pieces.join(i, j);
        }
    }
    pairs
        .map(|(i, j)| pieces.first(if is_movable(i) { i } else { j }))
        .collect()
}
