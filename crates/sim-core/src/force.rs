//! Forces on bodies, as data.
//!
//! Every force except [`Force::Gravity`] is a law of one of two kinds. A [`BodyLaw`] depends on the motion of one
//! body. A [`PairLaw`] depends on the relative motion of two bodies and acts on them with opposite signs, so that
//! momentum is conserved. Both have analytic Jacobians, for implicit methods, and an energy if they have a potential.
//! A law from outside is a type that implements one of the traits; so is a built-in one, in a file of its own, which
//! `law.rs` knows. [`FORCES`] has one force of each kind, and [`Force::fields`] shows its fields with units and ranges:
//! scene files and panels are made from these.

mod anchor;
mod attraction;
mod described;
mod gravitation;
mod gravity;
mod law;
mod linear_drag;
mod outside;
mod push;
mod quadratic_drag;
mod spring;
#[cfg(test)]
mod tests;
mod vectors;

use alloc::sync::Arc;
use core::fmt::Debug;
use glam::DVec3;

use crate::Jacobians;
pub use described::{Description, Field, Nature, Tie, Value};
pub(crate) use law::Reach;

/// The forces that scene files can contain and panels offer, one of each kind.
pub static FORCES: [Force; 8] = [
    gravity::START,
    linear_drag::START,
    quadratic_drag::START,
    anchor::START,
    spring::START,
    push::START,
    attraction::START,
    gravitation::START,
];

/// A force of a world.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "kebab-case")
)]
pub enum Force {
    /// Weight: every body falls with the same acceleration.
    Gravity {
        /// The acceleration, m/s².
        acceleration: DVec3,
    },
    /// Stokes' drag, `F = -c v`.
    LinearDrag {
        /// The body on which it acts; `None` for every body.
        body: Option<usize>,
        /// `c`, kg/s, from 0.
        coefficient: f64,
    },
    /// Newton's drag, `F = -c |v| v`.
    QuadraticDrag {
        /// The body on which it acts; `None` for every body.
        body: Option<usize>,
        /// `c`, kg/m, from 0.
        coefficient: f64,
    },
    /// A spring and a damper between a body and a fixed point, `F = -k (1 - L/|d|) d - c v` with `d` from the anchor
    /// to the body. The damper opposes motion in every direction. With `L > 0` there is no spring force on a body
    /// exactly at the anchor.
    Anchor {
        /// The body on which it acts.
        body: usize,
        /// The attached point of the body, in the frame of its shape, m; `None` for its position. A force at a point
        /// rotates a turning body.
        #[cfg_attr(feature = "serde", serde(default))]
        point: Option<DVec3>,
        /// The fixed point, m.
        anchor: DVec3,
        /// Rest length `L`, m, from 0.
        rest_length: f64,
        /// `k`, N/m, from 0.
        stiffness: f64,
        /// `c`, kg/s, from 0.
        damping: f64,
    },
    /// A spring and a damper between two bodies, along the line through them: `F = (k (|d| - L) + c n·w) n` on the
    /// first, with `d = |d| n` and `w` the position and velocity of the second relative to the first.
    Spring {
        /// The bodies, two different ones.
        bodies: [usize; 2],
        /// The attached points of both, each in the frame of its body's shape, m; `None` for their positions.
        #[cfg_attr(feature = "serde", serde(default))]
        points: Option<[DVec3; 2]>,
        /// Rest length `L`, m, from 0.
        rest_length: f64,
        /// `k`, N/m, from 0.
        stiffness: f64,
        /// `c`, kg/s, from 0.
        damping: f64,
    },
    /// A constant force at a point of a body; it rotates a turning body. With this force alone a free body is a heavy
    /// top about its centre of mass.
    Push {
        /// The body on which it acts.
        body: usize,
        /// The point, in the frame of the body's shape, m.
        point: DVec3,
        /// The force in the world, N.
        force: DVec3,
    },
    /// Attraction to a fixed point, as by a large mass there, `F = -m μ d / |d|³`.
    Attraction {
        /// The body on which it acts; `None` for every body.
        body: Option<usize>,
        /// The point, m.
        centre: DVec3,
        /// `μ = G M`, m³/s², from 0.
        strength: f64,
    },
    /// Newton's gravitation between all bodies, `F = G m₁ m₂ d / |d|³`.
    Gravitation {
        /// `G`, m³/(kg s²), from 0.
        constant: f64,
    },
    /// An external law of one body's motion. It is code: `serde` refuses it.
    #[cfg_attr(feature = "serde", serde(skip))]
    Body {
        /// The body on which it acts; `None` for every body.
        body: Option<usize>,
        /// The law.
        law: Law<dyn BodyLaw>,
    },
    /// An external law of two bodies' relative motion. It is code: `serde` refuses it.
    #[cfg_attr(feature = "serde", serde(skip))]
    Pair {
        /// The bodies on which it acts, two different ones; `None` for every two.
        bodies: Option<[usize; 2]>,
        /// The law.
        law: Law<dyn PairLaw>,
    },
}

