//! Nodes and leaves: four boxes side by side, and their contents.

use core::array;
use glam::{BVec4A, Vec3, Vec4};

use crate::Aabb;

/// The most children of a node, and triangles of a leaf.
pub(crate) const WIDTH: usize = 4;

/// No path from the root has more nodes and leaves, for any input (see `build`).
pub(crate) const MAX_DEPTH: usize = 32;

/// This bit of a code marks a leaf. Meshes have fewer than 2^31 triangles.
pub(crate) const LEAF: u32 = 1 << 31;

/// Four boxes by axis, so that one instruction processes all four. They are centres and half extents, rounded
/// outward: the same form remains valid for moved and rotated boxes, and overlap is one comparison for each axis,
/// `|c - c'| <= h + h'`.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Boxes {
    pub(crate) centre: [[f32; WIDTH]; 3],
    /// Minus infinity in an empty lane, which so meets no box.
    pub(crate) half: [[f32; WIDTH]; 3],
}

impl Boxes {
    pub(crate) const EMPTY: Boxes = Boxes {
        centre: [[0.0; WIDTH]; 3],
        half: [[f32::NEG_INFINITY; WIDTH]; 3],
    };

    /// Boxes with given ends by axis; only the first `count` are boxes.
    #[inline]
    pub(crate) fn between(min: [Vec4; 3], max: [Vec4; 3], count: usize) -> Boxes {
        let mut boxes = Boxes::EMPTY;
        let used = array::from_fn(|lane| lane < count);
        let used = BVec4A::from_array(used);
        for axis in 0..3 {
            let (min, max) = (min[axis], max[axis]);
            let centre = 0.5 * min + 0.5 * max;
            // Each difference is rounded once; the factor compensates.
            let half = (max - centre).max(centre - min) * (1.0 + 2.0 * f32::EPSILON);
            boxes.centre[axis] = Vec4::select(used, centre, Vec4::ZERO).to_array();
            boxes.half[axis] = Vec4::select(used, half, Vec4::NEG_INFINITY).to_array();
        }
        boxes
    }

    /// The box of a lane that is not empty, rounded outward once more.
    pub(crate) fn bounds(&self, lane: usize) -> Aabb {
        let centre = Vec3::from_array(self.centre.map(|axis| axis[lane]));
        let half = Vec3::from_array(self.half.map(|axis| axis[lane]));
        let (min, max) = (centre - half, centre + half);
        let exact = |i: usize| half[i] == 0.0;
        let outward = |i: usize| {
            if exact(i) {
                (min[i], max[i])
            } else {
                (min[i].next_down(), max[i].next_up())
            }
        };
        let [x, y, z] = [0, 1, 2].map(outward);
        Aabb {
            min: Vec3::new(x.0, y.0, z.0),
            max: Vec3::new(x.1, y.1, z.1),
        }
    }
}

/// Four boxes and their contents: the children of a node, or the triangles of a leaf.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) boxes: Boxes,
    /// The codes of a node's children: indices of nodes, with [`LEAF`] for a leaf. A leaf has its own code in every
    /// lane, because it stays the same if the descent continues in the other tree only.
    pub(crate) child: [u32; WIDTH],
    /// Lanes in use.
    pub(crate) count: u32,
    /// The index of a leaf's triangles; for a node, that of the first leaf below it.
    pub(crate) triangles: u32,
}

/// Up to four triangles, side by side.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Triangles {
    /// Corners by coordinate: x, y, z of the first, of the second, of the third.
    pub(crate) corners: [[f32; WIDTH]; 9],
    /// Indices of the mesh's triangles.
    pub(crate) face: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Node = Node {
        boxes: Boxes::EMPTY,
        child: [0; WIDTH],
        count: 0,
        triangles: 0,
    };

    pub(crate) fn lanes(&self) -> core::ops::Range<usize> {
        0..self.count as usize
    }
}

impl Triangles {
    /// The corners of a lane's triangle.
    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [Vec3; 3] {
        [
            self.corner(lane, 0),
            self.corner(lane, 1),
            self.corner(lane, 2),
        ]
    }

    /// The `k`-th corner of a lane's triangle.
    #[inline(always)]
    pub(crate) fn corner(&self, lane: usize, k: usize) -> Vec3 {
        let of = |axis: usize| self.corners[3 * k + axis][lane];
        Vec3::new(of(0), of(1), of(2))
    }
}
