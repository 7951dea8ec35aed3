//! Rigid triangle meshes, spheres and half-spaces that move and collide.
//!
//! The crate is `no_std` with `alloc`. It has no I/O and no clock, and threads only with the feature `rayon`.
//! `unsafe` is used only for vector instructions and for a stack that is not zeroed. Quantities are in SI units. The
//! state is `f64`, geometry is `f32`, and decisions about geometry are exact.
//!
//! # A step, in the order in which it happens
//!
//! 1. [`FixedStep`] turns the time since the last frame into whole steps of `dt`.
//! 2. [`World::step`] keeps the state as the previous one and moves every [`Body`] under its
//!    [`Force`]s by a [`Method`] of the table [`METHODS`], or by one of your own.
//! 3. With [`Collision::Continuous`], the default, the broad phase finds the pairs whose swept boxes meet, and the
//!    impact search finds the first time of impact of each pair on their trajectories. For meshes that translate,
//!    [`collide::touch`] finds it exactly, with the feature that touches and its normal. The step resolves the earliest
//!    impact ([`impulse::between`], or [`impulse::reflect`] for several at the same time), both bodies continue for the
//!    rest of the step, and so on until no impact is left.
//!    With [`Collision::Bvh`] and [`Collision::Naive`], the discrete modes of the course, bodies that meet at the end
//!    of the step exchange an impulse and go back to where the step began.
//! 4. [`collide::naive`] decides whether two meshes meet by testing every edge against every triangle,
//!    [`collide::tree`] by a [`Bvh`] of each mesh. Both use the exact [`collide::predicates`]
//!    and always agree. No step ends with two surfaces crossing.
//!    Bodies may be placed in overlap: [`World::overlaps`] reports their depth,
//!    the step keeps them from getting deeper, and [`World::separate`] moves them apart.
//! 5. A body that comes to rest on another stays in contact with it from step to step
//!    ([`World::contacts`], [`World::contact_features`]): contact forces press on both, friction
//!    ([`Body::friction`]) slows and holds them, and bodies that lie still sleep. If many contacts of a heap
//!    begin and end within a step, they are solved at once, and [`World::bundled`] reports the error of this.
//! 6. [`World::impacts`] counts impacts, [`World::step_reporting`] lists them, and
//!    [`World::interpolated`] gives positions between the last two states, for drawing.
//!    [`World::contact_events`] lists the contacts that begin, persist and end, with their impulses.
//!
//! The module [`query`] answers queries about shapes without a world: do they meet, how far apart are they, when do
//! they hit (a shape cast), what does a ray hit? [`World::cast_ray`] and its like answer them for all bodies of a
//! world, between steps.
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
//! Two parts need no bodies: a [`Stepper`] lets any method step any [`System`] `x'' = a(t, x, v)`, and
//! [`Dopri5`] and [`Dop853`] solve `y' = f(t, y)` to a tolerance.
//!
//! # Bodies
//!
//! A body is dynamic, kinematic or static ([`BodyKind`]). Collision groups and ignored pairs select which bodies
//! collide ([`Groups`], [`World::ignore_pair`]). [`World::bodies`] gives all that a world knows of each body
//! ([`BodyView`]). Bodies are named by index. [`World::remove`] changes indices; a [`BodyHandle`] names the same body
//! before and after.
//!
//! # Features
//!
//! | Feature | What it brings |
//! |---|---|
//! | `std` | Asks the processor at run time for wider vectors than the crate was compiled for. |
//! | `rayon` | Searches for impacts on many threads, with the same bits at any number of threads. Needs `std`. |
//! | `serde` | Writes and reads [`Body`], [`Settings`], [`Mesh`], [`Force`] and a whole [`World`], which continues to the same bits. |
//!
//! No feature is on by default. No feature changes a result.
//!
//! # Limits
//!
//! - A body rotates only if it has a [`Turn`], and then has no friction. Methods integrate a rotation at their own
//!   order if forces act at points of the body, and exactly otherwise; in the first case methods that are not
//!   symplectic refuse a step of half a turn. In contact, turning bodies are pushed by forces that are constant for
//!   the rest of a step or a part of it: a body that slides on its faces moves exactly, a body that tips or spins in
//!   contact loses energy to second order. A body that touches others too often in a step stands still for the rest
//!   of it. Turning bodies that are placed in overlap pass through each other until they are apart.
//! - The impact search follows trajectories that curve under forces along chords, and certificates prove that bodies
//!   stay apart between them. For a pair that is already in contact it may miss a graze elsewhere on the two bodies
//!   that is shallower than a thousandth of the smaller one within a step, but never an overlap at the end of the step.
//! - In a heap whose contacts are solved at once, contacts close ahead of their time by up to a step, there are no
//!   flights shorter than a step, and friction acts at the start of the step. These errors shrink with the step.
//! - The discrete modes do not see a body that tunnels through another within one step, and a body that is put back
//!   loses the rest of its step. Under a force the work of that step stays in its velocity: a bouncing body keeps its
//!   height under symplectic and backward Euler, and gains some at each bounce under forward Euler and RK4.
//! - If several faces touch at a corner at once, one of them gives the normal.
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
pub mod force;
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
pub use force::{BodyLaw, BodyMotion, FORCES, Force, ForceError, Law, PairLaw, PairMotion};
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
