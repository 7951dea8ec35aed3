//! A turning body in the system that a method steps.

use core::f64::consts::PI;
use glam::{DQuat, DVec3};

use super::chart;

/// What a method's places and velocities are of a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coordinates {
    /// A rotation vector and its rate ([`chart`]).
    Vector,
    /// For the implicit midpoint rule, `Ω` in the body, and `hΩ` of the middle of the step, of which the rotation is the
    /// Cayley map: then angular momentum and energy of what nothing turns are kept, and a step goes back (Austin,
    /// Krishnaprasad, Wang 1993, "Almost Poisson integration of rigid body systems", J. Comput. Phys. 107,
    /// p. 105, eq. 4.4).
    Midpoint,
}

/// What is known of it where the step begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotor {
    /// Its place among the bodies.
    pub(crate) place: usize,
    /// Its slot among all that turn.
    pub(crate) slot: usize,
    /// Principal moments, kg m².
    pub(crate) moments: DVec3,
    /// Principal axes into the world.
    pub(crate) base: DQuat,
    /// Angular momentum about the centre of mass in the world, kg m²/s.
    pub(crate) momentum: DVec3,
    /// What its principal axes are in the frame of its shape, and where its centre of mass is there, m.
    pub(crate) axes: DQuat,
    pub(crate) centre: DVec3,
    /// Constant torque, N m.
    pub(crate) torque: DVec3,
    /// Whether anything turns it.
    pub(crate) is_movable: bool,
    pub(crate) coordinates: Coordinates,
}

impl Rotor {
    /// The rate of its rotation vector where the step begins, rad/s: the angular velocity in the body.
    pub(crate) fn first_rate(&self) -> DVec3 {
        into_body(self.base, self.momentum) / self.moments
    }

    /// Principal axes into the world, and the angular velocity in the body, rad/s, where a method asks for accelerations.
    pub(crate) fn pose(&self, theta: DVec3, rate: DVec3) -> (DQuat, DVec3) {
        let (turned, spin) = match self.coordinates {
            Coordinates::Vector => (chart::rotation(theta), chart::spin(theta, rate)),
            // Half of the step's: its tangent is |hΩ/2|.
            Coordinates::Midpoint => (by_tangents(theta, theta.length()), rate),
        };
        ((self.base * turned).normalize(), spin)
    }

    /// The same at the end of the step. Of a vector of half a turn or more, which does not tell it from less, none.
    pub(crate) fn end(&self, theta: DVec3, rate: DVec3) -> Option<(DQuat, DVec3)> {
        match self.coordinates {
            Coordinates::Vector => {
                // What is taken from a rotation may be half a turn, but for rounding.
                let most = PI * (1.0 + 8.0 * f64::EPSILON);
                (theta.length() <= most).then(|| self.pose(theta, rate))
            }
            Coordinates::Midpoint => {
                let turned = by_tangents(theta, 0.5 * theta.length());
                let turned = turned * turned;
                Some(((self.base * turned).normalize(), rate))
            }
        }
    }

    /// The second derivative of its vector under a torque in the body, N m; what it does by itself included or not.
    pub(crate) fn acceleration(
        &self,
        (theta, rate): (DVec3, DVec3),
        spin: DVec3,
        torque: DVec3,
        is_whole: bool,
    ) -> DVec3 {
        let whole = torque + (self.moments * spin).cross(spin);
        match (self.coordinates, is_whole) {
            (Coordinates::Midpoint, _) => whole / self.moments,
            (Coordinates::Vector, true) => {
                chart::rate(theta, whole / self.moments) + chart::bend(theta, rate, spin)
            }
            (Coordinates::Vector, false) => chart::rate(theta, torque / self.moments),
        }
    }
}

/// The rotation about an axis by an angle with a tangent.
fn by_tangents(axis: DVec3, tangent: f64) -> DQuat {
    let length = axis.length();
    match length > 0.0 {
        true => chart::rotation(libm::atan(tangent) / length * axis),
        false => DQuat::IDENTITY,
    }
}

/// Turns a vector of the world into the body whose axes a rotation turns into the world. A quaternion whose length is off by
/// a rounding makes it as much shorter as [`DQuat`]'s product makes one of the body longer: else what goes
/// there and back in each step would grow.
pub(crate) fn into_body(axes: DQuat, vector: DVec3) -> DVec3 {
    axes.inverse() * vector / axes.length_squared()
}
