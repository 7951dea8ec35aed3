//! Which of many boxes meet.
//!
//! Boxes are sorted along a curve that keeps neighbours together (Morton 1966, "A computer oriented
//! geodetic data base and a new technique in file sequencing"). Eight in a row have a box around them,
//! eight of these another, and so on: a tree without a pointer, made afresh in each step in less time
//! than it takes to ask it. Boxes that are replaced after that are few, and kept aside.

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
    const NOWHERE: Swept = Swept {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
        body: usize::MAX,
    };

    fn meets(&self, other: &Swept) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}

/// So many boxes are faster swept along an axis: sorted by their lower ends, a box can only meet
/// those that begin before it ends (Baraff 1992, "Dynamic simulation of non-penetrating rigid
/// bodies", sec. 2.1.3).
const FEW: usize = 512;

/// Boxes in a box.
const WIDTH: usize = 8;

/// Boxes side by side, by axis, so that a few instructions take all.
#[derive(Clone, Copy, Debug)]
struct Row {
    min: [[f64; WIDTH]; 3],
    max: [[f64; WIDTH]; 3],
}

impl Row {
    fn of(boxes: &[Swept]) -> Row {
        let mut row = Row {
            min: [[f64::INFINITY; WIDTH]; 3],
            max: [[f64::NEG_INFINITY; WIDTH]; 3],
        };
        for (lane, swept) in boxes.iter().enumerate() {
            for axis in 0..3 {
                row.min[axis][lane] = swept.min[axis];
                row.max[axis][lane] = swept.max[axis];
            }
        }
        row
    }

    /// A bit for each that meets a box.
    #[inline(always)]
    fn meeting(&self, of: &Swept) -> u32 {
        let mut apart = [false; WIDTH];
        for axis in 0..3 {
            let (low, high) = (of.min[axis], of.max[axis]);
            let ends = self.min[axis].iter().zip(&self.max[axis]);
            for (apart, (&min, &max)) in apart.iter_mut().zip(ends) {
                *apart |= (min > high) | (max < low);
            }
        }
        let bits = apart.iter().enumerate();
        bits.fold(0, |bits, (lane, &apart)| bits | u32::from(!apart) << lane)
    }

    /// The box around all.
    fn around(&self) -> Swept {
        let least = |x: &[f64; WIDTH]| x.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = |x: &[f64; WIDTH]| x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Swept {
            min: DVec3::from_array(self.min.each_ref().map(least)),
            max: DVec3::from_array(self.max.each_ref().map(greatest)),
            body: usize::MAX,
        }
    }
}

/// Boxes in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Broad {
    boxes: Vec<Swept>,
    keys: Vec<(u64, u32)>,
    sorted: Vec<Swept>,
    /// Rows of the sorted boxes, of the boxes around those, and so on to one.
    levels: Vec<Vec<Row>>,
    aside: Vec<Swept>,
    /// The axis along which the boxes are sorted, if it is not the curve.
    sweep: Option<usize>,
    /// For each body its place among the sorted, or after those among the others.
    place: Vec<usize>,
}

impl Broad {
    /// Takes boxes in the place of all others.
    pub(crate) fn fill(&mut self, boxes: impl Iterator<Item = Swept>) {
        self.aside.clear();
        self.boxes.clear();
        self.boxes.extend(boxes);
        self.sort();
        let mut depth = 0;
        loop {
            if self.levels.len() == depth {
                self.levels.push(Vec::new());
            }
            let (below, level) = self.levels.split_at_mut(depth);
            let level = &mut level[0];
            level.clear();
            match below.last() {
                None => level.extend(self.sorted.chunks(WIDTH).map(Row::of)),
                Some(below) => level.extend(below.chunks(WIDTH).map(|rows| {
                    let mut around = [Swept::NOWHERE; WIDTH];
                    for (around, row) in around.iter_mut().zip(rows) {
                        *around = row.around();
                    }
                    Row::of(&around)
                })),
            }
            depth += 1;
            if level.len() <= 1 {
                break;
            }
        }
        self.levels.truncate(depth);
        let bodies = self.boxes.iter().map(|swept| swept.body + 1).max();
        self.place.clear();
        self.place.resize(bodies.unwrap_or(0), usize::MAX);
        for (place, swept) in self.sorted.iter().enumerate() {
            self.place[swept.body] = place;
        }
    }

