//! What bodies may come to in a step: boxes, planes, and boxes in rows of eight.

use glam::DVec3;

/// A box around something that moves, and whose it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
    pub(crate) body: usize,
}

impl Swept {
    pub(super) const NOWHERE: Swept = Swept {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
        body: usize::MAX,
    };

    /// Most are found apart along the first axis or two.
    #[inline(always)]
    pub(super) fn meets(&self, other: &Swept) -> bool {
        let meet =
            |axis: usize| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis];
        meet(0) && meet(1) && meet(2)
    }

    pub(super) fn with(&self, other: &Swept) -> Swept {
        Swept {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            body: self.body,
        }
    }
}

/// A plane, in front of which a half-space stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Front {
    pub(crate) normal: DVec3,
    /// The farthest that it comes along the normal, m.
    pub(crate) level: f64,
    /// More than is lost in rounding.
    pub(crate) slack: f64,
}

impl Front {
    /// Whether a box may come to it; a "no" is a proof.
    pub(crate) fn may_meet(&self, swept: &Swept) -> bool {
        self.reaches([0, 1, 2].map(|axis| self.nearest(axis, &swept.min, &swept.max)[axis]))
    }

    /// Of two, what is nearer to the plane along an axis.
    #[inline(always)]
    fn nearest<'a, T>(&self, axis: usize, min: &'a T, max: &'a T) -> &'a T {
        match self.normal[axis] > 0.0 {
            true => min,
            false => max,
        }
    }

    #[inline(always)]
    fn reaches(&self, [x, y, z]: [f64; 3]) -> bool {
        let (x, y, z) = (x * self.normal.x, y * self.normal.y, z * self.normal.z);
        let size = x.abs() + y.abs() + z.abs();
        x + y + z - 16.0 * f64::EPSILON * size <= self.level + self.slack
    }
}

/// Boxes in a row.
pub(super) const WIDTH: usize = 8;

/// Boxes side by side, by axis, so that a few instructions take all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    min: [[f64; WIDTH]; 3],
    max: [[f64; WIDTH]; 3],
}

impl Row {
    pub(super) fn of(boxes: &[Swept]) -> Row {
        let mut row = Row {
            min: [[f64::INFINITY; WIDTH]; 3],
            max: [[f64::NEG_INFINITY; WIDTH]; 3],
        };
        for (lane, swept) in boxes.iter().enumerate() {
            row.set(lane, swept);
        }
        row
    }

    pub(super) fn set(&mut self, lane: usize, swept: &Swept) {
        for axis in 0..3 {
            self.min[axis][lane] = swept.min[axis];
            self.max[axis][lane] = swept.max[axis];
        }
    }

    pub(super) fn lane(&self, lane: usize) -> Swept {
        let of = |ends: &[[f64; WIDTH]; 3]| DVec3::from_array([0, 1, 2].map(|k| ends[k][lane]));
        Swept {
            min: of(&self.min),
            max: of(&self.max),
            body: usize::MAX,
        }
    }

    /// A bit for each that meets a box.
    #[inline(always)]
    pub(super) fn meeting(&self, of: &Swept) -> u32 {
        // The widest gap along an axis; of numbers that differ it is not zero.
        let mut gaps = [f64::NEG_INFINITY; WIDTH];
        let greater = |x: f64, y: f64| if x > y { x } else { y };
        for axis in 0..3 {
            let (low, high) = (of.min[axis], of.max[axis]);
            let (min, max) = (&self.min[axis], &self.max[axis]);
            for (lane, gap) in gaps.iter_mut().enumerate() {
                *gap = greater(*gap, greater(min[lane] - high, low - max[lane]));
            }
        }
        bits(gaps.map(|gap| gap <= 0.0))
    }

    /// A bit for each that may come to a plane.
    #[inline(always)]
    pub(super) fn reaching(&self, front: &Front) -> u32 {
        let ends = [0, 1, 2].map(|axis| front.nearest(axis, &self.min, &self.max)[axis]);
        let mut reach = [false; WIDTH];
        for (lane, reach) in reach.iter_mut().enumerate() {
            *reach = front.reaches(ends.map(|ends| ends[lane]));
        }
        bits(reach)
    }

    /// The box around all.
    pub(super) fn around(&self) -> Swept {
        let least = |x: &[f64; WIDTH]| x.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = |x: &[f64; WIDTH]| x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Swept {
            min: DVec3::from_array(self.min.each_ref().map(least)),
            max: DVec3::from_array(self.max.each_ref().map(greatest)),
            body: usize::MAX,
        }
    }
}

#[inline(always)]
fn bits(lanes: [bool; WIDTH]) -> u32 {
    let lanes = lanes.iter().enumerate();
    lanes.fold(0, |bits, (lane, &is)| bits | u32::from(is) << lane)
}
