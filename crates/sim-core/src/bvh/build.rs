//! Building a BVH top down by the binned surface area heuristic (Wald 2007, "On fast construction
//! of SAH-based bounding volume hierarchies"), four children at a time (Wald, Benthin, Boulos
//! 2008, "Getting rid of packets").

use alloc::{vec, vec::Vec};
use core::ops::Range;
use glam::Vec3A;

use super::{Bvh, Child, MAX_DEPTH, Node, Origin, WIDTH};
use crate::{Aabb, Mesh};

/// Candidate split planes per axis, less one.
const BINS: usize = 16;
/// From this level on, runs are halved by count. It leaves a quarter at most to each child, and a
/// mesh has fewer than 4^16 triangles, so the tree stays within `MAX_DEPTH`.
const HALVE_FROM: usize = MAX_DEPTH - 16;

/// A triangle while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    face: u32,
}

impl Item {
    /// Centre of the box, within range by halving before adding.
    #[inline]
    fn centre(&self) -> Vec3A {
        self.bounds.min * 0.5 + self.bounds.max * 0.5
    }
}

/// A box in two SIMD registers.
#[derive(Clone, Copy)]
struct Bounds {
    min: Vec3A,
    max: Vec3A,
}

impl Bounds {
    const EMPTY: Bounds = Bounds {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
    };

    #[inline]
    fn union(self, other: Bounds) -> Bounds {
        Bounds {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    #[inline]
    fn half_area(&self) -> f32 {
        let e = self.max - self.min;
        let area = e.x * e.y + e.y * e.z + e.z * e.x;
        // Infinite for huge meshes, NaN for none: then no plane is the best, and halves do.
        area
    }

    fn narrow(self) -> Aabb {
        Aabb {
            min: self.min.into(),
            max: self.max.into(),
        }
    }
}

pub(super) fn build(mesh: &Mesh) -> Bvh {
    let mut items: Vec<Item> = (0..mesh.triangles().len())
        .map(|face| {
            let [a, b, c] = mesh.corners(face).map(Vec3A::from);
            let bounds = Bounds {
                min: a.min(b).min(c),
                max: a.max(b).max(c),
            };
            Item {
                bounds,
                face: face as u32,
            }
        })
        .collect();

    let mut nodes = Vec::with_capacity(items.len() / 2 + 1);
    nodes.push(Node::EMPTY);
    let mut depth = 0;
    // Each entry: a node to make, its run of items, its level.
    let mut pending = vec![(0, 0..items.len(), 0)];
    while let Some((index, run, level)) = pending.pop() {
        depth = depth.max(level + 1);
        let (runs, count) = divide(&mut items, run, level);
        for (lane, run) in runs.into_iter().take(count).enumerate() {
            let bounds = bounds_of(&items[run.clone()]).narrow();
            let child = if run.len() == 1 {
                Child::Triangle(run.start as u32)
            } else {
                let child = nodes.len();
                nodes.push(Node::EMPTY);
                pending.push((child, run, level + 1));
                Child::Node(child as u32)
            };
            nodes[index].set(lane, child, bounds);
        }
    }
    debug_assert!(depth <= MAX_DEPTH);
    Bvh {
        bounds: mesh.bounds(),
        nodes,
        corners: items
            .iter()
            .map(|item| mesh.corners(item.face as usize))
            .collect(),
        origin: origins(mesh, items.iter().map(|item| item.face)),
        depth,
    }
}

/// Cuts a run into four runs or fewer, none of them empty, reordering its items.
fn divide(items: &mut [Item], run: Range<usize>, level: usize) -> ([Range<usize>; WIDTH], usize) {
    let mut runs = [run, 0..0, 0..0, 0..0];
    if runs[0].len() <= WIDTH {
        let start = runs[0].start;
        let count = runs[0].len();
        for (i, run) in runs.iter_mut().enumerate().take(count) {
            *run = start + i..start + i + 1;
        }
        return (runs, count);
    }
    for count in 1..WIDTH {
        // The longest run is the one that has most to win.
        let longest = (0..count).max_by_key(|&i| runs[i].len()).unwrap_or(0);
        let Range { start, end } = runs[longest];
        let left = start + split(&mut items[start..end], level);
        runs[longest] = start..left;
        runs[count] = left..end;
    }
    (runs, WIDTH)
}

/// Reorders a run of two or more so that its first part, of the length returned, goes left.
fn split(items: &mut [Item], level: usize) -> usize {
    let plane = (level < HALVE_FROM).then(|| best_plane(items)).flatten();
    match plane {
        Some(plane) => partition(items, |item| plane.bin(item) <= plane.last_left),
        // Centres that no plane separates: any halves do.
        None => items.len() / 2,
    }
}

/// A split plane: items up to a bin of an axis go left.
struct Plane {
    axis: usize,
    origin: f32,
    scale: f32,
    last_left: usize,
}

impl Plane {
    #[inline]
    fn bin(&self, item: &Item) -> usize {
        bin((item.centre()[self.axis] - self.origin) * self.scale)
    }
}

/// Saturates: too large goes last.
#[inline]
fn bin(place: f32) -> usize {
    (place as i32 as usize).min(BINS - 1)
}

/// The plane with the least area of boxes times triangles in them, over the three axes.
fn best_plane(items: &[Item]) -> Option<Plane> {
    let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for item in items {
        low = low.min(item.centre());
        high = high.max(item.centre());
    }
    let scale = BINS as f32 / (high - low);
    let mut bins = [[(Bounds::EMPTY, 0u32); BINS]; 3];
    for item in items {
        let place = (item.centre() - low) * scale;
        for axis in 0..3 {
            let (bounds, count) = &mut bins[axis][bin(place[axis])];
            *bounds = bounds.union(item.bounds);
            *count += 1;
        }
    }
    let (mut best, mut best_cost) = (None, f32::INFINITY);
    for axis in 0..3 {
        if !scale[axis].is_finite() || scale[axis] == 0.0 {
            continue;
        }
        // What lies to the right of each plane, swept from the right.
        let mut right = [(0.0, 0); BINS];
        let (mut swept, mut count) = (Bounds::EMPTY, 0);
        for i in (1..BINS).rev() {
            swept = swept.union(bins[axis][i].0);
            count += bins[axis][i].1;
            right[i - 1] = (swept.half_area() * count as f32, count);
        }
        (swept, count) = (Bounds::EMPTY, 0);
        for last_left in 0..BINS - 1 {
            swept = swept.union(bins[axis][last_left].0);
            count += bins[axis][last_left].1;
            let (right_cost, right_count) = right[last_left];
            let cost = swept.half_area() * count as f32 + right_cost;
            if count > 0 && right_count > 0 && cost < best_cost {
                best_cost = cost;
                best = Some(Plane {
                    axis,
                    origin: low[axis],
                    scale: scale[axis],
                    last_left,
                });
            }
        }
    }
    best
}

fn bounds_of(items: &[Item]) -> Bounds {
    items
        .iter()
        .fold(Bounds::EMPTY, |bounds, item| bounds.union(item.bounds))
}

/// Brings the items that go left to the front, and counts them.
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
fn origins(mesh: &Mesh, faces: impl Iterator<Item = u32>) -> Vec<Origin> {
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
            Origin {
                face,
                vertices,
                edges,
                owns_vertex: vertices.map(|v| owner_of_vertex[v as usize] == face),
                owns_edge: edges.map(|e| owner_of_edge[e as usize] == face),
            }
        })
        .collect()
}
