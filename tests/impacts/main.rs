//! Continuous collisions against exact outcomes, in addition to the hard cases of `cases`, whose verdicts
//! `crates/cases/tests/verdicts.rs` checks.
//!
//! Tolerances are the rounding errors of doubles, written as formulas: `ULP` is the distance from 1 to the next double,
//! 2u. Positions are sums over steps, so one rounding per step is allowed when they are compared with closed forms.

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
