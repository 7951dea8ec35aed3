//! The fields of a scene file, as written, with their positions in the text.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::force::ForceText;
use super::number::{Number, Scale, Triple};

/// The fields above the bodies.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    pub(super) title: Option<String>,
    pub(super) about: Option<String>,
    pub(super) rate: Option<Spanned<Number>>,
    pub(super) dt: Option<Spanned<Number>>,
    pub(super) method: Option<Spanned<String>>,
    pub(super) collision: Option<Spanned<String>>,
    pub(super) tolerance: Option<Spanned<Number>>,
    pub(super) ends: Option<Spanned<Number>>,
}

/// A `[[body]]`.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Body {
    pub(super) name: Spanned<String>,
    pub(super) mesh: Option<Spanned<String>>,
    pub(super) sphere: Option<Spanned<Number>>,
    #[serde(rename = "half-space")]
    pub(super) half_space: Option<Spanned<Triple>>,
    pub(super) position: Option<Spanned<Triple>>,
    pub(super) rotation: Option<Spanned<Triple>>,
    pub(super) scale: Option<Spanned<Scale>>,
    pub(super) velocity: Option<Spanned<Triple>>,
    pub(super) force: Option<Spanned<Triple>>,
    pub(super) mass: Option<Spanned<Number>>,
    pub(super) immovable: Option<Spanned<bool>>,
    pub(super) restitution: Option<Spanned<Number>>,
    pub(super) friction: Option<Spanned<Number>>,
    pub(super) groups: Option<Vec<Spanned<String>>>,
    pub(super) collides_with: Option<Vec<Spanned<String>>>,
    pub(super) turns: Option<Spanned<bool>>,
    pub(super) spin: Option<Spanned<Triple>>,
    pub(super) torque: Option<Spanned<Triple>>,
    pub(super) inertia: Option<Spanned<Triple>>,
    pub(super) colour: Option<Spanned<String>>,
    #[serde(skip_serializing)]
    pub(super) copies: Option<Spanned<usize>>,
    #[serde(skip_serializing)]
    pub(super) inside: Option<Spanned<Vec<Triple>>>,
    #[serde(skip_serializing)]
    pub(super) speed: Option<Spanned<Number>>,
    #[serde(skip_serializing)]
    pub(super) seed: Option<Spanned<u64>>,
}

/// A whole file, for writing.
#[derive(Serialize)]
pub(super) struct File {
    #[serde(flatten)]
    pub(super) header: Header,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) body: Vec<Body>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) force: Vec<ForceText>,
}
