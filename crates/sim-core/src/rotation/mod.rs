//! Rotations of bodies: free, and under a torque.
//!
//! The state of a rotation is a unit quaternion `q`, the rotation from the body's principal axes into the world, and
//! the angular momentum `L` about the centre of mass in the world, kg m²/s. The angular velocity `ω = R I⁻¹ Rᵀ L` is
//! computed from these and never stored. So in free flight `L` is the same to the bit for any rotation, and an
//! impulse `p` at `r` adds `r × p`.
//!
//! [`Flight`] is the trajectory of a rotation over some time. [`Inertia`](crate::Inertia) gives the principal axes of a
//! shape.

pub(crate) mod chart;
mod flight;
mod rotor;
mod series;

pub use flight::{Bounds, Flight, FlightError, Pose, spin};
pub(crate) use rotor::{Coordinates, Rotor, into_body};
