//! The laws of the built-in forces: force, Jacobians, potential.
//!
//! With `n = d/|d|` and `P = n nᵀ`, the derivatives used below are `∂|d|/∂d = nᵀ`,
//! `∂n/∂d = (I - P)/|d|`, so that
//!
//! ```text
//! spring       ∂/∂d [k (|d| - L) n] = k (P + (1 - L/|d|)(I - P))
//! damper       ∂/∂d [c (n·w) n]     = c/|d| (n wᵀ(I - P) + (n·w)(I - P)),   ∂/∂w = c P
//! attraction   ∂/∂d [μ d/|d|³]      = μ/|d|³ (I - 3 P)
//! drag         ∂/∂v [c |v| v]       = c |v| (I + P_v)
//! ```
//!
//! (Witkin, Baraff 1997, "Physically based modeling", ch. C and E.)

use glam::{DMat3, DVec3};

use super::{BodyMotion, Force, PairMotion};
use crate::Jacobians;

impl Force {
    /// Force on one body, N, for a force that acts on single bodies.
    #[inline]
    pub(crate) fn on_body(&self, at: &BodyMotion) -> DVec3 {
        match self {
            Force::LinearDrag { coefficient, .. } => -*coefficient * at.velocity,
            Force::QuadraticDrag { coefficient, .. } => {
                -coefficient * length(at.velocity) * at.velocity
            }
            Force::Anchor {
                anchor,
                rest_length,
                stiffness,
                damping,
                ..
            } => {
                let pull = spring(*stiffness, *rest_length, at.position - *anchor);
                -pull - *damping * at.velocity
            }
            Force::Push { force, .. } => *force,
            Force::Attraction {
                centre, strength, ..
            } => -at.mass * *strength * inverse_square(at.position - *centre),
            Force::Body { law, .. } => law.0.force(at),
            Force::Gravity { .. }
            | Force::Spring { .. }
            | Force::Gravitation { .. }
            | Force::Pair { .. } => DVec3::ZERO,
        }
    }

    /// The derivatives of this force.
    pub(crate) fn body_jacobians(&self, at: &BodyMotion) -> Jacobians {
        match self {
            Force::LinearDrag { coefficient, .. } => Jacobians {
                velocity: DMat3::from_diagonal(DVec3::splat(-coefficient)),
                ..Jacobians::ZERO
            },
            Force::QuadraticDrag { coefficient, .. } => {
                let speed = length(at.velocity);
                let along = direction(at.velocity).map_or(DMat3::ZERO, |n| outer(n, n));
                Jacobians {
                    velocity: -*coefficient * speed * (DMat3::IDENTITY + along),
                    ..Jacobians::ZERO
                }
            }
            Force::Anchor {
                anchor,
                rest_length,
                stiffness,
                damping,
                ..
            } => Jacobians {
                position: -spring_slope(*stiffness, *rest_length, at.position - *anchor),
                velocity: DMat3::from_diagonal(DVec3::splat(-damping)),
            },
            Force::Attraction {
                centre, strength, ..
            } => Jacobians {
                position: -at.mass * *strength * inverse_square_slope(at.position - *centre),
                velocity: DMat3::ZERO,
            },
            Force::Body { law, .. } => law.0.jacobians(at),
            Force::Gravity { .. }
            | Force::Push { .. }
            | Force::Spring { .. }
            | Force::Gravitation { .. }
            | Force::Pair { .. } => Jacobians::ZERO,
        }
    }

    /// The potential energy of this force, J.
    pub(crate) fn body_potential(&self, at: &BodyMotion) -> Option<f64> {
        match self {
            Force::Gravity { acceleration } => Some(-at.mass * dot(*acceleration, at.position)),
            Force::Anchor {
                anchor,
                rest_length,
                stiffness,
                ..
            } => Some(spring_energy(
                *stiffness,
                *rest_length,
                at.position - *anchor,
            )),
            Force::Push { force, .. } => Some(-dot(*force, at.position)),
            Force::Attraction {
                centre, strength, ..
            } => Some(-at.mass * strength / length(at.position - *centre)),
            Force::Body { law, .. } => law.0.potential(at),
            Force::LinearDrag { .. }
            | Force::QuadraticDrag { .. }
            | Force::Spring { .. }
            | Force::Gravitation { .. }
            | Force::Pair { .. } => None,
        }
    }

