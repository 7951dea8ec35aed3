//! Mesh files: one entry of [`FORMATS`] per file format, and the meshes that come built in.

mod builtin;
mod collada;
mod obj;
mod polygon;
mod soup;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sim_core::{Mesh, MeshError, Repairs};
use thiserror::Error;

pub use builtin::{BUILTIN_MESHES, builtin};
pub use soup::{ReadError, Soup};

/// The mesh file formats that can be read.
pub static FORMATS: &[Format] = &[obj::FORMAT, collada::FORMAT];

/// The largest file that is read, in bytes.
const MAX_BYTES: u64 = 1 << 30;

/// A mesh file format.
#[derive(Debug)]
pub struct Format {
    /// Short name, such as `obj`.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// File name extensions in lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// Reads the bytes of a whole file; opens no other file.
    pub read: fn(&[u8]) -> Result<Soup, ReadError>,
}

impl Format {
    /// The format of a path by its extension, upper or lower case.
    pub fn of(path: &Path) -> Result<&'static Format, MeshFileError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        FORMATS
            .iter()
            .find(|format| {
                let mut known = format.extensions.iter();
                known.any(|known| extension.eq_ignore_ascii_case(known))
            })
            .ok_or_else(|| MeshFileError::UnknownFormat {
                path: path.to_owned(),
            })
    }
}

/// A mesh from a file, and what the file had that a mesh must not have.
#[derive(Debug)]
pub struct LoadedMesh {
    /// Name of the format in [`FORMATS`].
    pub format: &'static str,
    /// The mesh in metres, y up.
    pub mesh: Mesh,
    /// What was mended on the way.
    pub repairs: Repairs,
}

/// Why a mesh file gives no mesh.
#[derive(Debug, Error)]
pub enum MeshFileError {
    /// The extension belongs to no format.
    #[error("{}: not a known kind of mesh file: the extension must be {}", path.display(), extensions())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read at all.
    #[error("{}: cannot read the mesh file: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        error: io::Error,
    },
    /// The file is larger than any sensible mesh.
    #[error("{}: the mesh file has {bytes} bytes: the most is {MAX_BYTES}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// The contents are not what the format asks for.
    #[error("{}: {}", place(path, error.line), error.what)]
    Content {
        /// The file.
        path: PathBuf,
        /// Line and explanation.
        error: ReadError,
    },
    /// The triangles make no mesh.
    #[error("{}: {error}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        error: MeshError,
    },
}

fn place(path: &Path, line: Option<usize>) -> String {
    match line {
        Some(line) => format!("{}:{line}", path.display()),
        None => path.display().to_string(),
    }
}

fn extensions() -> String {
    let known = FORMATS.iter().flat_map(|format| format.extensions);
    let known: Vec<String> = known.map(|extension| format!(".{extension}")).collect();
    known.join(" or ")
}

/// Reads a mesh file. The extension tells the format; no other file is opened.
pub fn load(path: &Path) -> Result<LoadedMesh, MeshFileError> {
    let format = Format::of(path)?;
    let io = |error| MeshFileError::Io {
        path: path.to_owned(),
        error,
    };
    // Reading a pipe or a device could take for ever.
    let metadata = fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        return Err(io(io::Error::other("it is not a regular file")));
    }
    if metadata.len() > MAX_BYTES {
        return Err(MeshFileError::TooLarge {
            path: path.to_owned(),
            bytes: metadata.len(),
        });
    }
    let bytes = fs::read(path).map_err(io)?;
    read(format, path, &bytes)
}

/// Makes a mesh from the bytes of a file; `path` serves the messages only.
pub fn read(
    format: &'static Format,
    path: &Path,
    bytes: &[u8],
) -> Result<LoadedMesh, MeshFileError> {
    let soup = (format.read)(bytes).map_err(|error| MeshFileError::Content {
        path: path.to_owned(),
        error,
    })?;
    let (mesh, mut repairs) =
        Mesh::repaired(soup.vertices, soup.triangles).map_err(|error| MeshFileError::Mesh {
            path: path.to_owned(),
            error,
        })?;
    repairs.unreferenced_vertices += soup.unreferenced;
    Ok(LoadedMesh {
        format: format.name,
        mesh,
        repairs,
    })
}
