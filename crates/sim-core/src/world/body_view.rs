//! All properties and the motion of one body.

use glam::DVec3;

use super::{BodyHandle, Groups, World, WorldError};
use crate::{Body, BodyKind, Shape, Turn};

/// A body as it is now.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BodyView<'a> {
    /// Its index: until a body is removed.
    pub index: usize,
    /// Its name for good.
    pub handle: BodyHandle,
    /// What it is to others that it meets.
    pub shape: Option<&'a Shape>,
    /// What moves it.
    pub kind: BodyKind,
    /// Position, m.
    pub position: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Mass, kg; it counts while the body is dynamic.
    pub mass: f64,
    /// Constant resultant force, N.
    pub force: DVec3,
    /// Part of the approaching speed that it keeps, 0 to 1.
    pub restitution: f64,
    /// Coefficient of friction, from 0 to infinity.
    pub friction: f64,
    /// Who it collides with.
    pub groups: Groups,
    /// The number that whoever uses the world has given it.
    pub user_data: u64,
    /// How it is turned and turns, if it does.
    pub turn: Option<Turn>,
}

impl BodyView<'_> {
    /// A body like it, to be added here or elsewhere.
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
    /// All of a body.
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

    /// The number that was given to a body ([`Body::user_data`]).
    ///
    /// # Panics
    ///
    /// If there is no body of that index.
    #[must_use]
    pub fn user_data(&self, body: usize) -> u64 {
        assert!(body < self.len(), "there is no body {body}");
        self.bodies.user_data.get(body)
    }

    /// Gives a body a number, which the world does not read.
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
