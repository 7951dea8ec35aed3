//! Mesh files: one entry of [`FORMATS`] per file format, and the meshes that come built in.

mod builtin;
mod collada;
mod encoding;
mod obj;
mod ply;
mod polygon;
mod report;
mod soup;
mod stl;

use std::io;
use std::path::{Path, PathBuf};

use sim_core::{Mesh, MeshError, Repairs};
use thiserror::Error;

use crate::file::{self, Refusal};
use crate::shown;

pub use builtin::{BUILTIN_MESHES, builtin};
pub use report::MeshReport;
pub use soup::{ReadError, Soup};

/// The mesh file formats that can be read.
pub static FORMATS: &[Format] = &[obj::FORMAT, collada::FORMAT, stl::FORMAT, ply::FORMAT];

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
        if ["gltf", "glb"]
            .iter()
            .any(|gltf| extension.eq_ignore_ascii_case(gltf))
        {
            return Err(MeshFileError::Gltf {
                path: path.to_owned(),
            });
        }
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

/// A mesh from a file, and the repairs that the file needed.
#[derive(Debug)]
pub struct LoadedMesh {
    /// Name of the format in [`FORMATS`].
    pub format: &'static str,
    /// The mesh in metres, y up.
    pub mesh: Mesh,
    /// The repairs of the mesh.
    pub repairs: Repairs,
    /// The unit of the file in metres, if the file states it; `mesh` is in metres.
    pub unit: Option<f64>,
    /// The up axis of the file, if the file states it; `mesh` has y up.
    pub up_axis: Option<char>,
    /// The number of instances that were left out because the file scales them to zero.
    pub flat_instances: usize,
}

/// The reason why a mesh file gives no mesh.
#[derive(Debug, Error)]
pub enum MeshFileError {
    /// No format has the extension.
    #[error(
        "{}: not a known kind of mesh file: the extension must be {}",
        shown::path(path),
        extensions()
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The format is known but not supported.
    #[error(
        "{}: glTF files are not read: export the mesh as {}",
        shown::path(path),
        extensions()
    )]
    Gltf {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read.
    #[error("{}: cannot read the mesh file: {error}", shown::path(path))]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
    /// The file is larger than any sensible mesh.
    #[error(
        "{}: the mesh file has {bytes} bytes: the most is {MAX_BYTES}",
        shown::path(path)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// The contents violate the format.
    #[error("{}: {}", place(path, error.line), shown::part(&error.what))]
    Content {
        /// The file.
        path: PathBuf,
        /// Line and explanation.
        error: ReadError,
    },
    /// The triangles do not form a valid mesh.
    #[error("{}: {error}", shown::path(path))]
    Mesh {
        /// The file.
        path: PathBuf,
        /// The error.
        error: MeshError,
    },
}

fn place(path: &Path, line: Option<usize>) -> String {
    match line {
        Some(line) => format!("{}:{line}", shown::path(path)),
        None => shown::path(path),
    }
}

fn extensions() -> String {
    let known = FORMATS.iter().flat_map(|format| format.extensions);
    let known: Vec<String> = known.map(|extension| format!(".{extension}")).collect();
    known.join(" or ")
}

/// Reads a mesh file. The extension determines the format; no other file is opened.
pub fn load(path: &Path) -> Result<LoadedMesh, MeshFileError> {
    let format = Format::of(path)?;
    let bytes = file::read(path, MAX_BYTES).map_err(|refusal| match refusal {
        Refusal::Io(error) => MeshFileError::Io {
            path: path.to_owned(),
            error,
        },
        Refusal::TooLarge(bytes) => MeshFileError::TooLarge {
            path: path.to_owned(),
            bytes,
        },
    })?;
    read(format, path, &bytes)
}

/// Makes a mesh from the bytes of a file; `path` is used only in messages.
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
        unit: soup.unit,
        up_axis: soup.up_axis,
        flat_instances: soup.flat_instances,
    })
}