    /// Force on the first of two bodies, N, for a force that acts between bodies.
    #[inline]
    pub(crate) fn on_pair(&self, at: &PairMotion) -> DVec3 {
        match self {
            Force::Spring {
                rest_length,
                stiffness,
                damping,
                ..
            } => {
                spring(*stiffness, *rest_length, at.position)
                    + *damping * along(at.position, at.velocity)
            }
            Force::Gravitation { constant } => {
                constant * at.mass[0] * at.mass[1] * inverse_square(at.position)
            }
            Force::Pair { law, .. } => law.0.force(at),
            Force::Gravity { .. }
            | Force::LinearDrag { .. }
            | Force::QuadraticDrag { .. }
            | Force::Anchor { .. }
            | Force::Push { .. }
            | Force::Attraction { .. }
            | Force::Body { .. } => DVec3::ZERO,
        }
    }

    /// The derivatives of this force with respect to the relative motion.
    pub(crate) fn pair_jacobians(&self, at: &PairMotion) -> Jacobians {
        match self {
            Force::Spring {
                rest_length,
                stiffness,
                damping,
                ..
            } => {
                let (of_position, of_velocity) = along_slopes(at.position, at.velocity);
                Jacobians {
                    position: spring_slope(*stiffness, *rest_length, at.position)
                        + *damping * of_position,
                    velocity: *damping * of_velocity,
                }
            }
            Force::Gravitation { constant } => Jacobians {
                position: constant * at.mass[0] * at.mass[1] * inverse_square_slope(at.position),
                velocity: DMat3::ZERO,
            },
            Force::Pair { law, .. } => law.0.jacobians(at),
            Force::Gravity { .. }
            | Force::LinearDrag { .. }
            | Force::QuadraticDrag { .. }
            | Force::Anchor { .. }
            | Force::Push { .. }
            | Force::Attraction { .. }
            | Force::Body { .. } => Jacobians::ZERO,
        }
    }

    /// The change of this force by a small relative motion: the product of the Jacobians with `dx` and `dv`. Springs
    /// and gravitation compute it without the matrices.
    #[inline]
    pub(crate) fn pair_change(&self, at: &PairMotion, dx: DVec3, dv: DVec3) -> DVec3 {
        match self {
            Force::Spring {
                rest_length,
                stiffness,
                damping,
                ..
            } => {
                let squared = dot(at.position, at.position);
                if squared == 0.0 {
                    return *stiffness * dx + *damping * dv;
                }
                let inverse = 1.0 / libm::sqrt(squared);
                let n = inverse * at.position;
                let (stretch, speed) = (dot(n, dx), dot(n, at.velocity));
                let across = dx - stretch * n;
                let slack = stiffness * (1.0 - rest_length * inverse) + damping * inverse * speed;
                let turned = damping * inverse * dot(at.velocity, across);
                (stiffness * stretch + turned + damping * dot(n, dv)) * n + slack * across
            }
            Force::Gravitation { constant } => {
                let squared = dot(at.position, at.position);
                let strength = constant * at.mass[0] * at.mass[1];
                let cubed = squared * libm::sqrt(squared);
                let along = 3.0 * dot(at.position, dx) / squared;
                strength / cubed * (dx - along * at.position)
            }
            _ => {
                let slopes = self.pair_jacobians(at);
                slopes.position * dx + slopes.velocity * dv
            }
        }
    }

