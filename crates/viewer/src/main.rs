//! `cowbell`: simulates colliding triangle meshes, in a window or without one.

use std::process::ExitCode;

fn main() -> ExitCode {
    viewer::cli::main()
}
