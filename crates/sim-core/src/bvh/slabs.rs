//! Oriented slabs beside the boxes.
//!
//! What a node holds is as a rule a patch of a surface, flat the more the smaller it is. A slab
//! along the patch's normal is thin where a box is not, so two surfaces that run side by side,
//! which boxes tell apart only at the size of their distance, come apart at the size of the square
//! root of it (Gottschalk, Lin, Manocha 1996, "OBBTree", sec. 5, on boxes of any orientation; here
//! it is a box and one slab).

use super::{LEAF, Node, Triangles, WIDTH};

/// A slab for each lane of a node, `|n·x - middle| <= half` but for rounding: heights are computed
/// in f32 and err by less than `2^-20` of the largest coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Slabs {
    /// Unit normals by axis.
    pub(crate) normal: [[f32; WIDTH]; 3],
    pub(crate) middle: [f32; WIDTH],
    pub(crate) half: [f32; WIDTH],
}

impl Slabs {
    const NONE: Slabs = Slabs {
        normal: [[0.0; WIDTH]; 3],
        middle: [0.0; WIDTH],
        half: [0.0; WIDTH],
    };

    /// With normals along area vectors.
    #[inline]
    fn along(mut area: [[f32; WIDTH]; 3]) -> Slabs {
        for lane in 0..WIDTH {
            let [x, y, z] = area.map(|axis| axis[lane].abs());
            let scale = 1.0 / if x > y { x.max(z) } else { y.max(z) };
            let [x, y, z] = area.map(|axis| axis[lane] * scale);
            let length = libm::sqrtf(x * x + y * y + z * z);
            // Any normal will do for a patch without one, or beyond the range of f32.
            let usable = length >= 0.5 && length < 2.0;
            let inverse = 1.0 / length;
            area[0][lane] = if usable { x * inverse } else { 1.0 };
            area[1][lane] = if usable { y * inverse } else { 0.0 };
            area[2][lane] = if usable { z * inverse } else { 0.0 };
        }
        Slabs {
            normal: area,
            ..Slabs::NONE
        }
    }

    fn set(&mut self, lane: usize, low: f32, high: f32) {
        self.middle[lane] = 0.5 * low + 0.5 * high;
        self.half[lane] = (self.middle[lane] - low).max(high - self.middle[lane]);
    }
}

/// The slabs of a tree's nodes and leaves. The triangles below a node lie side by side, so each
/// level looks at all of them once.
pub(super) fn slabs(nodes: &[Node], triangles: &[Triangles]) -> alloc::vec::Vec<Slabs> {
    // Of each node the first of its triangles, the one after the last, and the area vector. Children
    // come after their parents.
    let mut runs = alloc::vec![(u32::MAX, 0, [0.0f32; 3]); nodes.len()];
    let mut slabs = alloc::vec![Slabs::NONE; nodes.len()];
    for index in (0..nodes.len()).rev() {
        let node = &nodes[index];
        let is_leaf = node.child[0] == index as u32 | LEAF;
        let (mut start, mut end, mut area) = (u32::MAX, 0, [[0.0; WIDTH]; 3]);
        if is_leaf {
            let leaf = &triangles[node.triangles as usize];
            (start, end) = (node.triangles, node.triangles + 1);
            area = leaf.areas();
            slabs[index] = leaf.slabs(area);
        } else {
            for lane in node.lanes() {
                let (from, to, of_lane) = runs[(node.child[lane] & !LEAF) as usize];
                (start, end) = (start.min(from), end.max(to));
                for axis in 0..3 {
                    area[axis][lane] = of_lane[axis];
                }
            }
            slabs[index] = Slabs::along(area);
            for lane in node.lanes() {
                let (from, to, _) = runs[(node.child[lane] & !LEAF) as usize];
                let below = &triangles[from as usize..to as usize];
                let (low, high) = heights(below, slabs[index].normal.map(|axis| axis[lane]));
                slabs[index].set(lane, low, high);
            }
        }
        let sum = |axis: [f32; WIDTH]| node.lanes().map(|lane| axis[lane]).sum();
        runs[index] = (start, end, area.map(sum));
    }
    slabs
}

impl Triangles {
    /// Normals of the triangles, twice as long as their areas.
    #[inline]
    fn areas(&self) -> [[f32; WIDTH]; 3] {
        let c = &self.corners;
        let mut areas = [[0.0; WIDTH]; 3];
        for axis in 0..3 {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            for lane in 0..WIDTH {
                let (uy, uz) = (c[3 + y][lane] - c[y][lane], c[3 + z][lane] - c[z][lane]);
                let (vy, vz) = (c[6 + y][lane] - c[y][lane], c[6 + z][lane] - c[z][lane]);
                areas[axis][lane] = uy * vz - uz * vy;
            }
        }
        areas
    }

    /// A slab for each triangle.
    #[inline]
    fn slabs(&self, areas: [[f32; WIDTH]; 3]) -> Slabs {
        let mut slabs = Slabs::along(areas);
        let (c, n) = (&self.corners, slabs.normal);
        for lane in 0..WIDTH {
            let height = |k: usize| {
                n[0][lane] * c[k][lane] + n[1][lane] * c[k + 1][lane] + n[2][lane] * c[k + 2][lane]
            };
            let (p, q, r) = (height(0), height(3), height(6));
            slabs.set(lane, p.min(q).min(r), p.max(q).max(r));
        }
        slabs
    }
}

/// The least and the greatest height of all corners along a normal.
fn heights(triangles: &[Triangles], [x, y, z]: [f32; 3]) -> (f32, f32) {
    let (mut low, mut high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
    for triangles in triangles {
        let c = &triangles.corners;
        for k in [0, 3, 6] {
            for lane in 0..WIDTH {
                let height = x * c[k][lane] + y * c[k + 1][lane] + z * c[k + 2][lane];
                low[lane] = if height < low[lane] {
                    height
                } else {
                    low[lane]
                };
                high[lane] = if height > high[lane] {
                    height
                } else {
                    high[lane]
                };
            }
        }
    }
    let low = low.into_iter().fold(f32::INFINITY, f32::min);
    (low, high.into_iter().fold(f32::NEG_INFINITY, f32::max))
}
