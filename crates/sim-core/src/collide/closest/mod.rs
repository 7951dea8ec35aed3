//! The distance of two meshes, or of a point and a mesh, and their closest points.
//!
//! Branch and bound: a priority queue holds pairs of nodes by the distance of their boxes. The search skips pairs
//! that are no nearer than the closest triangles so far.

mod double;
mod features;

use glam::DVec3;

use super::{is_turned, placement::Placement};
use crate::bvh::{Bvh, LEAF, MAX_DEPTH, Node, WIDTH};
pub(crate) use features::Closest;
use features::{Triangle, compare};

/// A part of the surface of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// An index of [`crate::Mesh::vertices`].
    Vertex(u32),
    /// An index of [`crate::Mesh::edges`].
    Edge(u32),
    /// An index of [`crate::Mesh::triangles`].
    Face(u32),
}

/// The closest points of two meshes that do not meet, if they are closer than a distance, m. The second mesh is
/// displaced by `offset`, m.
///
/// Exact for the placed vertices, up to 16 roundings (2^-53) of the sizes of the two triangles and of their distance.
pub(crate) fn closest(first: &Bvh, second: &Bvh, offset: DVec3, within: f64) -> Option<Closest> {
    if is_turned(offset) {
        let found = Search::of(second, first, -offset, within).run()?;
        return Some(found.turned(offset));
    }
    Search::of(first, second, offset, within).run()
}

/// The same for a mesh and a point in its frame, m, which is the second of the points; its own part has no meaning.
pub(crate) fn closest_to_point(mesh: &Bvh, point: DVec3, within: f64) -> Option<Closest> {
    let scale = scale_of(point);
    let (mut limit, mut best) = (within * scale, None);
    let point_there = Triangle {
        corners: [point * scale; 3],
        vertices: [0; 3],
        edges: [0; 3],
        face: 0,
    };
    let mut stack = [(0.0, mesh.root()); (WIDTH - 1) * MAX_DEPTH + 1];
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let (nearest, code) = stack[top];
        if nearest * scale >= limit {
            continue;
        }
        let node = mesh.node(code);
        let first = top;
        for lane in node.lanes() {
            let Side { centre, half } = Side::of(node, lane);
            let gap = box_gap(centre - point, half, centre.abs() + half + point.abs());
            if gap * scale >= limit {
                continue;
            }
            if code & LEAF == 0 {
                top = insert(&mut stack, first, top, (gap, node.child[lane]));
            } else {
                let triangle = triangle(mesh, node, lane, |v| v.as_dvec3() * scale);
                compare(
                    &triangle,
                    &point_there,
                    &mut |closest| best = Some(closest),
                    &mut limit,
                );
            }
        }
    }
    best.map(|closest| rescaled(closest, scale))
}

/// A power of two that keeps products of four lengths from overflowing.
fn scale_of(offset: DVec3) -> f64 {
    /// 2^-200.
    const SMALL: f64 = f64::from_bits((1023 - 200) << 52);
    if offset.abs().max_element() > 1.0 / SMALL {
        SMALL
    } else {
        1.0
    }
}

fn rescaled(closest: Closest, scale: f64) -> Closest {
    Closest {
        distance: closest.distance / scale,
        points: closest.points.map(|point| point / scale),
        ..closest
    }
}

/// A pair of nodes in the queue, and a lower bound on the distance of their boxes, m.
type Waiting = (f64, (u32, u32));

struct Search<'a> {
    meshes: [&'a Bvh; 2],
    at: Placement,
    scale: f64,
    /// Only smaller distances count, scaled m.
    limit: f64,
    best: Option<Closest>,
}

