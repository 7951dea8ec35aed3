//! Exact answers about points, segments and triangles.
//!
//! Every decision is the sign of a determinant, computed exactly (Shewchuk 1997, "Adaptive precision floating-point
//! arithmetic and fast robust geometric predicates", sec. 4). Sets are closed: sets that touch also meet. There is no
//! tolerance, so two triangles that share an edge never disagree about it, and no point slips between them.
//!
//! Coordinates must lie within ±1e100 and be multiples of 2^-340, as those of placed vertices are
//! ([`super`]), so that products of three differences neither overflow nor underflow.

use core::cmp::Ordering;
use glam::DVec3;
use robust::{Coord, Coord3D};

use super::plane::{Cross, Plane};

/// Positive if `d` sees `a`, `b`, `c` clockwise, negative if counter-clockwise, zero if the four
/// points lie in a plane: the exact sign of `det(a - d, b - d, c - d)`.
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let at = |p: DVec3| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    robust::orient3d(at(a), at(b), at(c), at(d))
}

/// Whether the closed segment `pq` and the closed triangle `abc` share a point.
///
/// Segment and triangle may be degenerate (a point, a segment).
pub fn segment_meets_triangle(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let plane = Plane::of([a, b, c]);
    let [sp, sq] = [p, q].map(|x| exact_side(plane, [a, b, c], x));
    if sp == sq {
        return sp == Ordering::Equal && coplanar_segment_meets_triangle(p, q, [a, b, c]);
    }
    // The segment reaches the plane.
    line_passes(p, q, [a, b, c])
}

/// Whether the line through `pq`, which crosses the plane of a triangle, passes through the triangle: all edges are
/// on one side of the line.
pub(super) fn line_passes(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let opposite = |s: Ordering, t: Ordering| s != Ordering::Equal && s == t.reverse();
    let (s, t) = (side([p, q, a], b), side([p, q, b], c));
    if opposite(s, t) {
        return false;
    }
    let u = side([p, q, c], a);
    !opposite(s, u) && !opposite(t, u)
}

/// Whether two closed triangles share a point.
///
/// They do if and only if an edge of one meets the other. If two triangles cross, the segment that they share ends on
/// an edge of one of them. If one lies in the other's plane, edges cross or lie inside.
pub fn triangles_meet(s: [DVec3; 3], t: [DVec3; 3]) -> bool {
    let t_sides = sides(s, t);
    if t_sides[0] != Ordering::Equal && t_sides == [t_sides[0]; 3] {
        return false;
    }
    let s_sides = sides(t, s);
    if s_sides[0] != Ordering::Equal && s_sides == [s_sides[0]; 3] {
        return false;
    }
    if [s_sides, t_sides].as_flattened().contains(&Ordering::Equal) {
        let edge_of_one_meets = |s: [DVec3; 3], t: [DVec3; 3]| {
            (0..3).any(|i| segment_meets_triangle(s[i], s[(i + 1) % 3], t))
        };
        return edge_of_one_meets(s, t) || edge_of_one_meets(t, s);
    }
    let above = |sides: [Ordering; 3]| {
        let [p, q, r] = sides.map(|side| u32::from(side == Ordering::Greater));
        p | q << 1 | r << 2
    };
    let (s_order, t_order) = crossing_orders(above(s_sides), above(t_sides));
    crossing_meet(s_order.map(|i| s[i]), t_order.map(|i| t[i]))
}

/// Whether two triangles meet that cross each other's planes, with no corner in a plane and with corners in the order
/// of [`crossing_orders`]. They meet if their intervals on the common line of the planes overlap (Guigue, Devillers
/// 2003, "Fast and robust triangle-triangle overlap test using orientation predicates", sec. 3).
#[inline(always)]
pub(super) fn crossing_meet([p1, q1, r1]: [DVec3; 3], [p2, q2, r2]: [DVec3; 3]) -> bool {
    let between = p2 - p1;
    let q = Cross::of(q1 - p1, q2 - p2).dot(between);
    let r = Cross::of(r1 - p1, r2 - p2).dot(between);
    if q.is_certain() && r.is_certain() {
        // Both signs are unpredictable, so there is one branch for both.
        return (q.value > 0.0) & (r.value < 0.0);
    }
    // The first determinant is minus that of `p1`, `q1`, `p2`, `q2`.
    side([p1, q1, p2], q2) != Ordering::Greater && side([p1, r1, r2], p2) != Ordering::Greater
}

/// The order in which [`crossing_meet`] takes the corners of two triangles. The arguments have a bit for each corner
/// above the other's plane; each triangle has corners on both sides. First comes the corner that is alone on its
/// side. The winding is chosen so that each first corner lies above the other's plane.
#[inline(always)]
pub(super) fn crossing_orders(s_above: u32, t_above: u32) -> ([usize; 3], [usize; 3]) {
    let order = |above: u32, others: u32| {
        let is_one_above = others.is_power_of_two();
        ORDERS[usize::from(is_one_above)][above as usize % 8]
    };
    (order(s_above, t_above), order(t_above, s_above))
}

