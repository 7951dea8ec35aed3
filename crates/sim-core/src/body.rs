//! What is put into a world.

use glam::{DQuat, DVec3};

use crate::{Inertia, Shape};

/// A body at the start: where it is, how it moves, what drives it. It translates, and a fixed
/// orientation and scale are part of its mesh ([`Mesh::transformed`](crate::Mesh::transformed)), unless
/// it is told to [`turn`](Body::turn).
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// What collides; `None` is a point, which meets nothing.
    pub shape: Option<Shape>,
    /// Place of the shape's origin, m; of a body that turns, of its centre of mass.
    pub position: DVec3,
    /// Velocity, m/s; of a body that turns, of its centre of mass.
    pub velocity: DVec3,
    /// Mass, kg; positive. Infinite for a body that nothing moves and that keeps its velocity:
    /// static where that is zero, kinematic where it is not.
    pub mass: f64,
    /// Constant resultant of all forces, N.
    pub force: DVec3,
    /// Part of the approaching speed with which it leaves an impact, 0 to 1. Of two bodies the
    /// lesser one counts.
    pub restitution: f64,
    /// Coefficient of Coulomb friction µ: the force along a contact is at most µ times the force
    /// across it, the same in every direction and whether the bodies slide or not. From 0, smooth,
    /// to infinity inclusive, which never slips.
    ///
    /// Of two bodies the geometric mean `sqrt(µ1 µ2)` counts; where one is smooth it is 0, whatever
    /// the other is (0 times infinity is 0).
    pub friction: f64,
    /// How it is turned and turns; `None` for a body that translates, and pays nothing for this.
    pub turn: Option<Turn>,
}

/// How a body is turned, how it turns, and what resists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Turns the shape's frame into the world; of unit length.
    pub rotation: DQuat,
    /// Angular velocity in the world, rad/s.
    pub spin: DVec3,
    /// Constant torque about the centre of mass in the world, N m.
    pub torque: DVec3,
    /// Centre of mass, principal moments and axes in the shape's frame. `None` takes those of a body
    /// that is the same everywhere within its closed mesh, or ball; a body of infinite mass, whose
    /// spin nothing changes, takes any, about its centre.
    pub inertia: Option<Inertia>,
}

impl Default for Turn {
    /// Not turned, and not turning, with the inertia of the shape.
    fn default() -> Turn {
        Turn {
            rotation: DQuat::IDENTITY,
            spin: DVec3::ZERO,
            torque: DVec3::ZERO,
            inertia: None,
        }
    }
}

impl Default for Body {
    /// An elastic, smooth point of 1 kg at rest at the origin.
    fn default() -> Body {
        Body {
            shape: None,
            position: DVec3::ZERO,
            velocity: DVec3::ZERO,
            mass: 1.0,
            force: DVec3::ZERO,
            restitution: 1.0,
            friction: 0.0,
            turn: None,
        }
    }
}
