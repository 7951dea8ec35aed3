//! The volumes that bodies may reach in a step: boxes, planes, and rows of eight boxes.

use glam::DVec3;

/// A box around a moving body, and the index of the body.
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

    #[inline(always)]
    pub(crate) fn meets(&self, other: &Swept) -> bool {
        self.meets_along([0, 1, 2], other)
    }

    /// Whether two boxes overlap along some axes. It uses the widest gap, because branches would often be mispredicted.
    #[inline(always)]
    pub(super) fn meets_along<const N: usize>(&self, axes: [usize; N], other: &Swept) -> bool {
        let gap = axes.into_iter().fold(f64::NEG_INFINITY, |gap, axis| {
            let (before, after) = (
                self.begin(axis) - other.end(axis),
                other.begin(axis) - self.end(axis),
            );
            greater(gap, greater(before, after))
        });
        gap <= 0.0
    }

    /// Its low end along an axis. The array avoids the `match` of indexing a vector.
    #[inline(always)]
    pub(super) fn begin(&self, axis: usize) -> f64 {
        let min: &[f64; 3] = self.min.as_ref();
        min[axis]
    }

    #[inline(always)]
    pub(super) fn end(&self, axis: usize) -> f64 {
        let max: &[f64; 3] = self.max.as_ref();
        max[axis]
    }

    /// Whether another box lies within it.
    #[inline(always)]
    pub(super) fn holds(&self, other: &Swept) -> bool {
        let inside = |axis: usize| {
            (self.begin(axis) <= other.begin(axis)) & (other.end(axis) <= self.end(axis))
        };
        inside(0) & inside(1) & inside(2)
    }

    /// The box with a margin on all sides.
    pub(super) fn grown_by(&self, margin: DVec3) -> Swept {
        Swept {
            min: self.min - margin,
            max: self.max + margin,
            body: self.body,
        }
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
    /// The farthest level of the plane along the normal, m.
    pub(crate) level: f64,
    /// A bound on rounding, m.
    pub(crate) slack: f64,
    pub(crate) body: usize,
}

impl Front {
    /// Whether a box may reach the plane; a "no" is a proof.
    pub(crate) fn may_meet(&self, swept: &Swept) -> bool {
        self.reaches([0, 1, 2].map(|axis| self.nearest(axis, &swept.min, &swept.max)[axis]))
    }

    /// The one of the two ends along an axis that is nearer to the plane.
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

/// Boxes side by side, stored by axis, so that a few instructions test all of them.
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

    /// A bit for each box that meets another box.
    #[inline(always)]
    pub(super) fn meeting(&self, of: &Swept) -> u32 {
        // The widest gap along an axis.
        let mut gaps = [f64::NEG_INFINITY; WIDTH];
        for axis in 0..3 {
            let (low, high) = (of.min[axis], of.max[axis]);
            let (min, max) = (&self.min[axis], &self.max[axis]);
            for (lane, gap) in gaps.iter_mut().enumerate() {
                *gap = greater(*gap, greater(min[lane] - high, low - max[lane]));
            }
        }
        bits(gaps.map(|gap| gap <= 0.0))
    }

    /// A bit for each box that may reach a plane.
    #[inline(always)]
    pub(super) fn reaching(&self, front: &Front) -> u32 {
        let ends = [0, 1, 2].map(|axis| front.nearest(axis, &self.min, &self.max)[axis]);
        let mut reach = [false; WIDTH];
        for (lane, reach) in reach.iter_mut().enumerate() {
            *reach = front.reaches(ends.map(|ends| ends[lane]));
        }
        bits(reach)
    }

    /// The box around all boxes of the row.
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

/// The maximum in one instruction, unlike `f64::max`. A difference of numbers that differ is not zero.
#[inline(always)]
fn greater(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

#[inline(always)]
fn bits(lanes: [bool; WIDTH]) -> u32 {
    let lanes = lanes.iter().enumerate();
    lanes.fold(0, |bits, (lane, &is)| bits | u32::from(is) << lane)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_box_with_a_corner_behind_a_plane_is_passed_over() {
        let swept = Swept {
            min: DVec3::new(-0.1, 0.2, 0.3),
            max: DVec3::new(0.4, 0.5, 0.9),
            body: 0,
        };
        for normal in [DVec3::X, DVec3::NEG_X, DVec3::new(0.0, -0.6, 0.8)] {
            let corners = (0..8).map(|i| {
                let end = |axis: usize| [swept.min, swept.max][i >> axis & 1][axis];
                normal.dot(DVec3::new(end(0), end(1), end(2)))
            });
            let nearest = corners.fold(f64::INFINITY, f64::min);
            let may_meet = |level: f64| {
                let slack = 0.0;
                let front = Front {
                    normal,
                    level,
                    slack,
                    body: 1,
                };
                let row = Row::of(&[swept]).reaching(&front);
                assert_eq!(front.may_meet(&swept), row == 1);
                front.may_meet(&swept)
            };
            assert!(may_meet(nearest) && may_meet(nearest + 0.1) && !may_meet(nearest - 1e-9));
        }
    }
}
