//! The program `cowbell`: the window with its control panel and pictures, and the same runs without a display.
//!
//! [`cli`] reads the command line and calls one of [`app`] (the window), [`headless`] (runs and checks as text) and
//! [`shot`] (one picture in a file). All of them use a [`session`], which depends on neither windows nor graphics. It
//! describes the scene as a [`picture`], which [`render`] draws. [`ui`] is the control panel around it, and a
//! [`worker`] takes the steps.

pub mod app;
pub mod camera;
pub mod canvas;
pub mod cli;
pub mod errors;
pub mod expression;
pub mod failure;
pub mod film;
pub mod gpu;
pub mod headless;
pub mod interrupt;
pub mod number;
pub mod picture;
pub mod preferences;
pub mod render;
pub mod reopening;
pub mod rescue;
pub mod session;
pub mod shot;
pub mod soak;
pub mod stopwatch;
pub mod ui;
pub mod watch;
pub mod words;
pub mod worker;