/// The corners of a triangle, first the one that is alone above or below, with reversed or original winding. A table,
/// because a branch on this corner would be unpredictable.
static ORDERS: [[[usize; 3]; 8]; 2] = {
    const TURNED: [[usize; 3]; 3] = [[0, 2, 1], [1, 0, 2], [2, 1, 0]];
    const AS_WOUND: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
    const fn by_bits([p, q, r]: [[usize; 3]; 3]) -> [[usize; 3]; 8] {
        [p, p, q, r, r, q, p, p]
    }
    [by_bits(TURNED), by_bits(AS_WOUND)]
};

/// The sides of the plane of `abc` on which some points lie: `abc` is counter-clockwise seen from above.
#[inline]
fn sides(abc: [DVec3; 3], points: [DVec3; 3]) -> [Ordering; 3] {
    let plane = Plane::of(abc);
    // Written out, because a closure would not be inlined.
    let [p, q, r] = points;
    [
        exact_side(plane, abc, p),
        exact_side(plane, abc, q),
        exact_side(plane, abc, r),
    ]
}

/// Whether a point lies above the plane of `abc`, on the side where it is counter-clockwise.
pub(super) fn above(abc: [DVec3; 3], p: DVec3) -> bool {
    side(abc, p) == Ordering::Greater
}

#[inline]
fn side(abc: [DVec3; 3], p: DVec3) -> Ordering {
    exact_side(Plane::of(abc), abc, p)
}

#[inline]
fn exact_side(plane: Plane, abc: [DVec3; 3], p: DVec3) -> Ordering {
    match plane.side(p) {
        Ordering::Equal => side_by_expansion(abc, p),
        side => side,
    }
}

#[cold]
fn side_by_expansion([a, b, c]: [DVec3; 3], p: DVec3) -> Ordering {
    let height = -orient3d(a, b, c, p);
    if height > 0.0 {
        Ordering::Greater
    } else if height < 0.0 {
        Ordering::Less
    } else {
        Ordering::Equal
    }
}

/// Whether all signs are in `[0, ∞)` or all in `(-∞, 0]`.
fn same_side(s1: f64, s2: f64, s3: f64) -> bool {
    (s1 >= 0.0 && s2 >= 0.0 && s3 >= 0.0) || (s1 <= 0.0 && s2 <= 0.0 && s3 <= 0.0)
}

fn coplanar_segment_meets_triangle(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let edges = [(a, b), (b, c), (c, a)];
    let inside = Axis::ALL
        .into_iter()
        .find(|axis| axis.orient(a, b, c) != 0.0)
        .is_some_and(|axis| {
            let inside = |x| {
                let [s1, s2, s3] = edges.map(|(a, b)| axis.orient(a, b, x));
                same_side(s1, s2, s3)
            };
            inside(p) || inside(q)
        });
    inside || edges.into_iter().any(|(a, b)| segments_meet(p, q, a, b))
}

/// Whether the closed segments `pq` and `ab` share a point; either may be a point.
pub fn segments_meet(p: DVec3, q: DVec3, a: DVec3, b: DVec3) -> bool {
    if orient3d(p, q, a, b) != 0.0 {
        return false;
    }
    // Some three of the points span the plane of all four. Along an axis in which these three keep a positive area, the
    // plane projects one to one, and signs in the projection decide.
    let triples = [(p, q, a), (p, q, b), (a, b, p), (a, b, q)];
    let axis = Axis::ALL
        .into_iter()
        .find(|axis| triples.iter().any(|&(x, y, z)| axis.orient(x, y, z) != 0.0));
    match axis {
        Some(axis) => {
            let [pa, pb, ap, aq] = triples.map(|(x, y, z)| axis.orient(x, y, z));
            let apart = |s: f64, t: f64| (s > 0.0 && t > 0.0) || (s < 0.0 && t < 0.0);
            !apart(pa, pb) && !apart(ap, aq)
        }
        // All points are on one line, where lexicographic order is the order along the line.
        None => {
            let before = |s: DVec3, t: DVec3| (s.x, s.y, s.z) <= (t.x, t.y, t.z);
            let sorted = |s: DVec3, t: DVec3| if before(s, t) { (s, t) } else { (t, s) };
            let ((p, q), (a, b)) = (sorted(p, q), sorted(a, b));
            before(p, b) && before(a, q)
        }
    }
}

