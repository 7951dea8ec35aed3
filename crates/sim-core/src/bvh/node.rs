//! A node: four boxes side by side, and what is in them.

use glam::Vec3;

use crate::Aabb;

/// Children of a node.
pub(crate) const WIDTH: usize = 4;

/// No path from the root has more nodes, whatever the input (see `build`).
pub(crate) const MAX_DEPTH: usize = 32;

/// Four children's boxes by axis, so that one instruction compares all four, in two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) min: [[f32; WIDTH]; 3],
    pub(crate) max: [[f32; WIDTH]; 3],
    /// What is in each box, for [`Child::of`].
    pub(crate) child: [u32; WIDTH],
}

/// What is in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    Node(u32),
    /// A triangle, by its place in leaf order.
    Triangle(u32),
}

impl Child {
    /// Reads a lane of [`Node::child`] that is not empty.
    #[inline(always)]
    pub(crate) fn of(code: u32) -> Child {
        if code & TRIANGLE == 0 {
            Child::Node(code)
        } else {
            Child::Triangle(code & !TRIANGLE)
        }
    }
}

/// Set in `Node::child` for a triangle. Meshes have fewer than 2^31 triangles.
pub(crate) const TRIANGLE: u32 = 1 << 31;
/// In `Node::child` for a lane that holds nothing; its box holds no point and meets no box.
const NOTHING: u32 = u32::MAX;

impl Node {
    pub(crate) const EMPTY: Node = Node {
        min: [[f32::INFINITY; WIDTH]; 3],
        max: [[f32::NEG_INFINITY; WIDTH]; 3],
        child: [NOTHING; WIDTH],
    };

    /// A node with one triangle, for a descent that has come to a triangle on one side only.
    pub(crate) fn of_triangle(triangle: u32, corners: [Vec3; 3]) -> Node {
        let mut node = Node::EMPTY;
        node.set(0, Child::Triangle(triangle), Aabb::around(corners));
        node
    }

    pub(crate) fn set(&mut self, lane: usize, child: Child, bounds: Aabb) {
        for axis in 0..3 {
            self.min[axis][lane] = bounds.min[axis];
            self.max[axis][lane] = bounds.max[axis];
        }
        self.child[lane] = match child {
            Child::Node(index) => index,
            Child::Triangle(index) => index | TRIANGLE,
        };
    }

    #[inline]
    pub(crate) fn child(&self, lane: usize) -> Option<Child> {
        (self.child[lane] != NOTHING).then(|| Child::of(self.child[lane]))
    }

    pub(crate) fn bounds(&self, lane: usize) -> Aabb {
        Aabb {
            min: Vec3::from_array(self.min.map(|axis| axis[lane])),
            max: Vec3::from_array(self.max.map(|axis| axis[lane])),
        }
    }
}
