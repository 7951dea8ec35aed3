//! The times at which moving points and edges meet triangles and edges: exact decisions, times rounded down.
//!
//! The motion is a translation from time 0 to time 1, so every time of contact is a quotient of two determinants of
//! differences of points (see [`super::touch`]). The signs of such determinants decide whether features meet: in f64
//! if a bound on the error allows it, else in exact arithmetic (Shewchuk 1997). Sets are closed: features that touch
//! meet, and features that touch at the start meet at time 0. Every time is the greatest f64 that is not above the
//! exact one. If coordinates are so large or small that exact products leave the range of f64, it is at most eight
//! units in the last place less.
//!
//! Coordinates must be multiples of 2^-340, as in [`super::predicates`]. Features with a coordinate or a
//! motion that is not a number or beyond ±1e100 meet nothing. Components of the motion below 2^-250 count as zero.

use core::cmp::Ordering;
use glam::DVec3;

use super::{
    placement::is_in_range,
    predicates::{orient3d, segment_meets_triangle, segments_meet},
    snap,
    triple::{Difference, Time, sign},
};

/// The time at which a point that moves by `motion` first meets a closed triangle at rest, which may degenerate to a
/// segment or a point; `None` if they do not meet from time 0 to 1.
///
/// A point that slides in the triangle's plane meets the triangle at time 0 if it is inside, else when it first meets
/// an edge.
pub fn point_meets_triangle(p: DVec3, motion: DVec3, triangle: [DVec3; 3]) -> Option<f64> {
    let (motion, [a, b, c]) = (snap(motion), triangle);
    if ![p, motion, a, b, c].into_iter().all(is_in_range) {
        return None;
    }
    let time = Time::new(Difference(b, a), Difference(c, a), Difference(a, p), motion);
    match time.course() {
        Ordering::Equal => point_slides_into_triangle(p, motion, triangle),
        course => (time.is_within(course) && line_passes(line_sides(p, motion, triangle)))
            .then(|| time.rounded_down()),
    }
}

/// The time at which an edge `cd` that moves by `motion` first meets an edge `ab` at rest; both are closed and may be
/// points. `None` if they do not meet from time 0 to 1.
pub fn edge_meets_edge([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], motion: DVec3) -> Option<f64> {
    let motion = snap(motion);
    if ![a, b, c, d, motion].into_iter().all(is_in_range) {
        return None;
    }
    let (u, w) = (Difference(b, a), Difference(d, c));
    let time = Time::new(u, w, Difference(a, c), motion);
    match time.course() {
        // If the edges stay in one plane, or on one line, an end meets the other edge first.
        Ordering::Equal if segments_meet(a, b, c, d) => Some(0.0),
        Ordering::Equal => least([
            point_meets_edge(c, motion, [a, b]),
            point_meets_edge(d, motion, [a, b]),
            point_meets_edge(a, -motion, [c, d]),
            point_meets_edge(b, -motion, [c, d]),
        ]),
        course => {
            let sides = edge_sides([a, b], [c, d], motion);
            let meet = !sides.contains(&course.reverse()) && time.is_within(course);
            meet.then(|| time.rounded_down())
        }
    }
}

/// The time at which a point that moves by `motion` first meets a closed edge at rest, which may be a point; `None` if
/// they do not meet from time 0 to 1.
pub fn point_meets_edge(p: DVec3, motion: DVec3, [a, b]: [DVec3; 2]) -> Option<f64> {
    let motion = snap(motion);
    if ![p, motion, a, b].into_iter().all(is_in_range) {
        return None;
    }
    if segments_meet(p, p, a, b) {
        return Some(0.0);
    }
    let (along, from, to) = (Difference(b, a), Difference(a, p), Difference(b, p));
    let way = Difference::from(motion);
    // In the projection along an axis in which motion and edge are not parallel.
    for axis in AXES.map(Difference::from) {
        let time = Time::new(along, axis, from, motion);
        let course = time.course();
        if course == Ordering::Equal {
            continue;
        }
        let ends = [from, to].map(|end| sign([end, way, axis]));
        let meets = sign([along, from, way]) == Ordering::Equal
            && (ends[0] == Ordering::Equal || ends[0] != ends[1])
            && time.is_within(course);
        return meets.then(|| time.rounded_down());
    }
    let is_ahead = AXES
        .iter()
        .all(|&axis| sign([from, way, axis.into()]) == Ordering::Equal);
    let along = (0..3).find(|&axis| is_ahead && motion[axis] != 0.0)?;
    // The motion is parallel to the edge, or the edge is a point.
    least([from, to].map(|gap| {
        let time = Time::new(
            AXES[(along + 1) % 3].into(),
            AXES[(along + 2) % 3].into(),
            gap,
            motion,
        );
        time.is_within(time.course()).then(|| time.rounded_down())
    }))
}

