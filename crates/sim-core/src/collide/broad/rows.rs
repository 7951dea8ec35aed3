//! Sorted boxes, and a tree of boxes around them.
//!
//! The rows sort boxes along a curve that keeps neighbours together (Morton 1966, "A computer oriented
//! geodetic data base and a new technique in file sequencing"). Eight boxes in a row have a box around them,
//! eight of these another, and so on: a tree without a pointer, which takes less time to build than to query.
//! Replacing a box later widens the boxes around it.

use alloc::vec::Vec;
use glam::DVec3;

use super::volume::{Front, Row, Swept, WIDTH};

/// Up to this many boxes, a sweep along an axis is faster. The boxes are sorted by their lower ends, so a box can
/// only meet those that begin before it ends (Baraff 1992, "Dynamic simulation of non-penetrating rigid bodies", sec.
/// 2.1.3).
const FEW: usize = 512;

/// Sorted boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    sorted: Vec<Swept>,
    /// The axis along which they are sorted; `None` if they are sorted along the curve.
    sweep: Option<usize>,
    /// Rows of the sorted boxes, rows of the boxes around those, and so on up to one box.
    levels: Vec<Vec<Row>>,
    /// For each body its index among the sorted boxes.
    place: Vec<usize>,
    /// The boxes with their places on the curve, before sorting.
    unsorted: Vec<Swept>,
    keys: Vec<(u64, u32)>,
}

impl Rows {
    /// Replaces all boxes by those of some bodies; `is_known` tells whether these are the bodies of the last fill.
    pub(super) fn fill(
        &mut self,
        bodies: &[usize],
        is_known: bool,
        swept: impl Fn(usize) -> Swept,
    ) {
        if !is_known {
            let last = bodies.iter().copied().max();
            self.place.clear();
            self.place.resize(last.map_or(0, |last| last + 1), 0);
        }
        if bodies.len() > FEW {
            self.sort_along_curve(bodies, swept);
        } else {
            if is_known {
                // In the last order, which is nearly the new one.
                for known in &mut self.sorted {
                    *known = swept(known.body);
                }
            } else {
                self.sorted.clear();
                self.sorted.extend(bodies.iter().map(|&body| swept(body)));
            }
            self.sort_along_axis();
        }
        for (place, swept) in self.sorted.iter().enumerate() {
            self.place[swept.body] = place;
        }
        self.make_rows();
    }

    fn sort_along_axis(&mut self) {
        let begins = || self.sorted.iter().map(|swept| swept.min);
        let low = begins().fold(DVec3::INFINITY, DVec3::min);
        let high = begins().fold(DVec3::NEG_INFINITY, DVec3::max);
        let spread = high - low;
        let is_wide = |&axis: &usize| 2.0 * spread[axis] >= spread.max_element();
        let axis = self.sweep.filter(is_wide);
        let axis = axis.unwrap_or_else(|| spread.max_position());
        self.sweep = Some(axis);
        insert(&mut self.sorted, axis);
    }

    fn sort_along_curve(&mut self, bodies: &[usize], swept: impl Fn(usize) -> Swept) {
        self.sweep = None;
        self.unsorted.clear();
        self.unsorted.extend(bodies.iter().map(|&body| swept(body)));
        let centre = |swept: &Swept| 0.5 * swept.min + 0.5 * swept.max;
        let centres = || self.unsorted.iter().map(centre);
        let low = centres().fold(DVec3::INFINITY, DVec3::min);
        let high = centres().fold(DVec3::NEG_INFINITY, DVec3::max);
        let longest = (high - low).max_element();
        let cells = if longest > 0.0 { CELLS / longest } else { 0.0 };
        self.keys.clear();
        let places = centres().map(|centre| curve((centre - low) * cells));
        self.keys.extend(places.zip(0..));
        self.keys.sort_unstable();
        self.sorted.clear();
        let in_order = self.keys.iter();
        let in_order = in_order.map(|&(_, index)| self.unsorted[index as usize]);
        self.sorted.extend(in_order);
    }

    fn make_rows(&mut self) {
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
    }