/// The motion of one body, as input of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion {
    /// Time, s.
    pub time: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Position, m.
    pub position: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
}

/// The relative motion of two bodies, as input of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairMotion {
    /// Time, s.
    pub time: f64,
    /// Masses, kg; infinite for a body that is not dynamic.
    pub mass: [f64; 2],
    /// The vector from the first to the second, m.
    pub position: DVec3,
    /// Velocity of the second relative to the first, m/s.
    pub velocity: DVec3,
}

/// A force on one body.
///
/// ```
/// use sim_core::{Body, BodyLaw, BodyMotion, DVec3, Force, Law, Settings, World};
///
/// /// A wind that blows along x, stronger with height.
/// #[derive(Debug)]
/// struct Wind(f64);
///
/// impl BodyLaw for Wind {
///     fn force(&self, at: &BodyMotion) -> DVec3 {
///         self.0 * at.position.y * DVec3::X - 0.1 * at.velocity
///     }
/// }
///
/// let mut world = World::new(Settings::default())?;
/// world.add(Body { position: DVec3::Y, ..Body::default() })?;
/// world.add_force(Force::Body { body: None, law: Law::new(Wind(2.0)) })?;
/// world.step()?;
/// assert!(world.velocity(0).x > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait BodyLaw: Debug + Send + Sync {
    /// The force, N.
    fn force(&self, at: &BodyMotion) -> DVec3;

    /// The derivatives of the force with respect to the body's position and velocity, N/m and kg/s. The default uses
    /// central differences, correct to about ten digits.
    fn jacobians(&self, at: &BodyMotion) -> Jacobians {
        vectors::differences(at.position, at.velocity, |position, velocity| {
            self.force(&BodyMotion {
                position,
                velocity,
                ..*at
            })
        })
    }

    /// Potential energy, J, if the force has a potential.
    fn potential(&self, _at: &BodyMotion) -> Option<f64> {
        None
    }
}

/// A force between two bodies.
pub trait PairLaw: Debug + Send + Sync {
    /// The force on the first body, N; the force on the second one is the opposite.
    fn force(&self, at: &PairMotion) -> DVec3;

    /// The derivatives of the force with respect to the relative position and velocity, N/m and kg/s. The default
    /// uses central differences, correct to about ten digits.
    fn jacobians(&self, at: &PairMotion) -> Jacobians {
        vectors::differences(at.position, at.velocity, |position, velocity| {
            self.force(&PairMotion {
                position,
                velocity,
                ..*at
            })
        })
    }

    /// Potential energy, J, if the force has a potential.
    fn potential(&self, _at: &PairMotion) -> Option<f64> {
        None
    }
}

/// An external law, shared. Two laws are equal if they are the same object.
#[derive(Debug)]
pub struct Law<T: ?Sized>(pub Arc<T>);

