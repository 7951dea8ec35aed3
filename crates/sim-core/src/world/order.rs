//! An order of bodies that depends on their motion, not on their places in the columns.

use alloc::vec::Vec;
use glam::DVec3;

use super::{bodies::Bodies, state::State};

/// The numbers that distinguish bodies: position, velocity, mass, and the acceleration by constant forces. Bodies for
/// which all of these are equal are interchangeable.
pub(super) type Key = [i64; 10];

/// The key of a body in a state.
pub(super) fn key(bodies: &Bodies, motion: &State, body: usize) -> Key {
    let [x, y, z] = motion.position[body].to_array();
    let [u, v, w] = motion.velocity[body].to_array();
    let [a, b, c] = bodies.acceleration[body].to_array();
    [x, y, z, u, v, w, bodies.mass[body], a, b, c].map(ordinal)
}

/// Some bodies, once each, in the order of their keys.
pub(super) fn in_order(
    bodies: &Bodies,
    motion: &State,
    these: impl Iterator<Item = usize>,
) -> InOrder {
    let mut these: Vec<usize> = these.collect();
    these.sort_unstable();
    these.dedup();
    // By the first number of their keys, which is enough in nearly all cases.
    let first = |body: usize| ordinal(motion.position[body].x);
    let mut keys: Vec<(i64, usize)> = these.iter().map(|&body| first(body)).zip(0..).collect();
    keys.sort_unstable_by(|&(x, one), &(y, other)| {
        let of = |place: usize| (key(bodies, motion, these[place]), place);
        x.cmp(&y).then_with(|| of(one).cmp(&of(other)))
    });
    let mut places: Vec<(usize, usize)> = these.iter().map(|&body| (body, 0)).collect();
    for (order, &(_, place)) in keys.iter().enumerate() {
        places[place].1 = order;
    }
    let bodies = keys.iter().map(|&(_, place)| these[place]).collect();
    InOrder { bodies, places }
}

/// Bodies in order, and the position of each body in this order.
#[derive(Clone, Debug, Default)]
pub(super) struct InOrder {
    pub(super) bodies: Vec<usize>,
    /// Pairs of body and position, sorted by body.
    places: Vec<(usize, usize)>,
}

impl InOrder {
    /// The place of one of the bodies.
    pub(super) fn place(&self, body: usize) -> usize {
        let before = |&(other, _): &(usize, usize)| other < body;
        self.places[self.places.partition_point(before)].1
    }

    /// A key of a vector between two of the bodies: a normal from the first body to the second.
    pub(super) fn between(&self, (i, j): (usize, usize), normal: DVec3) -> ([usize; 2], [i64; 3]) {
        let (first, second) = (self.place(i), self.place(j));
        match first > second {
            true => ([second, first], of_vector(-normal)),
            false => ([first, second], of_vector(normal)),
        }
    }
}

/// A key of a vector.
pub(super) fn of_vector(vector: DVec3) -> [i64; 3] {
    vector.to_array().map(ordinal)
}

/// An integer with the order of `f64::total_cmp`, except that both zeros are equal: an order of bodies must not
/// depend on the sign of zero.
pub(super) fn ordinal(number: f64) -> i64 {
    let bits = (number + 0.0).to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

#[cfg(test)]
mod tests {
    use super::ordinal;

    #[test]
    fn keys_have_the_order_of_numbers() {
        assert_eq!(ordinal(-0.0), ordinal(0.0));
        let mut numbers = [1.0, 1e-310, 1e300, f64::INFINITY].to_vec();
        numbers.extend(numbers.clone().iter().map(|x| -x));
        numbers.push(0.0);
        for &one in &numbers {
            for &other in &numbers {
                let order = ordinal(one).cmp(&ordinal(other));
                assert_eq!(order, one.total_cmp(&other), "{one} {other}");
            }
        }
    }
}