    /// Each pair of bodies whose boxes meet, the lower one first; as filled, without replacements.
    pub(super) fn each_pair(&self, mut found: impl FnMut(usize, usize)) {
        for (place, first) in self.sorted.iter().enumerate() {
            let mut found = |second: usize| found(first.body.min(second), first.body.max(second));
            if let Some(axis) = self.sweep {
                let (last, rest) = (first.end(axis), [(axis + 1) % 3, (axis + 2) % 3]);
                let after = self.sorted[place + 1..].iter();
                let reachable = after.take_while(|other| other.begin(axis) <= last);
                for other in reachable.filter(|other| other.meets_along(rest, first)) {
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
    pub(super) fn replace(&mut self, swept: Swept) {
        let mut place = self.place[swept.body];
        for (depth, level) in self.levels.iter_mut().enumerate() {
            let row = &mut level[place / WIDTH];
            let wide = row.lane(place % WIDTH).with(&swept);
            row.set(place % WIDTH, if depth == 0 { &swept } else { &wide });
            place /= WIDTH;
        }
    }

    /// Each other body whose box meets a box.
    pub(super) fn each_partner(&self, of: &Swept, mut found: impl FnMut(usize)) {
        self.each(
            |row| row.meeting(of),
            |body| {
                if body != of.body {
                    found(body);
                }
            },
        );
    }

    /// Each body whose box may reach a plane.
    pub(super) fn each_before(&self, front: &Front, found: impl FnMut(usize)) {
        self.each(|row| row.reaching(front), found);
    }

    /// Each body whose box is selected in its row, and so are the boxes around it.
    fn each(&self, select: impl Fn(&Row) -> u32, mut found: impl FnMut(usize)) {
        let top = (self.levels.len(), 0);
        self.each_row(&select, 0, top, &mut |row| {
            self.each_in_row(row, &select, u32::MAX, &mut found);
        });
    }

    /// Each row of sorted boxes, from a given one on, that is inside selected boxes, below one row of a level. Level
    /// 0 has the rows of sorted boxes themselves.
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
        // The number of rows of sorted boxes in one of these boxes.
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

    /// The bodies of a row whose boxes are selected.
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

impl Rows {
    /// Visits bodies, within each row those with the nearest boxes first. `near` returns a lower bound on the
    /// distance for the contents of a box, infinity for an empty one. `visit` receives a body and returns the limit
    /// for the next ones.
    pub(super) fn visit_near(
        &self,
        near: &impl Fn(&Swept) -> f64,
        limit: f64,
        visit: &mut impl FnMut(usize) -> f64,
    ) {
        self.visit_row((self.levels.len(), 0), near, limit, visit);
    }

    fn visit_row(
        &self,
        (level, index): (usize, usize),
        near: &impl Fn(&Swept) -> f64,
        mut limit: f64,
        visit: &mut impl FnMut(usize) -> f64,
    ) -> f64 {
        let Some(row) = self.levels[level - 1].get(index) else {
            return limit;
        };
        let mut lanes: [(f64, usize); WIDTH] = core::array::from_fn(|lane| {
            let swept = row.lane(lane);
            // Empty lanes.
            let is_empty = swept.min.x > swept.max.x;
            let nearest = if is_empty {
                f64::INFINITY
            } else {
                near(&swept)
            };
            (nearest, index * WIDTH + lane)
        });
        lanes.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
        for (nearest, below) in lanes {
            if nearest > limit || nearest == f64::INFINITY {
                break;
            }
            limit = match level {
                1 => visit(self.sorted[below].body),
                _ => self.visit_row((level - 1, below), near, limit, visit),
            };
        }
        limit
    }
}

/// Insertion sort of boxes by their lower ends along an axis; it stops early if they are not nearly sorted.
fn insert(boxes: &mut [Swept], axis: usize) {
    let mut moves = 8 * boxes.len();
    for i in 1..boxes.len() {
        let (swept, mut place) = (boxes[i], i);
        let begin = swept.begin(axis);
        while place > 0 && boxes[place - 1].begin(axis) > begin {
            boxes[place] = boxes[place - 1];
            place -= 1;
        }
        if place < i {
            boxes[place] = swept;
        }
        moves = moves.saturating_sub(i - place);
        if moves == 0 {
            boxes.sort_unstable_by(|one, other| one.begin(axis).total_cmp(&other.begin(axis)));
            return;
        }
    }
}

/// The number of cells of the curve along an axis.
const CELLS: f64 = 2_097_151.0;

/// The place of a cell on the curve: the interleaved bits of its three coordinates.
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
