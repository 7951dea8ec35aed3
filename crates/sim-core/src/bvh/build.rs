//! Building a BVH top down by the binned surface area heuristic (Wald 2007, "On fast construction
//! of SAH-based bounding volume hierarchies"), four children at a time (Wald, Benthin, Boulos
//! 2008, "Getting rid of packets").

use alloc::{vec, vec::Vec};
use core::ops::Range;
use glam::Vec3A;

use super::slabs::slabs;
use super::{Bvh, LEAF, MAX_DEPTH, Node, Origin, Triangles, WIDTH};
use crate::Mesh;

/// Candidate split planes, less one; a power of two.
const BINS: usize = 16;
/// Runs up to this are cut in the middle of their centres: of so few triangles the heuristic makes
/// nothing better.
const SHORT: usize = 16;
/// From this level on, runs are halved by count. It leaves a quarter at most to each child, and a
/// mesh has fewer than 4^16 triangles, so the tree stays within `MAX_DEPTH`.
const HALVE_FROM: usize = MAX_DEPTH - 16;

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

    /// Twice the centre; infinite for a huge box, which then counts as one that no plane separates.
    #[inline]
    fn centre(&self) -> Vec3A {
        self.min + self.max
    }

    /// Half of the surface area; infinite for huge boxes, and then no plane is the best.
    #[inline]
    fn half_area(&self) -> f32 {
        let e = self.max - self.min;
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}

/// Triangles in an order that the build changes, run by run. Each run is in one of two buffers; a
/// split writes its parts to the other one.
struct Items {
    bounds: [Vec<Bounds>; 2],
    face: [Vec<u32>; 2],
}

/// A run of items on its way to becoming a child.
#[derive(Clone)]
struct Run {
    items: Range<usize>,
    buffer: usize,
    bounds: Bounds,
}

impl Run {
    const NONE: Run = Run {
        items: 0..0,
        buffer: 0,
        bounds: Bounds::EMPTY,
    };

    fn len(&self) -> usize {
        self.items.len()
    }

    /// What a child's triangles cost a query that reaches its parent.
    fn cost(&self) -> f32 {
        self.bounds.half_area() * self.len() as f32
    }
}

pub(super) fn build(mesh: &Mesh) -> Bvh {
    let count = mesh.triangles().len();
    let mut items = Items::of(mesh);
    let mut nodes: Vec<Node> = Vec::with_capacity(count * 5 / 8 + 1);
    let mut triangles = Vec::with_capacity(count / 2 + 1);
    let mut depth = 0;
    let bounds = mesh.bounds();
    let all = Run {
        items: 0..count,
        buffer: 0,
        bounds: Bounds {
            min: bounds.min.into(),
            max: bounds.max.into(),
        },
    };
    // Each entry: a run, its level, and which child of which node it is to be.
    let mut pending = vec![(all, 0, None)];
    while let Some((run, level, place)) = pending.pop() {
        depth = depth.max(level + 1);
        let index = nodes.len();
        let is_leaf = run.len() <= WIDTH;
        let code = index as u32 | if is_leaf { LEAF } else { 0 };
        if let Some((node, lane)) = place {
            let parent: &mut Node = &mut nodes[node];
            parent.boxes.set(lane, run.bounds.min, run.bounds.max);
            parent.child[lane] = code;
        }
        if is_leaf {
            nodes.push(items.leaf(&run, code, triangles.len() as u32));
            triangles.push(items.triangles(mesh, &run));
        } else {
            let (children, count) = items.divide(run, level);
            nodes.push(Node {
                count: count as u32,
                ..Node::EMPTY
            });
            for (lane, child) in children.into_iter().enumerate().take(count).rev() {
                pending.push((child, level + 1, Some((index, lane))));
            }
        }
    }
    debug_assert!(depth <= MAX_DEPTH);
    Bvh {
        bounds: mesh.bounds(),
        root: if count <= WIDTH { LEAF } else { 0 },
        count,
        slabs: slabs(&nodes, &triangles),
        nodes,
        triangles,
        origin: origins(mesh),
        depth,
        closed: mesh.is_closed(),
    }
}

