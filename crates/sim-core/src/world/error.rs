//! Errors of worlds.

use alloc::{format, string::String};
use glam::DVec3;

use super::BodyHandle;
use crate::{Body, BodyKind, Force, Shape, force::ForceError};

/// The reason why a world refuses a value or a call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A vector with a component that is NaN, infinite or huge.
    #[error("{field} of body {body} is {value}: every component must be a number within ±1e100")]
    Vector {
        /// Index of the body.
        body: usize,
        /// The quantity.
        field: &'static str,
        /// The value refused.
        value: DVec3,
    },
    /// A mass that is not positive, or huge.
    #[error("mass of body {body} is {value} kg: it must be between 1e-100 and 1e100{}", mass_remedy(*value))]
    Mass {
        /// Index of the body.
        body: usize,
        /// The value refused, kg.
        value: f64,
    },
    /// A static body with a velocity.
    #[error(
        "velocity of body {body} is {value}: a static body has none; one that keeps it is kinematic"
    )]
    StaticVelocity {
        /// Index of the body.
        body: usize,
        /// The velocity refused, m/s.
        value: DVec3,
    },
    /// A restitution below 0 or above 1.
    #[error("restitution of body {body} is {value}: it must be between 0 and 1")]
    Restitution {
        /// Index of the body.
        body: usize,
        /// The value refused.
        value: f64,
    },
    /// A coefficient of friction that is negative or NaN.
    #[error("friction of body {body} is {value}: it must be between 0 and infinity")]
    Friction {
        /// Index of the body.
        body: usize,
        /// The value refused.
        value: f64,
    },
    /// A sphere whose radius is negative, NaN or huge.
    #[error("radius of body {body} is {value} m: it must be between 0 and 1e100")]
    Radius {
        /// Index of the body.
        body: usize,
        /// The value refused, m.
        value: f64,
    },
    /// A half-space whose normal is zero.
    #[error("normal of body {body} is {value}: it must have a direction")]
    Normal {
        /// Index of the body.
        body: usize,
        /// The value refused.
        value: DVec3,
    },
    /// A rotation that is not a unit quaternion.
    #[error("rotation of body {body} must be a quaternion of unit length")]
    Rotation {
        /// Index of the body.
        body: usize,
    },
    /// A body that cannot rotate, because it has no inertia.
    #[error("body {body} cannot turn: {error}")]
    Inertia {
        /// Index of the body.
        body: usize,
        /// The reason.
        error: crate::InertiaError,
    },
    /// A body that cannot rotate.
    #[error("body {body} does not turn: add it with `turn`")]
    DoesNotTurn {
        /// Index of the body.
        body: usize,
    },
    /// A change of kind for which the inertia of a turning body is not known.
    #[error("body {body} turns: it stays dynamic, or not, as it was added")]
    TurningKind {
        /// Index of the body.
        body: usize,
    },
    /// A half-space with a rotation.
    #[error("body {body} is a half-space, which cannot turn")]
    TurningHalfSpace {
        /// Index of the body.
        body: usize,
    },
    /// A body that does not exist.
    #[error("there is no body {body}: the world has {bodies}, counted from 0")]
    NoBody {
        /// The requested index.
        body: usize,
        /// The number of bodies.
        bodies: usize,
    },
    /// A handle of a body that has been removed, or of another world.
    #[error("the body of this handle is not in the world: it has been removed, or never was")]
    Stale {
        /// The handle.
        handle: BodyHandle,
    },
    /// A pair of a body and itself.
    #[error("the pair is body {body} and itself: name two different ones")]
    SameBody {
        /// The body.
        body: usize,
    },
    /// A number that a force cannot have.
    #[error("force {index} ({kind}): {error}")]
    Force {
        /// Its index in the list of forces.
        index: usize,
        /// The name of its kind.
        kind: &'static str,
        /// The field, and the reason.
        error: ForceError,
    },
    /// A force that does not exist.
    #[error("there is no force {index}: the world has {forces}, counted from 0")]
    NoForce {
        /// The requested index.
        index: usize,
        /// The number of forces.
        forces: usize,
    },
    /// A tolerance out of range.
    #[error("the tolerance is {value}: it must be between 1e-15 and 1")]
    Tolerance {
        /// The value refused.
        value: f64,
    },
    /// A step length out of range.
    #[error("dt is {value} s: it must be between 1e-100 and 1e100")]
    Dt {
        /// The value refused, s.
        value: f64,
    },
}

