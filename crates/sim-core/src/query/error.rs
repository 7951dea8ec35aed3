//! Errors of queries.

use glam::DVec3;

/// A value that no shape or query can have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// A vector with a component that is NaN, infinite or huge.
    #[error("{what} is {value}: every component must be a number within ±1e100")]
    Vector {
        /// Which quantity.
        what: &'static str,
        /// The value refused.
        value: DVec3,
    },
    /// A sphere of an impossible size.
    #[error("radius is {value} m: it must be between 0 and 1e100")]
    Radius {
        /// The value refused, m.
        value: f64,
    },
    /// A normal or a ray without a direction.
    #[error("{what} is {value}: it must have a direction")]
    Direction {
        /// Which quantity.
        what: &'static str,
        /// The value refused.
        value: DVec3,
    },
}

/// Largest coordinate, m.
const LARGEST: f64 = 1e100;

pub(super) fn check_vector(what: &'static str, value: DVec3) -> Result<(), QueryError> {
    // NaN fails the comparison.
    match value.abs().cmple(DVec3::splat(LARGEST)).all() {
        true => Ok(()),
        false => Err(QueryError::Vector { what, value }),
    }
}

pub(super) fn check_radius(value: f64) -> Result<(), QueryError> {
    match (0.0..=LARGEST).contains(&value) {
        true => Ok(()),
        false => Err(QueryError::Radius { value }),
    }
}

/// The unit vector of a direction.
pub(super) fn check_direction(what: &'static str, value: DVec3) -> Result<DVec3, QueryError> {
    check_vector(what, value)?;
    // Scaled first, so that no square overflows or underflows.
    let scaled = value / value.abs().max_element();
    let unit = scaled.try_normalize();
    unit.ok_or(QueryError::Direction { what, value })
}