impl Items {
    fn of(mesh: &Mesh) -> Items {
        let count = mesh.triangles().len();
        let bounds = (0..count).map(|face| {
            let [a, b, c] = mesh.corners(face).map(Vec3A::from);
            Bounds {
                min: a.min(b).min(c),
                max: a.max(b).max(c),
            }
        });
        Items {
            bounds: [bounds.collect(), vec![Bounds::EMPTY; count]],
            face: [(0..count as u32).collect(), vec![0; count]],
        }
    }

    fn leaf(&self, run: &Run, code: u32, triangles: u32) -> Node {
        let mut leaf = Node {
            child: [code; WIDTH],
            count: run.len() as u32,
            triangles,
            ..Node::EMPTY
        };
        let bounds = &self.bounds[run.buffer][run.items.clone()];
        for (lane, bounds) in bounds.iter().enumerate() {
            leaf.boxes.set(lane, bounds.min, bounds.max);
        }
        leaf
    }

    fn triangles(&self, mesh: &Mesh, run: &Run) -> Triangles {
        let faces = &self.face[run.buffer][run.items.clone()];
        let mut triangles = Triangles::NONE;
        for lane in 0..WIDTH {
            // Lanes that hold nothing repeat the last one, so that they widen nothing.
            let face = faces[lane.min(faces.len() - 1)];
            triangles.set(lane, face, mesh.corners(face as usize));
        }
        triangles
    }

    /// Cuts a run of more than four into two to four runs, none of them empty, reordering items.
    fn divide(&mut self, run: Run, level: usize) -> ([Run; WIDTH], usize) {
        let mut runs = [run, Run::NONE, Run::NONE, Run::NONE];
        let mut count = 1;
        while count < WIDTH {
            // Below the level of halving, the longest run has to go first.
            let dearest = (0..count)
                .filter(|&i| runs[i].len() > WIDTH)
                .max_by(|&i, &j| {
                    let by_length = runs[i].len().cmp(&runs[j].len());
                    if level < HALVE_FROM {
                        runs[i].cost().total_cmp(&runs[j].cost()).then(by_length)
                    } else {
                        by_length
                    }
                });
            let Some(dearest) = dearest else {
                break;
            };
            (runs[dearest], runs[count]) = self.split(&runs[dearest], level);
            count += 1;
        }
        (runs, count)
    }

    /// Cuts a run of two or more in two, along the axis on which centres lie farthest apart.
    fn split(&mut self, run: &Run, level: usize) -> (Run, Run) {
        let items = &self.bounds[run.buffer][run.items.clone()];
        let Centres { axis, low, high } = Centres::of(items);
        if level >= HALVE_FROM || !(high > low && high - low < f32::INFINITY) {
            return self.halve(run);
        }
        if run.len() <= SHORT {
            let middle = low + 0.5 * (high - low);
            let at = self.partition(run, |item| along(item, axis) <= middle);
            return self.parts(run.items.clone(), at, 1 - run.buffer);
        }
        let Some(best) = best_plane(items, axis, low, high) else {
            return self.halve(run);
        };
        let at = self.partition(run, |item| {
            bin(item, axis, low, best.scale) <= best.last_left
        });
        let part = |items, bounds| Run {
            items,
            bounds,
            buffer: 1 - run.buffer,
        };
        (
            part(run.items.start..at, best.left),
            part(at..run.items.end, best.right),
        )
    }

    /// Cuts a run where it is whose centres no plane separates.
    fn halve(&self, run: &Run) -> (Run, Run) {
        let middle = run.items.start + run.len() / 2;
        self.parts(run.items.clone(), middle, run.buffer)
    }

    fn parts(&self, run: Range<usize>, middle: usize, buffer: usize) -> (Run, Run) {
        let part = |items: Range<usize>| Run {
            bounds: self.bounds[buffer][items.clone()]
                .iter()
                .fold(Bounds::EMPTY, |all, &item| all.union(item)),
            items,
            buffer,
        };
        (part(run.start..middle), part(middle..run.end))
    }

