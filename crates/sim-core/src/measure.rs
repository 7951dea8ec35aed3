//! Quantities that a force-free world conserves. Immovable bodies, of infinite mass, do not count.

use glam::DVec3;

use crate::World;

impl World {
    /// Kinetic energy of all bodies, J.
    pub fn kinetic_energy(&self) -> f64 {
        self.movable()
            .map(|i| 0.5 * self.mass(i) * self.velocity(i).length_squared())
            .sum()
    }

    /// Momentum of all bodies, kg m/s.
    pub fn momentum(&self) -> DVec3 {
        self.movable()
            .map(|i| self.mass(i) * self.velocity(i))
            .sum()
    }

    /// The bodies of finite mass.
    pub(crate) fn movable(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        (0..self.len()).filter(|&i| self.mass(i).is_finite())
    }
}
