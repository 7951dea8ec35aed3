//! Bodies in each other: how deep they are, that they get no deeper, and that they can be moved apart.

mod depth;
mod features;
mod held;
mod separate;
mod shapes;
