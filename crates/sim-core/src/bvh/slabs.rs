//! Oriented slabs of nodes, in addition to the boxes.
//!
//! The triangles of a node are usually a patch of a surface; the smaller the patch, the flatter it is. A slab along
//! the patch's normal is thin where a box is not. Boxes separate two surfaces that run side by side only at patches
//! of the size of their distance; slabs separate them at patches of the size of the square root of it (Gottschalk,
//! Lin, Manocha 1996, "OBBTree", sec. 5, on boxes of any orientation; here it is a box and one slab).

use glam::{BVec4A, Vec4};

use super::{LEAF, Node, Triangles, WIDTH};

/// A slab for each lane of a node, `|n·x - middle| <= half` up to rounding: heights are computed in f32 and err by
/// less than `2^-20` of the largest coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Slabs {
    /// Unit normals by axis, or zero.
    pub(crate) normal: [[f32; WIDTH]; 3],
    pub(crate) middle: [f32; WIDTH],
    pub(crate) half: [f32; WIDTH],
}

/// The data that a node passes to its parent: the place of its triangles, and the sum of their area vectors.
#[derive(Clone, Copy)]
pub(super) struct Below {
    start: u32,
    end: u32,
    area: [f32; 3],
}

impl Slabs {
    /// For a node whose slabs have not been computed.
    pub(super) const NONE: Slabs = Slabs {
        normal: [[0.0; WIDTH]; 3],
        middle: [0.0; WIDTH],
        half: [0.0; WIDTH],
    };

    #[inline]
    fn between(normal: [Vec4; 3], low: Vec4, high: Vec4) -> Slabs {
        let middle = 0.5 * low + 0.5 * high;
        Slabs {
            normal: normal.map(|axis| axis.to_array()),
            middle: middle.to_array(),
            half: (middle - low).max(high - middle).to_array(),
        }
    }
}

impl Below {
    pub(super) const NONE: Below = Below {
        start: 0,
        end: 0,
        area: [0.0; 3],
    };
}

/// Unit vectors along area vectors. For a patch without area, or beyond the range of f32, any vector is valid.
#[inline]
fn normals(area: [Vec4; 3]) -> [Vec4; 3] {
    let largest = area[0].abs().max(area[1].abs()).max(area[2].abs());
    let scale = largest.recip();
    let [x, y, z] = area.map(|axis| axis * scale);
    // The square of a length from 1 to sqrt 3. A parabola approximates its inverse root to 0.02, and each step of
    // Newton's method squares this error, times 3/2.
    let square = x * x + y * y + z * z;
    let usable = square.cmpge(Vec4::splat(0.9)) & square.cmple(Vec4::splat(3.1));
    let mut inverse = (0.0771 * square - 0.5094) * square + 1.4177;
    for _ in 0..2 {
        inverse *= 1.5 - 0.5 * square * inverse * inverse;
    }
    let select = |mask: BVec4A, axis: Vec4, or: Vec4| Vec4::select(mask, axis * inverse, or);
    [
        select(usable, x, Vec4::ONE),
        select(usable, y, Vec4::ZERO),
        select(usable, z, Vec4::ZERO),
    ]
}

