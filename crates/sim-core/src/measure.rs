//! Quantities that a world without forces conserves. Only dynamic bodies count.

use glam::DVec3;

use crate::World;

impl World {
    /// Kinetic energy of all dynamic bodies, J, including that of rotation.
    pub fn kinetic_energy(&self) -> f64 {
        let moving: f64 = self
            .movable()
            .map(|i| 0.5 * self.mass(i) * self.velocity(i).length_squared())
            .sum();
        moving + self.turning_energy()
    }

    /// The part of the kinetic energy that is in rotations about centres of mass, J.
    pub fn turning_energy(&self) -> f64 {
        self.turning_bodies()
            .filter(|&i| self.kind(i).is_movable())
            .map(|i| 0.5 * self.angular_momentum(i).dot(self.spin(i)))
            .sum()
    }

    /// Angular momentum of all bodies about a point, kg m²/s.
    pub fn angular_momentum_about(&self, point: DVec3) -> DVec3 {
        self.movable()
            .map(|i| {
                let arm = self.position(i) - point;
                arm.cross(self.mass(i) * self.velocity(i)) + self.angular_momentum(i)
            })
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
