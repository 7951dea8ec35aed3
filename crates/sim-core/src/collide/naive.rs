//! The naive search: every edge of one mesh against every triangle of the other, both ways.

use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::DVec3;

use super::{
    Hit, Placement, Side, Work,
    plane::Plane,
    predicates::{line_passes, segment_meets_triangle},
};
use crate::Mesh;

/// Whether the surfaces of two meshes meet. The second one is placed: displaced by a `DVec3` (m), or rotated too
/// ([`Placement::turned`]). Stops at the first hit.
///
/// One direction would miss a spike: a corner of the second that pierces a face of the first
/// between its edges.
pub fn intersect(first: &Mesh, second: &Mesh, at: impl Into<Placement>) -> bool {
    each_hit(first, second, &at.into(), |_| ControlFlow::Break(())).is_break()
}

/// The cost of [`intersect`]: tests of an edge against a triangle, until the first hit.
pub fn work(first: &Mesh, second: &Mesh, at: impl Into<Placement>) -> Work {
    let tests = |edges_of: &Mesh, faces: usize| (faces * edges_of.edges().len()) as u64;
    let all_of_first = tests(first, second.triangles().len());
    let all_of_second = tests(second, first.triangles().len());
    let (mut meet, mut done) = (false, all_of_first + all_of_second);
    let _ = each_hit(first, second, &at.into(), |pair| {
        let (side, edge, _) = pair.edge;
        let (face, edge) = (pair.face.0 as usize, u64::from(edge) + 1);
        done = match side {
            Side::First => tests(first, face) + edge,
            Side::Second => all_of_first + tests(second, face) + edge,
        };
        meet = true;
        ControlFlow::Break(())
    });
    Work {
        meet,
        boxes: 0,
        tests: done,
    }
}

/// Every edge of one mesh in a triangle of the other; edges of the first mesh first, by edge and face.
pub fn hits(first: &Mesh, second: &Mesh, at: impl Into<Placement>) -> Vec<Hit> {
    let mut hits = Vec::new();
    let _ = each_hit(first, second, &at.into(), |pair| {
        hits.push(pair.measure());
        ControlFlow::Continue(())
    });
    hits.sort_unstable_by_key(Hit::key);
    hits
}

/// An edge and the triangle that it meets.
struct Pair {
    edge: (Side, u32, [DVec3; 2]),
    face: (u32, [DVec3; 3]),
}

impl Pair {
    fn measure(self) -> Hit {
        Hit::new(self.edge, self.face)
    }
}

fn each_hit(
    first: &Mesh,
    second: &Mesh,
    at: &Placement,
    mut found: impl FnMut(Pair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    if !at.is_in_range() {
        return ControlFlow::Continue(());
    }
    let first_vertices: Vec<DVec3> = first.vertices().iter().map(|v| v.as_dvec3()).collect();
    let second_vertices: Vec<DVec3> = second.vertices().iter().map(|&v| at.place(v)).collect();
    let ways = [
        (
            Side::First,
            first,
            &first_vertices,
            second,
            &second_vertices,
        ),
        (
            Side::Second,
            second,
            &second_vertices,
            first,
            &first_vertices,
        ),
    ];
    let mut sides = Vec::new();
    for (side, edges_of, edge_vertices, faces_of, face_vertices) in ways {
        for (face, corners) in faces_of.triangles().iter().enumerate() {
            let corners = corners.map(|v| face_vertices[v as usize]);
            // An edge with both ends on one side of the plane needs no more tests.
            let plane = Plane::of(corners);
            sides.clear();
            sides.extend(edge_vertices.iter().map(|&p| plane.side(p) as i8));
            for (edge, ends) in edges_of.edges().iter().enumerate() {
                let [p, q] = ends.map(|v| v as usize);
                let across = sides[p] * sides[q];
                if across > 0 {
                    continue;
                }
                let [p, q] = [edge_vertices[p], edge_vertices[q]];
                let meets = if across < 0 {
                    line_passes(p, q, corners)
                } else {
                    segment_meets_triangle(p, q, corners)
                };
                if meets {
                    found(Pair {
                        edge: (side, edge as u32, [p, q]),
                        face: (face as u32, corners),
                    })?;
                }
            }
        }
    }
    ControlFlow::Continue(())
}