#[inline]
fn dot(a: [Vec4; 3], b: [Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// With up to this many leaves below a child, its slab is that of their corners. With more, it is the slab around the
/// slabs below it, whose cost does not depend on the number. With 4 instead, two spheres one in the other take half
/// as many tiles more; without a limit, a build takes 4 % more instructions.
pub(super) const FEW_LEAVES: u32 = 64;

/// The slabs of a node whose children have slabs, and the data for its parent. The triangles below a node lie side by
/// side.
#[inline]
pub(super) fn of_node(
    node: &Node,
    nodes: &[Node],
    slabs: &[Slabs],
    below: &[Below],
    triangles: &[Triangles],
) -> (Slabs, Below) {
    let mut area = [[0.0; WIDTH]; 3];
    let mut all = Below {
        start: node.triangles,
        ..Below::NONE
    };
    for lane in node.lanes() {
        let of_lane = &below[(node.child[lane] & !LEAF) as usize];
        all.end = all.end.max(of_lane.end);
        for (axis, area) in area.iter_mut().enumerate() {
            area[lane] = of_lane.area[axis];
            all.area[axis] += of_lane.area[axis];
        }
    }
    let normal = normals(area.map(Vec4::from_array));
    let normals = normal.map(|axis| axis.to_array());
    let (mut low, mut high) = ([0.0; WIDTH], [0.0; WIDTH]);
    for lane in node.lanes() {
        let child = (node.child[lane] & !LEAF) as usize;
        let Below { start, end, .. } = below[child];
        let normal = normals.map(|axis| Vec4::splat(axis[lane]));
        (low[lane], high[lane]) = if end - start <= FEW_LEAVES {
            heights(&triangles[start as usize..end as usize], normal)
        } else {
            heights_of_slabs(&nodes[child], &slabs[child], normal)
        };
    }
    (Slabs::between(normal, low.into(), high.into()), all)
}

impl Triangles {
    /// The corners by axis.
    #[inline]
    fn rows(&self) -> [[Vec4; 3]; 3] {
        let c = &self.corners;
        [0, 3, 6].map(|k| [0, 1, 2].map(|axis| Vec4::from_array(c[k + axis])))
    }

    /// A slab for each of the `count` triangles of a leaf, and the data for its parent.
    #[inline]
    pub(super) fn slabs(&self, count: usize, place: u32) -> (Slabs, Below) {
        let [a, b, c] = self.rows();
        let u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let v = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
        let area = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        let normal = normals(area);
        let (p, q, r) = (dot(normal, a), dot(normal, b), dot(normal, c));
        let slabs = Slabs::between(normal, p.min(q).min(r), p.max(q).max(r));
        let used = Vec4::from_array([0, 1, 2, 3].map(|lane| f32::from(u8::from(lane < count))));
        let area = area.map(|axis| axis.dot(used));
        let below = Below {
            start: place,
            end: place + 1,
            area,
        };
        (slabs, below)
    }
}

/// A bound on the error of the height of a corner, or of a slab's side, relative to its coordinates: some twenty
/// roundings of 2^-24, and the 2^-20 of a slab.
const ROUNDINGS: f32 = 32.0 * f32::EPSILON;

/// The least and the greatest height of all corners along a normal.
#[inline]
fn heights(triangles: &[Triangles], normal: [Vec4; 3]) -> (f32, f32) {
    let (mut low, mut high) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
    for triangles in triangles {
        let [a, b, c] = triangles.rows().map(|corner| dot(normal, corner));
        low = low.min(a.min(b).min(c));
        high = high.max(a.max(b).max(c));
    }
    (low.min_element(), high.max_element())
}

/// The same for the contents of the slabs and boxes of a node.
///
/// With the normal `m` of such a slab, `n·x = k m·x + (n - k m)·x` for any `k`. For `k = n·m` the second part is
/// small if the normals are similar. The slab bounds the first part, the box the second.
#[inline]
fn heights_of_slabs(node: &Node, slabs: &Slabs, n: [Vec4; 3]) -> (f32, f32) {
    let axes = |of: &[[f32; WIDTH]; 3]| of.map(Vec4::from_array);
    let (m, centre, half) = (
        axes(&slabs.normal),
        axes(&node.boxes.centre),
        axes(&node.boxes.half),
    );
    let k = dot(n, m);
    let rest = [0, 1, 2].map(|axis| n[axis] - k * m[axis]);
    let middle = k * Vec4::from_array(slabs.middle) + dot(rest, centre);
    let reach = k.abs() * Vec4::from_array(slabs.half) + dot(rest.map(Vec4::abs), half);
    // A bound on all roundings, here and in the slab.
    let size = dot([Vec4::ONE; 3], centre.map(Vec4::abs)) + dot([Vec4::ONE; 3], half);
    let reach = reach + ROUNDINGS * size;
    let mut heights = (f32::INFINITY, f32::NEG_INFINITY);
    for lane in node.lanes() {
        heights.0 = heights.0.min(middle[lane] - reach[lane]);
        heights.1 = heights.1.max(middle[lane] + reach[lane]);
    }
    heights
}
