//! Builds a BVH top down: first over cells of triangles, and below that over triangles.

use alloc::{boxed::Box, vec, vec::Vec};
use core::array;
use glam::{Mat4, Vec4};

use super::cuboid::Cuboid;
use super::grid::{Grid, Sorted};
use super::short::SHORT;
use super::slabs::{self, Below, Slabs};
use super::split::{Bounds, HALVE_FROM, Items, Run};
use super::{Boxes, Bvh, LEAF, MAX_DEPTH, Node, Triangles, WIDTH};
use crate::Mesh;

/// Runs of at most this many cells, or of cells with at most this many triangles, are built over triangles, because
/// near the leaves the borders of cells show. Twice as many make trees better by 1 % and the build dearer by 5 %.
const FEW_CELLS: usize = 4;
const FEW: u32 = 32;

pub(super) fn build(mesh: &Mesh) -> Bvh {
    let count = mesh.triangles().len();
    // With a fourth coordinate, each vertex is one load.
    let vertices = mesh.vertices().iter();
    let vertices: Vec<Vec4> = vertices.map(|v| v.extend(Bounds::ONE)).collect();
    let mut grid = Grid::of(mesh, &vertices);
    let mut items = Items::default();
    let mut tree = Tree::with_capacity(count);
    let mut depth = 0;
    let bounds = mesh.bounds();
    // Nodes whose descendants are being built, and the number of runs that waited before these.
    let mut open: Vec<(u32, usize)> = Vec::new();
    // Runs that wait to become children, the next one last.
    let mut runs = vec![Run {
        start: 0,
        end: grid.cells.bounds[0].len() as u32,
        count: count as u32,
        bounds: Bounds {
            min: bounds.min.extend(0.0),
            max: bounds.max.extend(0.0),
        },
        parent: u32::MAX,
        lane: 0,
        level: 0,
        buffer: 0,
        of_cells: true,
    }];
    while let Some(mut run) = runs.pop() {
        let level = usize::from(run.level);
        // Depth first, so no other triangles wait in `items` when it is filled anew.
        let few = run.len() <= FEW_CELLS || run.count <= FEW || level >= HALVE_FROM;
        if run.of_cells && few {
            run = grid.gather(&vertices, &run, &mut items);
        }
        depth = depth.max(level + 1);
        let leaf = run.count <= WIDTH as u32;
        let index = tree.nodes.len() as u32;
        if run.parent != u32::MAX {
            let code = index | if leaf { LEAF } else { 0 };
            tree.nodes[run.parent as usize].child[usize::from(run.lane)] = code;
        }
        if leaf {
            tree.push_leaf(&grid.sorted, &vertices, items.of(&run));
        } else if !run.of_cells && run.count as usize <= SHORT {
            tree.push_node();
            let (mut bounds, mut child, mut count) = ([Bounds::EMPTY; WIDTH], [0; WIDTH], 0);
            items.leaves(&run, |items| {
                child[count] = tree.nodes.len() as u32 | LEAF;
                bounds[count] = tree.push_leaf(&grid.sorted, &vertices, items);
                count += 1;
            });
            tree.nodes[index as usize].child = child;
            tree.adopt(index, &bounds, count);
            tree.close(index);
            depth = depth.max(level + 2);
        } else {
            tree.push_node();
            let first = runs.len();
            open.push((index, first));
            runs.push(run);
            let of = if run.of_cells {
                &mut grid.cells
            } else {
                &mut items
            };
            of.divide(&mut runs);
            let mut bounds = [Bounds::EMPTY; WIDTH];
            for (lane, child) in runs[first..].iter_mut().enumerate() {
                child.parent = index;
                child.lane = lane as u8;
                child.level = run.level + 1;
                bounds[lane] = child.bounds;
            }
            tree.adopt(index, &bounds, runs.len() - first);
        }
        while let Some((index, _)) = open.pop_if(|&mut (_, waiting)| waiting == runs.len()) {
            tree.close(index);
        }
    }
    debug_assert!(depth <= MAX_DEPTH);
    Bvh {
        bounds: mesh.bounds(),
        root: if count <= WIDTH { LEAF } else { 0 },
        count,
        nodes: tree.nodes,
        slabs: tree.slabs,
        triangles: tree.triangles,
        topology: mesh.topology().clone(),
        cuboid: Cuboid::of(mesh).map(Box::new),
        depth,
    }
}

