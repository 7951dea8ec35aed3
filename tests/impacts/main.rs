//! Continuous collisions against exact outcomes: hard cases of impacts.
//!
//! Tolerances are those that doubles allow, written as formulas: `ULP` is the distance from 1 to
//! the next double, 2u. Positions are sums over steps, so that a rounding a step is granted where
//! they are compared with closed forms.

mod balls;
mod centres;
mod chains;
mod crowds;
mod discrete;
mod extents;
mod forces;
mod grazing;
mod meshes;
mod overlap;
mod pairs;
mod random;
mod shapes;
mod symmetry;
mod worlds;
