//! The kind and the mass of a body.

use glam::DVec3;

use super::{World, WorldError, error};
use crate::BodyKind;

impl World {
    /// The kind of a body: what can move it.
    ///
    /// # Panics
    ///
    /// If there is no body of that index.
    #[inline]
    #[must_use]
    pub fn kind(&self, body: usize) -> BodyKind {
        match self.bodies.mass[body].is_finite() {
            true => BodyKind::Dynamic,
            false => self.bodies.kind.get(body),
        }
    }

    /// Changes the kind of a body. It keeps its mass, and its velocity unless it becomes static.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], or [`WorldError::TurningKind`] if the body can rotate and would become immovable, or
    /// cease to be.
    pub fn set_kind(&mut self, body: usize, kind: BodyKind) -> Result<(), WorldError> {
        self.check_body(body)?;
        let before = self.kind(body);
        if self.turns(body) && before.is_movable() != kind.is_movable() {
            return Err(WorldError::TurningKind { body });
        }
        if kind == BodyKind::Static {
            self.current.velocity[body] = DVec3::ZERO;
        }
        self.integrator.forget_growth();
        self.continuous.wake_all();
        if before.is_movable() != kind.is_movable() {
            self.forget_contacts_of(body);
            self.bodies.set_kind(body, kind);
            // Two immovable bodies may overlap.
            self.note_placed(body);
            self.bodies.acceleration[body] = self.constant_acceleration(body);
        } else {
            self.bodies.set_kind(body, kind);
        }
        Ok(())
    }

    /// Mass of a body, kg. It has no effect while the body is not dynamic.
    ///
    /// # Panics
    ///
    /// If there is no body of that index.
    #[inline]
    #[must_use]
    pub fn mass(&self, body: usize) -> f64 {
        self.bodies.own_mass(body)
    }

    /// Sets the mass of a body, kg, from 1e-100 to 1e100. It takes effect while the body is dynamic.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`], [`WorldError::Mass`] out of that range, or [`WorldError::Vector`] if the angular
    /// momentum of a turning body would be beyond ±1e100.
    pub fn set_mass(&mut self, body: usize, mass: f64) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_mass(body, mass)?;
        self.scale_inertia(body, mass)?;
        if !self.bodies.is_movable(body) {
            self.bodies.set_own_mass(body, mass);
            return Ok(());
        }
        self.forget_contacts_of(body);
        self.bodies.set_own_mass(body, mass);
        self.note_placed(body);
        self.bodies.acceleration[body] = self.constant_acceleration(body);
        self.integrator.forget_growth();
        Ok(())
    }

    /// Applies an impulse to a body, N s: its velocity changes at once by the impulse over its mass. It has no effect
    /// on a body that is not dynamic, as in an impact.
    ///
    /// # Errors
    ///
    /// [`WorldError::NoBody`]; an impulse, or the velocity after it, with a component beyond ±1e100.
    pub fn apply_impulse(&mut self, body: usize, impulse: DVec3) -> Result<(), WorldError> {
        self.check_body(body)?;
        error::check_vector(body, "impulse", impulse)?;
        if !self.bodies.is_movable(body) {
            return Ok(());
        }
        self.set_velocity(body, self.velocity(body) + impulse / self.mass(body))
    }
}
