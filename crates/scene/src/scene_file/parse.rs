//! Parses TOML text to a scene, with errors that name line, body and field.

use std::collections::HashMap;
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;

use glam::DVec3;
use serde::Deserialize;
use sim_core::{Collision, FixedStep, METHODS, Method, Settings};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue, ValueDeserializer};

use super::copies::Obstacles;
use super::meshes::MeshSource;
use super::number::{Number, Triple};
use super::text::{Body, Header};
use super::{body, force};
use crate::error::SceneError;
use crate::scene::Scene;
use crate::shown;
use crate::world::{MOST_GROUPS, TOO_MANY_GROUPS, note_groups};

/// The collision modes, by their names in scene files.
const COLLISIONS: [(&str, Collision); 3] = [
    ("naive", Collision::Naive),
    ("bvh", Collision::Bvh),
    ("continuous", Collision::Continuous),
];

/// The largest absolute value of a number of a body, as in a [`World`](sim_core::World).
pub(super) const LARGEST: f64 = 1e100;

/// The name of a collision mode.
pub(super) fn collision_name(collision: Collision) -> &'static str {
    let mut known = COLLISIONS.iter();
    known
        .find(|known| known.1 == collision)
        .map_or("bvh", |known| known.0)
}

/// Parses a scene file. The stem of `file` becomes the name of the scene.
pub(crate) fn parse(text: &str, file: &Path, mut meshes: MeshSource) -> Result<Scene, SceneError> {
    let source = Source { text, file };
    let table =
        DeTable::parse(text).map_err(|error| source.toml_error(&error, Subject::Scene, &[]))?;
    let span = table.span();
    let mut table = table.into_inner();
    let bodies = tables(&source, "body", table.remove("body"))?;
    let forces = tables(&source, "force", table.remove("force"))?;
    let header: Header = source.read(Spanned::new(span, DeValue::Table(table)), Subject::Scene)?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    let mut scene = Scene {
        title: header.title.clone().unwrap_or_else(|| name.to_string()),
        about: header.about.clone().unwrap_or_default(),
        name: name.into_owned(),
        dt: dt(&source, &header)?,
        method: method(&source, header.method)?,
        collision: collision(&source, header.collision)?,
        tolerance: tolerance(&source, header.tolerance)?,
        ends: ends(&source, header.ends)?,
        bodies: Vec::new(),
        forces: Vec::new(),
    };
    let mut starts = HashMap::new();
    let mut obstacles = Obstacles::default();
    for (i, table) in bodies.into_iter().enumerate() {
        let called = match table.get_ref().get("name").map(Spanned::get_ref) {
            Some(DeValue::String(name)) => name.to_string(),
            _ => format!("number {}", i + 1),
        };
        let body: Body = source.read(
            Spanned::new(table.span(), DeValue::Table(table.into_inner())),
            Subject::Body(&called),
        )?;
        let span = body.name.span();
        let bodies = body::parse(&source, body, &mut meshes, &scene.bodies, &mut obstacles)?;
        for body in &bodies {
            if let Some(first) = starts.insert(body.name.clone(), span.start) {
                let first = source.line(first);
                let place = Place::new(&source, Subject::Body(&body.name));
                let what = format!("the body in line {first} has this name too: choose another");
                return Err(place.error(span, "name", what));
            }
        }
        scene.bodies.extend(bodies);
    }
    let mut groups = Vec::new();
    for body in &scene.bodies {
        note_groups(body, &mut groups);
        if groups.len() > MOST_GROUPS {
            let start = starts.get(&body.name).copied().unwrap_or_default();
            let place = Place::new(&source, Subject::Body(&body.name));
            return Err(place.error(start..start, "groups", TOO_MANY_GROUPS));
        }
    }
    let names = scene.bodies.iter().map(|body| body.name.as_str());
    let names: HashMap<&str, usize> = names.zip(0..).collect();
    for (i, table) in forces.into_iter().enumerate() {
        scene
            .forces
            .push(force::parse(&source, i + 1, table, &names)?);
    }
    Ok(scene)
}

