//! The time at which the boxes of two trees, one of which moves, begin to meet.

use glam::DVec3;

use crate::bvh::{Boxes, Bvh, Triangles, WIDTH};
use crate::collide::{
    Level,
    apart::{Way, stay_apart},
    pairs::{InLanes, Lanes, Reach, TILE},
};

/// The relative motion, prepared for tests of boxes.
pub(super) struct Moving {
    offset: DVec3,
    motion: DVec3,
    /// The same in f32, if its range is enough.
    swift: Option<Swift>,
    level: Level,
    /// How near boxes come that count as meeting, m.
    margin: f64,
}

impl Moving {
    pub(super) fn new(first: &Bvh, second: &Bvh, offset: DVec3, motion: DVec3) -> Moving {
        Moving {
            offset,
            motion,
            swift: Swift::new(first, second, offset, motion),
            level: Level::best(),
            margin: 0.0,
        }
    }

    /// The same for boxes that count as wider on all sides by half of `margin`, m.
    pub(super) fn widened(mut self, margin: f64) -> Moving {
        self.margin = margin;
        if let Some(swift) = &mut self.swift {
            // Rounded up, here and in the sum.
            let margin = (margin * 1.001) as f32;
            swift.margin = swift.margin.map(|of| (of + margin) * 1.001);
        }
        self
    }

    /// A bit for each pair of boxes that meet no later than the horizon, and the times at which they begin to meet,
    /// rounded down.
    pub(super) fn meet(&self, first: &Boxes, second: &Boxes, horizon: f64) -> (u32, [f32; TILE]) {
        match &self.swift {
            Some(swift) => {
                let mut enter = [0.0; TILE];
                let pairs = self.level.run(Meet {
                    swift,
                    boxes: [first, second],
                    horizon: horizon as f32,
                    enter: &mut enter,
                });
                (pairs, enter)
            }
            None => self.meet_in_f64(first, second, horizon),
        }
    }

    /// A bit for each pair of triangles of two leaves that are proven to stay on two sides of the plane of one of
    /// them until the horizon. Their boxes meet before.
    pub(super) fn parted(
        &self,
        first: (&Boxes, &Triangles),
        second: (&Boxes, &Triangles),
        horizon: f64,
    ) -> u32 {
        let Some(way) = self.swift.as_ref().and_then(|swift| swift.way.as_ref()) else {
            return 0;
        };
        let way = Way {
            motion: (horizon * self.motion).as_vec3().to_array(),
            ..*way
        };
        self.level.run(StayApart { first, second, way })
    }

    /// For meshes too large for f32. Its speed does not matter.
    #[cold]
    fn meet_in_f64(&self, first: &Boxes, second: &Boxes, horizon: f64) -> (u32, [f32; TILE]) {
        let (mut bits, mut times) = (0, [f32::INFINITY; TILE]);
        for (pair, place) in times.iter_mut().enumerate() {
            let time = self.entry(first, pair / WIDTH, second, pair % WIDTH);
            if let Some(time) = time.filter(|&t| t <= horizon) {
                bits |= 1 << pair;
                let rounded = time as f32;
                *place = match f64::from(rounded) > time {
                    true => rounded.next_down(),
                    false => rounded,
                };
            }
        }
        (bits, times)
    }

    /// The time at which two boxes begin to meet, rounded down; `None` if they do not meet within the motion.
    fn entry(&self, first: &Boxes, i: usize, second: &Boxes, j: usize) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let wide = |x: &[[f32; WIDTH]; 3], lane: usize| f64::from(x[axis][lane]);
            let (a, b) = (wide(&first.centre, i), wide(&second.centre, j));
            let reach = wide(&first.half, i) + wide(&second.half, j);
            if reach < 0.0 {
                return None;
            }
            let offset = self.offset[axis];
            let between = a - (b + offset);
            let (near, far) = (between - reach, between + reach);
            let slack = 8.0 * f64::EPSILON * (a.abs() + b.abs() + reach + offset.abs());
            let slack = slack + self.margin;
            let (near, far) = (near - slack, far + slack);
            let motion = self.motion[axis];
            let inverse = 1.0 / motion;
            if inverse.is_finite() {
                let (s, t) = (near * inverse, far * inverse);
                // One more rounding than the slack covers.
                enter = enter.max(s.min(t) * (1.0 - f64::EPSILON));
                leave = leave.min(s.max(t) * (1.0 + f64::EPSILON));
            } else if near > 0.0 || far < 0.0 {
                return None;
            }
        }
        (enter <= leave).then_some(enter)
    }
}

