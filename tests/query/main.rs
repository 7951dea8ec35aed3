//! Queries about shapes and worlds, against slower methods.

mod distance;
mod events;
mod oracle;
mod world;
