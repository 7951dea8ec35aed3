//! Bodies that turn: how a rotation goes on by itself, and under a torque.
//!
//! The state of a rotation is a unit quaternion `q`, which turns a body's principal axes into the
//! world, and the angular momentum `L` about the centre of mass in the world, kg m²/s. The angular
//! velocity `ω = R I⁻¹ Rᵀ L` is a function of these and never a second truth. So in free flight `L` is
//! the same to the bit whatever the rotation does, and an impulse `p` at `r` adds `r × p`.
//!
//! [`Flight`] is the way of a rotation for some time. [`Inertia`](crate::Inertia) tells where the
//! principal axes lie in a shape.

pub(crate) mod chart;
mod flight;
mod rotor;
mod series;

pub use flight::{Bounds, Flight, FlightError, Pose, spin};
pub(crate) use rotor::{Coordinates, Rotor, into_body};