    fn sort(&mut self) {
        let centre = |swept: &Swept| 0.5 * swept.min + 0.5 * swept.max;
        let centres = || self.boxes.iter().map(centre);
        let low = centres().fold(DVec3::INFINITY, DVec3::min);
        let high = centres().fold(DVec3::NEG_INFINITY, DVec3::max);
        let axis = (high - low).max_position();
        let longest = (high - low).max_element();
        let cells = if longest > 0.0 { CELLS / longest } else { 0.0 };
        self.sweep = (self.boxes.len() <= FEW).then_some(axis);
        let key = |swept: &Swept| match self.sweep {
            Some(axis) => ordered(swept.min[axis]),
            None => curve((centre(swept) - low) * cells),
        };
        self.keys.clear();
        self.keys.extend(self.boxes.iter().map(key).zip(0..));
        self.keys.sort_unstable();
        self.sorted.clear();
        let in_order = self
            .keys
            .iter()
            .map(|&(_, place)| self.boxes[place as usize]);
        self.sorted.extend(in_order);
    }

    /// The boxes as filled.
    pub(crate) fn boxes(&self) -> &[Swept] {
        &self.boxes
    }

    /// Each pair of bodies whose boxes meet, the lower one first; as filled, without replacements.
    pub(crate) fn each_pair(&self, mut found: impl FnMut(usize, usize)) {
        for (place, first) in self.sorted.iter().enumerate() {
            let mut found = |second: usize| found(first.body.min(second), first.body.max(second));
            if let Some(axis) = self.sweep {
                let after = self.sorted[place + 1..].iter();
                let reachable = after.take_while(|other| other.min[axis] <= first.max[axis]);
                for other in reachable.filter(|other| other.meets(first)) {
                    found(other.body);
                }
                continue;
            }
            let own = place / WIDTH;
            self.each_row(first, own, (self.levels.len(), 0), &mut |row| {
                let after = if row == own {
                    u32::MAX << (place % WIDTH + 1)
                } else {
                    u32::MAX
                };
                self.each_in_row(row, first, after, &mut found);
            });
        }
    }

    /// Replaces the box of a body.
    pub(crate) fn replace(&mut self, swept: Swept) {
        let place = self.place[swept.body];
        match place.checked_sub(self.sorted.len()) {
            Some(aside) => self.aside[aside] = swept,
            None => {
                // Meets nothing any more, but keeps its place in the order.
                self.levels[0][place / WIDTH].max[0][place % WIDTH] = f64::NEG_INFINITY;
                self.place[swept.body] = self.sorted.len() + self.aside.len();
                self.aside.push(swept);
            }
        }
    }

    /// Each other body whose box meets a box.
    pub(crate) fn each_partner(&self, of: &Swept, mut found: impl FnMut(usize)) {
        let mut found = |other| {
            if other != of.body {
                found(other);
            }
        };
        self.each_row(of, 0, (self.levels.len(), 0), &mut |row| {
            self.each_in_row(row, of, u32::MAX, &mut found);
        });
        for other in self.aside.iter().filter(|other| other.meets(of)) {
            found(other.body);
        }
    }

    /// Each row of sorted boxes, from one on, whose box meets a box, within a row of a level. Level 0
    /// are the rows of sorted boxes themselves.
    fn each_row(
        &self,
        of: &Swept,
        from: usize,
        (level, index): (usize, usize),
        found: &mut impl FnMut(usize),
    ) {
        if level <= 1 {
            return found(index);
        }
        let row = &self.levels[level - 1][index];
        // How many rows of sorted boxes are in one of these.
        let inside = WIDTH.pow(level as u32 - 2);
        let mut meeting = row.meeting(of);
        while meeting != 0 {
            let child = index * WIDTH + meeting.trailing_zeros() as usize;
            meeting &= meeting - 1;
            if (child + 1) * inside > from {
                self.each_row(of, from, (level - 1, child), found);
            }
        }
    }

    /// Some bodies of a row, those whose box meets one.
    fn each_in_row(&self, row: usize, of: &Swept, which: u32, found: &mut impl FnMut(usize)) {
        let Some(boxes) = self.levels[0].get(row) else {
            return;
        };
        let mut meeting = boxes.meeting(of) & which;
        while meeting != 0 {
            let place = row * WIDTH + meeting.trailing_zeros() as usize;
            meeting &= meeting - 1;
            found(self.sorted[place].body);
        }
    }
}

/// Cells of the curve along an axis.
const CELLS: f64 = 2_097_151.0;

/// An integer in the order of numbers (IEEE 754, total order).
fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits >> 63 == 0 {
        bits | 1 << 63
    } else {
        !bits
    }
}

/// The place of a cell on the curve: the bits of its three coordinates in turns.
fn curve(cell: DVec3) -> u64 {
    let spread = |x: f64| {
        let mut bits = x as u64;
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
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
        for count in [0, 1, 2, 3, 10, 300, 600] {
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
