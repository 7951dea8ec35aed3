//! Triangulation of polygons, convex or not.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// The most corners of a polygon that is not convex, because ear clipping takes quadratic time.
pub(super) const MAX_CONCAVE_CORNERS: usize = 1000;

/// Cuts a polygon into `corners.len() - 2` triangles of corner numbers and appends them to `out`.
///
/// Every corner is a corner of some triangle, even one in the middle of a straight side, so that neighbouring faces
/// still meet edge to edge. Convex polygons become fans; others are triangulated by ear clipping. A polygon that
/// crosses itself has no correct triangulation; it gets some triangles.
///
/// Returns false for a polygon that is not convex and has more than [`MAX_CONCAVE_CORNERS`].
pub(super) fn triangulate(corners: &[DVec3], out: &mut Vec<[usize; 3]>) -> bool {
    let n = corners.len();
    if n == 3 {
        out.push([0, 1, 2]);
        return true;
    }
    let flat = projected(corners);
    let convex = (0..n).all(|i| turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) > 0.0)
        && (1..n - 1).all(|i| turn(flat[0], flat[i], flat[i + 1]) > 0.0);
    if convex {
        out.extend((1..n - 1).map(|i| [0, i, i + 1]));
        return true;
    }
    if n > MAX_CONCAVE_CORNERS {
        return false;
    }
    cut_ears(&flat, out);
    true
}

/// Cuts a polygon with holes into triangles of corner numbers. `rings` has the numbers of corners of the outline and of
/// each hole, in either orientation.
///
/// Two coincident sides (a bridge) connect each hole with the outline; they cross no other side.
pub(super) fn pierced(corners: &[DVec3], rings: &[usize]) -> Result<Vec<[usize; 3]>, String> {
    if corners.len() + 2 * (rings.len() - 1) > MAX_CONCAVE_CORNERS {
        return Err(format!(
            "a polygon with holes has more than {MAX_CONCAVE_CORNERS} corners: cut it before export"
        ));
    }
    let flat = projected_by(&corners[..rings[0]], corners);
    let mut start = rings[0];
    let mut holes: Vec<Vec<usize>> = Vec::new();
    for &length in &rings[1..] {
        let mut hole: Vec<usize> = (start..start + length).collect();
        if doubled_area(&flat, &hole) > 0.0 {
            hole.reverse();
        }
        holes.push(hole);
        start += length;
    }
    let mut outline: Vec<usize> = (0..rings[0]).collect();
    while !holes.is_empty() {
        let (place, hole, corner) = bridge(&flat, &outline, &holes).ok_or(
            "a hole of the polygon crosses its outline or another hole: mend it before export",
        )?;
        let mut ring = holes.swap_remove(hole);
        ring.rotate_left(corner);
        ring.push(ring[0]);
        ring.push(outline[place]);
        outline.splice(place + 1..place + 1, ring);
    }
    let around: Vec<DVec2> = outline.iter().map(|&corner| flat[corner]).collect();
    let mut cut = Vec::new();
    cut_ears(&around, &mut cut);
    Ok(cut.into_iter().map(|t| t.map(|at| outline[at])).collect())
}

/// The shortest segment from the outline to a hole that crosses no side: its place in the outline, the hole, and its
/// place in the hole.
fn bridge(
    flat: &[DVec2],
    outline: &[usize],
    holes: &[Vec<usize>],
) -> Option<(usize, usize, usize)> {
    let mut ways = Vec::new();
    for (place, &from) in outline.iter().enumerate() {
        for (hole, ring) in holes.iter().enumerate() {
            for (corner, &to) in ring.iter().enumerate() {
                ways.push((flat[from].distance_squared(flat[to]), place, hole, corner));
            }
        }
    }
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sides: Vec<[DVec2; 2]> = std::iter::once(outline)
        .chain(holes.iter().map(Vec::as_slice))
        .flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]))
        .map(|side| side.map(|corner| flat[corner]))
        .collect();
    ways.into_iter()
        .find(|&(_, place, hole, corner)| {
            let (from, to) = (flat[outline[place]], flat[holes[hole][corner]]);
            let n = outline.len();
            let before = flat[outline[(place + n - 1) % n]];
            let after = flat[outline[(place + 1) % n]];
            is_within(before, from, after, to)
                && sides.iter().all(|&[a, b]| !crosses(from, to, a, b))
        })
        .map(|(_, place, hole, corner)| (place, hole, corner))
}

