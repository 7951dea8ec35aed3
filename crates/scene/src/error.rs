//! What can be wrong with a scene.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::gallery::SCENES;

/// Why there is no scene, or no world from it. The message names file, line, body and field as
/// far as they are known, and the remedy.
#[derive(Debug, Error)]
pub enum SceneError {
    /// Neither a gallery scene nor a scene file.
    #[error(
        "there is no scene `{name}`: give the path of a .toml file or one of {}",
        gallery()
    )]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// The scene file cannot be read.
    #[error("{}: cannot read the scene file: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        error: io::Error,
    },
    /// The scene file cannot be written.
    #[error("{}: cannot write the scene file: {error}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        error: io::Error,
    },
    /// The scene file says something wrong.
    #[error("{}{}: {}{what}", file.display(), line_suffix(*line), subject(body, field))]
    Content {
        /// The file, or the name of a gallery scene.
        file: PathBuf,
        /// Line from 1.
        line: Option<usize>,
        /// Name of the body.
        body: Option<String>,
        /// Name of the field.
        field: Option<String>,
        /// What is wrong and what to do about it.
        what: String,
    },
    /// The scene, changed in memory, makes no world.
    #[error("scene `{scene}`: {}{what}", subject(body, field))]
    World {
        /// Name of the scene.
        scene: String,
        /// Name of the body.
        body: Option<String>,
        /// Name of the field.
        field: Option<String>,
        /// What is wrong and what to do about it.
        what: String,
    },
}

fn gallery() -> String {
    let names: Vec<&str> = SCENES.iter().map(|scene| scene.name).collect();
    names.join(", ")
}

fn line_suffix(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(":{line}"))
}

fn subject(body: &Option<String>, field: &Option<String>) -> String {
    match (body, field) {
        (Some(body), Some(field)) => format!("body `{body}`, {field}: "),
        (Some(body), None) => format!("body `{body}`: "),
        (None, Some(field)) => format!("{field}: "),
        (None, None) => String::new(),
    }
}