/// A step that failed. Every variant names the body, the step (from 1) and the title of the method.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A position or velocity beyond ±1e100, or not a number.
    #[error(
        "step {step}: the motion of body {body} under {method} left the range of ±1e100; {}",
        remedy(*stable_dt)
    )]
    OutOfRange {
        /// Index of the body.
        body: usize,
        /// The step that failed, from 1.
        step: u64,
        /// Title of the method.
        method: &'static str,
        /// The largest `dt`, s, for which the method is stable for the forces where the growth began, as in
        /// [`StepError::Unstable`], if `dt` is longer: 0 if it is stable for none.
        stable_dt: Option<f64>,
    },
    /// Speeds have grown a millionfold, and the step is longer than the stability limit of the method.
    #[error(
        "step {step}: the motion of body {body} grows without bound: dt is too long for \
         {method}, which is stable up to {stable_dt:.4e} s where the growth began"
    )]
    Unstable {
        /// Index of the fastest body.
        body: usize,
        /// The step that failed, from 1.
        step: u64,
        /// Title of the method.
        method: &'static str,
        /// The largest `dt`, s, for which the method is stable for the forces where the growth began.
        ///
        /// This is not the limit where the step failed: under a force that grows faster than the motion, as quadratic
        /// drag does, the motion that has blown up is stiffer by as much as it has grown. The world keeps the motion
        /// at the start, or when bodies, forces or settings were last set, and each time that the greatest speed has
        /// doubled since. It examines each of these motions, and the motion one step later by a stable method. This
        /// is the first limit among them that is below `dt`. If forces become still stiffer on a stable trajectory, a
        /// run with this `dt` reports that in turn.
        stable_dt: f64,
    },
    /// A body rotates too fast for its rotation to be computed.
    #[error("step {step}: body {body} cannot be turned: {error}")]
    Turning {
        /// Index of the body.
        body: usize,
        /// The step that failed, from 1.
        step: u64,
        /// The reason.
        error: crate::rotation::FlightError,
    },
    /// An implicit method found no solution of its equations.
    #[error(
        "step {step}: {method} found no motion of body {body}{} in {iterations} iterations; lower dt, or choose \
         a method that controls its error",
        beside(*other)
    )]
    NotConverged {
        /// Index of the body farthest from a solution.
        body: usize,
        /// The nearest of the bodies that forces connect to it, if any.
        other: Option<usize>,
        /// The step that failed, from 1.
        step: u64,
        /// Title of the method.
        method: &'static str,
        /// Iterations of Newton's method.
        iterations: u32,
    },
    /// An adaptive method did not reach the end of the step.
    #[error(
        "step {step}: {method} needs more than {steps} steps within dt to hold the tolerance for \
         body {body}{}; lower dt or raise the tolerance{}",
        beside(*other), nearer_origin(*other)
    )]
    TooManySteps {
        /// Index of the body.
        body: usize,
        /// The nearest of the bodies that forces connect to it, if any.
        other: Option<usize>,
        /// The step that failed, from 1.
        step: u64,
        /// Title of the method.
        method: &'static str,
        /// Steps taken.
        steps: u32,
    },
    /// A body between two immovable ones that move towards each other has no room left.
    #[error(
        "step {step}: body {body} is squeezed between bodies {} and {}, which nothing stops: stop \
         one of them, make it dynamic, or, should there be room for it, lower dt",
        between.0, between.1
    )]
    Squeezed {
        /// Index of the body.
        body: usize,
        /// The bodies between which it is, or other bodies in their way.
        between: (usize, usize),
        /// The step that failed, from 1.
        step: u64,
    },
    /// The number of impacts reached its limit.
    #[error(
        "step {step}: body {body} has an impact after {impacts} others in the step; lower dt, or \
         part what it is caught between"
    )]
    TooManyImpacts {
        /// Index of a body in the last impact.
        body: usize,
        /// The step that failed, from 1.
        step: u64,
        /// Title of the method.
        method: &'static str,
        /// The number of impacts resolved.
        impacts: u64,
    },
    /// A body moves, rotates or is pushed so fast that the step would take thousands of times as long as one without
    /// impacts.
    #[error(
        "step {step}: body {body} is too fast for its size to be followed under {method}: the step would \
         cost thousands of steps without impacts; lower dt, the force or the velocity"
    )]
    TooMuchWork {
        /// Index of the body.
        body: usize,
        /// The step that failed, from 1.
        step: u64,
        /// Title of the method.
        method: &'static str,
    },
}

