//! Random scenes in which contacts are easily missed or never end: bodies in contact, at the boundary of a step, in the
//! plane of each other's faces.
//!
//! Each kind has a closed form, or is tested for the invariants of every motion: no two bodies meet after a step,
//! energy does not grow, momentum is conserved, and a step has a bounded number of impacts. `CASES` sets the number of
//! scenes of each kind, `FIRST` the first one.

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
