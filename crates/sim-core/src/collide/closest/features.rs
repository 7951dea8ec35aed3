//! The closest features of two triangles that share no point: a vertex and a face, two edges, or a vertex
//! and a vertex or edge.
//!
//! Distances from vertices to edges and vertices are differences of points. The others are quotients
//! `det / |n|`; if triangles are needles or edges are nearly parallel, all digits of `n` and of the
//! determinant may cancel. So f64 only excludes, with bounds on its rounding, features that cannot be closest;
//! the others are computed with twice the digits.

use glam::DVec3;

use super::{
    Part,
    double::{Double, Vector},
};

/// A triangle: its corners and the indices of its vertices, edges (`ab`, `bc`, `ca`) and face.
#[derive(Clone, Copy)]
pub(super) struct Triangle {
    pub(super) corners: [DVec3; 3],
    pub(super) vertices: [u32; 3],
    pub(super) edges: [u32; 3],
    pub(super) face: u32,
}

impl Triangle {
    fn edge(&self, k: usize) -> [DVec3; 2] {
        [self.corners[k], self.corners[(k + 1) % 3]]
    }
}

/// Two points, one of each shape, and the vector between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Closest {
    /// The distance, m.
    pub(crate) distance: f64,
    /// In the first shape's frame, m.
    pub(crate) points: [DVec3; 2],
    /// Unit normal, from the first point to the second; zero if rounding leaves no direction.
    pub(crate) normal: DVec3,
    pub(crate) parts: [Part; 2],
}

impl Closest {
    /// The same with the shapes in the other order, in the frame of the shape that is at `offset` now.
    pub(super) fn turned(self, offset: DVec3) -> Closest {
        let [first, second] = self.points;
        let [one, other] = self.parts;
        Closest {
            distance: self.distance,
            points: [second + offset, first + offset],
            normal: -self.normal,
            parts: [other, one],
        }
    }

    fn between(points: [DVec3; 2], way: DVec3, parts: [Part; 2]) -> Closest {
        let distance = way.length();
        let normal = way / distance;
        Closest {
            distance,
            points,
            normal: if normal.is_finite() {
                normal
            } else {
                DVec3::ZERO
            },
            parts,
        }
    }
}

/// A bound on the roundings of a product of three lengths in a determinant.
const ROUNDINGS: f64 = 32.0 * f64::EPSILON;

/// Keeps the closest features of two triangles, if they are closer than the best so far.
pub(super) fn compare(
    first: &Triangle,
    second: &Triangle,
    found: &mut impl FnMut(Closest),
    limit: &mut f64,
) {
    let mut take = |closest: Closest, is_turned: bool| {
        if closest.distance < *limit {
            *limit = closest.distance;
            found(match is_turned {
                true => closest.turned(DVec3::ZERO),
                false => closest,
            });
        }
        *limit
    };
    let mut within = take(vertices(first, second), false);
    for (one, other, is_turned) in [(first, second, false), (second, first, true)] {
        for i in 0..3 {
            for k in 0..3 {
                if let Some(closest) = vertex_edge((other, i), (one, k)) {
                    within = take(closest, is_turned);
                }
            }
        }
    }
    for (one, other, is_turned) in [(first, second, false), (second, first, true)] {
        for i in 0..3 {
            if let Some(closest) = vertex_face((other, i), one, within) {
                within = take(closest, is_turned);
            }
        }
    }
    for i in 0..3 {
        for k in 0..3 {
            if let Some(closest) = edge_edge((first, i), (second, k), within) {
                within = take(closest, false);
            }
        }
    }
}

/// The closest vertices.
fn vertices(first: &Triangle, second: &Triangle) -> Closest {
    let pairs = (0..9).map(|k| (k / 3, k % 3));
    let square = |(i, k): (usize, usize)| first.corners[i].distance_squared(second.corners[k]);
    let (i, k) = pairs
        .reduce(|one, other| {
            if square(other) < square(one) {
                other
            } else {
                one
            }
        })
        .unwrap_or_default();
    let points = [first.corners[i], second.corners[k]];
    let parts = [
        Part::Vertex(first.vertices[i]),
        Part::Vertex(second.vertices[k]),
    ];
    Closest::between(points, points[1] - points[0], parts)
}

/// A vertex opposite to the interior of an edge, from the edge to the vertex.
fn vertex_edge((of, i): (&Triangle, usize), (on, k): (&Triangle, usize)) -> Option<Closest> {
    let (p, [a, b]) = (of.corners[i], on.edge(k));
    let along = b - a;
    let (from_a, from_b) = ((p - a).dot(along), (b - p).dot(along));
    if !(from_a > 0.0 && from_b > 0.0) {
        return None;
    }
    let length = along.length_squared();
    // From the nearer end, where less is rounded.
    let (end, part) = match from_a <= from_b {
        true => (a, from_a / length),
        false => (b, -from_b / length),
    };
    let way = (p - end) - part * along;
    let parts = [Part::Edge(on.edges[k]), Part::Vertex(of.vertices[i])];
    Some(Closest::between([end + part * along, p], way, parts))
}