/// Moving boxes in f32.
struct Swift {
    offset: [f32; 3],
    /// The inverse of the motion; zero on an axis whose motion is so small that it is added to the margin instead.
    inverse: [f32; 3],
    /// A bound on the rounding of distances, plus the motion that is too small to count.
    margin: [f32; 3],
    /// The whole motion, if the test with planes is possible too.
    way: Option<Way>,
}

impl Swift {
    /// `None` if the coordinates or the motion exceed the range of f32.
    fn new(first: &Bvh, second: &Bvh, offset: DVec3, motion: DVec3) -> Option<Swift> {
        let reach = Reach::new(first, second, &offset.into())?;
        let margin = reach.margin();
        if motion.abs().max_element() > 1e30 {
            return None;
        }
        // Distances are below 2^127. With a motion above 2^-100, quotients that are times from 0 to 1 neither overflow
        // nor underflow enough to matter.
        let counts = motion
            .to_array()
            .map(|m| m.abs() > f64::from(margin).max(1e-30));
        let of = |axis: usize| (counts[axis], motion[axis]);
        let moved = Reach::new(first, second, &(offset + motion).into())?;
        let has_planes = reach.has_planes() && moved.has_planes();
        let way = has_planes.then(|| Way {
            offset: reach.offset(),
            motion: motion.as_vec3().to_array(),
            // Boxes that meet within the motion are no farther apart before.
            wide: [0, 1, 2].map(|axis| 2.0 * margin + (motion[axis].abs() * 2.01) as f32),
            miss: reach.miss(),
            shift: reach.shift(),
        });
        Some(Swift {
            way,
            offset: reach.offset(),
            inverse: [0, 1, 2].map(|axis| match of(axis) {
                (true, m) => (1.0 / m) as f32,
                (false, _) => 0.0,
            }),
            margin: [0, 1, 2].map(|axis| match of(axis) {
                (true, _) => margin,
                (false, m) => margin + (m.abs() * 1.001) as f32,
            }),
        })
    }
}

/// [`Moving::meet`] in f32.
struct Meet<'a> {
    swift: &'a Swift,
    boxes: [&'a Boxes; 2],
    horizon: f32,
    enter: &'a mut [f32; TILE],
}

impl InLanes for Meet<'_> {
    type Output = u32;

    /// Distances are known to within the margin ([`Reach::new`]); the roundings here are a small part of it.
    /// Quotients are rounded three times, by `2^-24` each.
    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        const DOWN: f32 = 1.0 - 4.0 * f32::EPSILON;
        const UP: f32 = 1.0 + 4.0 * f32::EPSILON;
        let (swift, [first, second]) = (self.swift, self.boxes);
        let (mut enter, mut leave) = (L::splat(0.0), L::splat(1.0));
        let mut meet = u32::MAX;
        for axis in 0..3 {
            let (c, h) = (&first.centre[axis], &first.half[axis]);
            let (d, k) = (&second.centre[axis], &second.half[axis]);
            let moved = L::columns(d).add(L::splat(swift.offset[axis]));
            let between = L::rows(c).sub(moved);
            let reach = L::rows(h).add(L::columns(k));
            let reach = reach.add(L::splat(swift.margin[axis]));
            // Excludes empty lanes.
            meet &= L::splat(0.0).at_most(reach);
            let inverse = L::splat(swift.inverse[axis]);
            if swift.inverse[axis] == 0.0 {
                meet &= between.abs().at_most(reach);
            } else {
                let middle = between.mul(inverse);
                let around = reach.mul(inverse.abs());
                // Both roundings are relative to the terms, not to their difference.
                let slack = middle.abs().add(around.abs());
                let slack = slack.mul(L::splat(4.0 * f32::EPSILON));
                enter = enter.max(middle.sub(around).sub(slack));
                leave = leave.min(middle.add(around).add(slack));
            }
        }
        let enter = enter.mul(L::splat(DOWN));
        enter.store(self.enter);
        // More than quotients lose below the normal numbers.
        let least = L::splat(f32::MIN_POSITIVE);
        let latest = leave.min(L::splat(self.horizon));
        let latest = latest.mul_add(L::splat(UP), least);
        meet & enter.at_most(latest) & 0xffff
    }
}

