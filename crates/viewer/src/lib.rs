//! The window on a world: what is drawn, from where, and how.

pub mod camera;
pub mod picture;
pub mod render;
