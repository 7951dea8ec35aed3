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

    fn set(&mut self, lane: usize, area: [f32; 3], heights: impl Fn([f32; 3]) -> (f32, f32)) {
        let normal = unit(area);
        let (low, high) = heights(normal);
        for axis in 0..3 {
            self.normal[axis][lane] = normal[axis];
        }
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
        let is_leaf = node.child[0] & LEAF != 0 && (node.child[0] & !LEAF) as usize == index;
        let (mut start, mut end, mut area) = (u32::MAX, 0, [0.0; 3]);
        for lane in node.lanes() {
            let of_lane = if is_leaf {
                let leaf = &triangles[node.triangles as usize];
                let of_lane = leaf.area(lane);
                slabs[index].set(lane, of_lane, |normal| leaf.heights(lane, normal));
                (start, end) = (node.triangles, node.triangles + 1);
                of_lane
            } else {
                let (from, to, of_lane) = runs[(node.child[lane] & !LEAF) as usize];
                (start, end) = (start.min(from), end.max(to));
                let below = &triangles[from as usize..to as usize];
                slabs[index].set(lane, of_lane, |normal| heights(below, normal));
                of_lane
            };
            for axis in 0..3 {
                area[axis] += of_lane[axis];
            }
        }
        runs[index] = (start, end, area);
    }
    slabs
}

impl Triangles {
    /// Normal of a lane's triangle, twice as long as its area.
    fn area(&self, lane: usize) -> [f32; 3] {
        let [a, b, c] = self.corners(lane);
        (b - a).cross(c - a).to_array()
    }

    fn heights(&self, lane: usize, normal: [f32; 3]) -> (f32, f32) {
        let heights = self
            .corners(lane)
            .map(|v| normal[0] * v.x + normal[1] * v.y + normal[2] * v.z);
        let [a, b, c] = heights;
        (a.min(b).min(c), a.max(b).max(c))
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
                low[lane] = if height < low[lane] { height } else { low[lane] };
                high[lane] = if height > high[lane] { height } else { high[lane] };
            }
        }
    }
    let low = low.into_iter().fold(f32::INFINITY, f32::min);
    (low, high.into_iter().fold(f32::NEG_INFINITY, f32::max))
}

/// A unit vector along an area vector; any where that says nothing.
fn unit([x, y, z]: [f32; 3]) -> [f32; 3] {
    let scale = x.abs().max(y.abs()).max(z.abs());
    if !(scale > 0.0 && scale.is_finite()) {
        return [1.0, 0.0, 0.0];
    }
    let [x, y, z] = [x / scale, y / scale, z / scale];
    let length = libm::sqrtf(x * x + y * y + z * z);
    [x / length, y / length, z / length]
}