/// [`stay_apart`] in lanes.
struct StayApart<'a> {
    first: (&'a Boxes, &'a Triangles),
    second: (&'a Boxes, &'a Triangles),
    way: Way,
}

impl InLanes for StayApart<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        stay_apart::<L>(self.first, self.second, &self.way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, test_meshes::cube, test_random::Random};
    use glam::{DQuat, Vec3};

    /// The time at which two boxes, given by low and high corners, begin to meet within the motion, as a fraction.
    fn exact(
        [low, high]: [[i64; 3]; 2],
        [others_low, others_high]: [[i64; 3]; 2],
        offset: [i64; 3],
        motion: [i64; 3],
    ) -> Option<(i128, i128)> {
        let (mut enter, mut leave) = ((0_i128, 1_i128), (1_i128, 1_i128));
        for axis in 0..3 {
            let near = i128::from(low[axis] - others_high[axis] - offset[axis]);
            let far = i128::from(high[axis] - others_low[axis] - offset[axis]);
            let (from, to, by) = match i128::from(motion[axis]) {
                0 if near <= 0 && far >= 0 => continue,
                0 => return None,
                m if m > 0 => (near, far, m),
                m => (-far, -near, -m),
            };
            if from * enter.1 > enter.0 * by {
                enter = (from, by);
            }
            if to * leave.1 < leave.0 * by {
                leave = (to, by);
            }
        }
        (enter.0 * leave.1 <= leave.0 * enter.1).then_some(enter)
    }

    #[test]
    fn moving_boxes_in_f32_are_never_apart_where_exact_ones_meet() {
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let (mut meetings, mut misses) = (0, 0);
        for round in 0..4000 {
            // A lattice on which boxes touch; and the limits of the precision of f32.
            let (most, unit) = [(4, 0.25), (1 << 23, 0.5_f64.powi(23))][round % 2];
            let size = cube().transformed(
                DQuat::IDENTITY,
                glam::DVec3::splat(8.0 * most as f64 * unit),
            );
            let tree = Bvh::build(&size.unwrap());
            let tile = |random: &mut Random| {
                let corners: [[[i64; 3]; 2]; WIDTH] = core::array::from_fn(|_| {
                    let (p, q) = (random.three(most), random.three(most));
                    let low: [i64; 3] = core::array::from_fn(|i| p[i].min(q[i]));
                    let high: [i64; 3] = core::array::from_fn(|i| p[i].max(q[i]));
                    [low, high]
                });
                let [low, high] = [0, 1].map(|end| {
                    let float = |x: i64| (x as f64 * unit) as f32;
                    [0, 1, 2].map(|axis| corners.map(|of| float(of[end][axis])).into())
                });
                (Boxes::between(low, high, WIDTH), corners)
            };
            let ((first, s), (second, t)) = (tile(&mut random), tile(&mut random));
            let (offset, mut motion) = (random.three(most), random.three(4 * most));
            motion[round % 3] *= i64::from(round % 5 != 0);
            let float = |v: [i64; 3]| DVec3::from_array(v.map(|x| x as f64 * unit));
            let mut moving = Moving::new(&tree, &tree, float(offset), float(motion));
            moving.level = Level::ALL[round % Level::ALL.len()];
            assert!(moving.swift.is_some());
            let (pairs, enter) = moving.meet(&first, &second, 1.0);
            for pair in 0..TILE {
                let time = exact(s[pair / WIDTH], t[pair % WIDTH], offset, motion);
                let Some((over, under)) = time else {
                    misses += u32::from(pairs >> pair & 1 == 0);
                    continue;
                };
                meetings += 1;
                assert!(pairs >> pair & 1 == 1, "{round} {pair}");
                // Rounding to f64 is monotonic.
                let time = over as f64 / under as f64;
                assert!(f64::from(enter[pair]) <= time, "{round} {pair}");
                // Also if the horizon is exactly that time.
                let (pairs, _) = moving.meet(&first, &second, time);
                assert!(pairs >> pair & 1 == 1, "{round} {pair} at the horizon");
            }
        }
        assert!(meetings > 5_000 && misses > 5_000, "{meetings} {misses}");
    }

    /// Whether points lie on one side of the plane of a triangle before and after a motion.
    fn stay_on_one_side(
        [a, b, c]: [[i64; 3]; 3],
        points: [[i64; 3]; 3],
        motion: [i64; 3],
        way: i128,
    ) -> bool {
        let minus =
            |p: [i64; 3], q: [i64; 3]| -> [i128; 3] { [0, 1, 2].map(|k| i128::from(p[k] - q[k])) };
        let (u, v) = (minus(b, a), minus(c, a));
        let normal = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| u[i] * v[j] - u[j] * v[i]);
        let along = |w: [i128; 3]| normal[0] * w[0] + normal[1] * w[1] + normal[2] * w[2];
        let fall = way * along(motion.map(i128::from));
        let heights = points.map(|p| along(minus(p, a)));
        heights.iter().all(|&h| h > 0 && h + fall > 0)
            || heights.iter().all(|&h| h < 0 && h + fall < 0)
    }

    #[test]
    fn triangles_that_lanes_see_apart_stay_on_one_side_of_a_plane() {
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let (mut apart, mut in_doubt) = (0, 0);
        for round in 0..4000 {
            let (most, unit) = [(4, 0.25), (1 << 20, 0.5_f64.powi(20))][round % 2];
            let place = |p: [i64; 3]| DVec3::from_array(p.map(|x| x as f64 * unit));
            let tree = |random: &mut Random| {
                let corners: [[i64; 3]; 12] = core::array::from_fn(|_| random.three(most));
                let vertices = corners.map(|corner| place(corner).as_vec3()).to_vec();
                let triangles = (0..4).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
                Mesh::new(vertices, triangles.collect()).map(|mesh| Bvh::build(&mesh))
            };
            let (Ok(first), Ok(second)) = (tree(&mut random), tree(&mut random)) else {
                continue;
            };
            let (offset, motion) = (random.three(most), random.three(2 * most));
            let mut moving = Moving::new(&first, &second, place(offset), place(motion));
            moving.level = Level::ALL[round % Level::ALL.len()];
            let (a, b) = (first.node(first.root()), second.node(second.root()));
            let (s, t) = (first.triangles(a), second.triangles(b));
            let (pairs, _) = moving.meet(&a.boxes, &b.boxes, 1.0);
            let parted = moving.parted((&a.boxes, s), (&b.boxes, t), 1.0);
            for pair in (0..TILE).filter(|pair| pairs >> pair & 1 == 1) {
                let whole = |corners: [Vec3; 3]| {
                    let of = |x: f32| (f64::from(x) / unit) as i64;
                    corners.map(|corner| corner.to_array().map(of))
                };
                let one = whole(s.corners(pair / WIDTH));
                let other = whole(t.corners(pair % WIDTH));
                let other = other.map(|p| [0, 1, 2].map(|k| p[k] + offset[k]));
                let stays = stay_on_one_side(one, other, motion, 1)
                    || stay_on_one_side(other, one, motion, -1);
                let is_seen = parted >> pair & 1 == 1;
                assert!(stays || !is_seen, "{round} {pair}");
                apart += u32::from(is_seen);
                in_doubt += u32::from(stays && !is_seen);
            }
        }
        assert!(apart > 1_000 && in_doubt < apart, "{apart} {in_doubt}");
    }
}
