//! An order of bodies that comes from their motion, whatever their places in the columns are.

use alloc::vec::Vec;
use core::cmp::Ordering;
use glam::DVec3;

use super::World;

/// What tells one body from another: position, velocity, mass, and the acceleration by constant
/// forces. Bodies of which these are the same may take each other's place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Key([f64; 10]);

impl World {
    /// The key of a body where the step begins.
    pub(super) fn motion_key(&self, body: usize) -> Key {
        let [x, y, z] = self.previous.position[body].to_array();
        let [u, v, w] = self.previous.velocity[body].to_array();
        let [a, b, c] = self.acceleration[body].to_array();
        Key([x, y, z, u, v, w, self.mass[body], a, b, c])
    }

    /// Those of some pairs, once each, in that order.
    pub(super) fn in_order(&self, pairs: impl Iterator<Item = (usize, usize)>) -> InOrder {
        let mut bodies: Vec<usize> = pairs.flat_map(|(i, j)| [i, j]).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let key = |body: usize| (self.motion_key(body), body);
        let mut keys: Vec<(Key, usize)> = bodies.into_iter().map(key).collect();
        keys.sort_unstable();
        let bodies: Vec<usize> = keys.into_iter().map(|(_, body)| body).collect();
        let mut places: Vec<(usize, usize)> = bodies.iter().copied().zip(0..).collect();
        places.sort_unstable();
        InOrder { bodies, places }
    }
}

/// Bodies in order, and the place of each among them.
pub(super) struct InOrder {
    pub(super) bodies: Vec<usize>,
    /// By body.
    places: Vec<(usize, usize)>,
}

impl InOrder {
    /// The place of one of the bodies.
    pub(super) fn place(&self, body: usize) -> usize {
        let before = |&(other, _): &(usize, usize)| other < body;
        self.places[self.places.partition_point(before)].1
    }

    /// Compares what is between two of the bodies each, along a normal from the first one to the second.
    pub(super) fn compare(
        &self,
        one: ((usize, usize), DVec3),
        other: ((usize, usize), DVec3),
    ) -> Ordering {
        let (one_pair, one_normal) = self.turned(one);
        let (other_pair, other_normal) = self.turned(other);
        let by_bodies = one_pair.cmp(&other_pair);
        by_bodies.then_with(|| of_vectors(one_normal, other_normal))
    }

    /// The places of a pair, the lower one first, and the normal from it.
    fn turned(&self, ((i, j), normal): ((usize, usize), DVec3)) -> ((usize, usize), DVec3) {
        let (first, second) = (self.place(i), self.place(j));
        match first > second {
            true => ((second, first), -normal),
            false => ((first, second), normal),
        }
    }
}

impl Ord for Key {
    fn cmp(&self, other: &Key) -> Ordering {
        lexicographic(&self.0, &other.0)
    }
}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Key) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Key {
    fn eq(&self, other: &Key) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Key {}

/// Of vectors: by the first component that differs.
pub(super) fn of_vectors(one: DVec3, other: DVec3) -> Ordering {
    lexicographic(&one.to_array(), &other.to_array())
}

fn lexicographic(one: &[f64], other: &[f64]) -> Ordering {
    let pairs = one.iter().zip(other);
    pairs
        .map(|(one, other)| one.total_cmp(other))
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}
