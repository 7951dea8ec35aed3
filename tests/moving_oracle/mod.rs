//! First times of contact in exact rational arithmetic: slow, simple, and by another method than the library's.
//!
//! For a moving point and a convex polygon, the interval of times is clipped by one linear condition after the other.
//! Two edges are equivalent to one point and the parallelogram of their differences.
//! condition after the other. Two edges are one point against the parallelogram of their differences.

pub(crate) mod brute;
pub(crate) mod inputs;

use kit::rational::{Point, Q, cross, dot, rational, sub, zero};
use proptest::prelude::*;
use sim_core::DVec3;

fn point(p: DVec3) -> Point {
    p.to_array().map(rational)
}

fn add(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|i| &a[i] + &b[i])
}

/// The remaining times from 0 to 1.
struct Times {
    from: Q,
    to: Q,
}

impl Times {
    fn all() -> Times {
        Times {
            from: zero(),
            to: Q::from_integer(1.into()),
        }
    }

    /// Keeps the times with `at_start + t rate >= 0`.
    fn keep(&mut self, at_start: &Q, rate: &Q) {
        if *rate > zero() {
            self.from = self.from.clone().max(-at_start / rate);
        } else if *rate < zero() {
            self.to = self.to.clone().min(-at_start / rate);
        } else if *at_start < zero() {
            self.to = &self.from - Q::from_integer(1.into());
        }
    }

    /// Keeps the times with `at_start + t rate = 0`.
    fn keep_zero(&mut self, at_start: &Q, rate: &Q) {
        self.keep(at_start, rate);
        self.keep(&-at_start, &-rate);
    }

    fn first(self) -> Option<Q> {
        (self.from <= self.to).then_some(self.from)
    }
}

/// The time at which a moving point first meets a segment.
fn in_segment(p: &Point, motion: &Point, a: &Point, b: &Point) -> Option<Q> {
    let (along, from) = (sub(b, a), sub(p, a));
    let mut times = Times::all();
    if dot(&along, &along) == zero() {
        (0..3).for_each(|i| times.keep_zero(&from[i], &motion[i]));
        return times.first();
    }
    let (off, off_rate) = (cross(&from, &along), cross(motion, &along));
    (0..3).for_each(|i| times.keep_zero(&off[i], &off_rate[i]));
    let (at, rate) = (dot(&from, &along), dot(motion, &along));
    times.keep(&at, &rate);
    times.keep(&(dot(&along, &along) - &at), &-rate);
    times.first()
}

/// The time at which a moving point first meets a convex polygon, whose corners may be collinear.
fn in_polygon(p: &Point, motion: &Point, corners: &[Point]) -> Option<Q> {
    let normal = cross(
        &sub(&corners[1], &corners[0]),
        &sub(&corners[2], &corners[0]),
    );
    if dot(&normal, &normal) == zero() {
        let pairs = corners
            .iter()
            .flat_map(|a| corners.iter().map(move |b| (a, b)));
        return pairs.filter_map(|(a, b)| in_segment(p, motion, a, b)).min();
    }
    let mut times = Times::all();
    times.keep_zero(&dot(&normal, &sub(p, &corners[0])), &dot(&normal, motion));
    for (i, a) in corners.iter().enumerate() {
        let inward = cross(&normal, &sub(&corners[(i + 1) % corners.len()], a));
        times.keep(&dot(&inward, &sub(p, a)), &dot(&inward, motion));
    }
    times.first()
}

pub(crate) fn point_meets_triangle(p: DVec3, motion: DVec3, corners: [DVec3; 3]) -> Option<Q> {
    in_polygon(&point(p), &point(motion), &corners.map(point))
}

pub(crate) fn point_meets_edge(p: DVec3, motion: DVec3, [a, b]: [DVec3; 2]) -> Option<Q> {
    in_segment(&point(p), &point(motion), &point(a), &point(b))
}

/// The second edge moves.
pub(crate) fn edge_meets_edge([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], motion: DVec3) -> Option<Q> {
    let [a, b, c, d] = [a, b, c, d].map(point);
    let (u, w) = (sub(&b, &a), sub(&d, &c));
    let far = sub(&b, &w);
    let corners = [a.clone(), add(&a, &u), far, sub(&a, &w)];
    in_polygon(&c, &point(motion), &corners)
}

/// Whether the motion crosses the plane of two vectors.
pub(crate) fn is_across(u: [DVec3; 2], v: [DVec3; 2], motion: DVec3) -> bool {
    let along = |[from, to]: [DVec3; 2]| sub(&point(to), &point(from));
    dot(&cross(&along(u), &along(v)), &point(motion)) != zero()
}

/// The greatest f64 that is not above the exact time.
pub(crate) fn assert_rounded_down(
    time: Option<f64>,
    exact: Option<Q>,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(time.is_some(), exact.is_some(), "{:?} {:?}", time, exact);
    if let Some((time, exact)) = time.zip(exact) {
        prop_assert!(rational(time) <= exact, "{} is late", time);
        prop_assert!(rational(time.next_up()) > exact, "{} is early", time);
    }
    Ok(())
}
