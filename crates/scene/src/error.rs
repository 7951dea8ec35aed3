//! What can be wrong with a scene.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::gallery::SCENES;
use crate::{MeshFileError, shown};

/// Why there is no scene, or no world from it. The message names file, line, body and field as
/// far as they are known, and the remedy.
#[derive(Debug, Error)]
pub enum SceneError {
    /// Neither a gallery scene nor a scene file.
    #[error(
        "there is no scene `{}`: give the path of a .toml file, of a mesh, or one of {}",
        shown::name(name),
        gallery()
    )]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// The mesh file that was to be a scene of its own is refused.
    #[error(transparent)]
    Mesh(Box<MeshFileError>),
    /// The scene file cannot be read.
    #[error("{}: cannot read the scene file: {error}", shown::path(path))]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        error: io::Error,
    },
    /// The file is larger than any sensible scene.
    #[error(
        "{}: the scene file has {bytes} bytes or more: the most is {most}",
        shown::path(path)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
        /// The most that is read.
        most: u64,
    },
    /// The scene file cannot be written.
    #[error("{}: cannot write the scene file: {error}", shown::path(path))]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        error: io::Error,
    },
    /// The scene file says something wrong.
    #[error(
        "{}{}: {}{}",
        shown::path(file), line_suffix(*line), subject(body, field), shown::part(what)
    )]
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
    #[error(
        "scene `{}`: {}{}",
        shown::name(scene),
        subject(body, field),
        shown::part(what)
    )]
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
    let body = body.as_deref().map(shown::name);
    let field = field.as_deref().map(shown::name);
    match (body, field) {
        (Some(body), Some(field)) => format!("body `{body}`, {field}: "),
        (Some(body), None) => format!("body `{body}`: "),
        (None, Some(field)) => format!("{field}: "),
        (None, None) => String::new(),
    }
}
