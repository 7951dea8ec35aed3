//! Bodies as the input of a world.

use glam::{DQuat, DVec3};

use crate::{Groups, Inertia, Shape};

/// What can move a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BodyKind {
    /// Forces and impulses move it.
    #[default]
    Dynamic,
    /// Only its velocity moves it, and only a setter changes this velocity, as for a lift or a closing wall. Bodies
    /// that it meets give way.
    Kinematic,
    /// It stands still, as a floor does.
    Static,
}

impl BodyKind {
    /// Whether forces and impulses change the motion of such a body. Two bodies that are not movable pass through
    /// each other.
    #[inline]
    #[must_use]
    pub const fn is_movable(self) -> bool {
        matches!(self, BodyKind::Dynamic)
    }
}

/// A body at the start: its place, its motion, and the forces on it. It rotates only if it has a
/// [`turn`](Body::turn). Otherwise it translates, and a fixed orientation and scale are part of its mesh
/// ([`Mesh::transformed`](crate::Mesh::transformed)).
///
/// ```
/// use sim_core::{Body, BodyKind, DVec3, Shape};
///
/// let floor = Body {
///     shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
///     kind: BodyKind::Static,
///     ..Body::default()
/// };
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Body {
    /// The shape that collides; `None` is a point, which meets no other body.
    pub shape: Option<Shape>,
    /// Whether forces, its own velocity, or nothing moves it.
    pub kind: BodyKind,
    /// Position of the shape's origin, m; for a turning body, position of its centre of mass.
    pub position: DVec3,
    /// Velocity, m/s; zero for a static body; for a turning body, velocity of its centre of mass.
    pub velocity: DVec3,
    /// Mass, kg, from 1e-100 to 1e100. It has an effect while the body is dynamic.
    pub mass: f64,
    /// Constant resultant of all forces, N. It has an effect while the body is dynamic.
    pub force: DVec3,
    /// Coefficient of restitution, 0 to 1: the opening speed after an impact as a part of the closing speed. For two
    /// bodies the lesser value counts.
    pub restitution: f64,
    /// Coefficient of Coulomb friction µ: the tangential force of a contact is at most µ times the normal force, in
    /// every direction and whether the bodies slide or not. From 0 (smooth) to infinity inclusive (never slips).
    ///
    /// For two bodies the geometric mean `sqrt(µ1 µ2)` counts. If one of them is smooth it is 0, for any value of
    /// the other (0 times infinity is 0).
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_number"))]
    pub friction: f64,
    /// The groups that select the bodies with which it collides.
    pub groups: Groups,
    /// A number for the user; the world does not read it.
    pub user_data: u64,
    /// Its rotation; `None` for a body that only translates, which costs nothing for rotations.
    pub turn: Option<Turn>,
}

/// The rotation of a body, its angular velocity, its torque and its inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Turn {
    /// The rotation from the shape's frame into the world; of unit length.
    pub rotation: DQuat,
    /// Angular velocity in the world, rad/s.
    pub spin: DVec3,
    /// Constant torque about the centre of mass in the world, N m.
    pub torque: DVec3,
    /// Centre of mass, principal moments and axes in the shape's frame. `None` means those of a body of uniform
    /// density within its closed mesh, or ball. For a body that is not dynamic, whose spin is constant, `None` means
    /// any moments about its centre.
    pub inertia: Option<Inertia>,
}

impl Default for Turn {
    /// No rotation, no spin, and the inertia of the shape.
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
    /// An elastic, smooth, dynamic point of 1 kg at rest at the origin.
    fn default() -> Body {
        Body {
            shape: None,
            kind: BodyKind::Dynamic,
            position: DVec3::ZERO,
            velocity: DVec3::ZERO,
            mass: 1.0,
            force: DVec3::ZERO,
            restitution: 1.0,
            friction: 0.0,
            groups: Groups::ALL,
            user_data: 0,
            turn: None,
        }
    }
}
