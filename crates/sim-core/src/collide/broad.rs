//! Which of many boxes meet: sweep and prune (Baraff 1992, "Dynamic simulation of non-penetrating
//! rigid bodies", sec. 2.1.3).
//!
//! Boxes are sorted by their lower ends along the axis on which they lie farthest apart; a box can
//! only meet those that begin before it ends. Boxes that are replaced after that are few, and kept
//! aside. Sorted afresh each time, the order of answers depends on the boxes alone.

use alloc::vec::Vec;
use glam::DVec3;

/// A box around something that moves, and whose it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
    pub(crate) body: usize,
}

impl Swept {
    fn meets(&self, other: &Swept) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}

/// Boxes in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Broad {
    boxes: Vec<Swept>,
    keys: Vec<(i64, u32)>,
    sorted: Vec<Swept>,
    aside: Vec<Swept>,
    /// For each body its place among the sorted, or after those among the others.
    place: Vec<usize>,
    axis: usize,
    /// The longest box along the axis.
    longest: f64,
}

impl Broad {
    /// Takes boxes in the place of all others.
    pub(crate) fn fill(&mut self, boxes: impl Iterator<Item = Swept>) {
        self.aside.clear();
        self.boxes.clear();
        self.boxes.extend(boxes);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut longest = DVec3::ZERO;
        let mut bodies = 0;
        for swept in &self.boxes {
            let centre = 0.5 * swept.min + 0.5 * swept.max;
            (low, high) = (low.min(centre), high.max(centre));
            longest = longest.max(swept.max - swept.min);
            bodies = bodies.max(swept.body + 1);
        }
        // In lengths of a box, so that few begin before one ends.
        let spread = (high - low) / longest.max(DVec3::splat(f64::MIN_POSITIVE));
        self.axis = spread.max_position();
        self.longest = longest[self.axis];
        // Small keys are sorted faster than boxes.
        self.keys.clear();
        let lows = self.boxes.iter().map(|swept| swept.min[self.axis]);
        self.keys.extend(lows.map(ordered).zip(0..));
        self.keys.sort_unstable();
        self.sorted.clear();
        let in_order = self
            .keys
            .iter()
            .map(|&(_, place)| self.boxes[place as usize]);
        self.sorted.extend(in_order);
        self.place.clear();
        self.place.resize(bodies, usize::MAX);
        for (place, swept) in self.sorted.iter().enumerate() {
            self.place[swept.body] = place;
        }
    }

    /// The boxes as filled.
    pub(crate) fn boxes(&self) -> &[Swept] {
        &self.boxes
    }

    /// Each pair of bodies whose boxes meet, the lower one first; as filled, without replacements.
    pub(crate) fn each_pair(&self, mut found: impl FnMut(usize, usize)) {
        for (i, first) in self.sorted.iter().enumerate() {
            for second in &self.sorted[i + 1..] {
                if second.min[self.axis] > first.max[self.axis] {
                    break;
                }
                if first.meets(second) {
                    found(first.body.min(second.body), first.body.max(second.body));
                }
            }
        }
    }

    /// Replaces the box of a body.
    pub(crate) fn replace(&mut self, swept: Swept) {
        let place = self.place[swept.body];
        match place.checked_sub(self.sorted.len()) {
            Some(aside) => self.aside[aside] = swept,
            None => {
                // Meets nothing any more, but keeps its place in the order.
                self.sorted[place].max = DVec3::NEG_INFINITY;
                self.place[swept.body] = self.sorted.len() + self.aside.len();
                self.aside.push(swept);
            }
        }
    }

    /// Each other body whose box meets a box.
    pub(crate) fn each_partner(&self, of: &Swept, mut found: impl FnMut(usize)) {
        let key = |swept: &Swept| swept.min[self.axis];
        let begin = of.min[self.axis] - self.longest * (1.0 + f64::EPSILON);
        let from = self.sorted.partition_point(|swept| key(swept) < begin);
        let sorted = self.sorted[from..].iter();
        let reachable = sorted.take_while(|swept| key(swept) <= of.max[self.axis]);
        for other in reachable.chain(&self.aside) {
            if other.body != of.body && other.meets(of) {
                found(other.body);
            }
        }
    }
}

/// An integer in the order of numbers (IEEE 754, total order).
fn ordered(value: f64) -> i64 {
    let bits = value.to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn boxes(count: usize, seed: u64) -> Vec<Swept> {
        let mut state = seed;
        let mut random = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut vector = || DVec3::new(random(), random(), random());
        (0..count)
            .map(|body| {
                let (min, size) = (10.0 * vector(), 2.0 * vector());
                Swept {
                    min,
                    max: min + size * size,
                    body,
                }
            })
            .collect()
    }

    #[test]
    fn pairs_and_partners_are_those_of_brute_force() {
        for count in [0, 1, 2, 3, 10, 300] {
            let mut all = boxes(count, 7 + count as u64);
            let mut broad = Broad::default();
            broad.fill(all.iter().copied());
            let mut pairs = vec![];
            broad.each_pair(|i, j| pairs.push((i, j)));
            pairs.sort_unstable();
            let mut expected = vec![];
            for j in 0..count {
                expected.extend((0..j).filter(|&i| all[i].meets(&all[j])).map(|i| (i, j)));
            }
            expected.sort_unstable();
            assert_eq!(pairs, expected);
            assert!(count < 300 || pairs.len() > 100);
            // Some move, one of them twice.
            for (step, new) in boxes(count, 99).into_iter().enumerate() {
                if step % 3 == 0 || step == 1 {
                    let body = if step == 1 { 0 } else { new.body };
                    all[body] = Swept { body, ..new };
                    broad.replace(all[body]);
                }
            }
            for of in &all {
                let mut partners = vec![];
                broad.each_partner(of, |other| partners.push(other));
                partners.sort_unstable();
                let others = all.iter().filter(|other| other.body != of.body);
                let expected: Vec<_> = others.filter(|o| o.meets(of)).map(|o| o.body).collect();
                assert_eq!(partners, expected);
            }
        }
    }
}
