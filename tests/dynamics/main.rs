//! Worlds under forces against exact solutions, in addition to the hard cases of `cases`, whose verdicts
//! `crates/cases/tests/verdicts.rs` checks for every method.

mod blow_ups;
mod forces;
mod oscillators;
mod planets;
mod refused;
mod worlds;
