//! How long a direction keeps two sets of points apart.
//!
//! With the gap `s` between two points along a direction, its derivative `w`, and all that is known of
//! its second derivative being that it is at least `q`, the gap is at least `s + w t + q t²/2`. With the
//! second derivative `c` at the start and a bound `J` on the third, it is at least
//! `s + w t + c t²/2 - J t³/6`, which up to a time `m` is at least the parabola with `q = c - J m/3`.
//!
//! Rounding: with `S` all lengths together, placed coordinates are right to 16 roundings of `S`, so `s` is
//! lowered by 32, and `w` by 32 of all speeds, `q` by 64 of all accelerations.

use glam::DVec3;

use super::{
    NEAR,
    nearest::{Pair, nearest},
    pieces::{Boxed, Points},
    view::{Direction, View},
};

/// Half of the distance of 1 to the next number.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// All lengths, speeds and accelerations of a pair together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin {
    pub(super) size: f64,
    pub(super) speed: f64,
    pub(super) bend: f64,
}

/// What is between two pieces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// How far they are apart now, m.
    pub(super) distance: f64,
    /// As near as this is touching, m.
    pub(super) near: f64,
    /// They are apart for so long, s.
    pub(super) lasts: f64,
    /// Whether the nearest points part along the direction that tells so, and fast enough beside what is near
    /// them for this to be followed.
    pub(super) opens: bool,
    pub(super) normal: DVec3,
    pub(super) points: [DVec3; 2],
}

impl View {
    /// How long two boxes are certainly apart, s from here; 0 where nothing is known.
    pub(super) fn boxes_apart(&self, a: &Boxed, b: &Boxed, only: Option<DVec3>) -> f64 {
        let placed = self.turn * b.centre;
        let between = self.offset + placed - a.centre;
        let motion =
            self.velocity + self.second.spin.cross(placed) - self.first.spin.cross(a.centre);
        let margin = self.margin([a.farthest, b.farthest + b.radius + a.radius]);
        let bend = self.first.second * a.farthest + self.second.second * b.farthest;
        let mut lasts: f64 = 0.0;
        let mut along = |direction: &Direction, is_oriented: bool| {
            let n = direction.along;
            let (height, reach) = (
                n.dot(between),
                direction.reach[0].dot(a.half) + direction.reach[1].dot(b.half),
            );
            let sign = if is_oriented {
                1.0
            } else {
                1.0_f64.copysign(height)
            };
            let s = sign * height - reach - a.radius - b.radius - 32.0 * UNIT * margin.size;
            if s <= 0.0 {
                return;
            }
            let sweep = direction.sweep[0].dot(a.half) + direction.sweep[1].dot(b.half);
            let w = sign * n.dot(motion) - sweep - 32.0 * UNIT * margin.speed;
            let q = sign * n.dot(self.acceleration) - bend - 64.0 * UNIT * margin.bend;
            lasts = lasts.max(root(s, w, q));
        };
        match only {
            Some(normal) => along(&self.direction(normal), true),
            None => {
                for direction in &self.directions {
                    along(direction, false);
                }
                if let Some(straight) = between.try_normalize() {
                    along(&self.direction(straight), true);
                }
            }
        }
        // However they turn, they stay within balls about their centres of mass.
        if let Some(n) = only.or_else(|| self.offset.try_normalize()) {
            let balls = a.farthest + a.radius + b.farthest + b.radius;
            let s = n.dot(self.offset) - balls - 32.0 * UNIT * margin.size;
            if s > 0.0 {
                let w = n.dot(self.velocity) - 32.0 * UNIT * margin.speed;
                let q = n.dot(self.acceleration) - 64.0 * UNIT * margin.bend;
                lasts = lasts.max(root(s, w, q));
            }
        }
        lasts
    }

