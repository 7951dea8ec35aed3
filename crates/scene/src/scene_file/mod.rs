//! Scene files: TOML text to a [`Scene`](crate::Scene) and back.

mod body;
mod copies;
mod force;
mod meshes;
mod number;
mod parse;
mod text;
mod write;

pub(crate) use meshes::MeshSource;
pub(crate) use parse::parse;
pub(crate) use write::write;
