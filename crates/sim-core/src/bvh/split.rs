//! Splits runs of boxes in two by the binned surface area heuristic (Wald 2007, "On fast construction of SAH-based
//! bounding volume hierarchies"), and splits the parts again until there are four (Wald, Benthin, Boulos 2008,
//! "Getting rid of packets").

use alloc::vec::Vec;
use core::ops::Range;
use glam::Vec4;

use super::short::{SHORT, sort};
use super::{MAX_DEPTH, WIDTH};

/// One more than the number of candidate split planes; a power of two.
const BINS: usize = 16;
/// Runs of at most this many triangles are cut in the middle between their outer centres. With planes by the surface
/// area heuristic a build took a sixth longer, and queries needed 1 to 2 % fewer tiles.
const FEW: usize = 64;
/// From this level on, runs are halved by count. This leaves at most a quarter to each child, and a mesh has fewer than
/// 4^16 triangles, so the tree stays within `MAX_DEPTH`.
pub(super) const HALVE_FROM: usize = MAX_DEPTH - 16;

/// A box in two SIMD registers. Their last lanes hold the number of its triangles, and the index of the item that the
/// box contains.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) min: Vec4,
    pub(super) max: Vec4,
}

impl Bounds {
    pub(super) const EMPTY: Bounds = Bounds {
        min: Vec4::INFINITY,
        max: Vec4::NEG_INFINITY,
    };

