//! Building a BVH top down: first over cells of triangles, and below over triangles.

use alloc::{boxed::Box, vec, vec::Vec};
use core::array;
use glam::{Mat4, Vec3A, Vec4};

use super::cuboid::Cuboid;
use super::grid::Grid;
use super::short::SHORT;
use super::slabs::{self, Below, Slabs};
use super::split::{Bounds, HALVE_FROM, Items, Run};
use super::{Boxes, Bvh, LEAF, MAX_DEPTH, Node, Triangles, WIDTH};
use crate::Mesh;

/// Runs of so few cells, or of cells with so few triangles, are built over triangles: so near the
/// leaves the borders of cells show. Twice as many make trees better by 1 % and the build dearer
/// by 5 %.
const FEW_CELLS: usize = 4;
const FEW: u32 = 32;

pub(super) fn build(mesh: &Mesh) -> Bvh {
    let count = mesh.triangles().len();
    // With a fourth coordinate each is one load.
    let vertices: Vec<Vec4> = mesh.vertices().iter().map(|v| v.extend(0.0)).collect();
    let mut grid = Grid::of(mesh, &vertices);
    let mut items = Items::default();
    let mut tree = Tree::with_capacity(count);
    let mut depth = 0;
    let bounds = mesh.bounds();
    // Nodes whose descendants are under way, and how many runs waited before these.
    let mut open: Vec<(u32, usize)> = Vec::new();
    // Those that wait to become children, the next one last.
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
            run = grid.gather(mesh, &vertices, &run, &mut items);
        }
        depth = depth.max(level + 1);
        let leaf = run.count <= WIDTH as u32;
        let index = tree.nodes.len() as u32;
        if run.parent != u32::MAX {
            let code = index | if leaf { LEAF } else { 0 };
            tree.adopt(run.parent, usize::from(run.lane), code, &run.bounds);
        }
        if leaf {
            tree.push_leaf(mesh, &vertices, items.of(&run));
        } else if !run.of_cells && run.count as usize <= SHORT {
            tree.push_node();
            let mut lane = 0;
            items.leaves(&run, |items| {
                let code = tree.nodes.len() as u32 | LEAF;
                let bounds = tree.push_leaf(mesh, &vertices, items);
                tree.adopt(index, lane, code, &bounds);
                lane += 1;
            });
            tree.close(index);
            depth = depth.max(level + 2);
        } else {
            tree.push_node();
            let first = runs.len();
            open.push((index, first));
            runs.push(run);
            if run.of_cells {
                grid.divide(&mut runs);
            } else {
                items.divide(&mut runs, |_| 1);
            }
            for (lane, child) in runs[first..].iter_mut().enumerate() {
                child.parent = index;
                child.lane = lane as u8;
                child.level = run.level + 1;
            }
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

/// A tree that grows, and what its nodes tell their parents.
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

    #[inline]
    fn adopt(&mut self, parent: u32, lane: usize, code: u32, bounds: &Bounds) {
        let parent = &mut self.nodes[parent as usize];
        let (min, max) = (Vec3A::from_vec4(bounds.min), Vec3A::from_vec4(bounds.max));
        parent.boxes.set(lane, min, max);
        parent.child[lane] = code;
        parent.count += 1;
    }

    fn push_node(&mut self) {
        self.nodes.push(Node {
            triangles: self.triangles.len() as u32,
            ..Node::EMPTY
        });
        self.slabs.push(Slabs::NONE);
        self.below.push(Below::NONE);
    }

    /// Gives a node its slabs, when all below it are there: they are still in the cache.
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
    fn push_leaf(&mut self, mesh: &Mesh, vertices: &[Vec4], items: &[Bounds]) -> Bounds {
        // Lanes that hold nothing repeat the last one, so that they widen nothing.
        let of_lane = array::from_fn(|lane| items[lane.min(items.len() - 1)]);
        let leaf = leaf(mesh, vertices, &of_lane);
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
fn leaf(mesh: &Mesh, vertices: &[Vec4], items: &[Bounds; WIDTH]) -> Triangles {
    let face = array::from_fn(|lane| items[lane].number());
    let of_lane = face.map(|face: u32| mesh.triangles()[face as usize]);
    let mut corners = [[0.0; WIDTH]; 9];
    for k in 0..3 {
        let [a, b, c, d] = of_lane.map(|corners| vertices[corners[k] as usize]);
        let columns = Mat4::from_cols(a, b, c, d).transpose();
        corners[3 * k] = columns.x_axis.to_array();
        corners[3 * k + 1] = columns.y_axis.to_array();
        corners[3 * k + 2] = columns.z_axis.to_array();
    }
    Triangles { corners, face }
}

impl Triangles {
    /// The boxes of the first `count` triangles.
    #[inline]
    fn boxes(&self, count: usize) -> Boxes {
        let mut boxes = Boxes::EMPTY;
        // Infinite in lanes that hold nothing.
        let beyond = array::from_fn(|lane| if lane < count { 0.0 } else { f32::INFINITY });
        let beyond = Vec4::from_array(beyond);
        for axis in 0..3 {
            let [a, b, c] = [0, 3, 6].map(|k| Vec4::from_array(self.corners[k + axis]));
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            let centre = 0.5 * min + 0.5 * max;
            let half = (max - centre).max(centre - min) * (1.0 + 2.0 * f32::EPSILON);
            boxes.centre[axis] = centre.to_array();
            boxes.half[axis] = (half - beyond).to_array();
        }
        boxes
    }
}
