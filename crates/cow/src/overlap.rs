//! Whether two triangles of a mesh share more points than their common
//! vertices, decided exactly.
//!
//! A sign of Shewchuk's predicates (crate `robust`) is that of the exact
//! determinant, so touching counts and near misses do not.

use robust::{Coord, Coord3D, orient2d, orient3d};

/// A position in metres; every f32 is an f64.
pub(crate) type Point = [f64; 3];

/// Whether two triangles with no common vertex share a point.
pub(crate) fn disjoint_triangles_meet(s: [Point; 3], t: [Point; 3]) -> bool {
    edges(s).any(|e| segment_meets_triangle(e, t)) || edges(t).any(|e| segment_meets_triangle(e, s))
}

/// Whether two triangles whose first vertex is common share another point.
///
/// Their intersection is convex. Along a ray from the common vertex it ends on
/// the side opposite that vertex, of one triangle or the other.
pub(crate) fn fans_meet(s: [Point; 3], t: [Point; 3]) -> bool {
    segment_meets_triangle([s[1], s[2]], t) || segment_meets_triangle([t[1], t[2]], s)
}

/// Whether two triangles with the common edge `edge` and the other corners `a`
/// and `b` share a point off the edge: only if one is folded onto the other.
pub(crate) fn hinge_is_shut(edge: [Point; 2], a: Point, b: Point) -> bool {
    let [p, q] = edge;
    orient(p, q, a, b) == 0.0 && {
        let drop = dropped_axis([p, q, a]);
        orient_flat(p, q, a, drop) * orient_flat(p, q, b, drop) > 0.0
    }
}

/// Whether the three corners lie on one line.
pub(crate) fn is_degenerate(t: [Point; 3]) -> bool {
    (0..3).all(|drop| orient_flat(t[0], t[1], t[2], drop) == 0.0)
}

fn edges(t: [Point; 3]) -> impl Iterator<Item = [Point; 2]> {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].into_iter()
}

fn segment_meets_triangle([p, q]: [Point; 2], t: [Point; 3]) -> bool {
    let [a, b, c] = t;
    let (above_p, above_q) = (orient(a, b, c, p), orient(a, b, c, q));
    if above_p * above_q > 0.0 {
        return false;
    }
    if above_p == 0.0 && above_q == 0.0 {
        return flat_segment_meets_triangle([p, q], t);
    }
    // The segment's line pierces the plane within the segment; it pierces the
    // triangle if all edges turn about it the same way.
    let turns = [orient(p, q, a, b), orient(p, q, b, c), orient(p, q, c, a)];
    turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0)
}

/// As [`segment_meets_triangle`], all points in one plane.
fn flat_segment_meets_triangle([p, q]: [Point; 2], t: [Point; 3]) -> bool {
    let drop = dropped_axis(t);
    let turn = |a, b, c| orient_flat(a, b, c, drop);
    let holds = |x| {
        let turns = [
            turn(t[0], t[1], x),
            turn(t[1], t[2], x),
            turn(t[2], t[0], x),
        ];
        turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0)
    };
    // A segment with both ends outside meets the triangle only across an edge,
    // and then at least one edge strictly or through a corner.
    holds(p)
        || holds(q)
        || edges(t).any(|[a, b]| {
            turn(p, q, a) * turn(p, q, b) <= 0.0 && turn(a, b, p) * turn(a, b, q) < 0.0
        })
}

/// The first axis along which the triangle's projection keeps an area.
fn dropped_axis(t: [Point; 3]) -> usize {
    (0..3)
        .find(|&drop| orient_flat(t[0], t[1], t[2], drop) != 0.0)
        .unwrap_or(0)
}

fn orient(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|[x, y, z]| Coord3D { x, y, z });
    sign(orient3d(a, b, c, d))
}

fn orient_flat(a: Point, b: Point, c: Point, drop: usize) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord {
        x: p[(drop + 1) % 3],
        y: p[(drop + 2) % 3],
    });
    sign(orient2d(a, b, c))
}

/// -1, 0 or 1, so that products of signs cannot underflow.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}
