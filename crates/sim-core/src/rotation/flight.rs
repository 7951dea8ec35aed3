//! The trajectory of a rotation under no torque, or under a constant one.

use alloc::vec::Vec;
use glam::{DQuat, DVec3};

use super::series::{FARTHEST, ROOT_3, Series, order, rate};

/// The rotation of a body at a time, with its first two derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation from principal axes into the world; of unit length.
    pub rotation: DQuat,
    /// Angular momentum about the centre of mass in the world, kg m²/s.
    pub momentum: DVec3,
    /// Angular velocity in the world, rad/s.
    pub spin: DVec3,
    /// Its derivative, rad/s².
    pub acceleration: DVec3,
}

/// The angular velocity (world, rad/s) for an angular momentum (world, kg m²/s).
pub fn spin(moments: DVec3, rotation: DQuat, momentum: DVec3) -> DVec3 {
    rotation * (rotation.inverse() * momentum / moments)
}

/// The reason why a rotation cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FlightError {
    /// A value is not finite, or becomes infinite within the duration.
    #[error(
        "its angular momentum and torque, and what becomes of them, must be finite: lower the spin, the torque or \
         the forces, or take shorter steps"
    )]
    NotFinite,
    /// The body rotates by half a turn or more while forces act at points of it.
    #[error(
        "a body turns by half a turn or more in {duration:e} s while forces act at points of it: take shorter steps, \
         or a symplectic method if this is none"
    )]
    HalfTurn {
        /// The duration, s.
        duration: f64,
    },
    /// The body tumbles too often.
    #[error(
        "a body tumbles more than {MOST_PIECES} times {FARTHEST} rad in {duration:e} s: take shorter steps"
    )]
    TooFar {
        /// The duration of the flight, s.
        duration: f64,
    },
}

/// The most pieces of a flight, of about a quarter of a radian each.
const MOST_PIECES: usize = 1 << 16;

/// The number of pieces for which a flight costs about as much as an impact.
const AFFORDABLE: usize = 256;

/// The rotation of a body over some time: without torque, or under a torque that is constant in the world.
///
/// Exact to rounding for any moments at any speed. The angular momentum is that of the start plus torque times time,
/// and nothing else. If all moments are equal and there is no torque, the rotation is one about a fixed axis; if two
/// are equal, it is the product of two such rotations; otherwise it is a sequence of Taylor polynomials, of a number
/// and an order for which the remainder is below rounding.
#[derive(Clone, Debug)]
pub struct Flight {
    moments: DVec3,
    rotation: DQuat,
    momentum: DVec3,
    torque: DVec3,
    duration: f64,
    kind: Kind,
}

#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "an allocation would cost more than most flights"
)]
enum Kind {
    /// About a fixed axis, with this angular velocity in the world, rad/s.
    Steady(DVec3),
    /// About the angular momentum in the world with the first angular velocity, and about the body's own axis with the
    /// second, rad/s.
    Symmetric(DVec3, DVec3),
    /// One polynomial for the whole flight.
    One(Series),
    /// Polynomials one after the other, each with its start.
    Pieces(Vec<Piece>),
}

#[derive(Clone, Debug)]
struct Piece {
    time: f64,
    rotation: DQuat,
    series: Series,
}

/// Bounds on a rotation after a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Bound on the angular speed, rad/s.
    pub spin: f64,
    /// A point of the body at a distance `r` from its centre of mass has, relative to this centre, an acceleration of
    /// at most this times `r`, 1/s²,
    pub second: f64,
    /// and a third derivative of its position of at most this times `r`, 1/s³.
    pub third: f64,
}

impl Flight {
    /// The flight of a body with principal `moments` (kg m², see [`Inertia`](crate::Inertia)) from a `rotation` of
    /// unit length and a `momentum` (kg m²/s), under a `torque` (N m, constant in the world), for a `duration` in s,
    /// which may be negative.
    ///
    /// An error if these are not finite, or if a body whose moments all differ tumbles more than some 2,000 times.
    pub fn new(
        moments: DVec3,
        rotation: DQuat,
        momentum: DVec3,
        torque: DVec3,
        duration: f64,
    ) -> Result<Flight, FlightError> {
        let mut flight = Flight {
            moments,
            rotation,
            momentum,
            torque,
            duration,
            kind: Kind::Steady(DVec3::ZERO),
        };
        let is_finite = rotation.is_finite() && momentum.is_finite() && torque.is_finite();
        if !(is_finite && duration.is_finite() && flight.momentum_at(duration).is_finite()) {
            return Err(FlightError::NotFinite);
        }
        flight.kind = flight.kind()?;
        Ok(flight)
    }