const AXES: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

/// The earliest of some times.
fn least<const N: usize>(times: [Option<f64>; N]) -> Option<f64> {
    times.into_iter().flatten().min_by(f64::total_cmp)
}

/// [`point_meets_triangle`] for a motion in the triangle's plane, or a triangle without area.
#[cold]
pub(super) fn point_slides_into_triangle(
    p: DVec3,
    motion: DVec3,
    [a, b, c]: [DVec3; 3],
) -> Option<f64> {
    if orient3d(a, b, c, p) != 0.0 {
        return None;
    }
    if segment_meets_triangle(p, p, [a, b, c]) {
        return Some(0.0);
    }
    least([[a, b], [b, c], [c, a]].map(|edge| point_meets_edge(p, motion, edge)))
}

/// Whether a line passes through a triangle, given its sides of the edges: all on one side.
pub(super) fn line_passes(sides: [Ordering; 3]) -> bool {
    !(sides.contains(&Ordering::Less) && sides.contains(&Ordering::Greater))
}

/// The sides on which a line through `p` along `motion` has the edges of a triangle.
pub(super) fn line_sides(p: DVec3, motion: DVec3, [a, b, c]: [DVec3; 3]) -> [Ordering; 3] {
    [(a, b), (b, c), (c, a)].map(|(a, b)| sign([Difference(b, a), motion.into(), Difference(a, p)]))
}

/// With `a + s (b - a) = c + q (d - c) + t motion`, the signs of `s`, `1 - s`, `q` and `1 - q`, times
/// that of `det(b - a, d - c, motion)`.
pub(super) fn edge_sides([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], motion: DVec3) -> [Ordering; 4] {
    let (u, w) = (Difference(b, a), Difference(d, c));
    [
        (w, Difference(a, c)),
        (w, Difference(c, b)),
        (u, Difference(a, c)),
        (u, Difference(d, a)),
    ]
    .map(|(along, apart)| sign([along, apart, motion.into()]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_or_too_far_meets_nothing() {
        let v = DVec3::new;
        let (p, down) = (v(0.2, 0.2, 1.0), v(0.0, 0.0, -2.0));
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let edges = [
            [v(0.2, -1.0, 1.0), v(0.2, 1.0, 1.0)],
            [DVec3::ZERO, DVec3::X],
        ];
        assert_eq!(point_meets_triangle(p, down, triangle), Some(0.5));
        assert_eq!(edge_meets_edge(edges[1], edges[0], down), Some(0.5));
        assert_eq!(
            point_meets_edge(v(0.2, 0.0, 1.0), down, edges[1]),
            Some(0.5)
        );
        for bad in [1e101, 1e200, 1.7e308, f64::INFINITY, f64::NAN] {
            for motion in [DVec3::NEG_Z * bad, v(1e200, 1e100, bad)] {
                assert_eq!(point_meets_triangle(p, motion, triangle), None);
                assert_eq!(edge_meets_edge(edges[1], edges[0], motion), None);
                assert_eq!(point_meets_edge(p, motion, edges[1]), None);
            }
            let far = v(0.0, bad, -bad);
            assert_eq!(point_meets_triangle(far, down, triangle), None);
            assert_eq!(
                point_meets_triangle(p, down, [far, DVec3::X, DVec3::Y]),
                None
            );
            assert_eq!(edge_meets_edge([far, DVec3::X], edges[0], down), None);
            assert_eq!(point_meets_edge(p, down, [DVec3::ZERO, far]), None);
        }
    }
}