/// A tree under construction, and the data that its nodes pass to their parents.
struct Tree {
    nodes: Vec<Node>,
    slabs: Vec<Slabs>,
    below: Vec<Below>,
    triangles: Vec<Triangles>,
}

impl Tree {
    fn with_capacity(count: usize) -> Tree {
        let nodes = count / 2 + 1;
        Tree {
            nodes: Vec::with_capacity(nodes),
            slabs: Vec::with_capacity(nodes),
            below: Vec::with_capacity(nodes),
            triangles: Vec::with_capacity(count * 3 / 8 + 1),
        }
    }

    /// Gives a node the boxes of its children.
    #[inline]
    fn adopt(&mut self, parent: u32, children: &[Bounds; WIDTH], count: usize) {
        let axes = |of: fn(&Bounds) -> Vec4| {
            let [a, b, c, d] = children.each_ref().map(of);
            let columns = Mat4::from_cols(a, b, c, d).transpose();
            [columns.x_axis, columns.y_axis, columns.z_axis]
        };
        let parent = &mut self.nodes[parent as usize];
        parent.boxes = Boxes::between(axes(|child| child.min), axes(|child| child.max), count);
        parent.count = count as u32;
    }

    fn push_node(&mut self) {
        self.nodes.push(Node {
            triangles: self.triangles.len() as u32,
            ..Node::EMPTY
        });
        self.slabs.push(Slabs::NONE);
        self.below.push(Below::NONE);
    }

    /// Computes the slabs of a node when all nodes below it exist: they are still in the cache.
    #[inline]
    fn close(&mut self, index: u32) {
        let index = index as usize;
        let (slabs, below) = slabs::of_node(
            &self.nodes[index],
            &self.nodes,
            &self.slabs,
            &self.below,
            &self.triangles,
        );
        self.slabs[index] = slabs;
        self.below[index] = below;
    }

    #[inline]
    fn push_leaf(&mut self, sorted: &[Sorted], vertices: &[Vec4], items: &[Bounds]) -> Bounds {
        // Empty lanes repeat the last triangle, so that they do not widen the box.
        let of_lane = array::from_fn(|lane| items[lane.min(items.len() - 1)]);
        let leaf = leaf(sorted, vertices, &of_lane);
        let place = self.triangles.len() as u32;
        self.nodes.push(Node {
            boxes: leaf.boxes(items.len()),
            child: [self.nodes.len() as u32 | LEAF; WIDTH],
            count: items.len() as u32,
            triangles: place,
        });
        let (slabs, below) = leaf.slabs(items.len(), place);
        self.slabs.push(slabs);
        self.below.push(below);
        self.triangles.push(leaf);
        Bounds::around(&of_lane)
    }
}

/// The triangles of a leaf side by side.
#[inline]
fn leaf(sorted: &[Sorted], vertices: &[Vec4], items: &[Bounds; WIDTH]) -> Triangles {
    let of_lane = items.each_ref().map(|item| sorted[item.number() as usize]);
    let mut corners = [[0.0; WIDTH]; 9];
    for k in 0..3 {
        let [a, b, c, d] = of_lane.map(|triangle| vertices[triangle.corners[k] as usize]);
        let columns = Mat4::from_cols(a, b, c, d).transpose();
        corners[3 * k] = columns.x_axis.to_array();
        corners[3 * k + 1] = columns.y_axis.to_array();
        corners[3 * k + 2] = columns.z_axis.to_array();
    }
    Triangles {
        corners,
        face: of_lane.map(|triangle| triangle.face),
    }
}

impl Triangles {
    /// The boxes of the first `count` triangles.
    #[inline]
    fn boxes(&self, count: usize) -> Boxes {
        let corners =
            [0, 1, 2].map(|axis| [0, 3, 6].map(|k| Vec4::from_array(self.corners[k + axis])));
        let min = corners.map(|[a, b, c]| a.min(b).min(c));
        let max = corners.map(|[a, b, c]| a.max(b).max(c));
        Boxes::between(min, max, count)
    }
}
