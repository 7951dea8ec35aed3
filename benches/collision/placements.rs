//! Placements of the second mesh, and the truth for each.
//!
//! The second mesh approaches along directions distributed evenly over the sphere, until it touches the first. Offsets
//! lie on a grid along the direction, so that "touches" and "one step before" are both exact. The truth is computed by
//! parry's trees and their traversal with exact predicates, never by the code under test; a part of it is verified in
//! rational arithmetic.

use std::rc::Rc;

use kit::oracle;
use sim_core::DVec3;
use sim_core::collide::predicates::triangles_meet;

use crate::meshes::{Shape, Solid, Solids};
use crate::peers::parry_tree;

/// The position of the second mesh on its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// 1 % of the size farther out than the touching position, with boxes that overlap.
    Near,
    /// The first touching position of the grid.
    Graze,
    /// 30 % of the touching offset.
    Deep,
    /// The last position of the grid before touching.
    Hair,
    /// One sphere inside the other, nowhere touching.
    Nested,
}

impl Class {
    pub(crate) const ALL: [Class; 5] = [
        Class::Near,
        Class::Graze,
        Class::Deep,
        Class::Hair,
        Class::Nested,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Class::Near => "near",
            Class::Graze => "graze",
            Class::Deep => "deep",
            Class::Hair => "hair",
            Class::Nested => "nested",
        }
    }
}

/// An offset of the second mesh, and whether the surfaces meet there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) offset: DVec3,
    pub(crate) meet: bool,
}

/// The placements along one in so many directions are verified in rational arithmetic, which is slow.
const CHECKED: usize = 20;

/// Two solids and their placements.
pub(crate) struct Pair {
    pub(crate) first: Rc<Solid>,
    pub(crate) second: Rc<Solid>,
    placements: Vec<(Class, Placement)>,
}

impl Pair {
    /// The second mesh approaches the first from so many directions.
    pub(crate) fn approaching(solids: &Solids, shapes: [Shape; 2], directions: usize) -> Pair {
        let [first, second] = shapes.map(|shape| solids.get(shape));
        let mut placements = Vec::new();
        for i in 0..directions {
            let line = approach(&first, &second, direction(i, directions));
            if i % CHECKED == 0 {
                for (_, placement) in line.iter().flatten() {
                    let meet =
                        parry_tree(&first, &second, placement.offset, oracle::triangles_meet);
                    assert_eq!(meet, placement.meet, "{placement:?}");
                }
            }
            placements.extend(line.into_iter().flatten());
        }
        Pair {
            first,
            second,
            placements,
        }
    }

    /// The second inside the first, displaced by up to `slack` times its size, less than the gap.
    pub(crate) fn nested(
        solids: &Solids,
        shapes: [Shape; 2],
        slack: f64,
        directions: usize,
    ) -> Pair {
        let [first, second] = shapes.map(|shape| solids.get(shape));
        let size = size(&second);
        let placements = (0..directions).map(|i| {
            let part = slack * i as f64 / directions as f64;
            let placement = place(&first, &second, direction(i, directions) * part * size);
            assert!(!placement.meet, "one is inside the other");
            (Class::Nested, placement)
        });
        let placements = placements.collect();
        Pair {
            first,
            second,
            placements,
        }
    }

    pub(crate) fn placements(&self, class: Class) -> Vec<Placement> {
        let of_class = self.placements.iter().filter(|(c, _)| *c == class);
        of_class.map(|&(_, placement)| placement).collect()
    }
}

fn meet(first: &Solid, second: &Solid, offset: DVec3) -> bool {
    parry_tree(first, second, offset, triangles_meet)
}

fn place(first: &Solid, second: &Solid, offset: DVec3) -> Placement {
    Placement {
        offset,
        meet: meet(first, second, offset),
    }
}

/// The largest extent, m.
fn size(solid: &Solid) -> f64 {
    2.0 * solid.mesh.bounds().half_extent().max_element()
}

/// The placements along one line; `None` if the meshes pass each other.
fn approach(first: &Solid, second: &Solid, direction: DVec3) -> Option<Vec<(Class, Placement)>> {
    let size = size(first).max(size(second));
    // A power of two times a direction with few digits, so that every offset of the grid is exact.
    let step = 2.0_f64.powi(size.log2().ceil() as i32 - 20);
    let at = |steps: i64| steps as f64 * step * direction;
    let meets = |steps| meet(first, second, at(steps));

    // Inwards in large strides, then by bisection between the last two.
    let stride = 1 << 12;
    let outside = 2 << 20;
    let strides = (0..=outside / stride).map(|i| outside - i * stride);
    let mut touching = strides.into_iter().find(|&steps| meets(steps))?;
    let mut apart = touching + stride;
    while apart - touching > 1 {
        let middle = (apart + touching) / 2;
        if meets(middle) {
            touching = middle;
        } else {
            apart = middle;
        }
    }
    let near = apart + (0.01 * size / step) as i64;
    let deep = (0.3 * touching as f64) as i64;
    let boxes_overlap = |steps| first.mesh.bounds().meets(&second.mesh.bounds(), at(steps));
    let placements = [
        (Class::Near, near),
        (Class::Graze, touching),
        (Class::Deep, deep),
        (Class::Hair, apart),
    ];
    let placements = placements
        .into_iter()
        .filter(|&(_, steps)| boxes_overlap(steps));
    Some(
        placements
            .map(|(class, steps)| (class, place(first, second, at(steps))))
            .collect(),
    )
}

/// The `i`-th of `n` directions spread evenly, by the golden angle, rounded to 20 binary digits.
fn direction(i: usize, n: usize) -> DVec3 {
    let golden_angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
    let r = (1.0 - z * z).sqrt();
    let (sin, cos) = (golden_angle * i as f64).sin_cos();
    let digits = f64::from(1 << 20);
    (DVec3::new(r * cos, r * sin, z) * digits).round() / digits
}
