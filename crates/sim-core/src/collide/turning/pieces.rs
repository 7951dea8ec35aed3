//! What trees hold, as seen from the centre of mass: boxes, and up to three points.

use glam::DVec3;

use super::{Figure, Moving};
use crate::bvh::{Bvh, LEAF, WIDTH};

/// A node of a tree, or what can be split no further: a triangle by its leaf and lane, or a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Item {
    Node(u32),
    Piece(u32, u32),
}

/// A box of a shape, in the shape's frame about its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boxed {
    pub(super) centre: DVec3,
    pub(super) half: DVec3,
    /// What a ball adds all around, m.
    pub(super) radius: f64,
    /// No point of it is farther from the centre of mass, m; the radius apart.
    pub(super) farthest: f64,
    pub(super) item: Item,
}

/// Up to four boxes.
pub(super) struct Row {
    boxes: [Boxed; WIDTH],
    count: usize,
}

impl Row {
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

    /// A point with what is within a radius about it.
    fn point(moving: &Moving<'_>, radius: f64) -> Boxed {
        Boxed {
            radius,
            ..Boxed::new(-moving.centre, DVec3::ZERO, Item::Piece(0, 0))
        }
    }

    /// All of a shape; of a half-space a point of its plane.
    pub(super) fn root(moving: &Moving<'_>) -> Boxed {
        match moving.figure {
            Figure::Mesh(tree) => {
                let bounds = tree.bounds();
                // Boxes of f32 about centres of f64 may round by what a box of its size does.
                let centre = bounds.centre() - moving.centre;
                let half = bounds.half_extent() * (1.0 + f64::EPSILON);
                Boxed::new(centre, half, Item::Node(tree.root()))
            }
            Figure::Ball(radius) => Boxed::point(moving, radius),
            Figure::HalfSpace(_) => Boxed::point(moving, 0.0),
        }
    }

    /// What is in a box, or that itself where it is not to be split.
    pub(super) fn within(moving: &Moving<'_>, item: Item) -> Row {
        let only = |boxed: Boxed| Row {
            boxes: [boxed; WIDTH],
            count: 1,
        };
        let tree = match (moving.figure, item) {
            (Figure::Mesh(tree), Item::Node(_)) => tree,
            (Figure::Mesh(_), _) => return only(around(&Points::of(moving, item), item)),
            _ => return only(Boxed::root(moving)),
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
fn around(points: &Points, item: Item) -> Boxed {
    let [a, b, c] = points.at;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let half = 0.5 * (high - low) * (1.0 + 2.0 * f64::EPSILON);
    Boxed::new(0.5 * (low + high), half, item)
}

/// A triangle, or a point with what is within a radius about it, about the centre of mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points {
    /// The same one three times where there is but one.
    pub(super) at: [DVec3; 3],
    pub(super) is_point: bool,
    pub(super) radius: f64,
    pub(super) face: Option<u32>,
}

impl Points {
    pub(super) fn of(moving: &Moving<'_>, item: Item) -> Points {
        match (moving.figure, item) {
            (Figure::Mesh(tree), Item::Piece(code, lane)) => {
                triangle(tree, moving.centre, code, lane)
            }
            (figure, _) => Points {
                at: [-moving.centre; 3],
                is_point: true,
                radius: match figure {
                    Figure::Ball(radius) => radius,
                    _ => 0.0,
                },
                face: None,
            },
        }
    }
}

fn triangle(tree: &Bvh, centre: DVec3, code: u32, lane: u32) -> Points {
    let triangles = tree.triangles(tree.node(code));
    Points {
        at: triangles
            .corners(lane as usize)
            .map(|v| v.as_dvec3() - centre),
        is_point: false,
        radius: 0.0,
        face: Some(triangles.face[lane as usize]),
    }
}
