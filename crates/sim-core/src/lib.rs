//! Rigid triangle meshes that move and collide.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod aabb;
mod body;
pub mod bvh;
mod clock;
pub mod collide;
pub mod impulse;
mod integrate;
mod measure;
mod mesh;
#[cfg(test)]
mod test_meshes;
mod world;

pub use aabb::Aabb;
pub use body::Body;
pub use bvh::{Bvh, RayHit};
pub use clock::{ClockError, FixedStep};
pub use glam::{DQuat, DVec3, Vec3};
pub use integrate::{METHODS, Method};
pub use mesh::{Mesh, MeshError, Repairs};
pub use world::{Collision, Impact, Settings, StepError, World, WorldError};