impl StepError {
    /// Index of the body at which the step failed.
    pub fn body(&self) -> usize {
        match *self {
            StepError::OutOfRange { body, .. }
            | StepError::Unstable { body, .. }
            | StepError::NotConverged { body, .. }
            | StepError::TooManySteps { body, .. }
            | StepError::Squeezed { body, .. }
            | StepError::Turning { body, .. }
            | StepError::TooManyImpacts { body, .. }
            | StepError::TooMuchWork { body, .. } => body,
        }
    }
}

fn beside(other: Option<usize>) -> String {
    other.map_or_else(String::new, |other| format!(" beside body {other}"))
}

/// The remedy for two bodies that are so close that their coordinates have few digits for the distance.
fn nearer_origin(other: Option<usize>) -> &'static str {
    other.map_or("", |_| ", or put the origin nearer to both")
}

fn remedy(stable_dt: Option<f64>) -> String {
    match stable_dt {
        Some(0.0) => "the method is unstable here at every dt: choose another one".into(),
        Some(dt) if dt.is_finite() => {
            format!("the method is stable up to dt = {dt:.4e} s where the growth began")
        }
        _ => "lower dt, the force or the velocity".into(),
    }
}

/// Squares and products of quantities within these bounds stay finite.
pub(super) const LARGEST: f64 = 1e100;
const POSITIVE: core::ops::RangeInclusive<f64> = 1e-100..=LARGEST;

pub(super) fn check_vector(
    body: usize,
    field: &'static str,
    value: DVec3,
) -> Result<(), WorldError> {
    // NaN fails the comparison.
    if value.abs().cmple(DVec3::splat(LARGEST)).all() {
        Ok(())
    } else {
        Err(WorldError::Vector { body, field, value })
    }
}

fn mass_remedy(mass: f64) -> &'static str {
    match mass == f64::INFINITY {
        true => "; what nothing moves is static or kinematic",
        false => "",
    }
}

pub(super) fn check_kind(body: usize, kind: BodyKind, velocity: DVec3) -> Result<(), WorldError> {
    match kind == BodyKind::Static && velocity != DVec3::ZERO {
        true => Err(WorldError::StaticVelocity {
            body,
            value: velocity,
        }),
        false => Ok(()),
    }
}

/// Checks all properties of a body except its shape.
pub(super) fn check_body(index: usize, body: &Body) -> Result<(), WorldError> {
    check_vector(index, "position", body.position)?;
    check_vector(index, "velocity", body.velocity)?;
    check_vector(index, "force", body.force)?;
    check_mass(index, body.mass)?;
    check_kind(index, body.kind, body.velocity)?;
    check_restitution(index, body.restitution)?;
    check_friction(index, body.friction)
}

pub(super) fn check_mass(body: usize, value: f64) -> Result<(), WorldError> {
    if POSITIVE.contains(&value) {
        Ok(())
    } else {
        Err(WorldError::Mass { body, value })
    }
}

pub(super) fn check_restitution(body: usize, value: f64) -> Result<(), WorldError> {
    if (0.0..=1.0).contains(&value) {
        Ok(())
    } else {
        Err(WorldError::Restitution { body, value })
    }
}

pub(super) fn check_friction(body: usize, value: f64) -> Result<(), WorldError> {
    // NaN fails the comparison.
    if value >= 0.0 {
        Ok(())
    } else {
        Err(WorldError::Friction { body, value })
    }
}

/// The shape, with its normal of unit length.
pub(super) fn check_shape(body: usize, shape: Shape) -> Result<Shape, WorldError> {
    match shape {
        Shape::Mesh(_) => Ok(shape),
        Shape::Sphere { radius } if (0.0..=LARGEST).contains(&radius) => Ok(shape),
        Shape::Sphere { radius: value } => Err(WorldError::Radius { body, value }),
        Shape::HalfSpace { normal } => {
            check_vector(body, "normal", normal)?;
            // Scaled first, so that no square overflows or underflows.
            let scaled = normal / normal.abs().max_element();
            let unit = scaled.try_normalize();
            let normal = unit.ok_or(WorldError::Normal {
                body,
                value: normal,
            })?;
            Ok(Shape::HalfSpace { normal })
        }
    }
}

pub(super) fn check_dt(value: f64) -> Result<(), WorldError> {
    if POSITIVE.contains(&value) {
        Ok(())
    } else {
        Err(WorldError::Dt { value })
    }
}

pub(super) fn check_force(index: usize, force: &Force) -> Result<(), WorldError> {
    force.check().map_err(|error| WorldError::Force {
        index,
        kind: force.kind(),
        error,
    })
}

pub(super) fn check_tolerance(value: f64) -> Result<(), WorldError> {
    if super::Settings::TOLERANCES.contains(&value) {
        Ok(())
    } else {
        Err(WorldError::Tolerance { value })
    }
}