impl<T: ?Sized> Clone for Law<T> {
    fn clone(&self) -> Law<T> {
        Law(self.0.clone())
    }
}

impl<T: ?Sized> PartialEq for Law<T> {
    fn eq(&self, other: &Law<T>) -> bool {
        core::ptr::addr_eq(Arc::as_ptr(&self.0), Arc::as_ptr(&other.0))
    }
}

impl Law<dyn BodyLaw> {
    /// A law of one body.
    pub fn new(law: impl BodyLaw + 'static) -> Law<dyn BodyLaw> {
        Law(Arc::new(law))
    }
}

impl Law<dyn PairLaw> {
    /// A law of two bodies.
    pub fn of_pair(law: impl PairLaw + 'static) -> Law<dyn PairLaw> {
        Law(Arc::new(law))
    }
}

impl Force {
    /// Name of its kind, as in scene files.
    pub fn kind(&self) -> &'static str {
        self.description().kind
    }

    /// The bodies that the force names; it may act on others too.
    pub fn bodies(&self) -> impl Iterator<Item = usize> + use<> {
        let [first, second] = match self.reach() {
            Reach::Body(body) => [Some(body), None],
            Reach::Pair(bodies) => bodies.map(Some),
            Reach::Weight | Reach::EachBody | Reach::EachPair => [None, None],
        };
        first.into_iter().chain(second)
    }

    /// The same force on other bodies: `renumber` gives the new index of each body that it names. `None` if
    /// `renumber` gives none.
    pub fn renumbered(mut self, renumber: impl Fn(usize) -> Option<usize>) -> Option<Force> {
        let mut is_left = true;
        self.fields(|mut field| {
            for body in field.value.bodies() {
                match renumber(*body) {
                    Some(new) => *body = new,
                    None => is_left = false,
                }
            }
        });
        is_left.then_some(self)
    }

    /// Whether it acts at points other than positions.
    pub(crate) fn has_points(&self) -> bool {
        self.point().is_some() || self.points().is_some()
    }

    /// Checks all numbers; the error names the field of the first one that is out of range.
    pub fn check(&self) -> Result<(), ForceError> {
        let mut checked = Ok(());
        self.seen(&mut |field| {
            if checked.is_ok() {
                checked = field.check();
            }
        });
        checked?;
        match self.reach() {
            Reach::Pair([first, second]) if first == second => {
                Err(ForceError::SameBody { body: first })
            }
            Reach::Weight | Reach::Body(_) | Reach::EachBody | Reach::Pair(_) | Reach::EachPair => {
                Ok(())
            }
        }
    }
}

/// A number or a pair of bodies that a force cannot have.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ForceError {
    /// A number that is negative, NaN or huge.
    #[error("{field} is {value}: it must be between 0 and 1e100")]
    Number {
        /// Which field.
        field: &'static str,
        /// The value refused.
        value: f64,
    },
    /// A number of either sign that is NaN or huge.
    #[error("{field} is {value}: it must be a number within ±1e100")]
    Signed {
        /// Which field.
        field: &'static str,
        /// The value refused.
        value: f64,
    },
    /// A vector with a component that is NaN, infinite or huge.
    #[error("{field} is {value}: every component must be a number within ±1e100")]
    Vector {
        /// Which field.
        field: &'static str,
        /// The value refused.
        value: DVec3,
    },
    /// A pair of a body and itself.
    #[error("bodies are {body} and {body}: they must be two different ones")]
    SameBody {
        /// The body.
        body: usize,
    },
}

impl ForceError {
    /// The name of the invalid field.
    pub fn field(&self) -> &'static str {
        match self {
            ForceError::Number { field, .. }
            | ForceError::Signed { field, .. }
            | ForceError::Vector { field, .. } => field,
            ForceError::SameBody { .. } => "bodies",
        }
    }
}