/// Whether the segment from a corner to a point starts on the inner side of that corner.
fn is_within(before: DVec2, corner: DVec2, after: DVec2, point: DVec2) -> bool {
    let (left_of_in, left_of_out) = (turn(before, corner, point), turn(corner, after, point));
    if turn(before, corner, after) > 0.0 {
        left_of_in > 0.0 && left_of_out > 0.0
    } else {
        left_of_in > 0.0 || left_of_out > 0.0
    }
}

/// Whether a bridge meets a side elsewhere than at a common end.
fn crosses(from: DVec2, to: DVec2, a: DVec2, b: DVec2) -> bool {
    let on = |p: DVec2| {
        p != from
            && p != to
            && turn(from, to, p) == 0.0
            && p.cmpge(from.min(to)).all()
            && p.cmple(from.max(to)).all()
    };
    let touches = |p: DVec2| {
        p != a
            && p != b
            && turn(a, b, p) == 0.0
            && p.cmpge(a.min(b)).all()
            && p.cmple(a.max(b)).all()
    };
    let apart = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    on(a)
        || on(b)
        || touches(from)
        || touches(to)
        || apart(turn(from, to, a), turn(from, to, b)) && apart(turn(a, b, from), turn(a, b, to))
}

/// Twice the area of a ring, positive if it is counter-clockwise.
fn doubled_area(flat: &[DVec2], ring: &[usize]) -> f64 {
    let origin = flat[ring[0]];
    let pairs = ring.windows(2);
    pairs
        .map(|pair| (flat[pair[0]] - origin).perp_dot(flat[pair[1]] - origin))
        .sum()
}

/// The polygon projected along the axis closest to its normal (Newell's method), counter-clockwise.
///
/// Dropping a coordinate is exact, so the orientations below are exact for the file's own numbers.
fn projected(corners: &[DVec3]) -> Vec<DVec2> {
    projected_by(corners, corners)
}

/// Projects `points` along the axis of `polygon`.
fn projected_by(polygon: &[DVec3], points: &[DVec3]) -> Vec<DVec2> {
    let (corners, n) = (polygon, polygon.len());
    let mut normal = DVec3::ZERO;
    for i in 1..n - 1 {
        normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
    }
    let size = normal.abs();
    let positive;
    let along: fn(&DVec3) -> DVec2;
    if size.x >= size.y && size.x >= size.z {
        positive = normal.x >= 0.0;
        along = |p| DVec2::new(p.y, p.z);
    } else if size.y >= size.z {
        positive = normal.y >= 0.0;
        along = |p| DVec2::new(p.z, p.x);
    } else {
        positive = normal.z >= 0.0;
        along = |p| DVec2::new(p.x, p.y);
    }
    let mirror = if positive { 1.0 } else { -1.0 };
    points
        .iter()
        .map(|p| along(p) * DVec2::new(mirror, 1.0))
        .collect()
}

