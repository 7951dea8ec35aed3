//! Cases with a known outcome, each defined once: problems of dynamics, hard cases, and scenes of bodies that collide,
//! rest, slide and rotate; and the engines and solvers that are tried on them, ours and peers.
//!
//! Tests assert every verdict, the report tabulates the same verdicts, benchmarks time the cases. The peers are
//! optional dependencies, each a feature of its name.

pub mod drift;
pub mod hard_cases;
pub mod problems;
pub mod scenes;
pub mod solvers;
pub mod turning;
pub mod worlds;

pub use hard_cases::{CASES, Case, Finding, Outcome, Verdict};
