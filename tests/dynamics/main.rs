//! Worlds under forces against exact solutions: what is beside the hard cases of `cases`, to whose
//! verdicts `crates/cases/tests/verdicts.rs` holds every method.

mod blow_ups;
mod forces;
mod oscillators;
mod planets;
mod refused;
mod worlds;