/// Positive if the path from `a` over `b` to `c` turns left; the sign is exact.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Ear clipping: of all ears, the one with the shortest new side is cut first.
fn cut_ears(flat: &[DVec2], out: &mut Vec<[usize; 3]>) {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut ears: Vec<Option<f64>> = (0..left.len()).map(|i| ear(flat, &left, i)).collect();
    while left.len() > 3 {
        let n = left.len();
        let shortest = (0..n)
            .filter_map(|i| ears[i].map(|length| (i, length)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        // There is always an ear, unless the polygon touches or crosses itself.
        let i = shortest.map_or(0, |(i, _)| i);
        out.push([left[(i + n - 1) % n], left[i], left[(i + 1) % n]]);
        left.remove(i);
        ears.remove(i);
        let n = n - 1;
        for j in [(i + n - 1) % n, i % n] {
            ears[j] = ear(flat, &left, j);
        }
    }
    out.push([left[0], left[1], left[2]]);
}

/// The squared length of the new side after corner `i` is cut off, if the corner is an ear: a left turn whose closed
/// triangle contains no other corner.
fn ear(flat: &[DVec2], left: &[usize], i: usize) -> Option<f64> {
    let n = left.len();
    let at = |k: usize| flat[left[k % n]];
    let (a, b, c) = (at(i + n - 1), at(i), at(i + 1));
    if turn(a, b, c) <= 0.0 {
        return None;
    }
    // The bridge to a hole visits corners twice: a corner at the position of a, b or c does not block.
    let blocked = left.iter().map(|&k| flat[k]).any(|p| {
        p != a
            && p != b
            && p != c
            && turn(a, b, p) >= 0.0
            && turn(b, c, p) >= 0.0
            && turn(c, a, p) >= 0.0
    });
    (!blocked).then(|| (c - a).length_squared())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
    }

    fn area(a: DVec3, b: DVec3, c: DVec3) -> f64 {
        (b - a).cross(c - a).z / 2.0
    }

    /// Shoelace formula.
    fn polygon_area(corners: &[DVec3]) -> f64 {
        (0..corners.len())
            .map(|i| corners[i].cross(corners[(i + 1) % corners.len()]).z / 2.0)
            .sum()
    }

    #[test]
    fn simple_polygons_are_covered_exactly_once() {
        let cases: [(&str, &[(f64, f64)]); 6] = [
            ("square", &[(0., 0.), (1., 0.), (1., 1.), (0., 1.)]),
            ("arrowhead", &[(0., 0.), (2., -1.), (0.5, 0.), (2., 1.)]),
            (
                "L",
                &[(0., 0.), (2., 0.), (2., 1.), (1., 1.), (1., 2.), (0., 2.)],
            ),
            (
                "square with a corner in the middle of two sides",
                &[(0., 0.), (1., 0.), (2., 0.), (2., 2.), (1., 2.), (0., 2.)],
            ),
            (
                "triangle with two corners on one side",
                &[(0., 0.), (1., 0.), (2., 0.), (3., 0.), (0., 3.)],
            ),
            (
                "square ring with a bridge",
                &[
                    (0., 0.),
                    (4., 0.),
                    (4., 4.),
                    (0., 4.),
                    (0., 0.),
                    (1., 1.),
                    (1., 3.),
                    (3., 3.),
                    (3., 1.),
                    (1., 1.),
                ],
            ),
        ];
        for (name, points) in cases {
            let corners = polygon(points);
            for shift in 0..corners.len() {
                let mut corners = corners.clone();
                corners.rotate_left(shift);
                let mut triangles = Vec::new();
                assert!(triangulate(&corners, &mut triangles), "{name}");
                assert_eq!(triangles.len(), corners.len() - 2, "{name}");
                let areas: Vec<f64> = triangles
                    .iter()
                    .map(|&[a, b, c]| area(corners[a], corners[b], corners[c]))
                    .collect();
                assert!(areas.iter().all(|&a| a > 0.0), "{name}, {shift}: {areas:?}");
                let sum: f64 = areas.iter().sum();
                assert!((sum - polygon_area(&corners)).abs() < 1e-12, "{name}");
            }
        }
    }

    #[test]
    fn winding_follows_the_polygon_in_every_plane() {
        for normal in [
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            -DVec3::X,
            -DVec3::Y,
            -DVec3::Z,
        ] {
            let (u, v) = normal.any_orthonormal_pair();
            let corners: Vec<DVec3> = [(0., 0.), (2., -1.), (0.5, 0.), (2., 1.)]
                .iter()
                .map(|&(x, y)| u * x + v * y)
                .collect();
            let mut triangles = Vec::new();
            assert!(triangulate(&corners, &mut triangles));
            for [a, b, c] in triangles {
                let n = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
                assert!(n.dot(u.cross(v)) > 0.0, "{normal}");
            }
        }
    }

    #[test]
    fn a_huge_convex_polygon_is_a_fan_and_a_huge_concave_one_is_refused() {
        let n = 3 * MAX_CONCAVE_CORNERS;
        let mut corners: Vec<DVec3> = (0..n)
            .map(|i| std::f64::consts::TAU * i as f64 / n as f64)
            .map(|angle| DVec3::new(angle.cos(), angle.sin(), 0.0))
            .collect();
        let mut triangles = Vec::new();
        assert!(triangulate(&corners, &mut triangles));
        assert_eq!(triangles.len(), n - 2);
        corners[5] *= 0.5;
        assert!(!triangulate(&corners, &mut triangles));
    }

    #[test]
    fn crossing_and_flat_polygons_still_get_triangles() {
        for points in [
            [(0., 0.), (1., 1.), (1., 0.), (0., 1.)],
            [(0., 0.), (1., 0.), (2., 0.), (3., 0.)],
            [(0., 0.), (0., 0.), (0., 0.), (0., 0.)],
            [(0., 0.), (f64::MAX, 0.), (f64::MAX, f64::MAX), (1., 1e300)],
        ] {
            let mut triangles = Vec::new();
            assert!(triangulate(&polygon(&points), &mut triangles));
            assert_eq!(triangles.len(), 2);
        }
    }
}
