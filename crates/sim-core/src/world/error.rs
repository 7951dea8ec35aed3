//! What a world refuses.

use glam::DVec3;

/// A value that no body or setting can have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorldError {
    /// A vector with a component that is NaN, infinite or huge.
    #[error("{field} of body {body} is {value}: every component must be a number within ±1e100")]
    Vector {
        /// Index of the body.
        body: usize,
        /// Which quantity.
        field: &'static str,
        /// The value refused.
        value: DVec3,
    },
    /// A mass that is not positive.
    #[error("mass of body {body} is {value} kg: it must be between 1e-100 and 1e100")]
    Mass {
        /// Index of the body.
        body: usize,
        /// The value refused, kg.
        value: f64,
    },
    /// A body that does not exist.
    #[error("there is no body {body}: the world has {bodies}, counted from 0")]
    NoBody {
        /// Index asked for.
        body: usize,
        /// How many bodies there are.
        bodies: usize,
    },
    /// A step that is not a length of time.
    #[error("dt is {value} s: it must be between 1e-100 and 1e100")]
    Dt {
        /// The value refused, s.
        value: f64,
    },
}

/// A step that could not be done.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// A position or velocity beyond ±1e100, or not a number.
    #[error(
        "step {step}: the motion of body {body} under {method} left the range of ±1e100; \
         lower dt, the force or the velocity"
    )]
    OutOfRange {
        /// Index of the body.
        body: usize,
        /// The step that failed, from 1.
        step: u64,
        /// Title of the method.
        method: &'static str,
    },
}

/// Squares and products of quantities within these bounds stay finite.
pub(super) const LARGEST: f64 = 1e100;
const POSITIVE: core::ops::RangeInclusive<f64> = 1e-100..=LARGEST;

pub(super) fn check_vector(
    body: usize,
    field: &'static str,
    value: DVec3,
) -> Result<(), WorldError> {
    // NaN is not below anything.
    if value.abs().cmple(DVec3::splat(LARGEST)).all() {
        Ok(())
    } else {
        Err(WorldError::Vector { body, field, value })
    }
}

pub(super) fn check_mass(body: usize, value: f64) -> Result<(), WorldError> {
    if POSITIVE.contains(&value) {
        Ok(())
    } else {
        Err(WorldError::Mass { body, value })
    }
}

pub(super) fn check_dt(value: f64) -> Result<(), WorldError> {
    if POSITIVE.contains(&value) {
        Ok(())
    } else {
        Err(WorldError::Dt { value })
    }
}
