//! The shapes of bodies.

use alloc::sync::Arc;
use glam::DVec3;

use crate::Mesh;

/// The shape of a body, relative to its position.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Shape {
    /// A surface of triangles, open or closed.
    Mesh(#[cfg_attr(feature = "serde", serde(with = "crate::mesh::data::shared"))] Arc<Mesh>),
    /// A solid ball about the position.
    Sphere {
        /// Its radius, m, from 0 (a point that collides) to 1e100.
        radius: f64,
    },
    /// Everything on one side of a plane through the position: a floor or a wall. Two half-spaces never collide.
    HalfSpace {
        /// Points out of the half-space; of any length but 0.
        normal: DVec3,
    },
}

impl Shape {
    /// The mesh, if it is one.
    pub fn mesh(&self) -> Option<&Arc<Mesh>> {
        match self {
            Shape::Mesh(mesh) => Some(mesh),
            Shape::Sphere { .. } | Shape::HalfSpace { .. } => None,
        }
    }

    /// Low and high corner of the least box around the shape, relative to its position, m; `None` for a half-space,
    /// which has no bounding box.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        match self {
            Shape::Mesh(mesh) => {
                let bounds = mesh.bounds();
                Some([bounds.min, bounds.max].map(|corner| corner.as_dvec3()))
            }
            &Shape::Sphere { radius } => Some([-radius, radius].map(DVec3::splat)),
            Shape::HalfSpace { .. } => None,
        }
    }
}

/// The extent of a shape about its origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Extent {
    /// Low and high corner of its bounding box, m; zero if it has none.
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// Largest half extent, m.
    pub(crate) half: f64,
    /// Largest coordinates of the points placed with it, m, by axis, and the largest of them.
    pub(crate) reach: DVec3,
    pub(crate) farthest: f64,
}

impl Extent {
    /// The extent of a ball.
    pub(crate) fn of_ball(radius: f64) -> Extent {
        Extent {
            low: DVec3::splat(-radius),
            high: DVec3::splat(radius),
            half: radius,
            reach: DVec3::splat(radius),
            farthest: radius,
        }
    }
}

impl Shape {
    pub(crate) fn extent(&self) -> Extent {
        match self {
            Shape::Mesh(mesh) => {
                let bounds = mesh.bounds();
                let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
                let reach = low.abs().max(high.abs());
                Extent {
                    low,
                    high,
                    half: bounds.half_extent().max_element(),
                    reach,
                    farthest: reach.max_element(),
                }
            }
            &Shape::Sphere { radius } => Extent::of_ball(radius),
            Shape::HalfSpace { .. } => Extent {
                half: f64::INFINITY,
                ..Extent::default()
            },
        }
    }
}

impl From<Arc<Mesh>> for Shape {
    fn from(mesh: Arc<Mesh>) -> Shape {
        Shape::Mesh(mesh)
    }
}
