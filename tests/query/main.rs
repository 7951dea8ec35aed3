//! Questions about shapes and worlds, against slower ways to the same answers.

mod distance;
mod events;
mod oracle;
mod world;
