//! Numbers, shapes, bodies, worlds and oracles that tests, cases and benchmarks share.

pub mod agree;
pub mod bodies;
pub mod cases;
pub mod elliptic;
mod hostile;
pub mod inputs;
pub mod meshes;
pub mod oracle;
pub mod random;
pub mod rational;
pub mod shapes;
pub mod worlds;