    /// The part of a duration, s, over which a rotation can be computed at a bounded cost: all of it if there is a
    /// closed form.
    pub(crate) fn affordable(
        moments: DVec3,
        rotation: DQuat,
        momentum: DVec3,
        torque: DVec3,
        duration: f64,
    ) -> Result<f64, FlightError> {
        let least = moments.min_element();
        let pull = torque.length() / least;
        let most = AFFORDABLE as f64 * FARTHEST;
        if rate(momentum.length() / least, pull) * duration <= most {
            return Ok(duration);
        }
        let start = Flight::new(moments, rotation, momentum, torque, 0.0)?;
        let Kind::One(_) = start.kind else {
            return Ok(duration);
        };
        let spin = rotation.inverse() * momentum / moments;
        let affordable = most / rate(spin.length(), pull);
        let parts = (MOST_PIECES / AFFORDABLE) as f64;
        match parts * affordable < duration {
            true => Err(FlightError::TooFar { duration }),
            false => Ok(affordable.min(duration)),
        }
    }

    fn kind(&self) -> Result<Kind, FlightError> {
        let inside = self.rotation.inverse() * self.momentum;
        let spin = inside / self.moments;
        if self.torque == DVec3::ZERO {
            let DVec3 { x, y, z } = self.moments;
            // If the momentum is parallel to the spin, the spin is constant.
            if inside.cross(spin) == DVec3::ZERO || x == y && y == z {
                return Ok(Kind::Steady(self.rotation * spin));
            }
            for (axis, alone, pair) in [
                (DVec3::Z, z, [x, y]),
                (DVec3::X, x, [y, z]),
                (DVec3::Y, y, [z, x]),
            ] {
                if pair[0] == pair[1] {
                    // ω = L/I₁ + (1 - I₃/I₁) ω₃ e₃: the first stays in the world, the second in the body.
                    let own = (1.0 - alone / pair[0]) * spin.dot(axis);
                    return Ok(Kind::Symmetric(self.momentum / pair[0], own * axis));
                }
            }
        }
        let pull = self.torque.length() / self.moments.min_element();
        if !(spin.is_finite() && pull.is_finite()) {
            return Err(FlightError::NotFinite);
        }
        let whole = rate(spin.length(), pull) * self.duration.abs();
        if whole <= FARTHEST {
            return Ok(Kind::One(self.series(
                self.rotation,
                self.momentum,
                order(whole),
            )));
        }
        let mut pieces = Vec::new();
        let (mut time, mut rotation) = (0.0, self.rotation);
        while time != self.duration {
            if pieces.len() == MOST_PIECES {
                return Err(FlightError::TooFar {
                    duration: self.duration,
                });
            }
            let momentum = self.momentum_at(time);
            let spin = (rotation.inverse() * momentum / self.moments).length();
            let left = self.duration - time;
            let rate = rate(spin, pull);
            let length = (FARTHEST / rate).min(left.abs());
            let order = order(rate * length);
            let series = self.series(rotation, momentum, order);
            pieces.push(Piece {
                time,
                rotation,
                series,
            });
            let end = time + length.copysign(left);
            // The rest may be too short to change the time.
            let end = if length == left.abs() || end == time {
                self.duration
            } else {
                end
            };
            rotation = pieces[pieces.len() - 1].at(end);
            time = end;
        }
        Ok(Kind::Pieces(pieces))
    }

    fn series(&self, rotation: DQuat, momentum: DVec3, order: usize) -> Series {
        let inverse = rotation.inverse();
        let spin = inverse * momentum / self.moments;
        let torque = (self.torque != DVec3::ZERO).then(|| inverse * self.torque);
        Series::new(self.moments, spin, torque, order)
    }

    /// The duration, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Principal moments, kg m².
    pub fn moments(&self) -> DVec3 {
        self.moments
    }

    /// The rotation at a time from the start, s, from 0 to [`Flight::duration`].
    pub fn rotation_at(&self, t: f64) -> DQuat {
        match &self.kind {
            Kind::Steady(spin) => (about(*spin, t) * self.rotation).normalize(),
            Kind::Symmetric(outer, own) => {
                (about(*outer, t) * self.rotation * about(*own, t)).normalize()
            }
            Kind::One(series) => (self.rotation * series.at(t)).normalize(),
            Kind::Pieces(pieces) => {
                let next = pieces.partition_point(|piece| piece.time.abs() <= t.abs());
                pieces[next.max(1) - 1].at(t)
            }
        }
    }

