//! Random scenes of the kinds in which contact is lost or never ends: bodies in touch, on the border
//! of a step, in the plane of each other's faces.
//!
//! Each kind has a closed form, or what every motion must keep: no two bodies meet after a step,
//! energy does not grow, momentum stays, and a step has a bounded number of impacts. `CASES` sets how
//! many scenes of each kind are tried, `FIRST` with which to begin.

mod falling;
mod lattices;
mod points;
mod rows;
mod scenes;
mod shapes;
mod sheets;
mod slides;
mod stacks;
mod stars;
