//! Quantities that a force-free world conserves. Only dynamic bodies count.

use glam::DVec3;

use crate::World;

impl World {
    /// Kinetic energy of all dynamic bodies, J.
    pub fn kinetic_energy(&self) -> f64 {
        self.movable()
            .map(|i| 0.5 * self.mass(i) * self.velocity(i).length_squared())
            .sum()
    }

    /// Momentum of all dynamic bodies, kg m/s.
    pub fn momentum(&self) -> DVec3 {
        self.movable()
            .map(|i| self.mass(i) * self.velocity(i))
            .sum()
    }

    /// The dynamic bodies.
    pub(crate) fn movable(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        (0..self.len()).filter(|&i| self.kind(i).is_movable())
    }
}
