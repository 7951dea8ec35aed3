//! The contents of trees relative to the centre of mass: boxes, and sets of points that are apart from others if
//! their convex hulls are.

use glam::DVec3;

use super::{Figure, Moving};
use crate::bvh::{Bvh, Cuboid, LEAF, WIDTH};

/// A node of a tree, or a set of points: a triangle (by its leaf and lane), a single point, or a cuboid as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Item {
    Node(u32),
    Piece(u32, u32),
    Cuboid,
}

impl Item {
    /// The item from which a search starts.
    pub(super) fn whole(moving: &Moving<'_>) -> Item {
        match moving.figure {
            Figure::Mesh(tree) if tree.cuboid().is_some() => Item::Cuboid,
            _ => Boxed::root(moving).item,
        }
    }

    pub(super) fn is_set(self) -> bool {
        !matches!(self, Item::Node(_))
    }
}

/// A box of a shape, in the shape's frame about its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boxed {
    pub(super) centre: DVec3,
    pub(super) half: DVec3,
    /// A ball extends the box by this radius on all sides, m.
    pub(super) radius: f64,
    /// The greatest distance of a point of the box from the centre of mass, m, without the radius.
    pub(super) farthest: f64,
    pub(super) item: Item,
}

/// Up to four boxes.
pub(super) struct Row {
    boxes: [Boxed; WIDTH],
    count: usize,
}

impl Row {
    /// A box around all boxes of the row.
    pub(super) fn around(&self, item: Item) -> Boxed {
        let [first, rest @ ..] = &self.boxes[..self.count] else {
            unreachable!("no node is empty")
        };
        if rest.is_empty() {
            return Boxed { item, ..*first };
        }
        let (mut low, mut high) = (first.centre - first.half, first.centre + first.half);
        for next in rest {
            low = low.min(next.centre - next.half);
            high = high.max(next.centre + next.half);
        }
        between(low, high, item)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Boxed> {
        self.boxes[..self.count].iter()
    }
}

impl Boxed {
    fn new(centre: DVec3, half: DVec3, item: Item) -> Boxed {
        Boxed {
            centre,
            half,
            radius: 0.0,
            farthest: (centre.abs() + half).length() * (1.0 + 4.0 * f64::EPSILON),
            item,
        }
    }

    /// A point, extended by a radius.
    fn point(moving: &Moving<'_>, radius: f64) -> Boxed {
        Boxed {
            radius,
            ..Boxed::new(-moving.centre, DVec3::ZERO, Item::Piece(0, 0))
        }
    }

    /// The box around the whole shape; for a half-space, a point of its plane.
    pub(super) fn root(moving: &Moving<'_>) -> Boxed {
        match moving.figure {
            Figure::Mesh(tree) => {
                let bounds = tree.bounds();
                // A box with f32 bounds and an f64 centre may round as much as any box of its size.
                let centre = bounds.centre() - moving.centre;
                let half = bounds.half_extent() * (1.0 + f64::EPSILON);
                Boxed::new(centre, half, Item::Node(tree.root()))
            }
            Figure::Ball(radius) => Boxed::point(moving, radius),
            Figure::HalfSpace(_) => Boxed::point(moving, 0.0),
        }
    }

    /// The boxes inside a box, or the box itself if it cannot be split.
    pub(super) fn within(moving: &Moving<'_>, item: Item) -> Row {
        let only = |boxed: Boxed| Row {
            boxes: [boxed; WIDTH],
            count: 1,
        };
        let tree = match (moving.figure, item) {
            (Figure::Mesh(tree), Item::Node(_)) => tree,
            (Figure::Mesh(_), Item::Piece(..)) => {
                return only(around(&Points::of(moving, item), item));
            }
            _ => {
                return only(Boxed {
                    item,
                    ..Boxed::root(moving)
                });
            }
        };
        let Item::Node(code) = item else {
            unreachable!("pieces are not split")
        };
        let node = tree.node(code);
        let mut row = only(Boxed::new(DVec3::ZERO, DVec3::ZERO, item));
        row.count = node.count as usize;
        for lane in node.lanes() {
            let of = |axes: &[[f32; WIDTH]; 3]| {
                DVec3::from_array([0, 1, 2].map(|axis| f64::from(axes[axis][lane])))
            };
            let inner = match code & LEAF {
                0 => Item::Node(node.child[lane]),
                _ => Item::Piece(code, lane as u32),
            };
            let centre = of(&node.boxes.centre) - moving.centre;
            row.boxes[lane] = Boxed::new(centre, of(&node.boxes.half), inner);
        }
        row
    }
}

/// The box around a triangle.
fn around(points: &Points<'_>, item: Item) -> Boxed {
    let [a, b, c] = points.corners();
    between(a.min(b).min(c), a.max(b).max(c), item)
}

fn between(low: DVec3, high: DVec3, item: Item) -> Boxed {
    let half = 0.5 * (high - low) * (1.0 + 2.0 * f64::EPSILON);
    Boxed::new(0.5 * (low + high), half, item)
}

/// The most points in a set.
pub(super) const MOST_POINTS: usize = 8;

/// A set of points about the centre of mass, in the frame of the shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<'a> {
    /// The points. If there are fewer, the last one is repeated.
    pub(super) at: [DVec3; MOST_POINTS],
    pub(super) kind: Kind<'a>,
    /// All that is within this distance of the hull belongs to the set, m.
    pub(super) radius: f64,
}

