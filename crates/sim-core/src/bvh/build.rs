//! Building a BVH top down by the binned surface area heuristic (Wald 2007, "On fast construction
//! of SAH-based bounding volume hierarchies").

use alloc::{vec, vec::Vec};
use glam::Vec3;

use super::{Bvh, MAX_DEPTH, Node, Triangle};
use crate::{Aabb, Mesh};

/// Candidate split planes per axis, less one. 16 costs 1 % of quality against 32 on the cow.
const BINS: usize = 16;
/// Cost of a step down the tree, in triangle tests.
const DESCENT_COST: f64 = 1.0;
/// A leaf never holds more, unless its triangles cannot be told apart.
const MAX_LEAF: usize = 4;
/// From this level on, runs are halved by count: below it at most 31 more levels exist, since a
/// mesh has fewer than 2^31 triangles, and the tree stays within `MAX_DEPTH`.
const HALVE_FROM: usize = 32;

/// A triangle while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    bounds: Aabb,
    /// Centre of the box, within range by halving before adding.
    centre: Vec3,
    face: u32,
}

pub(super) fn build(mesh: &Mesh) -> Bvh {
    let mut items: Vec<Item> = (0..mesh.triangles().len())
        .map(|face| {
            let bounds = Aabb::around(mesh.corners(face));
            Item {
                bounds,
                centre: bounds.min * 0.5 + bounds.max * 0.5,
                face: face as u32,
            }
        })
        .collect();

    let placeholder = Node {
        bounds: Aabb::EMPTY,
        first: 0,
        count: 0,
    };
    let mut nodes = Vec::with_capacity(items.len());
    nodes.push(placeholder);
    let mut depth = 0;
    // Each entry: a node to make, its run of items, its level.
    let mut pending = vec![(0, 0..items.len(), 0)];
    while let Some((node, run, level)) = pending.pop() {
        depth = depth.max(level + 1);
        let bounds = run
            .clone()
            .fold(Aabb::EMPTY, |b, i| b.union(items[i].bounds));
        match split(&mut items[run.clone()], &bounds, level) {
            Some(left) => {
                let first = nodes.len();
                nodes.extend([placeholder; 2]);
                nodes[node] = Node {
                    bounds,
                    first: first as u32,
                    count: 0,
                };
                let middle = run.start + left;
                pending.push((first + 1, middle..run.end, level + 1));
                pending.push((first, run.start..middle, level + 1));
            }
            None => {
                nodes[node] = Node {
                    bounds,
                    first: run.start as u32,
                    count: run.len() as u32,
                };
            }
        }
    }
    debug_assert!(depth <= MAX_DEPTH);
    Bvh {
        nodes,
        triangles: owners(mesh, items.iter().map(|item| item.face)),
        depth,
    }
}

/// Reorders a run so that its first part, of the length returned, goes left; `None` for a leaf.
fn split(items: &mut [Item], bounds: &Aabb, level: usize) -> Option<usize> {
    if items.len() == 1 {
        return None;
    }
    let by_area = (level < HALVE_FROM)
        .then(|| best_plane(items, bounds))
        .flatten();
    match by_area {
        Some(plane) if items.len() > MAX_LEAF || plane.cost < items.len() as f64 => {
            Some(partition(items, |item| plane.bin(item) <= plane.last_left))
        }
        _ if items.len() <= MAX_LEAF => None,
        // Centres that no plane separates: any halves do.
        _ => Some(items.len() / 2),
    }
}

/// A split plane: items up to a bin of an axis go left.
struct Plane {
    axis: usize,
    origin: f32,
    scale: f32,
    last_left: usize,
    cost: f64,
}

impl Plane {
    fn bin(&self, item: &Item) -> usize {
        bin((item.centre[self.axis] - self.origin) * self.scale)
    }
}

/// Saturates: below 0 and NaN go first, too large goes last.
fn bin(place: f32) -> usize {
    (place as usize).min(BINS - 1)
}

/// The cheapest plane over the three axes, in triangle tests for a ray that meets the parent.
fn best_plane(items: &[Item], bounds: &Aabb) -> Option<Plane> {
    let centres = Aabb::around(items.iter().map(|item| item.centre));
    let parent = bounds.half_area();
    let mut best: Option<Plane> = None;
    for axis in 0..3 {
        let origin = centres.min[axis];
        let scale = BINS as f32 / (centres.max[axis] - origin);
        if !scale.is_finite() || scale == 0.0 {
            continue;
        }
        let mut bins = [(Aabb::EMPTY, 0usize); BINS];
        for item in items {
            let (bounds, count) = &mut bins[bin((item.centre[axis] - origin) * scale)];
            *bounds = bounds.union(item.bounds);
            *count += 1;
        }
        // Cost of what lies to the right of each plane, swept from the right.
        let mut right = [(0.0, 0); BINS];
        let (mut swept, mut count) = (Aabb::EMPTY, 0);
        for i in (1..BINS).rev() {
            swept = swept.union(bins[i].0);
            count += bins[i].1;
            right[i - 1] = (weigh(swept, count), count);
        }
        (swept, count) = (Aabb::EMPTY, 0);
        for last_left in 0..BINS - 1 {
            swept = swept.union(bins[last_left].0);
            count += bins[last_left].1;
            let (right_weight, right_count) = right[last_left];
            if count == 0 || right_count == 0 {
                continue;
            }
            // A flat parent has no area to weigh by: halves then.
            let cost = if parent > 0.0 {
                DESCENT_COST + (weigh(swept, count) + right_weight) / parent
            } else {
                count.abs_diff(right_count) as f64
            };
            if best.as_ref().is_none_or(|b| cost < b.cost) {
                best = Some(Plane {
                    axis,
                    origin,
                    scale,
                    last_left,
                    cost,
                });
            }
        }
    }
    best
}

fn weigh(bounds: Aabb, count: usize) -> f64 {
    if count == 0 {
        0.0
    } else {
        bounds.half_area() * count as f64
    }
}

/// Brings the items that go left to the front, and counts them. The order within either part
/// depends on the input alone.
fn partition(items: &mut [Item], goes_left: impl Fn(&Item) -> bool) -> usize {
    let mut left = 0;
    for i in 0..items.len() {
        if goes_left(&items[i]) {
            items.swap(left, i);
            left += 1;
        }
    }
    left
}

/// The triangles in leaf order, each shared edge and vertex given to its first face.
fn owners(mesh: &Mesh, faces: impl Iterator<Item = u32>) -> Vec<Triangle> {
    let mut owner_of_vertex = vec![u32::MAX; mesh.vertices().len()];
    let mut owner_of_edge = vec![u32::MAX; mesh.edges().len()];
    for (face, (corners, edges)) in mesh
        .triangles()
        .iter()
        .zip(mesh.triangle_edges())
        .enumerate()
    {
        for &v in corners {
            let owner = &mut owner_of_vertex[v as usize];
            *owner = (*owner).min(face as u32);
        }
        for &e in edges {
            let owner = &mut owner_of_edge[e as usize];
            *owner = (*owner).min(face as u32);
        }
    }
    faces
        .map(|face| {
            let vertices = mesh.triangles()[face as usize];
            let edges = mesh.triangle_edges()[face as usize];
            Triangle {
                corners: mesh.corners(face as usize),
                face,
                vertices,
                edges,
                owns_vertex: vertices.map(|v| owner_of_vertex[v as usize] == face),
                owns_edge: edges.map(|e| owner_of_edge[e as usize] == face),
            }
        })
        .collect()
}
