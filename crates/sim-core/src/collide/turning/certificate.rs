//! Certificates for boxes, and for balls about centres of mass: how long they stay apart.
//!
//! Let `s` be the gap along a direction, `w` its derivative, and `q` a lower bound on its second derivative.
//! Then the gap is at least `s + w t + q t²/2`.
//!
//! Rounding: let `S` be the sum of all lengths. Placed coordinates are right to 16 roundings of `S`, so `s` is lowered
//! by 32 of these, `w` by 32 roundings of the sum of all speeds, and `q` by 64 of the sum of all accelerations.

use glam::DVec3;

use super::{
    Moving,
    pieces::Boxed,
    view::{Direction, View},
};

/// Half of the distance from 1 to the next number.
pub(super) const UNIT: f64 = 0.5 * f64::EPSILON;

/// The sums of all lengths, speeds and accelerations of a pair, which bound its rounding errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin {
    pub(super) size: f64,
    pub(super) speed: f64,
    pub(super) bend: f64,
}

impl View {
    /// A lower bound on the time in which two boxes move past each other by the sum of their sizes, s.
    pub(super) fn passing(&self, [a, b]: [&Boxed; 2]) -> f64 {
        let size = a.half.length() + a.radius + b.half.length() + b.radius;
        size / self.margin([a.farthest, b.farthest]).speed
    }

    /// How long two boxes are certainly apart, s from the view's time; 0 if nothing is proven.
    pub(super) fn boxes_apart(
        &self,
        directions: &[Direction; 6],
        [a, b]: [&Boxed; 2],
        only: Option<DVec3>,
    ) -> f64 {
        let placed = self.turn * b.centre;
        let between = self.offset + placed - a.centre;
        let motion =
            self.velocity + self.second.spin.cross(placed) - self.first.spin.cross(a.centre);
        let margin = self.margin([a.farthest, b.farthest + b.radius + a.radius]);
        let bend = self.first.second * a.farthest + self.second.second * b.farthest;
        // Whatever their rotation, the boxes stay within balls about the centres of mass.
        let balls = a.farthest + a.radius + b.farthest + b.radius;
        let course = [self.offset, self.velocity, self.acceleration];
        let mut lasts = balls_part(course, balls, margin, only);
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
                for direction in directions {
                    along(direction, false);
                }
                if let Some(straight) = between.try_normalize() {
                    along(&self.direction(straight), true);
                }
            }
        }
        lasts
    }
}

/// How long two shapes are certainly apart, s from the start. The proof uses balls about their centres of mass, in
/// which the shapes stay for any rotation.
pub(super) fn balls_apart(a: &Moving<'_>, b: &Moving<'_>, only: Option<DVec3>) -> f64 {
    let reach = |moving: &Moving<'_>| {
        let root = Boxed::root(moving);
        root.farthest + root.radius
    };
    let balls = reach(a) + reach(b);
    let course = [
        b.position - a.position,
        b.velocity - a.velocity,
        b.acceleration - a.acceleration,
    ];
    let [size, speed, bend] = course.map(DVec3::length);
    let margin = Margin {
        size: size + balls,
        speed,
        bend,
    };
    balls_part(course, balls, margin, only)
}

/// How long two balls are certainly apart. `balls` is the sum of their radii; the motion is that of one centre relative
/// to the other.
fn balls_part(
    [offset, velocity, acceleration]: [DVec3; 3],
    balls: f64,
    margin: Margin,
    only: Option<DVec3>,
) -> f64 {
    let Some(n) = only.or_else(|| offset.try_normalize()) else {
        return 0.0;
    };
    let s = n.dot(offset) - balls - 32.0 * UNIT * margin.size;
    if s.is_nan() || s <= 0.0 {
        return 0.0;
    }
    let w = n.dot(velocity) - 32.0 * UNIT * margin.speed;
    let q = n.dot(acceleration) - 64.0 * UNIT * margin.bend;
    root(s, w, q)
}

/// A lower bound on the first time at which `s + w t + q t²/2` is 0; `s` is positive.
fn root(s: f64, w: f64, q: f64) -> f64 {
    // Raised by a bound on its rounding, so that the root is no later.
    let depth = w * w * (1.0 + 8.0 * UNIT) - 2.0 * q * s;
    let first = match (q >= 0.0, w >= 0.0) {
        (true, true) => return f64::INFINITY,
        (true, false) if depth < 0.0 => return f64::INFINITY,
        (false, true) => (w + libm::sqrt(depth)) / -q,
        _ => 2.0 * s / (libm::sqrt(depth) - w),
    };
    first * (1.0 - 16.0 * UNIT)
}