/// The shape of a set's hull.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind<'a> {
    Point,
    /// A face of a mesh.
    Triangle(u32),
    /// A box; its corners are numbered as in `Cuboid`.
    Cuboid(&'a Cuboid),
}

impl<'a> Points<'a> {
    pub(super) fn of(moving: &Moving<'a>, item: Item) -> Points<'a> {
        let alone = |radius: f64| Points {
            at: [-moving.centre; MOST_POINTS],
            kind: Kind::Point,
            radius,
        };
        let tree = match moving.figure {
            Figure::Mesh(tree) => tree,
            Figure::Ball(radius) => return alone(radius),
            Figure::HalfSpace(_) => return alone(0.0),
        };
        match (item, tree.cuboid()) {
            (Item::Piece(code, lane), _) => triangle(tree, moving.centre, code, lane),
            (Item::Cuboid, Some(cuboid)) => Points {
                at: corners(cuboid.ends.map(|end| end - moving.centre)),
                kind: Kind::Cuboid(cuboid),
                radius: 0.0,
            },
            _ => unreachable!("nodes are no sets"),
        }
    }

    /// The first three points: the corners if the set is a triangle.
    pub(super) fn corners(&self) -> [DVec3; 3] {
        [self.at[0], self.at[1], self.at[2]]
    }

    /// The triangles of the surface, by the indices of their points and the face of the mesh, and their number.
    pub(super) fn triangles(&self) -> ([([u8; 3], u32); 12], usize) {
        let mut triangles = [([0; 3], 0); 12];
        let count = match self.kind {
            Kind::Point => 0,
            Kind::Triangle(face) => {
                triangles[0] = ([0, 1, 2], face);
                1
            }
            Kind::Cuboid(cuboid) => {
                for axis in 0..3 {
                    for end in 0..2 {
                        let face = &cuboid.faces[axis][end];
                        let across = 7 & !(1 << axis);
                        let one = 1 << ((axis + 1) % 3);
                        let corner = face.corner;
                        let diagonal = [(corner ^ one) as u8, (corner ^ across ^ one) as u8];
                        for (side, tip) in [corner, corner ^ across].into_iter().enumerate() {
                            let by_corners = [tip as u8, diagonal[0], diagonal[1]];
                            let place = 4 * axis + 2 * end + side;
                            triangles[place] = (by_corners, face.triangles[side]);
                        }
                    }
                }
                12
            }
        };
        (triangles, count)
    }
}

/// The eight corners of a box with the given low and high corners. Bit `k` of a corner's index selects the end on axis
/// `k`.
fn corners([low, high]: [DVec3; 2]) -> [DVec3; MOST_POINTS] {
    let mut corners = [low; MOST_POINTS];
    for (k, corner) in corners.iter_mut().enumerate() {
        corner.x = if k & 1 == 0 { low.x } else { high.x };
        corner.y = if k & 2 == 0 { low.y } else { high.y };
        corner.z = if k & 4 == 0 { low.z } else { high.z };
    }
    corners
}

fn triangle(tree: &Bvh, centre: DVec3, code: u32, lane: u32) -> Points<'_> {
    let triangles = tree.triangles(tree.node(code));
    let [a, b, c] = triangles
        .corners(lane as usize)
        .map(|v| v.as_dvec3() - centre);
    Points {
        at: [a, b, c, c, c, c, c, c],
        kind: Kind::Triangle(triangles.face[lane as usize]),
        radius: 0.0,
    }
}
