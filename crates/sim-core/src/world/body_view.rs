//! All properties and the motion of one body.

use glam::DVec3;

use super::{BodyHandle, Groups, World, WorldError};
use crate::{Body, BodyKind, Shape, Turn};

/// The current properties and motion of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BodyView<'a> {
    /// Its index; it may change when a body is removed.
    pub index: usize,
    /// Its permanent name.
    pub handle: BodyHandle,
    /// Its shape for collisions.
    pub shape: Option<&'a Shape>,
    /// What can move it.
    pub kind: BodyKind,
    /// Position, m.
    pub position: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Mass, kg; it has an effect only while the body is dynamic.
    pub mass: f64,
    /// Constant resultant force, N.
    pub force: DVec3,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f64,
    /// Coefficient of friction, from 0 to infinity.
    pub friction: f64,
    /// The groups that select the bodies with which it collides.
    pub groups: Groups,
    /// A number for the user of the world.
    pub user_data: u64,
    /// Its rotation and spin, if it can rotate.
    pub turn: Option<Turn>,
}

impl BodyView<'_> {
    /// A body with the same properties, to be added to this or another world.
    #[must_use]
    pub fn to_body(&self) -> Body {
        Body {
            shape: self.shape.cloned(),
            kind: self.kind,
            position: self.position,
            velocity: self.velocity,
            mass: self.mass,
            force: self.force,
            restitution: self.restitution,
            friction: self.friction,
            turn: self.turn,
            groups: self.groups,
            user_data: self.user_data,
        }
    }
}

impl World {
    /// All properties of a body.
    ///
    /// # Panics
    ///
    /// If there is no body of that index.
    #[must_use]
    pub fn body(&self, body: usize) -> BodyView<'_> {
        BodyView {
            index: body,
            turn: self.turn(body),
            handle: self.handle(body),
            shape: self.shape(body),
            kind: self.kind(body),
            position: self.position(body),
            velocity: self.velocity(body),
            mass: self.mass(body),
            force: self.force(body),
            restitution: self.restitution(body),
            friction: self.friction(body),
            groups: self.groups(body),
            user_data: self.user_data(body),
        }
    }

    /// All bodies, in the order of their indices.
    ///
    /// ```
    /// # use sim_core::{Body, DVec3, Settings, World};
    /// # let mut world = World::new(Settings::default())?;
    /// # world.add(Body { position: 5.0 * DVec3::X, ..Body::default() })?;
    /// let far = world.bodies().filter(|body| body.position.length() > 1.0);
    /// assert_eq!(far.count(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyView<'_>> + DoubleEndedIterator {
        (0..self.len()).map(|body| self.body(body))
    }

    /// The user's number of a body ([`Body::user_data`]).
    ///
    /// # Panics
    ///
    /// If there is no body of that index.
    #[must_use]
    pub fn user_data(&self, body: usize) -> u64 {
        assert!(body < self.len(), "there is no body {body}");
        self.bodies.user_data.get(body)
    }

    /// Sets the user's number of a body. The world does not read it.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`].
    pub fn set_user_data(&mut self, body: usize, user_data: u64) -> Result<(), WorldError> {
        self.check_body(body)?;
        self.bodies.user_data.set(body, user_data);
        Ok(())
    }
}
