//! The distance of two triangles in rational arithmetic.

use kit::oracle::triangles_meet;
use kit::rational::{Point, Q, cross, dot, rational, sub, zero};
use sim_core::DVec3;

/// A triangle by its corners, m.
pub(crate) type Triangle = [DVec3; 3];

/// The square of the distance of two triangles, m², exactly.
pub(crate) fn distance_square(s: Triangle, t: Triangle) -> Q {
    if triangles_meet(s, t) {
        return zero();
    }
    let exact = |corners: Triangle| corners.map(|p| p.to_array().map(rational));
    let (s, t) = (exact(s), exact(t));
    let mut squares = Vec::new();
    for (one, other) in [(&s, &t), (&t, &s)] {
        for p in one {
            squares.push(to_face(p, other));
            for k in 0..3 {
                squares.push(to_edge(p, &other[k], &other[(k + 1) % 3]));
            }
        }
    }
    for i in 0..3 {
        for k in 0..3 {
            squares.push(of_edges([&s[i], &s[(i + 1) % 3]], [&t[k], &t[(k + 1) % 3]]));
        }
    }
    squares.into_iter().flatten().min().expect("vertices")
}

fn square(p: &Point) -> Q {
    dot(p, p)
}

/// From a point to a segment, including its ends.
fn to_edge(p: &Point, a: &Point, b: &Point) -> Option<Q> {
    let (along, way) = (sub(b, a), sub(p, a));
    let part = dot(&way, &along);
    let length = square(&along);
    let ends = square(&way).min(square(&sub(p, b)));
    if part <= zero() || part >= length {
        return Some(ends);
    }
    Some(square(&cross(&way, &along)) / length)
}

/// From a point to the interior of a face.
fn to_face(p: &Point, corners: &[Point; 3]) -> Option<Q> {
    let [a, b, c] = corners;
    let normal = cross(&sub(b, a), &sub(c, a));
    let is_inside = (0..3).all(|k| {
        let (start, end) = (&corners[k], &corners[(k + 1) % 3]);
        dot(&normal, &cross(&sub(end, start), &sub(p, start))) > zero()
    });
    is_inside.then(|| {
        let height = dot(&normal, &sub(p, a));
        &height * &height / square(&normal)
    })
}

/// Between the interiors of two skew segments.
fn of_edges([a, b]: [&Point; 2], [c, d]: [&Point; 2]) -> Option<Q> {
    let (u, v, r) = (sub(b, a), sub(d, c), sub(c, a));
    let normal = cross(&u, &v);
    let length = square(&normal);
    if length == zero() {
        return None;
    }
    let parts = [cross(&r, &v), cross(&r, &u)].map(|product| dot(&product, &normal));
    let is_inside = parts.iter().all(|part| *part > zero() && *part < length);
    is_inside.then(|| {
        let height = dot(&normal, &r);
        &height * &height / length
    })
}