    /// What is between two triangles, points or a plane, and how long it stays.
    pub(super) fn pieces_apart(
        &self,
        a: &Points,
        b: &Points,
        only: Option<DVec3>,
        halt: f64,
    ) -> Gap {
        let first = a.at;
        let arms = b.at.map(|p| self.turn * p);
        let second = arms.map(|p| self.offset + p);
        let farthest = |points: &[DVec3; 3]| {
            let squares = points.map(|p| p.length_squared());
            libm::sqrt(squares[0].max(squares[1]).max(squares[2])) * (1.0 + 4.0 * f64::EPSILON)
        };
        let (far_a, far_b) = (farthest(&first), farthest(&arms));
        let radius = a.radius + b.radius;
        let margin = self.margin([far_a, far_b + radius]);
        let pair = match only {
            Some(normal) => below(normal, &second),
            None => nearest(a, &first, b, &second),
        };
        let distance = pair.length - radius;
        let mut gap = Gap {
            distance: distance.max(0.0),
            near: NEAR * UNIT * margin.size,
            lasts: 0.0,
            opens: false,
            normal: DVec3::ZERO,
            points: pair.points,
        };
        let moves = |spin: DVec3, p: DVec3| spin.cross(p);
        let bends =
            |spin: DVec3, turning: DVec3, p: DVec3| turning.cross(p) + spin.cross(spin.cross(p));
        let (va, vb) = (
            first.map(|p| moves(self.first.spin, p)),
            arms.map(|p| self.velocity + moves(self.second.spin, p)),
        );
        let (ca, cb) = (
            first.map(|p| bends(self.first.spin, self.first.turning, p)),
            arms.map(|p| self.acceleration + bends(self.second.spin, self.second.turning, p)),
        );
        let bend = self.first.second * far_a + self.second.second * far_b;
        let third = self.first.third * far_a + self.second.third * far_b;
        let heights = |n: DVec3, points: &[DVec3; 3]| points.map(|p| n.dot(p));
        let [at_a, at_b] = pair.points;
        let parting = self.velocity + moves(self.second.spin, at_b - self.offset)
            - moves(self.first.spin, at_a);
        // How long a unit vector keeps them apart, and whether they part along it; 0 as soon as that is
        // known to be no longer than what there is.
        let lasts_along = |n: DVec3, than: f64, is_last: bool| {
            let (low, high) = (heights(n, &first), heights(n, &second));
            let (speeds_a, speeds_b) = (heights(n, &va), heights(n, &vb));
            let (bends_a, bends_b) = (heights(n, &ca), heights(n, &cb));
            let q = n.dot(self.acceleration) - bend - 64.0 * UNIT * margin.bend;
            let (mut lasts, mut closing) = (f64::INFINITY, 0.0_f64);
            for (i, j) in PAIRS {
                let s = high[j] - low[i] - radius - 32.0 * UNIT * margin.size;
                if s <= 0.0 {
                    return (0.0, false);
                }
                let w = speeds_b[j] - speeds_a[i] - 32.0 * UNIT * margin.speed;
                let c = bends_b[j] - bends_a[i] - 64.0 * UNIT * margin.bend;
                if s <= 4.0 * gap.near {
                    closing = closing.max(-w);
                }
                // What comes from afar stops where there is room for another rounding.
                let room = halt * UNIT * margin.size;
                let s = if s > room { s - room } else { s };
                let mut until = root(s, w, q.max(c - third * self.left / 3.0));
                if is_last && until < self.left.min(lasts) {
                    until = longer(until, s, w, [c, third], self.left);
                }
                lasts = lasts.min(until);
                if lasts <= than {
                    return (0.0, false);
                }
            }
            let parting = n.dot(parting) - 32.0 * UNIT * margin.speed;
            (lasts, parting >= FOLLOWED * closing)
        };
        // The same along a unit vector that turns with one of both, as the normal of its face does.
        let lasts_with = |owner: usize, n: DVec3, than: f64| {
            let (own, other) = match owner {
                0 => (&self.first, &self.second),
                _ => (&self.second, &self.first),
            };
            // The other one's points as seen from the owner's centre of mass, and how they move against it.
            let (points, speeds, bends, far, sign) = match owner {
                0 => (second, vb, cb, far_b, 1.0),
                _ => (
                    first.map(|p| p - self.offset),
                    va.map(|v| v - self.velocity),
                    ca.map(|c| c - self.acceleration),
                    far_a,
                    -1.0,
                ),
            };
            let face = match owner {
                0 => heights(n, &first),
                _ => heights(n, &arms),
            };
            let level = match owner {
                0 => face[0].max(face[1]).max(face[2]),
                _ => face[0].min(face[1]).min(face[2]),
            };
            let acceleration = self.acceleration.length();
            let fastest =
                self.velocity.length() + acceleration * self.left + other.fastest * (far + radius);
            let bent = acceleration + other.second * (far + radius);
            let (mut lasts, mut closing) = (f64::INFINITY, 0.0_f64);
            for k in 0..3 {
                let (d, v) = (points[k], speeds[k]);
                let s = sign * (n.dot(d) - level) - radius - 32.0 * UNIT * margin.size;
                if s <= 0.0 {
                    return (0.0, false);
                }
                let away = d.length() + fastest * self.left;
                let speed = margin.speed + own.fastest * d.length();
                let w = sign * n.dot(v - own.spin.cross(d)) - 32.0 * UNIT * speed;
                let most = bent + 2.0 * own.fastest * fastest + own.second * away;
                let turned = bends[k]
                    - own.turning.cross(d)
                    - 2.0 * own.spin.cross(v)
                    - own.spin.cross(d).cross(own.spin);
                let third = other.third * far
                    + 3.0 * own.fastest * bent
                    + 3.0 * own.second * fastest
                    + own.third * away;
                let c = sign * n.dot(turned) - 64.0 * UNIT * most;
                if s <= 4.0 * gap.near {
                    closing = closing.max(-w);
                }
                let room = halt * UNIT * margin.size;
                let s = if s > room { s - room } else { s };
                let mut until = root(s, w, (-most).max(c - third * self.left / 3.0));
                if until < self.left {
                    until = longer(until, s, w, [c, third], self.left);
                }
                lasts = lasts.min(until);
                if lasts <= than {
                    return (0.0, false);
                }
            }
            let parting = n.dot(parting) - 32.0 * UNIT * margin.speed;
            (lasts, parting >= FOLLOWED * closing)
        };
        let mut along = |direction: DVec3| -> f64 {
            // Also where squares of lengths would be no numbers.
            let scaled = direction / direction.abs().max_element();
            let n = scaled / scaled.length();
            if !n.is_finite() {
                return 0.0;
            }
            // From the first to the second, as far as both are on sides of their own.
            let is_turned = only.is_none() && n.dot(second[0] - first[0]) < 0.0;
            let n = if is_turned { -n } else { n };
            let (lasts, opens) = lasts_along(n, gap.lasts, false);
            if lasts > gap.lasts {
                (gap.lasts, gap.opens, gap.normal) = (lasts, opens, n);
            }
            gap.lasts
        };
        let refined = |mut gap: Gap| {
            if gap.lasts > 0.0 && gap.lasts < self.left {
                let (lasts, _) = lasts_along(gap.normal, 0.0, true);
                gap.lasts = gap.lasts.max(lasts);
            }
            gap
        };
        if let Some(normal) = only {
            along(normal);
            gap.normal = normal;
            return refined(gap);
        }
        if along(pair.points[1] - pair.points[0]) >= ENOUGH * self.left {
            return refined(gap);
        }
        // Near each other only features' own directions have enough digits.
        let sides = |points: &[DVec3; 3]| [0, 1, 2].map(|k| points[(k + 1) % 3] - points[k]);
        let (sides_a, sides_b) = (sides(&first), sides(&arms));
        let (normal_a, normal_b) = (sides_a[0].cross(sides_a[1]), sides_b[0].cross(sides_b[1]));
        if !a.is_point {
            along(normal_a);
        }
        if !b.is_point {
            along(normal_b);
        }
        for k in 0..3 {
            if !a.is_point {
                along(normal_a.cross(sides_a[k]));
            }
            if !b.is_point {
                along(normal_b.cross(sides_b[k]));
            }
            for other in sides_b {
                if !a.is_point && !b.is_point {
                    along(sides_a[k].cross(other));
                }
            }
        }
        // And where a corner is nearest to an edge, or to a corner with an edge across, the direction
        // between them, which must be exact across the edge only.
        let straight = pair.points[1] - pair.points[0];
        for side in sides_a.into_iter().chain(sides_b) {
            let length = side.length_squared();
            if length > 0.0 {
                let across = straight - straight.dot(side) / length * side;
                along(across - across.dot(side) / length * side);
            }
        }
        // Where they nearly touch, also those that turn with what they belong to: what lies in a face, or tips
        // over an edge, is kept apart by no direction at rest.
        let mut along_with = |owner: usize, direction: DVec3| {
            if let Some(n) = direction.try_normalize() {
                let n = if n.dot(second[0] - first[0]) < 0.0 {
                    -n
                } else {
                    n
                };
                let (lasts, opens) = lasts_with(owner, n, gap.lasts);
                if lasts > gap.lasts {
                    (gap.lasts, gap.opens, gap.normal) = (lasts, opens, n);
                }
            }
        };
        let is_near = distance <= NEARLY * gap.near;
        for (owner, normal, sides, is_point, spin) in [
            (0, normal_a, sides_a, a.is_point, self.first.spin),
            (1, normal_b, sides_b, b.is_point, self.second.spin),
        ] {
            if is_near && !is_point && spin != DVec3::ZERO {
                along_with(owner, normal);
                for side in sides {
                    along_with(owner, normal.cross(side));
                }
                for (side_a, side_b) in CROSSINGS.map(|(k, m)| (sides_a[k], sides_b[m])) {
                    along_with(owner, side_a.cross(side_b));
                }
            }
        }
        if gap.normal == DVec3::ZERO {
            let straight = (pair.points[1] - pair.points[0]).try_normalize();
            gap.normal = straight.unwrap_or(DVec3::ZERO);
        }
        refined(gap)
    }
}

