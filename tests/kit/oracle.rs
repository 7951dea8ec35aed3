//! Contact in exact rational arithmetic: slow, simple, and by another method than the library's.
//!
//! The library tests signs of orientations. Here the segment is clipped by the triangle's plane and half-planes, and it
//! meets the triangle if its parameter interval is not empty.

use sim_core::DVec3;

use crate::rational::{self, Point, Q, cross, dot, sub, zero};

fn rational(p: DVec3) -> Point {
    p.to_array().map(rational::rational)
}

fn one() -> Q {
    Q::from_integer(1.into())
}

fn is_zero(a: &Point) -> bool {
    a.iter().all(|x| *x == zero())
}

/// The remaining parameters `s` of `p + s (q - p)`.
struct Interval {
    low: Q,
    high: Q,
}

impl Interval {
    /// Keeps the part where `at_start + s (at_end - at_start) >= 0`.
    fn keep_positive(&mut self, at_start: &Q, at_end: &Q) {
        let slope = at_end - at_start;
        if slope > zero() {
            self.low = self.low.clone().max(-at_start / slope);
        } else if slope < zero() {
            self.high = self.high.clone().min(-at_start / slope);
        } else if *at_start < zero() {
            self.high = &self.low - one();
        }
    }

    fn is_empty(&self) -> bool {
        self.low > self.high
    }
}

/// Whether the closed segment `pq` and the closed triangle share a point.
pub fn segment_meets_triangle(p: DVec3, q: DVec3, corners: [DVec3; 3]) -> bool {
    let (p, q) = (rational(p), rational(q));
    let corners = corners.map(rational);
    let [a, b, c] = &corners;
    let normal = cross(&sub(b, a), &sub(c, a));
    if is_zero(&normal) {
        return [(a, b), (b, c), (c, a)]
            .into_iter()
            .any(|(a, b)| segments_meet(&p, &q, a, b));
    }
    let mut left = Interval {
        low: zero(),
        high: one(),
    };
    let heights = [&p, &q].map(|x| dot(&normal, &sub(x, a)));
    // On the plane: at least and at most zero.
    left.keep_positive(&heights[0], &heights[1]);
    left.keep_positive(&-&heights[0], &-&heights[1]);
    for i in 0..3 {
        let (a, b) = (&corners[i], &corners[(i + 1) % 3]);
        let inward = cross(&normal, &sub(b, a));
        let [at_p, at_q] = [&p, &q].map(|x| dot(&inward, &sub(x, a)));
        left.keep_positive(&at_p, &at_q);
    }
    !left.is_empty()
}

/// Whether two closed triangles share a point: an edge of one meets the other.
pub fn triangles_meet(s: [DVec3; 3], t: [DVec3; 3]) -> bool {
    let edge_meets = |s: [DVec3; 3], t: [DVec3; 3]| {
        (0..3).any(|i| segment_meets_triangle(s[i], s[(i + 1) % 3], t))
    };
    edge_meets(s, t) || edge_meets(t, s)
}

/// Whether two closed segments, or points, share a point.
fn segments_meet(p: &Point, q: &Point, a: &Point, b: &Point) -> bool {
    let (u, w, m) = (sub(q, p), sub(b, a), sub(a, p));
    if is_zero(&w) {
        return on_segment(p, &u, a);
    }
    if is_zero(&u) {
        return on_segment(a, &w, p);
    }
    let n = cross(&u, &w);
    if is_zero(&n) {
        // Parallel: some end lies on the other segment, or they are apart.
        return on_segment(p, &u, a)
            || on_segment(p, &u, b)
            || on_segment(a, &w, p)
            || on_segment(a, &w, q);
    }
    if dot(&n, &m) != zero() {
        return false;
    }
    let square = dot(&n, &n);
    let s = dot(&cross(&m, &w), &n) / &square;
    let t = dot(&cross(&m, &u), &n) / &square;
    [s, t].iter().all(|x| *x >= zero() && *x <= one())
}

/// Whether `x` is on the segment from `p` along `u`.
fn on_segment(p: &Point, u: &Point, x: &Point) -> bool {
    let d = sub(x, p);
    if is_zero(u) {
        return is_zero(&d);
    }
    let along = dot(&d, u);
    is_zero(&cross(&d, u)) && along >= zero() && along <= dot(u, u)
}
