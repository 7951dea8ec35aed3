//! A turning body in the system that a method steps.

use core::f64::consts::PI;
use glam::{DQuat, DVec3};

use super::chart;

/// The meaning of a method's positions and velocities for a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coordinates {
    /// A rotation vector and its rate ([`chart`]).
    Vector,
    /// For the implicit midpoint rule. The velocity is `Ω` in the body. The position is `hΩ` with the `Ω` of the
    /// middle of the step, and the rotation is its Cayley map. Then a step without torque conserves angular momentum
    /// and energy, and is reversible (Austin, Krishnaprasad, Wang 1993, "Almost Poisson integration of rigid body
    /// systems", J. Comput. Phys. 107, p. 105, eq. 4.4).
    Midpoint,
}

/// The data of a rotor at the start of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotor {
    /// Its place among the bodies of the system.
    pub(crate) place: usize,
    /// Its slot among all turning bodies.
    pub(crate) slot: usize,
    /// Principal moments, kg m².
    pub(crate) moments: DVec3,
    /// The rotation from principal axes into the world.
    pub(crate) base: DQuat,
    /// Angular momentum about the centre of mass in the world, kg m²/s.
    pub(crate) momentum: DVec3,
    /// The rotation of the principal axes in the frame of the shape, and the centre of mass there, m.
    pub(crate) axes: DQuat,
    pub(crate) centre: DVec3,
    /// Constant torque, N m.
    pub(crate) torque: DVec3,
    /// Whether impulses and torques can change its rotation.
    pub(crate) is_movable: bool,
    pub(crate) coordinates: Coordinates,
}

impl Rotor {
    /// The rate of the rotation vector at the start of the step, rad/s: the angular velocity in the body.
    pub(crate) fn first_rate(&self) -> DVec3 {
        into_body(self.base, self.momentum) / self.moments
    }

    /// The rotation from principal axes into the world, and the angular velocity in the body, rad/s, at a state for
    /// which a method asks for accelerations.
    pub(crate) fn pose(&self, theta: DVec3, rate: DVec3) -> (DQuat, DVec3) {
        let (turned, spin) = match self.coordinates {
            Coordinates::Vector => (chart::rotation(theta), chart::spin(theta, rate)),
            // Half of the step's rotation: the tangent of its angle is |hΩ/2|.
            Coordinates::Midpoint => (by_tangents(theta, theta.length()), rate),
        };
        ((self.base * turned).normalize(), spin)
    }

    /// The same at the end of the step. `None` for a vector of half a turn or more, which is ambiguous.
    pub(crate) fn end(&self, theta: DVec3, rate: DVec3) -> Option<(DQuat, DVec3)> {
        match self.coordinates {
            Coordinates::Vector => {
                // A vector computed from a rotation may be half a turn long, up to rounding.
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

    /// The second derivative of the rotation vector under a torque in the body, N m; with the free rotation if
    /// `is_whole`.
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

/// The rotation about an axis by the angle with a given tangent.
fn by_tangents(axis: DVec3, tangent: f64) -> DQuat {
    let length = axis.length();
    match length > 0.0 {
        true => chart::rotation(libm::atan(tangent) / length * axis),
        false => DQuat::IDENTITY,
    }
}

/// Transforms a vector from the world into the frame of a body with the rotation `axes`. If the length of the
/// quaternion is off by a rounding, the result is shorter by the same factor by which [`DQuat`]'s product makes a
/// vector of the body longer. Otherwise a vector that is transformed there and back in each step would grow.
pub(crate) fn into_body(axes: DQuat, vector: DVec3) -> DVec3 {
    axes.inverse() * vector / axes.length_squared()
}
