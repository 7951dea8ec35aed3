//! Bodies that rest, slide, rub, stack and form heaps: persisting contacts, against closed forms, and without overlap
//! or spurious gain of energy.

mod bowls;
mod curved;
mod friction;
mod heaps;
mod hollows;
mod level;
mod meshes;
mod scenes;
