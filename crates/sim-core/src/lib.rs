//! Rigid triangle meshes, and spheres and half-spaces, that move and collide.
//!
//! `no_std` with `alloc`, no I/O, no clock, no threads but with feature `rayon`; `unsafe` only around vector instructions
//! and a stack that is not zeroed. Quantities are in SI units. State is `f64`, geometry `f32`;
//! decisions about geometry are exact.
//!
//! # A step, in the order in which it happens
//!
//! 1. [`FixedStep`] turns the time since the last frame into whole steps of `dt`.
//! 2. [`World::step`] keeps the state as the previous one and moves every [`Body`] under its
//!    [`Force`]s by a [`Method`] of the table [`METHODS`], or by one of your own.
//! 3. With [`Collision::Continuous`], the default, each pair whose swept boxes meet is asked when it
//!    has its first impact on its way: [`collide::touch`] finds it exactly for meshes that
//!    translate, with the feature that touches and its normal. The earliest is answered
//!    ([`impulse::between`], [`impulse::reflect`] where several happen at once), the two go on with
//!    the rest of the step, and so on until none is left.
//!    With [`Collision::Bvh`] and [`Collision::Naive`], as in the course, bodies that meet at the end
//!    of the step exchange an impulse and go back to where it began.
//! 4. Whether two meshes meet, [`collide::naive`] finds by every edge against every triangle,
//!    [`collide::tree`] through a [`Bvh`] of each. Both rest on the exact [`collide::predicates`]
//!    and always agree. No two surfaces are left crossing at the end of a step.
//!    Bodies that are put into each other are no error: [`World::overlaps`] tells how deep they are,
//!    they are kept from getting deeper, and [`World::separate`] moves them apart.
//! 5. What comes to rest on something stays in contact with it, from step to step
//!    ([`World::contacts`], [`World::contact_features`]): forces press, friction
//!    ([`Body::friction`]) slows and holds, and what lies still sleeps. Where many contacts of a heap
//!    come and go within a step, they are solved at once, and [`World::bundled`] tells what that costs.
//! 6. [`World::impacts`] counts impacts, [`World::step_reporting`] lists them, and
//!    [`World::interpolated`] gives positions between the last two states to draw;
//!    [`World::contact_events`] tells who has begun and ended to touch whom, and by what impulse.
//!
//! Between steps, and without a world, module [`query`] answers questions about shapes: do they meet, how far
//! apart are they, when do they hit, what does a ray hit? [`World::cast_ray`] and its like ask all bodies.
//!
//! ```
//! use core::time::Duration;
//! use std::sync::Arc;
//! use sim_core::{Body, DVec3, FixedStep, Mesh, Settings, Shape, Vec3, World};
//!
//! let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let shape = Some(Shape::Mesh(Arc::new(Mesh::new(corners, faces)?)));
//!
//! let mut world = World::new(Settings::default())?;
//! let position = DVec3::new(-3.0, 0.0, 0.0);
//! world.add(Body { shape: shape.clone(), ..Body::default() })?;
//! world.add(Body { shape, position, velocity: -position, ..Body::default() })?;
//!
//! let mut clock = FixedStep::new(world.settings().dt, Duration::from_millis(250))?;
//! for _frame in 0..100 {
//!     clock.advance(Duration::from_millis(20));
//!     while clock.take() {
//!         world.step()?;
//!     }
//! }
//! assert_eq!(world.impacts(), 1);
//! assert!((world.kinetic_energy() - 4.5).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Without bodies: a [`Stepper`] lets any method step any [`System`] `x'' = a(t, x, v)`, and
//! [`Dopri5`] and [`Dop853`] solve `y' = f(t, y)` to a tolerance.
//!
//! # Bodies
//!
//! A body is dynamic, kinematic or static ([`BodyKind`]); groups and pairs tell who collides with whom
//! ([`Groups`], [`World::ignore_pair`]). [`World::bodies`] shows all of each ([`BodyView`]).
//! Bodies are named by index; where some are removed ([`World::remove`]) a [`BodyHandle`] goes on
//! naming the same one.
//!
//! # Features
//!
//! | Feature | What it brings |
//! |---|---|
//! | `std` | Asks the processor at run time for wider vectors than the crate was compiled for. |
//! | `rayon` | Seeks impacts on many threads; the same bits at any number of them. Needs `std`. |
//! | `serde` | Writes and reads [`Body`], [`Settings`], [`Mesh`], [`Force`] and a whole [`World`], which goes on to the bit. |
//!
//! None is on by default. None changes a result.
//!
//! # Limits
//!
//! - Bodies turn where they have a [`Turn`], without friction. Methods turn them at their own order where forces act at
//!   points of them, and exactly else; there methods that are not symplectic refuse a step of half a turn. In contact they are pushed by forces that are constant
//!   for what is left of a step or a part of it: what slides on its faces is exact, what tips or spins there loses
//!   energy to second order. What touches too often in a step stands still for the rest of it. Turning
//!   bodies that are put into each other pass through each other until they are apart.
//! - Ways that bend under forces are searched along chords. A graze shallower than a thousandth of
//!   the smaller body may be missed within a step; never an overlap at its end.
//! - In a heap whose contacts are solved at once, contacts close ahead of their time by up to a step,
//!   flights of less than a step are none, and friction acts at the step's start: errors that shrink
//!   with the step.
//! - In the discrete modes a body that is through another within one step is not seen, and one that
//!   is put back loses the rest of its step. Under a force the work done in that step stays in its
//!   velocity: a bouncing body keeps its height under symplectic and backward Euler, and gains some
//!   at each bounce under forward Euler and RK4.
//! - Where several faces touch at a corner at once, one of them gives the normal.
#![no_std]
#![deny(unsafe_code)]

extern crate alloc;
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
#[cfg(any(test, feature = "std"))]
extern crate std;

mod aabb;
mod body;
pub mod bvh;
mod clock;
pub mod collide;
mod expansion;
mod force;
pub mod impulse;
mod inertia;
mod integrate;
mod measure;
mod mesh;
pub mod ode;
mod pieces;
pub mod query;
pub mod rotation;
#[cfg(feature = "serde")]
mod serde_number;
mod shape;
#[cfg(test)]
mod test_meshes;
#[cfg(test)]
mod test_random;
mod world;

pub use aabb::Aabb;
pub use body::{Body, BodyKind, Turn};
pub use bvh::{Bvh, RayHit};
pub use clock::{ClockError, FixedStep};
pub use collide::Feature;
pub use force::{BodyLaw, BodyMotion, Force, ForceError, Law, PairLaw, PairMotion};
pub use glam::{DMat3, DQuat, DVec3, Vec3};
pub use inertia::{Inertia, InertiaError, Solid};
pub use integrate::{
    Ask, Failure, Jacobians, METHODS, Method, Scratch, Step, Stepper, System, Watch,
};
pub use mesh::{Mesh, MeshError, Repairs};
pub use ode::{Dop853, Dopri5, SolveError, Tolerance};
pub(crate) use shape::Extent;
pub use shape::Shape;
pub use world::{
    BodyHandle, BodyView, Bundled, Collision, ContactEvent, ContactEventKind, ContactFeature,
    Groups, Impact, Overlap, Phase, Profile, RestingContact, SeparateError, Settings, StepError,
    Touching, World, WorldError,
};
