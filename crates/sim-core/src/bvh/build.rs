//! Building a BVH top down by the binned surface area heuristic (Wald 2007, "On fast construction
//! of SAH-based bounding volume hierarchies"), four children at a time (Wald, Benthin, Boulos
//! 2008, "Getting rid of packets").

use alloc::{vec, vec::Vec};
use core::ops::Range;
use glam::Vec3A;

use super::slabs::slabs;
use super::{Bvh, LEAF, MAX_DEPTH, Node, Origin, Triangles, WIDTH};
use crate::{Aabb, Mesh};

/// Candidate split planes per axis, less one, for long runs and for short ones, where sweeping the
/// bins costs more than filling them.
const BINS: usize = 16;
const FEW_BINS: usize = 8;
/// The longest run for few bins.
const SHORT: usize = 64;
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

    fn narrow(self) -> Aabb {
        Aabb {
            min: self.min.into(),
            max: self.max.into(),
        }
    }
}

/// Triangles in an order that the build changes, run by run.
struct Items {
    bounds: Vec<Bounds>,
    face: Vec<u32>,
    /// What a partition writes to.
    other: (Vec<Bounds>, Vec<u32>),
}

/// A run of items on its way to becoming a child.
#[derive(Clone)]
struct Run {
    items: Range<usize>,
    bounds: Bounds,
}

impl Run {
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
    let all = Run {
        items: 0..count,
        bounds: items.bounds_of(0..count),
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
            parent.boxes.set(lane, run.bounds.narrow());
            parent.child[lane] = code;
        }
        if is_leaf {
            nodes.push(items.leaf(run.items.clone(), code, triangles.len() as u32));
            triangles.push(items.triangles(mesh, run.items));
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
            bounds: bounds.collect(),
            face: (0..count as u32).collect(),
            other: (vec![Bounds::EMPTY; count], vec![0; count]),
        }
    }

    fn bounds_of(&self, run: Range<usize>) -> Bounds {
        let bounds = self.bounds[run].iter();
        bounds.fold(Bounds::EMPTY, |all, &item| all.union(item))
    }

    fn leaf(&self, run: Range<usize>, code: u32, triangles: u32) -> Node {
        let mut leaf = Node {
            child: [code; WIDTH],
            count: run.len() as u32,
            triangles,
            ..Node::EMPTY
        };
        for (lane, bounds) in self.bounds[run].iter().enumerate() {
            leaf.boxes.set(lane, bounds.narrow());
        }
        leaf
    }

    fn triangles(&self, mesh: &Mesh, run: Range<usize>) -> Triangles {
        let mut triangles = Triangles::NONE;
        // Lanes that hold nothing repeat the last one, so that they widen nothing.
        for lane in 0..WIDTH {
            let face = self.face[(run.start + lane).min(run.end - 1)];
            triangles.set(lane, face, mesh.corners(face as usize));
        }
        triangles
    }

    /// Cuts a run of more than four into two to four runs, none of them empty, reordering items.
    fn divide(&mut self, run: Run, level: usize) -> ([Run; WIDTH], usize) {
        let none = Run {
            items: 0..0,
            bounds: Bounds::EMPTY,
        };
        let mut runs = [run, none.clone(), none.clone(), none];
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
            (runs[dearest], runs[count]) = self.split(runs[dearest].items.clone(), level);
            count += 1;
        }
        (runs, count)
    }

    /// Reorders a run of two or more into two.
    fn split(&mut self, run: Range<usize>, level: usize) -> (Run, Run) {
        let plane = match run.len() {
            _ if level >= HALVE_FROM => None,
            ..=SHORT => best_plane::<FEW_BINS>(&self.bounds[run.clone()]),
            _ => best_plane::<BINS>(&self.bounds[run.clone()]),
        };
        let middle = match plane {
            Some(plane) => self.partition(run.clone(), &plane),
            // Centres that no plane separates: any halves do.
            None => run.start + run.len() / 2,
        };
        let part = |items: Range<usize>| Run {
            bounds: self.bounds_of(items.clone()),
            items,
        };
        (part(run.start..middle), part(middle..run.end))
    }

    /// Brings the items on the left of a plane to the front; returns where the others begin.
    fn partition(&mut self, run: Range<usize>, plane: &Plane) -> usize {
        let (bounds, face) = (&mut self.bounds[run.clone()], &mut self.face[run.clone()]);
        let (other_bounds, other_face) = &mut self.other;
        let other_bounds = &mut other_bounds[..bounds.len()];
        let other_face = &mut other_face[..face.len()];
        // Those on the left from the left end, the others from the right: which of the two is a
        // toss-up, so it is an index and not a branch.
        let (mut left, mut right) = (0, bounds.len());
        for (&item, &face) in bounds.iter().zip(face.iter()) {
            let goes_left = plane.bin(&item) <= plane.last_left;
            let place = if goes_left { left } else { right - 1 };
            other_bounds[place] = item;
            other_face[place] = face;
            left += usize::from(goes_left);
            right -= usize::from(!goes_left);
        }
        bounds.copy_from_slice(other_bounds);
        face.copy_from_slice(other_face);
        run.start + left
    }
}

/// A split plane: items up to a bin of an axis go left.
struct Plane {
    axis: usize,
    origin: f32,
    scale: f32,
    last_left: i32,
    last: i32,
}

impl Plane {
    #[inline]
    fn bin(&self, item: &Bounds) -> i32 {
        let place = (item.centre()[self.axis] - self.origin) * self.scale;
        (place as i32).min(self.last)
    }
}

/// The plane with the least area of boxes times triangles in them, over the three axes.
fn best_plane<const BINS: usize>(items: &[Bounds]) -> Option<Plane> {
    let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for item in items {
        low = low.min(item.centre());
        high = high.max(item.centre());
    }
    // A little less than the bins, so that the highest place still lies in the last one.
    let scale = Vec3A::splat(BINS as f32 * (1.0 - 1e-6)) / (high - low);
    let mut bins = [[(Bounds::EMPTY, 0u32); BINS]; 3];
    let last = BINS as i32 - 1;
    for item in items {
        let place = (item.centre() - low) * scale;
        for axis in 0..3 {
            // Saturates: what is not a number goes first, too large last.
            let bin = (place[axis] as i32).min(last) as usize;
            let (bounds, count) = &mut bins[axis][bin];
            *bounds = bounds.union(*item);
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
                    last_left: last_left as i32,
                    last,
                });
            }
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
