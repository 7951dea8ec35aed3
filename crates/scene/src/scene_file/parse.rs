//! TOML text to a scene, with errors that name line, body and field.

use std::collections::HashMap;
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;

use glam::DVec3;
use serde::Deserialize;
use sim_core::{Collision, FixedStep, METHODS, Method, Settings};
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use super::meshes::MeshSource;
use super::number::{Number, Triple};
use super::text::{Body, Header};
use crate::colour;
use crate::error::SceneError;
use crate::scene::{Scene, SceneBody};

/// The ways to search for collisions, by the names in scene files.
const COLLISIONS: [(&str, Collision); 2] = [("naive", Collision::Naive), ("bvh", Collision::Bvh)];

/// The largest number of a body, as a [`World`](sim_core::World) has it.
const LARGEST: f64 = 1e100;

/// The name of a way to search for collisions.
pub(super) fn collision_name(collision: Collision) -> &'static str {
    let mut known = COLLISIONS.iter();
    known
        .find(|known| known.1 == collision)
        .map_or("bvh", |known| known.0)
}

/// Parses a scene file. The stem of `file` becomes the name of the scene.
pub(crate) fn parse(text: &str, file: &Path, mut meshes: MeshSource) -> Result<Scene, SceneError> {
    let source = Source { text, file };
    let table = DeTable::parse(text).map_err(|error| source.toml_error(&error, None, &[]))?;
    let span = table.span();
    let mut table = table.into_inner();
    let bodies = body_tables(&source, table.remove("body"))?;
    let header: Header = source.read(Spanned::new(span, DeValue::Table(table)), None)?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    let mut scene = Scene {
        title: header.title.clone().unwrap_or_else(|| name.to_string()),
        about: header.about.clone().unwrap_or_default(),
        name: name.into_owned(),
        dt: dt(&source, &header)?,
        method: method(&source, header.method)?,
        collision: collision(&source, header.collision)?,
        bodies: Vec::new(),
    };
    let mut lines = HashMap::new();
    for (i, table) in bodies.into_iter().enumerate() {
        let called = match table.get_ref().get("name").map(Spanned::get_ref) {
            Some(DeValue::String(name)) => name.to_string(),
            _ => format!("number {}", i + 1),
        };
        let body: Body = source.read(
            Spanned::new(table.span(), DeValue::Table(table.into_inner())),
            Some(&called),
        )?;
        let line = source.line(body.name.span().start);
        if let Some(first) = lines.insert(called, line) {
            let place = Place::new(&source, Some(body.name.get_ref()));
            let what = format!("the body in line {first} has this name too: choose another");
            return Err(place.error(body.name.span(), "name", what));
        }
        scene.bodies.push(scene_body(&source, body, &mut meshes)?);
    }
    Ok(scene)
}

/// The text, to tell where an error is.
struct Source<'a> {
    text: &'a str,
    file: &'a Path,
}

/// The fields of a table, with the text from each name to the end of its value.
type Fields = Vec<(String, Range<usize>)>;

impl Source<'_> {
    fn line(&self, offset: usize) -> usize {
        let before = &self.text.as_bytes()[..offset.min(self.text.len())];
        1 + before.iter().filter(|&&byte| byte == b'\n').count()
    }

    /// Reads a table by serde, which knows the fields and their types.
    fn read<'t, T: Deserialize<'t>>(
        &self,
        table: Spanned<DeValue<'t>>,
        body: Option<&str>,
    ) -> Result<T, SceneError> {
        let entries = table.get_ref().as_table();
        let fields: Fields = entries
            .into_iter()
            .flatten()
            .map(|(key, value)| {
                (
                    key.get_ref().to_string(),
                    key.span().start..value.span().end,
                )
            })
            .collect();
        T::deserialize(ValueDeserializer::from(table))
            .map_err(|error| self.toml_error(&error, body, &fields))
    }

    fn toml_error(
        &self,
        error: &toml::de::Error,
        body: Option<&str>,
        fields: &[(String, Range<usize>)],
    ) -> SceneError {
        let start = error.span().map(|span| span.start);
        let field = start.and_then(|start| fields.iter().find(|(_, span)| span.contains(&start)));
        SceneError::Content {
            file: self.file.to_owned(),
            line: start.map(|start| self.line(start)),
            body: body.map(str::to_owned),
            field: field.map(|(name, _)| name.clone()),
            what: error.message().to_owned(),
        }
    }
}

/// A place for errors: a body of the file, or none.
struct Place<'a> {
    source: &'a Source<'a>,
    body: Option<&'a str>,
}

