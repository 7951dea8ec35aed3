//! What lies, slides, rubs, stacks and heaps: contacts that last, against closed forms, and without
//! overlap or gain of energy where there is none.

mod friction;
mod heaps;
mod scenes;