    /// The potential energy of this force, J.
    pub(crate) fn pair_potential(&self, at: &PairMotion) -> Option<f64> {
        match self {
            Force::Spring {
                rest_length,
                stiffness,
                ..
            } => Some(spring_energy(*stiffness, *rest_length, at.position)),
            Force::Gravitation { constant } => {
                Some(-constant * at.mass[0] * at.mass[1] / length(at.position))
            }
            Force::Pair { law, .. } => law.0.potential(at),
            Force::Gravity { .. }
            | Force::LinearDrag { .. }
            | Force::QuadraticDrag { .. }
            | Force::Anchor { .. }
            | Force::Push { .. }
            | Force::Attraction { .. }
            | Force::Body { .. } => None,
        }
    }
}

/// `k (|d| - L) n`; without a rest length it is linear and needs no direction.
fn spring(stiffness: f64, rest_length: f64, d: DVec3) -> DVec3 {
    if rest_length == 0.0 {
        return stiffness * d;
    }
    let far = length(d);
    if far == 0.0 {
        return DVec3::ZERO;
    }
    stiffness * (1.0 - rest_length / far) * d
}

fn spring_slope(stiffness: f64, rest_length: f64, d: DVec3) -> DMat3 {
    let far = length(d);
    if rest_length == 0.0 || far == 0.0 {
        return DMat3::from_diagonal(DVec3::splat(stiffness));
    }
    let n = d / far;
    let radial = outer(n, n);
    stiffness * (radial + (1.0 - rest_length / far) * (DMat3::IDENTITY - radial))
}

fn spring_energy(stiffness: f64, rest_length: f64, d: DVec3) -> f64 {
    let stretch = length(d) - rest_length;
    0.5 * stiffness * stretch * stretch
}

/// The part of `w` along `d`. At `d = 0` it is all of `w`, because bodies that pass through each other move along the
/// line through them.
fn along(d: DVec3, w: DVec3) -> DVec3 {
    direction(d).map_or(w, |n| dot(n, w) * n)
}

/// The derivatives of `along` with respect to `d` and `w`.
fn along_slopes(d: DVec3, w: DVec3) -> (DMat3, DMat3) {
    let Some(n) = direction(d) else {
        return (DMat3::ZERO, DMat3::IDENTITY);
    };
    let radial = outer(n, n);
    let across = DMat3::IDENTITY - radial;
    let slope = outer(n, across * w) + dot(n, w) * across;
    (slope * (1.0 / length(d)), radial)
}

/// `d / |d|³`; infinite or NaN at 0, which the world reports.
#[inline]
fn inverse_square(d: DVec3) -> DVec3 {
    let squared = dot(d, d);
    d / (squared * libm::sqrt(squared))
}

fn inverse_square_slope(d: DVec3) -> DMat3 {
    let far = length(d);
    let n = d / far;
    (1.0 / (far * far * far)) * (DMat3::IDENTITY - 3.0 * outer(n, n))
}

#[inline]
fn dot(a: DVec3, b: DVec3) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline]
fn length(d: DVec3) -> f64 {
    libm::sqrt(dot(d, d))
}

fn direction(d: DVec3) -> Option<DVec3> {
    let far = length(d);
    (far > 0.0).then(|| d / far)
}

/// `a bᵀ`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Central differences of a force. The step is about the cube root of the rounding unit, at which the errors of
/// rounding and of the third derivative are equal.
pub(super) fn differences(x: DVec3, v: DVec3, force: impl Fn(DVec3, DVec3) -> DVec3) -> Jacobians {
    let step = |at: DVec3| 6e-6 * (1.0 + at.abs().max_element());
    let (hx, hv) = (step(x), step(v));
    let slope =
        |dx: DVec3, dv: DVec3, h: f64| (force(x + dx, v + dv) - force(x - dx, v - dv)) / (2.0 * h);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let [px, py, pz] = axes.map(|axis| slope(hx * axis, DVec3::ZERO, hx));
    let [vx, vy, vz] = axes.map(|axis| slope(DVec3::ZERO, hv * axis, hv));
    Jacobians {
        position: DMat3::from_cols(px, py, pz),
        velocity: DMat3::from_cols(vx, vy, vz),
    }
}
