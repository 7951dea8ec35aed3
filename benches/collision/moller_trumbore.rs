//! The best-known plain loop of floating-point tests, as a reference for the naive search.

use std::ops::{Add, Mul, Neg, Sub};

use sim_core::{DVec3, Mesh};

/// f32 or f64.
pub(crate) trait Float:
    Copy
    + PartialOrd
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
{
    fn of(value: f64) -> Self;
}

impl Float for f32 {
    fn of(value: f64) -> f32 {
        value as f32
    }
}

impl Float for f64 {
    fn of(value: f64) -> f64 {
        value
    }
}

type Vector<F> = [F; 3];

fn sub<F: Float>(a: Vector<F>, b: Vector<F>) -> Vector<F> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot<F: Float>(a: Vector<F>, b: Vector<F>) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<F: Float>(a: Vector<F>, b: Vector<F>) -> Vector<F> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Whether an edge of one mesh meets a triangle of the other, both ways, by Möller and Trumbore
/// 1997 ("Fast, minimum storage ray-triangle intersection") for segments: without a tolerance,
/// without a division, and with normals computed once for all edges.
pub(crate) fn meet<F: Float>(first: &Mesh, second: &Mesh, offset: DVec3) -> bool {
    one_way::<F>((first, DVec3::ZERO), (second, offset))
        || one_way::<F>((second, offset), (first, DVec3::ZERO))
}

fn one_way<F: Float>(edges_of: (&Mesh, DVec3), faces_of: (&Mesh, DVec3)) -> bool {
    let placed = |(mesh, offset): (&Mesh, DVec3)| {
        let place = |v: &sim_core::Vec3| (v.as_dvec3() + offset).to_array().map(F::of);
        mesh.vertices()
            .iter()
            .map(place)
            .collect::<Vec<Vector<F>>>()
    };
    let (ends, corners) = (placed(edges_of), placed(faces_of));
    let edges: Vec<[Vector<F>; 2]> = edges_of
        .0
        .edges()
        .iter()
        .map(|edge| {
            let [p, q] = edge.map(|v| ends[v as usize]);
            [p, sub(q, p)]
        })
        .collect();
    faces_of.0.triangles().iter().any(|triangle| {
        let [a, b, c] = triangle.map(|v| corners[v as usize]);
        let (u, v) = (sub(b, a), sub(c, a));
        let normal = cross(u, v);
        edges
            .iter()
            .any(|&[p, d]| segment_meets(p, d, a, u, v, normal))
    })
}

/// The segment from `p` along `d` against the triangle at `a` with sides `u` and `v`.
#[inline(always)]
fn segment_meets<F: Float>(
    p: Vector<F>,
    d: Vector<F>,
    a: Vector<F>,
    u: Vector<F>,
    v: Vector<F>,
    normal: Vector<F>,
) -> bool {
    let zero = F::default();
    let w = sub(p, a);
    let (start, slope) = (dot(w, normal), dot(d, normal));
    // Both ends on one side, or parallel.
    if (start > zero) == (start + slope > zero) {
        return false;
    }
    let moment = cross(w, d);
    let (det, s, t) = (-slope, dot(v, moment), -dot(u, moment));
    if det > zero {
        s >= zero && t >= zero && s + t <= det
    } else {
        s <= zero && t <= zero && s + t >= det
    }
}