impl<'a> Place<'a> {
    fn new(source: &'a Source<'a>, body: Option<&'a str>) -> Place<'a> {
        Place { source, body }
    }

    fn error(&self, span: Range<usize>, field: &str, what: impl Display) -> SceneError {
        SceneError::Content {
            file: self.source.file.to_owned(),
            line: Some(self.source.line(span.start)),
            body: self.body.map(str::to_owned),
            field: Some(field.to_owned()),
            what: what.to_string(),
        }
    }

    fn vector(&self, field: &str, value: Option<Spanned<Triple>>) -> Result<DVec3, SceneError> {
        let Some(value) = value else {
            return Ok(DVec3::ZERO);
        };
        let Triple(v) = *value.get_ref();
        // NaN is not below anything.
        if !v.abs().cmple(DVec3::splat(LARGEST)).all() {
            let what = format!("must be three numbers within ±1e100, is {v}");
            return Err(self.error(value.span(), field, what));
        }
        Ok(v)
    }
}

/// The bodies, which must be an array of tables.
fn body_tables<'t>(
    source: &Source,
    value: Option<Spanned<DeValue<'t>>>,
) -> Result<Vec<Spanned<DeTable<'t>>>, SceneError> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    let wrong = |span| {
        let what = "must be an array of tables: start each body with a line `[[body]]`";
        Place::new(source, None).error(span, "body", what)
    };
    let span = value.span();
    let DeValue::Array(array) = value.into_inner() else {
        return Err(wrong(span));
    };
    array
        .into_iter()
        .map(|body| {
            let span = body.span();
            match body.into_inner() {
                DeValue::Table(table) => Ok(Spanned::new(span, table)),
                _ => Err(wrong(span)),
            }
        })
        .collect()
}

fn dt(source: &Source, header: &Header) -> Result<f64, SceneError> {
    let place = Place::new(source, None);
    let (field, value, dt) = match (&header.rate, &header.dt) {
        (Some(rate), None) => ("rate", rate, 1.0 / rate.get_ref().0),
        (None, Some(dt)) => ("dt", dt, dt.get_ref().0),
        (Some(_), Some(dt)) => {
            let what = "the step has a rate as well: give either `rate` (Hz) or `dt` (s)";
            return Err(place.error(dt.span(), "dt", what));
        }
        (None, None) => {
            return Err(SceneError::Content {
                file: source.file.to_owned(),
                line: None,
                body: None,
                field: None,
                what: "the step is missing: give either `rate = 60` (Hz) or `dt = 0.2` (s) above \
                       the bodies"
                    .to_owned(),
            });
        }
    };
    if !FixedStep::DT_RANGE.contains(&dt) {
        let what = match field {
            "rate" => "must be from 1e-6 to 1e9 Hz",
            _ => "must be from 1e-9 to 1e3 s",
        };
        let what = format!("{what}, is {}", value.get_ref().0);
        return Err(place.error(value.span(), field, what));
    }
    Ok(dt)
}

fn method(source: &Source, name: Option<Spanned<String>>) -> Result<&'static Method, SceneError> {
    let Some(name) = name else {
        return Ok(Settings::default().method);
    };
    Method::named(name.get_ref()).ok_or_else(|| {
        let known: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
        let what = format!(
            "must be one of {}, is `{}`",
            known.join(", "),
            name.get_ref()
        );
        Place::new(source, None).error(name.span(), "method", what)
    })
}

fn collision(source: &Source, name: Option<Spanned<String>>) -> Result<Collision, SceneError> {
    let Some(name) = name else {
        return Ok(Settings::default().collision);
    };
    let known = COLLISIONS.iter().find(|known| known.0 == name.get_ref());
    known.map(|known| known.1).ok_or_else(|| {
        let what = format!("must be naive or bvh, is `{}`", name.get_ref());
        Place::new(source, None).error(name.span(), "collision", what)
    })
}

fn scene_body(
    source: &Source,
    body: Body,
    meshes: &mut MeshSource,
) -> Result<SceneBody, SceneError> {
    let name = body.name.get_ref().clone();
    let place = Place::new(source, Some(&name));
    if name.trim().is_empty() {
        return Err(place.error(body.name.span(), "name", "must not be empty"));
    }
    let mesh = meshes
        .get(body.mesh.get_ref())
        .map_err(|what| place.error(body.mesh.span(), "mesh", what))?;
    let mut scale = DVec3::ONE;
    if let Some(value) = body.scale {
        scale = value.get_ref().0;
        if !scale.is_finite() || scale.cmpeq(DVec3::ZERO).any() {
            let what = format!("must be finite and not 0, is {scale}");
            return Err(place.error(value.span(), "scale", what));
        }
    }
    let mut mass = 1.0;
    if let Some(value) = body.mass {
        Number(mass) = *value.get_ref();
        if !(1.0 / LARGEST..=LARGEST).contains(&mass) {
            let what = format!("must be a mass in kg above 0 (from 1e-100 to 1e100), is {mass}");
            return Err(place.error(value.span(), "mass", what));
        }
    }
    let mut chosen = None;
    if let Some(value) = body.colour {
        chosen = colour::parse(value.get_ref());
        if chosen.is_none() {
            let what = format!("must look like `#c8553d`, is `{}`", value.get_ref());
            return Err(place.error(value.span(), "colour", what));
        }
    }
    Ok(SceneBody {
        mesh,
        position: place.vector("position", body.position)?,
        rotation: place.vector("rotation", body.rotation)?,
        scale,
        velocity: place.vector("velocity", body.velocity)?,
        force: place.vector("force", body.force)?,
        mass,
        colour: chosen,
        name,
    })
}
