//! The errors of scenes.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::gallery::SCENES;
use crate::{MeshFileError, shown};

/// The reason why there is no scene, or no world made from it. The message names the file, line, body and field as far
/// as they are known, and the remedy.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The name is neither a gallery scene nor a scene file.
    #[error(
        "there is no scene `{}`: give the path of a .toml file, of a mesh, or one of {}",
        shown::name(name),
        gallery()
    )]
    Unknown {
        /// The name or path that the user gave.
        name: String,
    },
    /// The mesh file that was given as a scene cannot be loaded.
    #[error(transparent)]
    Mesh(Box<MeshFileError>),
    /// The scene file cannot be read.
    #[error("{}: cannot read the scene file: {error}", shown::path(path))]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
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
        /// Its size, bytes.
        bytes: u64,
        /// The largest size that is read, bytes.
        most: u64,
    },
    /// The scene file cannot be written.
    #[error("{}: cannot write the scene file: {error}", shown::path(path))]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
    /// The scene file has an error.
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
        /// The error and its remedy.
        what: String,
    },
    /// The scene was changed in memory, and no world can be made from it.
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
        /// The error and its remedy.
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