/// Contacts nearer than this times what is one are looked at in frames that turn.
const NEARLY: f64 = 1024.0;

/// Sides of both.
const CROSSINGS: [(usize, usize); 9] = PAIRS;

/// Nearest points that part by less than this beside the speed at which corners near them close are in
/// contact: to follow them would take as many certificates as this is small.
const FOLLOWED: f64 = 1.0 / 1024.0;

/// Corners of both, those next to each other in no order apart, as most directions fail early.
const PAIRS: [(usize, usize); 9] = [
    (0, 0),
    (1, 1),
    (2, 2),
    (0, 1),
    (1, 2),
    (2, 0),
    (0, 2),
    (1, 0),
    (2, 1),
];

/// A certificate for this part of what is left is not made longer. It changes cost only.
const ENOUGH: f64 = 0.125;

/// The point that is lowest above a plane through the first centre of mass.
fn below(normal: DVec3, points: &[DVec3; 3]) -> Pair {
    let mut lowest = points[0];
    for &p in points {
        if normal.dot(p) < normal.dot(lowest) {
            lowest = p;
        }
    }
    let height = normal.dot(lowest);
    Pair {
        length: height,
        points: [lowest - height * normal, lowest],
    }
}

/// No later than the first time at which `s + w t + q t²/2` is 0; `s` is positive.
fn root(s: f64, w: f64, q: f64) -> f64 {
    // Made greater by what rounding may have made it less, so that the root is no later.
    let depth = w * w * (1.0 + 8.0 * UNIT) - 2.0 * q * s;
    let first = match (q >= 0.0, w >= 0.0) {
        (true, true) => return f64::INFINITY,
        (true, false) if depth < 0.0 => return f64::INFINITY,
        (false, true) => (w + libm::sqrt(depth)) / -q,
        _ => 2.0 * s / (libm::sqrt(depth) - w),
    };
    first * (1.0 - 16.0 * UNIT)
}

/// A time that is at least `until`, before which `s + w t + c t²/2 - j t³/6` is not 0, found by halving
/// the ratio to all that is left.
fn longer(until: f64, s: f64, w: f64, [c, j]: [f64; 2], left: f64) -> f64 {
    let holds = |m: f64| root(s, w, c - j * m / 3.0) >= m;
    if holds(left) {
        return left;
    }
    let (mut low, mut high) = (until, left);
    for _ in 0..HALVINGS {
        let middle = libm::sqrt(low * high).max(0.5 * low);
        match holds(middle) {
            true => low = low.max(middle),
            false => high = middle,
        }
    }
    low
}

/// More of them cost more each time and save times.
const HALVINGS: u32 = 6;