/// A vertex opposite to the interior of a face, from the face to the vertex, if it is closer than a distance.
fn vertex_face((of, i): (&Triangle, usize), on: &Triangle, within: f64) -> Option<Closest> {
    let (p, corners) = (of.corners[i], on.corners);
    let [a, b, c] = corners;
    let (ab, ac, q) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    // Each component of the normal rounds by at most a few units of this.
    let size = ROUNDINGS * ab.length() * ac.length();
    let reach = q.length() + within;
    // A segment or a point has no interior.
    if size == 0.0 {
        return None;
    }
    if normal.dot(q).abs() > within * normal.length() + size * reach {
        return None;
    }
    for k in 0..3 {
        let [start, end] = on.edge(k);
        let (along, way) = (end - start, p - start);
        if normal.dot(along.cross(way)) < -size * along.length() * way.length() {
            return None;
        }
    }
    let exact = |from: DVec3, to: DVec3| Vector::between(from, to);
    let normal = exact(a, b).cross(exact(a, c));
    let is_inside = (0..3).all(|k| {
        let [start, end] = on.edge(k);
        let area = exact(start, end).cross(exact(start, p));
        normal.dot(area).rounded() > 0.0
    });
    let unit = is_inside.then(|| unit(normal))??;
    let height = over(normal, exact(a, p), unit);
    let normal = unit.direction * libm::copysign(1.0, height);
    Some(Closest {
        distance: height.abs(),
        points: [p - height * unit.direction, p],
        normal,
        parts: [Part::Face(on.face), Part::Vertex(of.vertices[i])],
    })
}

/// The interiors of two edges where they pass each other, if they are closer than a distance.
fn edge_edge(
    (first, i): (&Triangle, usize),
    (second, k): (&Triangle, usize),
    within: f64,
) -> Option<Closest> {
    let ([a, b], [c, d]) = (first.edge(i), second.edge(k));
    let (u, v, r) = (b - a, d - c, c - a);
    let normal = u.cross(v);
    let size = ROUNDINGS * u.length() * v.length();
    let (far, square) = (r.length(), normal.length_squared());
    if size == 0.0 {
        return None;
    }
    if normal.dot(r).abs() > within * normal.length() + size * (far + within) {
        return None;
    }
    // Positions along the edges as parts of their lengths, times the square of the normal.
    let (along_u, along_v) = (r.cross(v).dot(normal), r.cross(u).dot(normal));
    let slack_u = size * (far * v.length() + u.length() * v.length());
    let slack_v = size * (far * u.length() + u.length() * v.length());
    let may_be = |part: f64, slack: f64| part >= -slack && part <= square + slack;
    if !(may_be(along_u, slack_u) && may_be(along_v, slack_v)) {
        return None;
    }
    let exact = |from: DVec3, to: DVec3| Vector::between(from, to);
    let (u, v, r) = (exact(a, b), exact(c, d), exact(a, c));
    let normal = u.cross(v);
    let square = normal.dot(normal);
    let part = |numerator: Double| {
        let inside = numerator.rounded() > 0.0 && (square - numerator).rounded() > 0.0;
        inside.then(|| numerator.rounded() / square.rounded())
    };
    let on_first = part(r.cross(v).dot(normal))?;
    let on_second = part(r.cross(u).dot(normal))?;
    let unit = unit(normal)?;
    let height = over(normal, r, unit);
    Some(Closest {
        distance: height.abs(),
        points: [a + on_first * u.rounded(), c + on_second * v.rounded()],
        normal: unit.direction * libm::copysign(1.0, height),
        parts: [Part::Edge(first.edges[i]), Part::Edge(second.edges[k])],
    })
}

/// The direction of a vector, and its length.
#[derive(Clone, Copy)]
struct Unit {
    direction: DVec3,
    length: f64,
}

fn unit(vector: Vector) -> Option<Unit> {
    let vector = vector.rounded();
    let largest = vector.abs().max_element();
    let scaled = vector / largest;
    let length = scaled.length();
    scaled.is_finite().then(|| Unit {
        direction: scaled / length,
        length: length * largest,
    })
}

/// `normal · way`, divided by the length of the normal.
fn over(normal: Vector, way: Vector, unit: Unit) -> f64 {
    normal.dot(way).rounded() / unit.length
}