/// The text of the file, in which errors are located.
pub(super) struct Source<'a> {
    text: &'a str,
    file: &'a Path,
}

/// The part of a file to which a value belongs.
#[derive(Clone, Copy)]
pub(super) enum Subject<'a> {
    /// The fields above the bodies.
    Scene,
    /// The body of that name.
    Body(&'a str),
    /// The force of that number, from 1.
    Force(usize),
}

impl Subject<'_> {
    fn body(self) -> Option<String> {
        match self {
            Subject::Body(name) => Some(name.to_owned()),
            Subject::Scene | Subject::Force(_) => None,
        }
    }

    fn field(self, field: Option<&str>) -> Option<String> {
        match (self, field) {
            (Subject::Force(number), Some(field)) => Some(format!("force {number}, {field}")),
            (Subject::Force(number), None) => Some(format!("force {number}")),
            (_, field) => field.map(str::to_owned),
        }
    }
}

/// The fields of a table: names, and the text ranges from each name to the end of its value.
pub(super) type Fields = Vec<(String, Range<usize>)>;

pub(super) fn fields(table: &DeTable<'_>) -> Fields {
    let entries = table.into_iter();
    let place = |(key, value): (&Spanned<DeString<'_>>, &Spanned<DeValue<'_>>)| {
        let span = key.span().start..value.span().end;
        (key.get_ref().to_string(), span)
    };
    entries.map(place).collect()
}

impl Source<'_> {
    fn line(&self, offset: usize) -> usize {
        let before = &self.text.as_bytes()[..offset.min(self.text.len())];
        1 + before.iter().filter(|&&byte| byte == b'\n').count()
    }

    /// Deserializes a table; serde has the fields and their types.
    pub(super) fn read<'t, T: Deserialize<'t>>(
        &self,
        table: Spanned<DeValue<'t>>,
        subject: Subject<'_>,
    ) -> Result<T, SceneError> {
        let fields = table.get_ref().as_table().map(fields).unwrap_or_default();
        self.read_value(table, subject, &fields)
    }

    /// Deserializes a value; `fields` are those of the table that an error may be in.
    pub(super) fn read_value<'t, T: Deserialize<'t>>(
        &self,
        value: Spanned<DeValue<'t>>,
        subject: Subject<'_>,
        fields: &[(String, Range<usize>)],
    ) -> Result<T, SceneError> {
        T::deserialize(ValueDeserializer::from(value))
            .map_err(|error| self.toml_error(&error, subject, fields))
    }

    fn toml_error(
        &self,
        error: &toml::de::Error,
        subject: Subject<'_>,
        fields: &[(String, Range<usize>)],
    ) -> SceneError {
        let start = error.span().map(|span| span.start);
        let field = start.and_then(|start| fields.iter().find(|(_, span)| span.contains(&start)));
        let mut what = error.message().trim_end().replace('\n', ", ");
        // The parser's error points to the key but does not name it.
        if let Some(key) = error.span().and_then(|span| self.text.get(span))
            && what == "duplicate key"
        {
            what += &format!(" `{}`: give it once", shown::name(key));
        }
        if what == "floating-point number overflowed" {
            what += ": give one within ±1e100";
        }
        // The names of Rust types mean little to the authors of scenes.
        for whole in ["expected usize", "expected u64"] {
            what = what.replace(whole, "expected a whole number from 0");
        }
        SceneError::Content {
            file: self.file.to_owned(),
            line: start.map(|start| self.line(start)),
            body: subject.body(),
            field: subject.field(field.map(|(name, _)| name.as_str())),
            what,
        }
    }
}

/// The context of errors.
pub(super) struct Place<'a> {
    source: &'a Source<'a>,
    pub(super) subject: Subject<'a>,
}

