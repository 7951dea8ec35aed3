//! Quantities that a force-free world conserves.

use glam::DVec3;

use crate::World;

impl World {
    /// Kinetic energy of all bodies, J.
    pub fn kinetic_energy(&self) -> f64 {
        (0..self.len())
            .map(|i| 0.5 * self.mass(i) * self.velocity(i).length_squared())
            .sum()
    }

    /// Momentum of all bodies, kg m/s.
    pub fn momentum(&self) -> DVec3 {
        (0..self.len())
            .map(|i| self.mass(i) * self.velocity(i))
            .sum()
    }
}