/// The axis along which a plane is projected.
#[derive(Clone, Copy)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// The exact sign of the projected triangle's area.
    pub(super) fn orient(self, a: DVec3, b: DVec3, c: DVec3) -> f64 {
        let at = |p: DVec3| match self {
            Axis::X => Coord { x: p.y, y: p.z },
            Axis::Y => Coord { x: p.z, y: p.x },
            Axis::Z => Coord { x: p.x, y: p.y },
        };
        robust::orient2d(at(a), at(b), at(c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn segments_against_a_triangle() {
        let tiny = 1e-90;
        let cases = [
            (
                "through the middle",
                v(0.2, 0.2, -1.0),
                v(0.2, 0.2, 1.0),
                true,
            ),
            ("beside", v(0.6, 0.6, -1.0), v(0.6, 0.6, 1.0), false),
            ("ends above", v(0.2, 0.2, 1e-90), v(0.2, 0.2, 1.0), false),
            ("ends on the face", v(0.2, 0.2, 0.0), v(0.2, 0.2, 1.0), true),
            (
                "through a corner",
                v(0.0, 0.0, -1.0),
                v(0.0, 0.0, 1.0),
                true,
            ),
            ("through an edge", v(0.5, 0.5, -1.0), v(0.5, 0.5, 1.0), true),
            (
                "an ulp past the edge",
                v(0.5, 0.5 + f64::EPSILON, -1.0),
                v(0.5, 0.5 + f64::EPSILON, 1.0),
                false,
            ),
            (
                "in the plane, inside",
                v(0.1, 0.1, 0.0),
                v(0.2, 0.2, 0.0),
                true,
            ),
            (
                "in the plane, across",
                v(-1.0, 0.2, 0.0),
                v(2.0, 0.2, 0.0),
                true,
            ),
            (
                "in the plane, beside",
                v(-1.0, -0.1, 0.0),
                v(2.0, -0.1, 0.0),
                false,
            ),
            (
                "in the plane, along an edge",
                v(-1.0, 0.0, 0.0),
                v(2.0, 0.0, 0.0),
                true,
            ),
            (
                "in the plane, short of the edge",
                v(-1.0, 0.0, 0.0),
                v(-0.5, 0.0, 0.0),
                false,
            ),
            (
                "in the plane, touching a corner",
                v(-1.0, 0.0, 0.0),
                v(0.0, 0.0, 0.0),
                true,
            ),
            (
                "parallel, a little above",
                v(-1.0, 0.2, tiny),
                v(2.0, 0.2, tiny),
                false,
            ),
            ("a point inside", v(0.2, 0.2, 0.0), v(0.2, 0.2, 0.0), true),
            ("a point outside", v(0.2, 0.2, 1.0), v(0.2, 0.2, 1.0), false),
        ];
        for (what, p, q, expected) in cases {
            for t in [T, [T[1], T[2], T[0]], [T[2], T[1], T[0]]] {
                assert_eq!(segment_meets_triangle(p, q, t), expected, "{what}");
                assert_eq!(
                    segment_meets_triangle(q, p, t),
                    expected,
                    "{what}, reversed"
                );
                let turn = |p: DVec3| v(p.y, p.z, p.x);
                assert_eq!(
                    segment_meets_triangle(turn(p), turn(q), t.map(turn)),
                    expected,
                    "{what}, turned"
                );
            }
        }
    }

    #[test]
    fn triangles_without_area_are_segments_and_points() {
        let line = [DVec3::ZERO, v(1.0, 1.0, 1.0), v(0.5, 0.5, 0.5)];
        assert!(segment_meets_triangle(
            v(0.25, 0.25, 0.0),
            v(0.25, 0.25, 1.0),
            line
        ));
        assert!(!segment_meets_triangle(
            v(0.25, 0.26, 0.0),
            v(0.25, 0.26, 1.0),
            line
        ));
        assert!(segment_meets_triangle(
            v(-1.0, -1.0, -1.0),
            DVec3::ZERO,
            line
        ));
        assert!(!segment_meets_triangle(
            v(-1.0, -1.0, -1.0),
            v(-0.1, -0.1, -0.1),
            line
        ));
        let point = [DVec3::ONE; 3];
        assert!(segment_meets_triangle(DVec3::ZERO, v(2.0, 2.0, 2.0), point));
        assert!(!segment_meets_triangle(
            DVec3::ZERO,
            v(0.5, 0.5, 0.5),
            point
        ));
        assert!(segment_meets_triangle(DVec3::ONE, DVec3::ONE, point));
        assert!(!segment_meets_triangle(DVec3::X, DVec3::X, point));
    }

    #[test]
    fn a_triangle_within_another_meets_it() {
        let inner = [v(0.2, 0.2, 0.0), v(0.3, 0.2, 0.0), v(0.2, 0.3, 0.0)];
        assert!(triangles_meet(inner, T) && triangles_meet(T, inner));
        let above = inner.map(|p| p + v(0.0, 0.0, 1e-60));
        assert!(!triangles_meet(above, T) && !triangles_meet(T, above));
    }

    #[test]
    fn an_edge_cannot_slip_between_two_triangles() {
        // The line aims at points of the shared edge, which rounding has moved off it to one side or the other.
        let (a, b) = (v(0.1, 0.7, 0.3), v(0.9, -0.2, 0.4));
        let left = [a, b, v(-1.0, -1.0, 0.0)];
        let right = [b, a, v(2.0, 2.0, 0.1)];
        for i in 1..999 {
            let aim = a.lerp(b, f64::from(i) / 999.0);
            let (p, q) = (aim + v(0.01, 0.02, 1.0), aim - v(0.01, 0.02, 1.0));
            assert!(segment_meets_triangle(p, q, left) || segment_meets_triangle(p, q, right));
        }
    }
}
