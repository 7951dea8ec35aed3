//! The nearest points of two sets, in rounded arithmetic.

use glam::DVec3;

use super::pieces::{Kind, MOST_POINTS, Points};

/// Two points, and their distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) length: f64,
    pub(super) points: [DVec3; 2],
    /// The faces that contain the points, if any.
    pub(super) faces: [Option<u32>; 2],
}

impl Pair {
    fn of(first: DVec3, second: DVec3) -> Pair {
        Pair {
            length: (second - first).length(),
            points: [first, second],
            faces: [None; 2],
        }
    }

    fn keep_nearer(&mut self, other: Pair) {
        if other.length < self.length {
            *self = other;
        }
    }
}

/// The points of a set, placed.
type At = [DVec3; MOST_POINTS];

/// The nearest points of two sets whose surfaces do not cross, placed in one frame. Skips every pair of triangles that
/// cannot be nearer than the best pair by more than a sixty-fourth, by their heights along the unit vector `along`.
pub(super) fn nearest(
    (a, first): (&Points<'_>, &At),
    (b, second): (&Points<'_>, &At),
    along: DVec3,
) -> Pair {
    let mut best = Pair::of(first[0], second[0]);
    best.length = f64::INFINITY;
    let ((of_a, count_a), (of_b, count_b)) = (a.triangles(), b.triangles());
    let (heights_a, heights_b) = (
        first.map(|point| along.dot(point)),
        second.map(|point| along.dot(point)),
    );
    let pick = |at: &At, by: [u8; 3]| by.map(|k| at[k as usize]);
    let over = |heights: &[f64; MOST_POINTS], by: [u8; 3], of: fn(f64, f64) -> f64| {
        let [a, b, c] = by.map(|k| heights[k as usize]);
        of(a, of(b, c))
    };
    match (count_a, count_b) {
        (0, 0) => best = Pair::of(first[0], second[0]),
        (0, _) => {
            for &(by, face) in &of_b[..count_b] {
                let mut pair = Pair::of(first[0], on_triangle(first[0], &pick(second, by)));
                pair.faces[1] = Some(face);
                best.keep_nearer(pair);
            }
        }
        (_, 0) => {
            for &(by, face) in &of_a[..count_a] {
                let mut pair = Pair::of(on_triangle(second[0], &pick(first, by)), second[0]);
                pair.faces[0] = Some(face);
                best.keep_nearer(pair);
            }
        }
        _ => {
            let tops = of_a.map(|(by, _)| over(&heights_a, by, f64::max));
            let bottoms = of_b.map(|(by, _)| over(&heights_b, by, f64::min));
            let (boxes_a, boxes_b) = (
                of_a.map(|(by, _)| bounds(&pick(first, by))),
                of_b.map(|(by, _)| bounds(&pick(second, by))),
            );
            let bottom = bottoms[..count_b]
                .iter()
                .fold(f64::INFINITY, |low, &at| low.min(at));
            let compare = |best: &mut Pair, i: usize, k: usize| {
                if bottoms[k] - tops[i] < best.length * (1.0 - 1.0 / 64.0)
                    && between(&boxes_a[i], &boxes_b[k]) <= best.length * best.length
                {
                    let ((by_a, face_a), (by_b, face_b)) = (of_a[i], of_b[k]);
                    let mut pair = of_triangles(&pick(first, by_a), &pick(second, by_b));
                    pair.faces = [Some(face_a), Some(face_b)];
                    best.keep_nearer(pair);
                }
            };
            // The likely pairs first, so that most others can be skipped.
            for (i, k) in likely((a, first), second, &of_b[..count_b]) {
                compare(&mut best, i, k);
            }
            for (k, i) in likely((b, second), first, &of_a[..count_a]) {
                compare(&mut best, i, k);
            }
            for (i, top) in tops[..count_a].iter().enumerate() {
                // The triangle is too low even for the lowest triangle of the other set: skip all its pairs.
                if bottom - top >= best.length * (1.0 - 1.0 / 64.0) {
                    continue;
                }
                for k in 0..count_b {
                    compare(&mut best, i, k);
                }
            }
        }
    }
    best
}

/// Two pairs of triangles that are likely to be nearest, by index: the two triangles of the box on its side nearest to
/// the nearest corner of the other set, each with one triangle of that set at this corner. Empty if the first set is
/// not a box.
fn likely(
    (a, at): (&Points<'_>, &At),
    others: &At,
    triangles: &[([u8; 3], u32)],
) -> impl Iterator<Item = (usize, usize)> + use<> {
    let axes = [1, 2, 4].map(|k| at[k] - at[0]);
    let squares = axes.map(DVec3::length_squared);
    // The distance of a corner from the box, and the side between them.
    let away = |p: DVec3| {
        let mut rest = p - at[0];
        let mut side = (f64::NEG_INFINITY, 0);
        for axis in 0..3 {
            let along = axes[axis].dot(p - at[0]) / squares[axis];
            rest -= along.clamp(0.0, 1.0) * axes[axis];
            for (end, beyond) in [-along, along - 1.0].into_iter().enumerate() {
                if beyond > 0.0 && beyond * beyond * squares[axis] > side.0 {
                    side = (beyond * beyond * squares[axis], 2 * axis + end);
                }
            }
        }
        (rest.length_squared(), side.1)
    };
    let mut found = None;
    if let Kind::Cuboid(_) = a.kind {
        let corners = (0..).zip(others).map(|(corner, &p)| (away(p), corner));
        let nearest = corners.min_by(|a, b| a.0.0.total_cmp(&b.0.0));
        found = nearest.and_then(|((_, side), corner)| {
            let beside = triangles.iter().position(|(by, _)| by.contains(&corner))?;
            Some((side, beside))
        });
    }
    let both = found.map(|(side, beside)| [(2 * side, beside), (2 * side + 1, beside)]);
    both.into_iter().flatten()
}

/// The least and the greatest corner of the box around a triangle.
fn bounds([a, b, c]: &[DVec3; 3]) -> [DVec3; 2] {
    [a.min(*b).min(*c), a.max(*b).max(*c)]
}

/// The square of the distance of two boxes, m².
fn between([low, high]: &[DVec3; 2], [other_low, other_high]: &[DVec3; 2]) -> f64 {
    let apart = (*other_low - *high).max(*low - *other_high);
    apart.max(DVec3::ZERO).length_squared()
}

fn of_triangles(first: &[DVec3; 3], second: &[DVec3; 3]) -> Pair {
    let mut best = Pair::of(first[0], second[0]);
    for k in 0..3 {
        best.keep_nearer(Pair::of(first[k], on_triangle(first[k], second)));
        best.keep_nearer(Pair::of(on_triangle(second[k], first), second[k]));
        for m in 0..3 {
            let ends = |p: &[DVec3; 3], k: usize| [p[k], p[(k + 1) % 3]];
            best.keep_nearer(segments(ends(first, k), ends(second, m)));
        }
    }
    best
}

/// The point of a triangle nearest to another point (Ericson 2004, Real-Time Collision Detection, sec. 5.1.5).
fn on_triangle(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let [from_a, from_b, from_c] = [p - a, p - b, p - c];
    let (a1, a2) = (ab.dot(from_a), ac.dot(from_a));
    if a1 <= 0.0 && a2 <= 0.0 {
        return a;
    }
    let (b1, b2) = (ab.dot(from_b), ac.dot(from_b));
    if b1 >= 0.0 && b2 <= b1 {
        return b;
    }
    let of_c = a1 * b2 - b1 * a2;
    if of_c <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
        return a + a1 / (a1 - b1) * ab;
    }
    let (c1, c2) = (ab.dot(from_c), ac.dot(from_c));
    if c2 >= 0.0 && c1 <= c2 {
        return c;
    }
    let of_b = c1 * a2 - a1 * c2;
    if of_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        return a + a2 / (a2 - c2) * ac;
    }
    let of_a = b1 * c2 - c1 * b2;
    let (along, rest) = (b2 - b1, c1 - c2);
    if of_a <= 0.0 && along >= 0.0 && rest >= 0.0 {
        return b + along / (along + rest) * (c - b);
    }
    let whole = of_a + of_b + of_c;
    let inside = a + of_b / whole * ab + of_c / whole * ac;
    // The plane of a thin triangle has few correct digits; one more step towards the rest of the way corrects the
    // others.
    let onward = step([ab, ac], p - inside);
    let inside = inside + onward[0] * ab + onward[1] * ac;
    // A triangle without area has no interior.
    if inside.is_finite() { inside } else { a }
}

/// The factors of the linear combination of two vectors that is nearest to a third one; not finite if the two are
/// parallel.
fn step([u, v]: [DVec3; 2], to: DVec3) -> [f64; 2] {
    let (uu, vv, uv) = (u.dot(u), v.dot(v), u.dot(v));
    let (along_u, along_v) = (u.dot(to), v.dot(to));
    let depth = uu * vv - uv * uv;
    [
        (vv * along_u - uv * along_v) / depth,
        (uu * along_v - uv * along_u) / depth,
    ]
}

/// The nearest points of two segments.
fn segments([p, p1]: [DVec3; 2], [q, q1]: [DVec3; 2]) -> Pair {
    let (u, v, r) = (p1 - p, q1 - q, p - q);
    let (uu, vv, uv) = (u.dot(u), v.dot(v), u.dot(v));
    let (ur, vr) = (u.dot(r), v.dot(r));
    let depth = uu * vv - uv * uv;
    let mut s = if depth > f64::EPSILON * uu * vv {
        ((uv * vr - ur * vv) / depth).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut t = (uv * s + vr) / vv;
    if t < 0.0 {
        (s, t) = ((-ur / uu).clamp(0.0, 1.0), 0.0);
    } else if t > 1.0 {
        (s, t) = (((uv - ur) / uu).clamp(0.0, 1.0), 1.0);
    } else if 0.0 < s && s < 1.0 {
        // One more step, as for thin triangles.
        let [onward, back] = step([u, v], (q + t * v) - (p + s * u));
        if onward.is_finite() && back.is_finite() {
            (s, t) = ((s + onward).clamp(0.0, 1.0), (t - back).clamp(0.0, 1.0));
        }
    }
    Pair::of(p + s * u, q + t * v)
}