    /// The angular momentum at a time from the start (s), kg m²/s.
    pub fn momentum_at(&self, t: f64) -> DVec3 {
        match self.torque == DVec3::ZERO {
            true => self.momentum,
            false => self.momentum + t * self.torque,
        }
    }

    /// The pose at a time from the start, s, from 0 to [`Flight::duration`].
    pub fn at(&self, t: f64) -> Pose {
        let (rotation, momentum) = (self.rotation_at(t), self.momentum_at(t));
        let inverse = rotation.inverse();
        let inside = inverse * momentum;
        let own = inside / self.moments;
        let turning = (inside.cross(own) + inverse * self.torque) / self.moments;
        Pose {
            rotation,
            momentum,
            spin: rotation * own,
            acceleration: rotation * turning,
        }
    }

    /// Bounds that hold from the time of `pose` for `left` more, s.
    ///
    /// From Euler's equations, with `k = max |I_j - I_k| / I_i <= 1` and `a` a bound on the effect of the torque:
    /// `|Ω'| <= k|Ω|²/√3 + a`, `|Ω''| <= (2k/√3)|Ω||Ω'| + a|Ω|`, put into `r'' = ω'×r + ω×(ω×r)` and its derivative.
    /// The speed is bounded by the solution of `y' = k y²/√3 + a`, and by momentum and energy.
    pub fn bounds(&self, pose: &Pose, left: f64) -> Bounds {
        let (least, left) = (self.moments.min_element(), left.abs());
        let pull = self.torque.length();
        let a = pull / least;
        let k = match self.kind {
            Kind::Steady(_) => 0.0,
            _ => lopsidedness(self.moments),
        };
        let spin = pose.spin.length() * (1.0 + ROUNDING);
        let fastest = match self.kind {
            // The speed is constant: the two angular velocities keep their angle.
            Kind::Steady(_) | Kind::Symmetric(..) => spin,
            _ => {
                let start = spin + a * left;
                let share = 1.0 - k / ROOT_3 * start * left;
                let nearby = if share > 0.0 {
                    start / share
                } else {
                    f64::INFINITY
                };
                let root = libm::sqrt(pose.momentum.dot(pose.spin));
                let by_momentum = (pose.momentum.length() + pull * left) / least;
                let by_energy = (root + pull * left / libm::sqrt(least)) / libm::sqrt(least);
                nearby.min(by_momentum).min(by_energy).max(spin)
            }
        } * (1.0 + ROUNDING);
        let turning = match self.kind {
            // The own axis precesses about the momentum.
            Kind::Symmetric(outer, own) => outer.length() * own.length(),
            _ => k / ROOT_3 * fastest * fastest + a,
        };
        let again = match self.kind {
            Kind::Symmetric(outer, _) => outer.length() * turning,
            _ => fastest * turning * (1.0 + 2.0 * k / ROOT_3) + a * fastest,
        };
        let second = turning + fastest * fastest;
        Bounds {
            spin: fastest,
            second: second * (1.0 + ROUNDING),
            third: (again + 3.0 * turning * fastest + fastest * fastest * fastest)
                * (1.0 + ROUNDING),
        }
    }
}

/// A bound on the relative rounding of a bound.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Piece {
    fn at(&self, t: f64) -> DQuat {
        (self.rotation * self.series.at(t - self.time)).normalize()
    }
}

/// `max |I_j - I_k| / I_i`; at most 1 for a real body.
fn lopsidedness(moments: DVec3) -> f64 {
    let DVec3 { x, y, z } = moments;
    (DVec3::new(y - z, z - x, x - y) / moments)
        .abs()
        .max_element()
}

/// The rotation by an angular velocity (rad/s) over a time, s.
pub(super) fn about(spin: DVec3, t: f64) -> DQuat {
    // Right to half an ulp, also where squares overflow or underflow.
    let scale = spin.abs().max_element();
    if scale == 0.0 {
        return DQuat::IDENTITY;
    }
    let speed = scale * (spin / scale).length();
    let (sin, cos) = libm::sincos(0.5 * speed * t);
    let axis = spin / speed * sin;
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cos)
}