    /// Writes a run to the other buffer, items that go left in front; returns where the others
    /// begin.
    #[inline]
    fn partition(&mut self, run: &Run, goes_left: impl Fn(&Bounds) -> bool) -> usize {
        let [bounds, other_bounds] = two(&mut self.bounds, run.buffer, run.items.clone());
        let [face, other_face] = two(&mut self.face, run.buffer, run.items.clone());
        // Those on the left from the left end, the others from the right: which of the two is a
        // toss-up, so it is an index and not a branch.
        let (mut left, mut right) = (0, bounds.len());
        for (item, &face) in bounds.iter().zip(face.iter()) {
            let goes_left = goes_left(item);
            let place = if goes_left { left } else { right - 1 };
            other_bounds[place] = *item;
            other_face[place] = face;
            left += usize::from(goes_left);
            right -= usize::from(!goes_left);
        }
        run.items.start + left
    }
}

/// A range of one of two buffers, and the same of the other.
fn two<T>(buffers: &mut [Vec<T>; 2], from: usize, range: Range<usize>) -> [&mut [T]; 2] {
    let [zero, one] = buffers;
    let [from, to] = if from == 0 { [zero, one] } else { [one, zero] };
    [&mut from[range.clone()], &mut to[range]]
}

/// The axis along which the centres of some boxes lie farthest apart, and twice the outer ones.
struct Centres {
    axis: usize,
    low: f32,
    high: f32,
}

impl Centres {
    fn of(items: &[Bounds]) -> Centres {
        let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for item in items {
            low = low.min(item.centre());
            high = high.max(item.centre());
        }
        let axis = (high - low).max_position();
        Centres {
            axis,
            low: low[axis],
            high: high[axis],
        }
    }
}

/// A plane that items are split by: up to a bin to the left, and the boxes of both sides.
struct Plane {
    scale: f32,
    last_left: u32,
    left: Bounds,
    right: Bounds,
}

/// Adding this to a small float rounds it to whole numbers, which are then its last bits.
const WHOLE: f32 = (3 << 22) as f32;

#[inline]
fn bin(item: &Bounds, axis: usize, origin: f32, scale: f32) -> u32 {
    ((along(item, axis) - origin) * scale - 0.5 + WHOLE).to_bits() & BINS as u32 - 1
}

/// Twice the centre along an axis, straight from memory rather than from a vector of three.
#[inline]
fn along(item: &Bounds, axis: usize) -> f32 {
    let (min, max): (&[f32; 3], &[f32; 3]) = (item.min.as_ref(), item.max.as_ref());
    min[axis] + max[axis]
}

/// The plane across an axis with the least area of boxes times triangles in them.
///
/// Planes across the other two axes as well would take three times as long and save queries at
/// best a few tiles in a hundred.
fn best_plane(items: &[Bounds], axis: usize, low: f32, high: f32) -> Option<Plane> {
    // A little less than the bins, so that the highest centre still lies in the last one.
    let scale = BINS as f32 * (1.0 - 1e-6) / (high - low);
    let mut bins = [Bounds::EMPTY; BINS];
    let mut counts = [0u32; BINS];
    for item in items {
        let bin = bin(item, axis, low, scale) as usize;
        bins[bin] = bins[bin].union(*item);
        counts[bin] += 1;
    }
    // What lies to the right of each plane, swept from the right.
    let mut right = [Bounds::EMPTY; BINS];
    for i in (1..BINS).rev() {
        right[i - 1] = right[i].union(bins[i]);
    }
    let (mut left, mut count, mut best, mut best_cost) = (Bounds::EMPTY, 0, None, f32::INFINITY);
    for last_left in 0..BINS - 1 {
        left = left.union(bins[last_left]);
        count += counts[last_left];
        let others = items.len() as u32 - count;
        let right = right[last_left];
        let cost = left.half_area() * count as f32 + right.half_area() * others as f32;
        if count > 0 && others > 0 && cost < best_cost {
            best_cost = cost;
            best = Some(Plane {
                scale,
                last_left: last_left as u32,
                left,
                right,
            });
        }
    }
    best
}

/// The mesh's triangles with what they own.
fn origins(mesh: &Mesh) -> Vec<Origin> {
    let corners = mesh.triangles().iter();
    let edges = mesh.triangle_edges().iter().zip(mesh.owned());
    corners
        .zip(edges)
        .map(|(&vertices, (&edges, &owned))| Origin {
            vertices,
            edges,
            owned,
        })
        .collect()
}
