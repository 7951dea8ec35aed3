//! Building a BVH top down: first over cells of triangles, and below over triangles.

use alloc::{vec, vec::Vec};
use glam::{Mat4, Vec3A, Vec4};

use super::grid::Grid;
use super::slabs::{self, Below, Slabs};
use super::split::{Bounds, HALVE_FROM, Items, Run};
use super::{Boxes, Bvh, LEAF, MAX_DEPTH, Node, Origin, Triangles, WIDTH};
use crate::Mesh;

/// Runs of cells up to this are built over triangles, as are those with no more triangles than
/// `FEW`: so near the leaves the borders of cells would show.
const FEW_CELLS: usize = 8;
const FEW: u32 = 64;

pub(super) fn build(mesh: &Mesh) -> Bvh {
    let count = mesh.triangles().len();
    // With a fourth coordinate each is one load.
    let vertices: Vec<Vec4> = mesh.vertices().iter().map(|v| v.extend(0.0)).collect();
    let mut grid = Grid::of(mesh, &vertices);
    let mut items = Items::default();
    let mut nodes: Vec<Node> = Vec::with_capacity(count / 2 + 1);
    let mut triangles = Vec::with_capacity(count * 3 / 8 + 1);
    let mut slabs = Vec::with_capacity(nodes.capacity());
    let mut below = Vec::with_capacity(nodes.capacity());
    let mut depth = 0;
    let bounds = mesh.bounds();
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
        let index = nodes.len() as u32;
        let is_leaf = run.count <= WIDTH as u32;
        let code = index | if is_leaf { LEAF } else { 0 };
        if let Some(parent) = nodes.get_mut(run.parent as usize) {
            let (lane, Bounds { min, max }) = (usize::from(run.lane), run.bounds);
            parent.boxes.set(lane, Vec3A::from_vec4(min), Vec3A::from_vec4(max));
            parent.child[lane] = code;
        }
        if is_leaf {
            let leaf = leaf(mesh, &vertices, items.of(&run));
            nodes.push(Node {
                boxes: leaf.boxes(run.count as usize),
                child: [code; WIDTH],
                count: run.count,
                triangles: triangles.len() as u32,
            });
            let (of_leaf, sum) = leaf.slabs(run.count as usize, triangles.len() as u32 + 1);
            slabs.push(of_leaf);
            below.push(sum);
            triangles.push(leaf);
            continue;
        }
        let first = runs.len();
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
        nodes.push(Node {
            count: (runs.len() - first) as u32,
            triangles: triangles.len() as u32,
            ..Node::EMPTY
        });
        slabs.push(Slabs::NONE);
        below.push(Below::NONE);
    }
    slabs::fill(&nodes, &triangles, &mut below, &mut slabs);
    debug_assert!(depth <= MAX_DEPTH);
    Bvh {
        bounds: mesh.bounds(),
        root: if count <= WIDTH { LEAF } else { 0 },
        count,
        slabs,
        nodes,
        triangles,
        origin: origins(mesh),
        depth,
    }
}

/// The triangles of a leaf side by side.
#[inline]
fn leaf(mesh: &Mesh, vertices: &[Vec4], items: &[Bounds]) -> Triangles {
    // Lanes that hold nothing repeat the last one, so that they widen nothing.
    let face = core::array::from_fn(|lane| items[lane.min(items.len() - 1)].number());
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
        for axis in 0..3 {
            let [a, b, c] = [0, 3, 6].map(|k| Vec4::from_array(self.corners[k + axis]));
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            let centre = 0.5 * min + 0.5 * max;
            let half = (max - centre).max(centre - min) * (1.0 + 2.0 * f32::EPSILON);
            boxes.centre[axis] = centre.to_array();
            boxes.half[axis] = half.to_array();
            for lane in count..WIDTH {
                boxes.half[axis][lane] = f32::NEG_INFINITY;
            }
        }
        boxes
    }
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
