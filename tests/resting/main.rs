//! What lies, slides, rubs, stacks and heaps: contacts that last, against closed forms, and without
//! overlap or gain of energy where there is none.

mod bowls;
mod curved;
mod friction;
mod heaps;
mod hollows;
mod level;
mod meshes;
mod scenes;
