//! Continuous collisions against exact outcomes: what is beside the hard cases of `cases`, to whose
//! verdicts `crates/cases/tests/verdicts.rs` holds them.
//!
//! Tolerances are those that doubles allow, written as formulas: `ULP` is the distance from 1 to
//! the next double, 2u. Positions are sums over steps, so that a rounding a step is granted where
//! they are compared with closed forms.

mod balls;
mod centres;
mod chains;
mod crowds;
mod extents;
mod forces;
mod grazing;
mod meshes;
mod overlap;
mod pairs;
mod random;
mod symmetry;
mod worlds;
