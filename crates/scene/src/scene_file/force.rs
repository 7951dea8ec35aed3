//! The `[[force]]` tables of a scene file.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};
use sim_core::Force;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::number::{Number, Triple};
use super::parse::{Place, Source, Subject, fields};
use crate::error::SceneError;
use crate::shown;

/// The kinds of forces that a file can contain.
const KINDS: [&str; 8] = [
    "gravity",
    "linear-drag",
    "quadratic-drag",
    "anchor",
    "spring",
    "push",
    "attraction",
    "gravitation",
];

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Gravity {
    kind: String,
    acceleration: Triple,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Drag {
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    body: Option<String>,
    coefficient: Number,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Anchor {
    kind: String,
    body: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    point: Option<Triple>,
    anchor: Triple,
    #[serde(default = "zero")]
    rest_length: Number,
    stiffness: Number,
    #[serde(default = "zero")]
    damping: Number,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spring {
    kind: String,
    bodies: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<Triple>>,
    #[serde(default = "zero")]
    rest_length: Number,
    stiffness: Number,
    #[serde(default = "zero")]
    damping: Number,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Push {
    kind: String,
    body: String,
    point: Triple,
    force: Triple,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Attraction {
    kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    body: Option<String>,
    centre: Triple,
    strength: Number,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Gravitation {
    kind: String,
    constant: Number,
}

fn zero() -> Number {
    Number(0.0)
}

/// A force to write.
#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum ForceText {
    Gravity(Gravity),
    Drag(Drag),
    Anchor(Anchor),
    Spring(Spring),
    Push(Push),
    Attraction(Attraction),
    Gravitation(Gravitation),
}

/// Reads one table, the `number`th from 1. Bodies are looked up by name.
pub(super) fn parse(
    source: &Source<'_>,
    number: usize,
    table: Spanned<DeTable<'_>>,
    names: &HashMap<&str, usize>,
) -> Result<Force, SceneError> {
    let place = Place::new(source, Subject::Force(number));
    let spans = fields(table.get_ref());
    let at = |field: &str| {
        let known = spans.iter().find(|(name, _)| name == field);
        known.map_or(table.span(), |(_, span)| span.clone())
    };
    let body = |field: &str, name: &String| {
        names.get(name.as_str()).copied().ok_or_else(|| {
            let what = format!("there is no body `{}`", shown::name(name));
            place.error(at(field), field, what)
        })
    };
    let maybe_body = |name: &Option<String>| name.as_ref().map(|n| body("body", n)).transpose();
    let kind = match table.get_ref().get("kind").map(Spanned::get_ref) {
        Some(DeValue::String(kind)) => kind.to_string(),
        _ => String::new(),
    };
    let whole = Spanned::new(table.span(), DeValue::Table(table.get_ref().clone()));
    let force = match kind.as_str() {
        "gravity" => {
            let text: Gravity = source.read(whole, place.subject)?;
            Force::Gravity {
                acceleration: text.acceleration.0,
            }
        }
        "linear-drag" | "quadratic-drag" => {
            let text: Drag = source.read(whole, place.subject)?;
            let (body, coefficient) = (maybe_body(&text.body)?, text.coefficient.0);
            if kind == "linear-drag" {
                Force::LinearDrag { body, coefficient }
            } else {
                Force::QuadraticDrag { body, coefficient }
            }
        }
        "anchor" => {
            let text: Anchor = source.read(whole, place.subject)?;
            Force::Anchor {
                body: body("body", &text.body)?,
                point: text.point.map(|point| point.0),
                anchor: text.anchor.0,
                rest_length: text.rest_length.0,
                stiffness: text.stiffness.0,
                damping: text.damping.0,
            }
        }
        "spring" => {
            let text: Spring = source.read(whole, place.subject)?;
            // A fixed array would drop a third name silently.
            let [first, second] = &text.bodies[..] else {
                let what = format!("must be the names of two bodies, has {}", text.bodies.len());
                return Err(place.error(at("bodies"), "bodies", what));
            };
            let points = text.points.as_deref().map(|points| match points {
                [first, second] => Ok([first.0, second.0]),
                _ => {
                    let what =
                        format!("must be two points, one of each body, has {}", points.len());
                    Err(place.error(at("points"), "points", what))
                }
            });
            Force::Spring {
                bodies: [body("bodies", first)?, body("bodies", second)?],
                points: points.transpose()?,
                rest_length: text.rest_length.0,
                stiffness: text.stiffness.0,
                damping: text.damping.0,
            }
        }
        "push" => {
            let text: Push = source.read(whole, place.subject)?;
            Force::Push {
                body: body("body", &text.body)?,
                point: text.point.0,
                force: text.force.0,
            }
        }
        "attraction" => {
            let text: Attraction = source.read(whole, place.subject)?;
            Force::Attraction {
                body: maybe_body(&text.body)?,
                centre: text.centre.0,
                strength: text.strength.0,
            }
        }
        "gravitation" => {
            let text: Gravitation = source.read(whole, place.subject)?;
            Force::Gravitation {
                constant: text.constant.0,
            }
        }
        _ => {
            let what = format!(
                "must be one of {}, is `{}`",
                KINDS.join(", "),
                shown::name(&kind)
            );
            return Err(place.error(at("kind"), "kind", what));
        }
    };
    force
        .check()
        .map_err(|error| place.error(at(error.field()), error.field(), error))?;
    Ok(force)
}

/// The text of a force; `None` if its law is code.
pub(super) fn write(force: &Force, name: impl Fn(usize) -> String) -> Option<ForceText> {
    let kind = force.kind().to_owned();
    Some(match *force {
        Force::Gravity { acceleration } => ForceText::Gravity(Gravity {
            kind,
            acceleration: Triple(acceleration),
        }),
        Force::LinearDrag { body, coefficient } | Force::QuadraticDrag { body, coefficient } => {
            ForceText::Drag(Drag {
                kind,
                body: body.map(name),
                coefficient: Number(coefficient),
            })
        }
        Force::Anchor {
            body,
            point,
            anchor,
            rest_length,
            stiffness,
            damping,
        } => ForceText::Anchor(Anchor {
            kind,
            body: name(body),
            point: point.map(Triple),
            anchor: Triple(anchor),
            rest_length: Number(rest_length),
            stiffness: Number(stiffness),
            damping: Number(damping),
        }),
        Force::Spring {
            bodies,
            points,
            rest_length,
            stiffness,
            damping,
        } => ForceText::Spring(Spring {
            kind,
            bodies: bodies.map(name).to_vec(),
            points: points.map(|points| points.map(Triple).to_vec()),
            rest_length: Number(rest_length),
            stiffness: Number(stiffness),
            damping: Number(damping),
        }),
        Force::Push { body, point, force } => ForceText::Push(Push {
            kind,
            body: name(body),
            point: Triple(point),
            force: Triple(force),
        }),
        Force::Attraction {
            body,
            centre,
            strength,
        } => ForceText::Attraction(Attraction {
            kind,
            body: body.map(name),
            centre: Triple(centre),
            strength: Number(strength),
        }),
        Force::Gravitation { constant } => ForceText::Gravitation(Gravitation {
            kind,
            constant: Number(constant),
        }),
        Force::Body { .. } | Force::Pair { .. } => return None,
    })
}
