//! Which of many boxes meet.
//!
//! Boxes are sorted along a curve that keeps neighbours together (Morton 1966, "A computer oriented
//! geodetic data base and a new technique in file sequencing"). Eight in a row have a box around them,
//! eight of these another, and so on: a tree without a pointer, made afresh in each step in less time
//! than it takes to ask it. A box that is replaced after that widens those around it.

mod volume;

use alloc::vec::Vec;
use glam::DVec3;

pub(crate) use volume::{Front, Swept};
use volume::{Row, WIDTH};

/// So many boxes are faster swept along an axis: sorted by their lower ends, a box can only meet
/// those that begin before it ends (Baraff 1992, "Dynamic simulation of non-penetrating rigid
/// bodies", sec. 2.1.3).
const FEW: usize = 512;

/// Boxes in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Broad {
    boxes: Vec<Swept>,
    /// Place on the axis or curve of each box, and its own, in order. No two are the same, so that the
    /// order does not depend on that of the last time.
    keys: Vec<(u64, u32)>,
    sorted: Vec<Swept>,
    /// Rows of the sorted boxes, of the boxes around those, and so on to one.
    levels: Vec<Vec<Row>>,
    /// The axis along which the boxes are sorted, if it is not the curve.
    sweep: Option<usize>,
    /// For each body its place among the sorted.
    place: Vec<usize>,
}

impl Broad {
    /// Takes boxes in the place of all others.
    pub(crate) fn fill(&mut self, boxes: impl Iterator<Item = Swept>) {
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
        let count = self.boxes.len();
        if self.keys.len() == count && self.sweep.is_some() {
            // In the order of last time, which is nearly this one.
            for (at, place) in &mut self.keys {
                *at = key(&self.boxes[*place as usize]);
            }
            insert(&mut self.keys);
        } else {
            self.keys.clear();
            self.keys.extend(self.boxes.iter().map(key).zip(0..));
            self.keys.sort_unstable();
        }
        self.sorted.clear();
        let in_order = self
            .keys
            .iter()
            .map(|&(_, place)| self.boxes[place as usize]);
        self.sorted.extend(in_order);
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
            let select = |row: &Row| row.meeting(first);
            self.each_row(&select, own, (self.levels.len(), 0), &mut |row| {
                let after = if row == own {
                    u32::MAX << (place % WIDTH + 1)
                } else {
                    u32::MAX
                };
                self.each_in_row(row, &select, after, &mut found);
            });
        }
    }

    /// Replaces the box of a body.
    pub(crate) fn replace(&mut self, swept: Swept) {
        let mut place = self.place[swept.body];
        for (depth, level) in self.levels.iter_mut().enumerate() {
            let row = &mut level[place / WIDTH];
            let wide = row.lane(place % WIDTH).with(&swept);
            row.set(place % WIDTH, if depth == 0 { &swept } else { &wide });
            place /= WIDTH;
        }
    }

    /// Each other body whose box meets a box.
    pub(crate) fn each_partner(&self, of: &Swept, mut found: impl FnMut(usize)) {
        self.each(
            |row| row.meeting(of),
            |body| {
                if body != of.body {
                    found(body);
                }
            },
        );
    }

    /// Each body whose box may come to a plane.
    pub(crate) fn each_before(&self, front: &Front, found: impl FnMut(usize)) {
        self.each(|row| row.reaching(front), found);
    }

    /// Each body whose box is among those of a row that something selects, and so are those around
    /// it.
    fn each(&self, select: impl Fn(&Row) -> u32, mut found: impl FnMut(usize)) {
        let top = (self.levels.len(), 0);
        self.each_row(&select, 0, top, &mut |row| {
            self.each_in_row(row, &select, u32::MAX, &mut found);
        });
    }

    /// Each row of sorted boxes, from one on, that is in a selected box, within a row of a level.
    /// Level 0 are the rows of sorted boxes themselves.
    fn each_row(
        &self,
        select: &impl Fn(&Row) -> u32,
        from: usize,
        (level, index): (usize, usize),
        found: &mut impl FnMut(usize),
    ) {
        if level <= 1 {
            return found(index);
        }
        // How many rows of sorted boxes are in one of these.
        let inside = WIDTH.pow(level as u32 - 2);
        let mut selected = select(&self.levels[level - 1][index]);
        while selected != 0 {
            let child = index * WIDTH + selected.trailing_zeros() as usize;
            selected &= selected - 1;
            if (child + 1) * inside > from {
                self.each_row(select, from, (level - 1, child), found);
            }
        }
    }

    /// Some bodies of a row, those whose box is selected.
    #[inline(always)]
    fn each_in_row(
        &self,
        row: usize,
        select: &impl Fn(&Row) -> u32,
        which: u32,
        found: &mut impl FnMut(usize),
    ) {
        let Some(boxes) = self.levels[0].get(row) else {
            return;
        };
        let mut selected = select(boxes) & which;
        while selected != 0 {
            let place = row * WIDTH + selected.trailing_zeros() as usize;
            selected &= selected - 1;
            found(self.sorted[place].body);
        }
    }
}

/// Sorts keys that are nearly sorted; others at last as any.
fn insert(keys: &mut [(u64, u32)]) {
    let mut moves = 8 * keys.len();
    for i in 1..keys.len() {
        let (key, mut place) = (keys[i], i);
        while place > 0 && keys[place - 1] > key {
            keys[place] = keys[place - 1];
            place -= 1;
        }
        keys[place] = key;
        moves = moves.saturating_sub(i - place);
        if moves == 0 {
            return keys.sort_unstable();
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
            let mut broad = Broad::default();
            let mut all = vec![];
            // Unordered, a little on, and in quite another order.
            for (seed, by) in [(7, 0.0), (7, 0.1), (8, 0.0)] {
                all = boxes(count, seed + count as u64);
                for (i, swept) in all.iter_mut().enumerate() {
                    let by = by * DVec3::splat((i % 7) as f64 - 3.0);
                    (swept.min, swept.max) = (swept.min + by, swept.max + by);
                }
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
            }
            // Some move, one of them twice.
            for (step, new) in boxes(count, 99).into_iter().enumerate() {
                if step % 3 == 0 || step == 1 {
                    let body = if step == 1 { 0 } else { new.body };
                    all[body] = Swept { body, ..new };
                    broad.replace(all[body]);
                }
            }
            for (normal, level) in [(DVec3::X, 2.0), (DVec3::new(0.0, -0.6, 0.8), -3.0)] {
                let front = Front {
                    normal,
                    level,
                    slack: 0.0,
                };
                let mut reaching = vec![];
                broad.each_before(&front, |body| reaching.push(body));
                reaching.sort_unstable();
                // As box by box; and no box with a corner behind the plane is left out.
                let expected = all.iter().filter(|swept| front.may_meet(swept));
                assert_eq!(reaching, expected.map(|o| o.body).collect::<Vec<_>>());
                for swept in &all {
                    let nearest = (0..8).map(|i| {
                        let end = |axis: usize| [swept.min, swept.max][i >> axis & 1][axis];
                        normal.dot(DVec3::new(end(0), end(1), end(2)))
                    });
                    let is_behind = nearest.fold(f64::INFINITY, f64::min) <= level - 1e-9;
                    assert!(!is_behind || reaching.contains(&swept.body));
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