    #[inline]
    pub(super) fn union(self, other: Bounds) -> Bounds {
        Bounds {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    #[inline]
    pub(super) fn around(items: &[Bounds]) -> Bounds {
        items
            .iter()
            .fold(Bounds::EMPTY, |all, &item| all.union(item))
    }

    /// The last lane of a vertex, and so of the box of a triangle: one triangle.
    pub(super) const ONE: f32 = f32::from_bits(f32::MIN_POSITIVE.to_bits() + 1);

    /// Stores the count as a float of the same bits, offset beyond the subnormal numbers, which are slow in processors.
    #[inline]
    pub(super) fn set_count(&mut self, count: u32) {
        self.min.w = f32::from_bits(count + f32::MIN_POSITIVE.to_bits());
    }

    #[inline]
    pub(super) fn count(&self) -> u32 {
        self.min.w.to_bits() - f32::MIN_POSITIVE.to_bits()
    }

    /// Stores the index likewise.
    #[inline]
    pub(super) fn set_number(&mut self, number: u32) {
        self.max.w = f32::from_bits(number + f32::MIN_POSITIVE.to_bits());
    }

    #[inline]
    pub(super) fn number(&self) -> u32 {
        self.max.w.to_bits() - f32::MIN_POSITIVE.to_bits()
    }

    /// Twice the centre; infinite for a huge box, which then counts as a box that no plane separates.
    #[inline]
    pub(super) fn centre(&self) -> Vec4 {
        self.min + self.max
    }

    /// Twice the centre along an axis, read from memory instead of from a register.
    #[inline]
    pub(super) fn along(&self, axis: usize) -> f32 {
        let (min, max): (&[f32; 4], &[f32; 4]) = (self.min.as_ref(), self.max.as_ref());
        min[axis & 3] + max[axis & 3]
    }

    /// Half of the surface area; infinite for huge boxes, for which then no plane is the best.
    #[inline]
    fn half_area(&self) -> f32 {
        let e = self.max - self.min;
        e.x * (e.y + e.z) + e.y * e.z
    }
}

/// The items to be divided into a tree; each division reorders a run. A run is in one of two buffers, and a split
/// writes its parts to the other one.
#[derive(Default)]
pub(super) struct Items {
    pub(super) bounds: [Vec<Bounds>; 2],
}

/// Items that will become a child.
#[derive(Clone, Copy)]
pub(super) struct Run {
    pub(super) bounds: Bounds,
    pub(super) start: u32,
    pub(super) end: u32,
    /// The number of triangles in the items.
    pub(super) count: u32,
    pub(super) parent: u32,
    pub(super) lane: u8,
    pub(super) level: u8,
    pub(super) buffer: u8,
    pub(super) of_cells: bool,
}

impl Run {
    pub(super) fn len(&self) -> usize {
        self.range().len()
    }

    pub(super) fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// The cost of the triangles in a box for a query that reaches the parent of the box: area times leaves to fill.
#[inline]
fn cost(bounds: &Bounds, count: u32) -> f32 {
    bounds.half_area() * count.div_ceil(WIDTH as u32) as f32
}

impl Items {
    pub(super) fn of(&self, run: &Run) -> &[Bounds] {
        &self.bounds[run.buffer as usize][run.range()]
    }

    /// Resizes the second buffer to the number of items in the first.
    pub(super) fn mirror(&mut self) {
        let len = self.bounds[0].len();
        if self.bounds[1].len() < len {
            self.bounds[1].resize(len, Bounds::EMPTY);
        }
    }

    /// Cuts the last of some runs, which has more than four triangles and more than one item, into two to four runs.
    /// None is empty; the items are reordered.
    pub(super) fn divide(&mut self, runs: &mut Vec<Run>) {
        let first = runs.len() - 1;
        let mut costs = [f32::INFINITY; WIDTH];
        let mut dearest = 0;
        for part in 1..WIDTH {
            let (left, right) = self.split(&runs[first + dearest]);
            // From the level of halving on, the longest run must be cut first.
            let cost = |run: &Run| {
                if run.count <= WIDTH as u32 || run.len() == 1 {
                    -1.0
                } else if usize::from(run.level) < HALVE_FROM {
                    cost(&run.bounds, run.count)
                } else {
                    run.count as f32
                }
            };
            (costs[dearest], costs[part]) = (cost(&left), cost(&right));
            runs[first + dearest] = left;
            runs.push(right);
            dearest = 0;
            for i in 1..=part {
                if costs[i] > costs[dearest] {
                    dearest = i;
                }
            }
            if costs[dearest] < 0.0 {
                break;
            }
        }
    }

    /// Cuts a run of at least two items in two, along the axis on which centres lie farthest apart.
    #[inline]
    fn split(&mut self, run: &Run) -> (Run, Run) {
        if run.len() == run.count as usize && run.len() <= SHORT {
            return self.split_short(run);
        }
        let level = usize::from(run.level);
        let items = self.of(run);
        let Centres { axis, low, high } = Centres::of(items);
        if level >= HALVE_FROM || !(high > low && high - low < f32::INFINITY) {
            return self.halve(run);
        }
        if run.len() == run.count as usize && run.len() <= FEW {
            // At least one item lies beyond.
            let middle = (0.5 * low + 0.5 * high).min(high.next_down());
            let at = self.partition(run, |item| item.along(axis) <= middle);
            return self.parts(run, at - run.start);
        }
        let Some(best) = best_plane(items, run.count, axis, low, high) else {
            return self.halve(run);
        };
        let at = self.partition(run, |item| {
            place(item, axis, low, best.scale) <= best.last_left
        });
        let buffer = 1 - run.buffer;
        let left = Run {
            end: at,
            count: best.count,
            bounds: best.left,
            buffer,
            ..*run
        };
        let right = Run {
            start: at,
            count: run.count - best.count,
            bounds: best.right,
            buffer,
            ..*run
        };
        (left, right)
    }

    /// Cuts a run of five to sixteen triangles in two parts that fill no more leaves than the run.
    fn split_short(&mut self, run: &Run) -> (Run, Run) {
        let [from, to] = two(&mut self.bounds, run.buffer, run.range());
        let cut = sort(from, to) as u32;
        self.parts(run, cut)
    }

    /// Both parts of a run of triangles, which are in the other buffer; the first part has `cut` triangles.
    #[inline]
    fn parts(&self, run: &Run, cut: u32) -> (Run, Run) {
        let buffer = 1 - run.buffer;
        let (left, right) = self.bounds[buffer as usize][run.range()].split_at(cut as usize);
        let middle = run.start + cut;
        let part = |start, end, items: &[Bounds]| Run {
            start,
            end,
            count: end - start,
            bounds: Bounds::around(items),
            buffer,
            ..*run
        };
        (part(run.start, middle, left), part(middle, run.end, right))
    }

    /// Cuts a run of five to sixteen triangles into the least number of leaves.
    #[inline]
    pub(super) fn leaves(&mut self, run: &Run, mut leaf: impl FnMut(&[Bounds])) {
        let [from, to] = two(&mut self.bounds, run.buffer, run.range());
        let cut = sort(from, to);
        let (halves, rooms) = (to.split_at(cut), from.split_at_mut(cut));
        for (half, room) in [(halves.0, rooms.0), (halves.1, rooms.1)] {
            if half.len() <= WIDTH {
                leaf(half);
            } else {
                let cut = sort(half, room);
                leaf(&room[..cut]);
                leaf(&room[cut..]);
            }
        }
    }

    /// Halves a run by count, if no plane separates its centres.
    #[cold]
    fn halve(&self, run: &Run) -> (Run, Run) {
        let middle = run.start + run.len() as u32 / 2;
        let part = |start, end| {
            let part = Run { start, end, ..*run };
            let items = self.of(&part).iter();
            Run {
                count: items.map(Bounds::count).sum(),
                bounds: Bounds::around(self.of(&part)),
                ..part
            }
        };
        (part(run.start, middle), part(middle, run.end))
    }

    /// Writes a run to the other buffer, items that go left in front. Returns the index of the first other item.
    #[inline]
    fn partition(&mut self, run: &Run, goes_left: impl Fn(&Bounds) -> bool) -> u32 {
        let [from, to] = two(&mut self.bounds, run.buffer, run.range());
        // Left items fill the buffer from the left end, others from the right. The side is unpredictable, so it
        // selects an index and not a branch.
        let (mut left, mut right) = (0, from.len());
        for item in from.iter() {
            let goes_left = goes_left(item);
            let place = if goes_left { left } else { right - 1 };
            to[place] = *item;
            left += usize::from(goes_left);
            right -= usize::from(!goes_left);
        }
        run.start + left as u32
    }
}

/// A range of one of two buffers, and the same of the other.
#[inline]
fn two(buffers: &mut [Vec<Bounds>; 2], from: u8, range: Range<usize>) -> [&mut [Bounds]; 2] {
    let [zero, one] = buffers;
    let [from, to] = if from == 0 { [zero, one] } else { [one, zero] };
    [&mut from[range.clone()], &mut to[range]]
}

/// The axis along which the centres of some boxes lie farthest apart, and twice the outer centres on it.
pub(super) struct Centres {
    pub(super) axis: usize,
    pub(super) low: f32,
    pub(super) high: f32,
}

impl Centres {
    #[inline]
    pub(super) fn of(items: &[Bounds]) -> Centres {
        let (mut low, mut high) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
        for item in items {
            low = low.min(item.centre());
            high = high.max(item.centre());
        }
        let extent = (high - low).to_array();
        let mut axis = usize::from(extent[1] > extent[0]);
        if extent[2] > extent[axis] {
            axis = 2;
        }
        Centres {
            axis,
            low: low[axis],
            high: high[axis],
        }
    }
}

/// A plane that splits items: items up to a [`place`] go left. It has the number of their triangles, and the boxes of
/// both sides.
struct Plane {
    scale: f32,
    last_left: f32,
    count: u32,
    left: Bounds,
    right: Bounds,
}

/// Adding this to a small float rounds it to a whole number, which is then in its last bits.
pub(super) const WHOLE: f32 = (3 << 22) as f32;

#[inline]
pub(super) fn whole(sum: f32) -> u32 {
    sum.to_bits() & ((1 << 22) - 1)
}

/// The bin of an item, plus `WHOLE`.
#[inline]
fn place(item: &Bounds, axis: usize, origin: f32, scale: f32) -> f32 {
    (item.along(axis) - origin) * scale - 0.5 + WHOLE
}

/// The plane across an axis that minimises the area of boxes times the leaves to fill in them.
///
/// Trying planes across the other two axes too took three times as long, and saved queries only a few tiles in a
/// hundred.
#[inline]
fn best_plane(items: &[Bounds], count: u32, axis: usize, low: f32, high: f32) -> Option<Plane> {
    // A little less than the number of bins, so that the highest centre still lies in the last one.
    let scale = BINS as f32 * (1.0 - 1e-6) / (high - low);
    let mut bins = [Bounds::EMPTY; BINS];
    let mut counts = [0u32; BINS];
    for item in items {
        let bin = whole(place(item, axis, low, scale)) as usize & (BINS - 1);
        bins[bin] = bins[bin].union(*item);
        counts[bin] += item.count();
    }
    // The boxes to the right of each plane, swept from the right.
    let mut right = [Bounds::EMPTY; BINS];
    for i in (1..BINS).rev() {
        right[i - 1] = right[i].union(bins[i]);
    }
    let (mut left, mut on_left) = (Bounds::EMPTY, 0);
    let (mut best, mut least) = (None, f32::INFINITY);
    for last_left in 0..BINS - 1 {
        left = left.union(bins[last_left]);
        on_left += counts[last_left];
        let cost = cost(&left, on_left) + cost(&right[last_left], count - on_left);
        if cost < least && on_left > 0 && on_left < count {
            least = cost;
            best = Some((last_left, on_left, left));
        }
    }
    best.map(|(last_left, count, left)| Plane {
        scale,
        last_left: last_left as f32 + WHOLE,
        count,
        left,
        right: right[last_left],
    })
}