impl<'a> Search<'a> {
    fn of(first: &'a Bvh, second: &'a Bvh, offset: DVec3, within: f64) -> Search<'a> {
        let scale = scale_of(offset);
        Search {
            meshes: [first, second],
            at: Placement::from(offset),
            scale,
            limit: within * scale,
            best: None,
        }
    }

    fn run(mut self) -> Option<Closest> {
        let [first, second] = self.meshes;
        // Each opened pair leaves on the stack one pair less than it has children, on as many levels as both trees
        // have together.
        let root = (0.0, (first.root(), second.root()));
        let mut stack: [Waiting; 2 * MAX_DEPTH * (WIDTH * WIDTH - 1) + 1] =
            [root; 2 * MAX_DEPTH * (WIDTH * WIDTH - 1) + 1];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (gap, pair) = stack[top];
            if gap * self.scale < self.limit {
                top = self.open(pair, &mut stack, top);
            }
        }
        self.best.map(|closest| rescaled(closest, self.scale))
    }

    /// Opens both nodes of a pair, or the one that is not a leaf; compares the triangles of two leaves.
    fn open(&mut self, (a, b): (u32, u32), stack: &mut [Waiting], mut top: usize) -> usize {
        let [first, second] = self.meshes;
        let (one, other) = (first.node(a), second.node(b));
        let start = top;
        match (a & LEAF != 0, b & LEAF != 0) {
            (true, true) => self.compare_leaves(one, other),
            (false, true) => {
                for i in one.lanes() {
                    let gaps = other.lanes().map(|k| self.gap((one, i), (other, k)));
                    let gap = gaps.fold(f64::INFINITY, f64::min);
                    top = self.wait(stack, (start, top), (gap, (one.child[i], b)));
                }
            }
            (true, false) => {
                for k in other.lanes() {
                    let gaps = one.lanes().map(|i| self.gap((one, i), (other, k)));
                    let gap = gaps.fold(f64::INFINITY, f64::min);
                    top = self.wait(stack, (start, top), (gap, (a, other.child[k])));
                }
            }
            (false, false) => {
                for i in one.lanes() {
                    for k in other.lanes() {
                        let gap = self.gap((one, i), (other, k));
                        let pair = (one.child[i], other.child[k]);
                        top = self.wait(stack, (start, top), (gap, pair));
                    }
                }
            }
        }
        top
    }

    fn wait(&self, stack: &mut [Waiting], (start, top): (usize, usize), new: Waiting) -> usize {
        match new.0 * self.scale < self.limit {
            true => insert(stack, start, top, new),
            false => top,
        }
    }

    /// A lower bound on the distance of two boxes, m.
    #[inline]
    fn gap(&self, (one, i): (&Node, usize), (other, k): (&Node, usize)) -> f64 {
        let (one, other) = (Side::of(one, i), Side::of(other, k));
        let offset = self.at.offset();
        let half = one.half + other.half;
        let size = one.centre.abs() + other.centre.abs() + half + offset.abs();
        box_gap(one.centre - (other.centre + offset), half, size)
    }

    fn compare_leaves(&mut self, one: &Node, other: &Node) {
        let [first, second] = self.meshes;
        let (at, scale) = (self.at, self.scale);
        let placed: [Option<Triangle>; WIDTH] = core::array::from_fn(|k| {
            let is_used = k < other.count as usize;
            is_used.then(|| triangle(second, other, k, |v| at.place(v) * scale))
        });
        for i in one.lanes() {
            let s = triangle(first, one, i, |v| v.as_dvec3() * scale);
            for (k, t) in placed.iter().flatten().enumerate() {
                if self.gap((one, i), (other, k)) * scale < self.limit
                    && corner_gap(&s, t) < self.limit
                {
                    compare(
                        &s,
                        t,
                        &mut |closest| self.best = Some(closest),
                        &mut self.limit,
                    );
                }
            }
        }
    }
}

/// A box by its centre and half extent.
struct Side {
    centre: DVec3,
    half: DVec3,
}

impl Side {
    #[inline]
    fn of(node: &Node, lane: usize) -> Side {
        let of =
            |axes: &[[f32; WIDTH]; 3]| DVec3::from_array(axes.map(|axis| f64::from(axis[lane])));
        Side {
            centre: of(&node.boxes.centre),
            half: of(&node.boxes.half),
        }
    }
}

/// A lower bound on the distance of two boxes, from the vector between their centres, the sum of their half extents,
/// and the sum of all rounded terms.
#[inline]
fn box_gap(apart: DVec3, half: DVec3, size: DVec3) -> f64 {
    let gap = (apart.abs() - half - 4.0 * f64::EPSILON * size).max(DVec3::ZERO);
    gap.length() * (1.0 - 4.0 * f64::EPSILON)
}

/// The same for the boxes around two triangles; boxes of nodes are rounded to f32.
#[inline]
fn corner_gap(s: &Triangle, t: &Triangle) -> f64 {
    let low = |[a, b, c]: [DVec3; 3]| a.min(b).min(c);
    let high = |[a, b, c]: [DVec3; 3]| a.max(b).max(c);
    let gap = (low(s.corners) - high(t.corners)).max(low(t.corners) - high(s.corners));
    gap.max(DVec3::ZERO).length() * (1.0 - 4.0 * f64::EPSILON)
}

/// The triangle of a lane of a leaf, its corners placed.
fn triangle(mesh: &Bvh, leaf: &Node, lane: usize, place: impl Fn(glam::Vec3) -> DVec3) -> Triangle {
    let triangles = mesh.triangles(leaf);
    let face = triangles.face[lane];
    let topology = mesh.topology();
    Triangle {
        corners: triangles.corners(lane).map(place),
        vertices: topology.triangles[face as usize],
        edges: topology.triangle_edges[face as usize],
        face,
    }
}

/// Inserts an entry among those from `start` on, so that the nearest one is on top; returns the new top.
fn insert<T: Copy>(stack: &mut [(f64, T)], start: usize, top: usize, new: (f64, T)) -> usize {
    let mut place = top;
    while place > start && stack[place - 1].0 < new.0 {
        stack[place] = stack[place - 1];
        place -= 1;
    }
    stack[place] = new;
    top + 1
}
