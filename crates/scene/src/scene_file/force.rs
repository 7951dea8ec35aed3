//! The `[[force]]` tables of a scene file, by the fields that each force shows.

use std::collections::HashMap;
use std::fmt::Display;
use std::ops::Range;

use serde::{Deserialize, Serialize, Serializer};
use sim_core::force::{Field, Value};
use sim_core::{FORCES, Force};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::number::{Number, Triple};
use super::parse::{Fields, Place, Source, Subject, fields};
use crate::error::SceneError;
use crate::shown;

/// Reads one table, the `number`th from 1. Bodies are looked up by name.
pub(super) fn parse(
    source: &Source<'_>,
    number: usize,
    table: Spanned<DeTable<'_>>,
    names: &HashMap<&str, usize>,
) -> Result<Force, SceneError> {
    let place = Place::new(source, Subject::Force(number));
    let spans = fields(table.get_ref());
    let kind = match table.get_ref().get("kind").map(Spanned::get_ref) {
        Some(DeValue::String(kind)) => kind.to_string(),
        _ => String::new(),
    };
    let table = Table {
        source,
        place,
        span: table.span(),
        table: table.into_inner(),
        spans,
        names,
    };
    let Some(force) = FORCES.iter().find(|force| force.kind() == kind) else {
        let kinds: Vec<&str> = FORCES.iter().map(Force::kind).collect();
        let kind = shown::name(&kind);
        let what = format!("must be one of {}, is `{kind}`", kinds.join(", "));
        return Err(table.error("kind", what));
    };
    let mut force = force.clone();
    let mut known = vec!["kind"];
    force.fields(|field| known.push(field.name));
    table.check_names(&known)?;
    let mut read = Ok(());
    force.fields(|field| {
        if read.is_ok() {
            read = table.read(field);
        }
    });
    read?;
    force
        .check()
        .map_err(|error| table.error(error.field(), error))?;
    Ok(force)
}

/// The table of a force, and what errors about it need.
struct Table<'a, 't> {
    source: &'a Source<'a>,
    place: Place<'a>,
    span: Range<usize>,
    table: DeTable<'t>,
    spans: Fields,
    names: &'a HashMap<&'a str, usize>,
}

impl Table<'_, '_> {
    fn error(&self, field: &str, what: impl Display) -> SceneError {
        let known = self.spans.iter().find(|(name, _)| name == field);
        let span = known.map_or(&self.span, |(_, span)| span);
        self.place.error(span.clone(), field, what)
    }

    /// Refuses a field that the force does not have.
    fn check_names(&self, known: &[&str]) -> Result<(), SceneError> {
        let mut names = self.spans.iter().map(|(name, _)| name);
        let Some(name) = names.find(|name| !known.contains(&name.as_str())) else {
            return Ok(());
        };
        let (known, name) = (known.join("`, `"), shown::name(name));
        let what = format!("unknown field `{name}`, expected one of `{known}`");
        Err(self.error(&name, what))
    }

    /// Reads one field.
    fn read(&self, field: Field<'_>) -> Result<(), SceneError> {
        let name = field.name;
        match field.value {
            Value::Number { value, default, .. } => {
                *value = match (self.get(name)?, default) {
                    (Some(Number(number)), _) => number,
                    (None, Some(default)) => default,
                    (None, None) => return Err(self.missing(name)),
                };
            }
            Value::Vector(value) => *value = self.need::<Triple>(name)?.0,
            Value::Body(body) => *body = self.body(name, &self.need::<String>(name)?)?,
            Value::AnyBody(body) => {
                let called: Option<String> = self.get(name)?;
                *body = called.map(|called| self.body(name, &called)).transpose()?;
            }
            Value::Bodies(bodies) => {
                *bodies = self.two_bodies(name, &self.need::<Vec<String>>(name)?)?;
            }
            Value::AnyBodies(bodies) => {
                let called: Option<Vec<String>> = self.get(name)?;
                let called = called.map(|called| self.two_bodies(name, &called));
                *bodies = called.transpose()?;
            }
            Value::Point(point) => {
                let triple: Option<Triple> = self.get(name)?;
                *point = triple.map(|triple| triple.0);
            }
            Value::Points(points) => {
                *points = match self.get::<Vec<Triple>>(name)?.as_deref() {
                    None => None,
                    Some([first, second]) => Some([first.0, second.0]),
                    Some(points) => {
                        let count = points.len();
                        let what = format!("must be two points, one of each body, has {count}");
                        return Err(self.error(name, what));
                    }
                };
            }
        }
        Ok(())
    }

    /// The value of a field, if the table has it.
    fn get<T: for<'de> Deserialize<'de>>(&self, name: &str) -> Result<Option<T>, SceneError> {
        let Some(value) = self.table.get(name) else {
            return Ok(None);
        };
        let read = |value| {
            self.source
                .read_value(value, self.place.subject, &self.spans)
        };
        read(value.clone()).map(Some)
    }

    /// The value of a field that must be there.
    fn need<T: for<'de> Deserialize<'de>>(&self, name: &str) -> Result<T, SceneError> {
        self.get(name)?.ok_or_else(|| self.missing(name))
    }

    fn missing(&self, name: &str) -> SceneError {
        let what = format!("missing field `{name}`");
        self.place.error_at(self.span.clone(), None, what)
    }

    fn body(&self, field: &str, name: &str) -> Result<usize, SceneError> {
        self.names.get(name).copied().ok_or_else(|| {
            let what = format!("there is no body `{}`", shown::name(name));
            self.error(field, what)
        })
    }

    fn two_bodies(&self, field: &str, names: &[String]) -> Result<[usize; 2], SceneError> {
        // A fixed array would drop a third name silently.
        let [first, second] = names else {
            let what = format!("must be the names of two bodies, has {}", names.len());
            return Err(self.error(field, what));
        };
        Ok([self.body(field, first)?, self.body(field, second)?])
    }
}

/// A force to write.
pub(super) struct ForceText(Vec<(&'static str, Text)>);

/// The value of a field to write.
#[derive(Serialize)]
#[serde(untagged)]
enum Text {
    Name(String),
    Names(Vec<String>),
    Number(Number),
    Triple(Triple),
    Triples(Vec<Triple>),
}

impl Serialize for ForceText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, text)| (name, text)))
    }
}

/// The text of a force; `None` if its law is code.
pub(super) fn write(force: &Force, name: impl Fn(usize) -> String) -> Option<ForceText> {
    let kind = force.kind();
    if FORCES.iter().all(|known| known.kind() != kind) {
        return None;
    }
    let mut texts = vec![("kind", Text::Name(kind.to_owned()))];
    force.clone().fields(|field| {
        let text = match field.value {
            Value::Number { value, .. } => Some(Text::Number(Number(*value))),
            Value::Vector(value) => Some(Text::Triple(Triple(*value))),
            Value::Body(body) => Some(Text::Name(name(*body))),
            Value::AnyBody(body) => body.map(|body| Text::Name(name(body))),
            Value::Bodies(bodies) => Some(Text::Names(bodies.map(&name).to_vec())),
            Value::AnyBodies(bodies) => {
                bodies.map(|bodies| Text::Names(bodies.map(&name).to_vec()))
            }
            Value::Point(point) => point.map(|point| Text::Triple(Triple(point))),
            Value::Points(points) => {
                points.map(|points| Text::Triples(points.map(Triple).to_vec()))
            }
        };
        texts.extend(text.map(|text| (field.name, text)));
    });
    Some(ForceText(texts))
}