impl<'a> Place<'a> {
    pub(super) fn new(source: &'a Source<'a>, subject: Subject<'a>) -> Place<'a> {
        Place { source, subject }
    }

    pub(super) fn error(&self, span: Range<usize>, field: &str, what: impl Display) -> SceneError {
        self.error_at(span, Some(field), what)
    }

    /// An error that may be about no single field.
    pub(super) fn error_at(
        &self,
        span: Range<usize>,
        field: Option<&str>,
        what: impl Display,
    ) -> SceneError {
        SceneError::Content {
            file: self.source.file.to_owned(),
            line: Some(self.source.line(span.start)),
            body: self.subject.body(),
            field: self.subject.field(field),
            what: what.to_string(),
        }
    }

    /// Three numbers in the range of a [`World`](sim_core::World); zeros if the field is absent.
    pub(super) fn vector(
        &self,
        field: &str,
        value: Option<Spanned<Triple>>,
    ) -> Result<DVec3, SceneError> {
        let Some(value) = value else {
            return Ok(DVec3::ZERO);
        };
        let Triple(v) = *value.get_ref();
        // The test is false for NaN, so NaN is refused.
        if !v.abs().cmple(DVec3::splat(LARGEST)).all() {
            let [x, y, z] = v.to_array().map(shown::number);
            let what = format!("must be three numbers within ±1e100, is [{x}, {y}, {z}]");
            return Err(self.error(value.span(), field, what));
        }
        Ok(v)
    }
}

/// The bodies or the forces, which must be an array of tables.
fn tables<'t>(
    source: &Source,
    name: &str,
    value: Option<Spanned<DeValue<'t>>>,
) -> Result<Vec<Spanned<DeTable<'t>>>, SceneError> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    let wrong = |span| {
        let what =
            format!("must be an array of tables: start each {name} with a line `[[{name}]]`");
        Place::new(source, Subject::Scene).error(span, name, what)
    };
    let span = value.span();
    let DeValue::Array(array) = value.into_inner() else {
        return Err(wrong(span));
    };
    array
        .into_iter()
        .map(|table| {
            let span = table.span();
            match table.into_inner() {
                DeValue::Table(table) => Ok(Spanned::new(span, table)),
                _ => Err(wrong(span)),
            }
        })
        .collect()
}

fn dt(source: &Source, header: &Header) -> Result<f64, SceneError> {
    let place = Place::new(source, Subject::Scene);
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
            "rate" => "must be from 1e-3 to 1e9 Hz",
            _ => "must be from 1e-9 to 1e3 s",
        };
        let what = format!("{what}, is {}", shown::number(value.get_ref().0));
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
            shown::name(name.get_ref())
        );
        Place::new(source, Subject::Scene).error(name.span(), "method", what)
    })
}

fn collision(source: &Source, name: Option<Spanned<String>>) -> Result<Collision, SceneError> {
    let Some(name) = name else {
        return Ok(Settings::default().collision);
    };
    let known = COLLISIONS.iter().find(|known| known.0 == name.get_ref());
    known.map(|known| known.1).ok_or_else(|| {
        let what = format!(
            "must be naive, bvh or continuous, is `{}`",
            shown::name(name.get_ref())
        );
        Place::new(source, Subject::Scene).error(name.span(), "collision", what)
    })
}

fn tolerance(source: &Source, value: Option<Spanned<Number>>) -> Result<f64, SceneError> {
    let Some(value) = value else {
        return Ok(Settings::default().tolerance);
    };
    let Number(tolerance) = *value.get_ref();
    if !Settings::TOLERANCES.contains(&tolerance) {
        let what = format!("must be from 1e-15 to 1, is {}", shown::number(tolerance));
        return Err(Place::new(source, Subject::Scene).error(value.span(), "tolerance", what));
    }
    Ok(tolerance)
}

fn ends(source: &Source, value: Option<Spanned<Number>>) -> Result<Option<f64>, SceneError> {
    let Some(value) = value else {
        return Ok(None);
    };
    let Number(ends) = *value.get_ref();
    if !(ends > 0.0 && ends.is_finite()) {
        let what = format!(
            "must be a time above 0 s, or left out, is {}",
            shown::number(ends)
        );
        return Err(Place::new(source, Subject::Scene).error(value.span(), "ends", what));
    }
    Ok(Some(ends))
}
