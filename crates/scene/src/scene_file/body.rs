//! Converts a `[[body]]` table to its bodies.

use glam::DVec3;
use sim_core::MeshError;
use toml::Spanned;

use super::copies::{self, Obstacles};
use super::meshes::MeshSource;
use super::number::{Number, Triple};
use super::parse::{LARGEST, Place, Source, Subject};
use super::text::Body;
use crate::colour;
use crate::error::SceneError;
use crate::scene::{SceneBody, SceneShape, SceneTurn};
use crate::shown;
use crate::world::{angular_momentum, baked_field};

/// The bodies of a table: one, or its copies, which do not overlap the bodies before them.
pub(super) fn parse(
    source: &Source,
    text: Body,
    meshes: &mut MeshSource,
    before: &[SceneBody],
    obstacles: &mut Obstacles,
) -> Result<Vec<SceneBody>, SceneError> {
    let name = text.name.get_ref().clone();
    let place = Place::new(source, Subject::Body(&name));
    if name.trim().is_empty() {
        return Err(place.error(text.name.span(), "name", "must not be empty"));
    }
    let shape = shape(&place, &text, meshes)?;
    let mut body = SceneBody::new(name.clone(), shape);
    refuse_senseless(&place, &text, &body.shape)?;
    let copies = copies::parse(&place, &text)?;
    let scale_span = text.scale.as_ref().map(Spanned::span);
    let rotation_span = text.rotation.as_ref().map(Spanned::span);
    body.position = place.vector("position", text.position)?;
    body.rotation = place.vector("rotation", text.rotation)?;
    body.velocity = place.vector("velocity", text.velocity)?;
    body.force = place.vector("force", text.force)?;
    if let Some(value) = text.scale {
        body.scale = value.get_ref().0;
        if !body.scale.is_finite() || body.scale.cmpeq(DVec3::ZERO).any() {
            let what = {
                let [x, y, z] = body.scale.to_array().map(shown::number);
                format!("must be finite and not 0, is [{x}, {y}, {z}]")
            };
            return Err(place.error(value.span(), "scale", what));
        }
    }
    if let Some(mesh) = body.mesh() {
        // The mesh is transformed here as the world will do it, because errors can name the line here.
        obstacles.baked.turned(mesh, &body).map_err(|error| {
            let field = baked_field(&error);
            let span = scale_span.or(rotation_span).unwrap_or(text.name.span());
            place.error(span, field, baked_what(&error, body.scale))
        })?;
    }
    if let Some(value) = text.mass {
        body.mass = mass(&place, &value)?;
    }
    if text.immovable.is_some_and(|value| *value.get_ref()) {
        body.immovable = true;
    }
    if let Some(value) = text.restitution {
        body.restitution = value.get_ref().0;
        if !(0.0..=1.0).contains(&body.restitution) {
            let what = format!(
                "must be from 0 (keeps nothing of the approaching speed) to 1 (all of it), is {}",
                shown::number(body.restitution)
            );
            return Err(place.error(value.span(), "restitution", what));
        }
    }
    if let Some(value) = text.friction {
        body.friction = value.get_ref().0;
        if !(0.0..=f64::INFINITY).contains(&body.friction) {
            let what = format!(
                "must be a coefficient from 0 (smooth) to inf (never slips), is {}",
                shown::number(body.friction)
            );
            return Err(place.error(value.span(), "friction", what));
        }
    }
    body.groups = group_names(&place, "groups", text.groups)?;
    body.collides_with = group_names(&place, "collides_with", text.collides_with)?;
    body.turn = turn(
        &place,
        (text.turns, text.spin, text.torque, text.inertia),
        &body,
        obstacles,
    )?;
    if let Some(value) = text.colour {
        body.colour = colour::parse(value.get_ref());
        if body.colour.is_none() {
            let what = format!(
                "must look like `#c8553d`, is `{}`",
                shown::name(value.get_ref())
            );
            return Err(place.error(value.span(), "colour", what));
        }
    }
    match copies {
        Some(copies) => copies.place(&place, &body, before, obstacles),
        None => Ok(vec![body]),
    }
}

/// Names of groups, none of them empty.
fn group_names(
    place: &Place,
    field: &str,
    names: Option<Vec<Spanned<String>>>,
) -> Result<Option<Vec<String>>, SceneError> {
    let Some(names) = names else {
        return Ok(None);
    };
    let empty = names.iter().find(|name| name.get_ref().trim().is_empty());
    match empty {
        Some(empty) => {
            Err(place.error(empty.span(), field, "the name of a group must not be empty"))
        }
        None => Ok(Some(names.into_iter().map(Spanned::into_inner).collect())),
    }
}

/// The fields of a table that concern rotation.
type TurnText = (
    Option<Spanned<bool>>,
    Option<Spanned<Triple>>,
    Option<Spanned<Triple>>,
    Option<Spanned<Triple>>,
);

/// The rotational properties of a body, if it has any, computed after all its other fields.
fn turn(
    place: &Place,
    (turns, spin, torque, inertia): TurnText,
    body: &SceneBody,
    obstacles: &mut Obstacles,
) -> Result<Option<SceneTurn>, SceneError> {
    let Some(turns) = turns.filter(|turns| *turns.get_ref()) else {
        let fields = [("spin", &spin), ("torque", &torque), ("inertia", &inertia)];
        let stray = fields.into_iter().find_map(|(field, value)| {
            let value = value.as_ref()?;
            Some((field, value.span()))
        });
        return match stray {
            Some((field, span)) => {
                let what = "is of a body that turns: say `turns = true`, or leave it out";
                Err(place.error(span, field, what))
            }
            None => Ok(None),
        };
    };
    let inertia_span = inertia.as_ref().map(Spanned::span);
    let spin_span = spin.as_ref().map_or(turns.span(), Spanned::span);
    let turn = SceneTurn {
        spin: place.vector("spin", spin)?,
        torque: place.vector("torque", torque)?,
        inertia: inertia.map(|value| value.get_ref().0),
    };
    // The inertia is computed here as the world will do it, because errors can name the line here.
    let turning = SceneBody {
        turn: Some(turn),
        ..body.clone()
    };
    match obstacles.baked.inertia(&turning) {
        Ok(Some(inertia)) if !body.immovable => {
            let momentum = angular_momentum(&turning, &inertia, turn.spin);
            match momentum.abs().cmple(DVec3::splat(LARGEST)).all() {
                true => Ok(Some(turn)),
                false => {
                    let what = "the angular momentum must be within ±1e100 kg m²/s: lower the spin, or the inertia";
                    Err(place.error(spin_span, "spin", what))
                }
            }
        }
        Ok(_) => Ok(Some(turn)),
        Err(what) => match inertia_span {
            Some(span) => Err(place.error(span, "inertia", what)),
            None => Err(place.error(turns.span(), "turns", what)),
        },
    }
}

/// The reason why a mesh cannot be rotated and scaled, as text.
fn baked_what(error: &MeshError, scale: DVec3) -> String {
    let [x, y, z] = scale.to_array().map(shown::number);
    match error {
        MeshError::NotFinite { .. } => {
            format!("is [{x}, {y}, {z}]: the mesh grows beyond 3.4e38 m; give numbers nearer to 1")
        }
        MeshError::Scale { .. } => {
            format!("is [{x}, {y}, {z}]: nothing is left of the mesh; give numbers nearer to 1")
        }
        other => other.to_string(),
    }
}

/// The shape of a table, which must have exactly one.
fn shape(place: &Place, text: &Body, meshes: &mut MeshSource) -> Result<SceneShape, SceneError> {
    match (&text.mesh, &text.sphere, &text.half_space) {
        (Some(name), None, None) => {
            let mesh = meshes.get(name.get_ref());
            mesh.map(SceneShape::Mesh)
                .map_err(|what| place.error(name.span(), "mesh", what))
        }
        (None, Some(value), None) => {
            let Number(radius) = *value.get_ref();
            if !(0.0..=LARGEST).contains(&radius) {
                let what = format!(
                    "must be a radius in m from 0 to 1e100, is {}",
                    shown::number(radius)
                );
                return Err(place.error(value.span(), "sphere", what));
            }
            Ok(SceneShape::Sphere { radius })
        }
        (None, None, Some(value)) => half_space(place, value),
        (None, None, None) => Err(place.error(
            text.name.span(),
            "mesh",
            "is missing: a body has one of `mesh`, `sphere` and `half-space`",
        )),
        (Some(_), Some(value), _) => Err(second_shape(place, value, "sphere")),
        (_, _, Some(value)) => Err(second_shape(place, value, "half-space")),
    }
}

fn half_space(place: &Place, value: &Spanned<Triple>) -> Result<SceneShape, SceneError> {
    let normal = place.vector("half-space", Some(value.clone()))?;
    if normal == DVec3::ZERO {
        let what = "must be the direction that points out of it, such as [0, 1, 0] for a floor, \
                    is [0, 0, 0]";
        return Err(place.error(value.span(), "half-space", what));
    }
    Ok(SceneShape::HalfSpace { normal })
}

fn second_shape<T>(place: &Place, value: &Spanned<T>, field: &str) -> SceneError {
    let what = "the body has a shape already: give one of `mesh`, `sphere` and `half-space`";
    place.error(value.span(), field, what)
}

/// Refuses fields that do not apply to a body of that shape.
fn refuse_senseless(place: &Place, text: &Body, shape: &SceneShape) -> Result<(), SceneError> {
    let wrong = |span, field, what: String| Err(place.error(span, field, what));
    let shape = match shape {
        SceneShape::Mesh(_) => None,
        SceneShape::Sphere { .. } => Some(("sphere", "`sphere` is its radius")),
        SceneShape::HalfSpace { .. } => Some(("half-space", "`half-space` is its normal")),
    };
    if let Some((kind, instead)) = shape {
        let what = format!("a {kind} has none, {instead}: leave it out");
        if let Some(value) = &text.rotation {
            return wrong(value.span(), "rotation", what);
        }
        if let Some(value) = &text.scale {
            return wrong(value.span(), "scale", what);
        }
    }
    let is_half_space = text.half_space.is_some();
    if let (Some(turns), true) = (&text.turns, is_half_space)
        && *turns.get_ref()
    {
        let what = "a half-space cannot turn: leave it out".to_owned();
        return wrong(turns.span(), "turns", what);
    }
    match (&text.mass, &text.immovable) {
        (Some(mass), _) if is_half_space => {
            let what = "a half-space is always immovable: leave it out".to_owned();
            wrong(mass.span(), "mass", what)
        }
        (_, Some(immovable)) if is_half_space && !immovable.get_ref() => {
            let what = "a half-space is always immovable: leave it out".to_owned();
            wrong(immovable.span(), "immovable", what)
        }
        (Some(mass), Some(immovable)) if *immovable.get_ref() => {
            let what = "an immovable body needs no mass: leave out one of both".to_owned();
            wrong(mass.span(), "mass", what)
        }
        _ => Ok(()),
    }
}

fn mass(place: &Place, value: &Spanned<Number>) -> Result<f64, SceneError> {
    let Number(mass) = *value.get_ref();
    if (1.0 / LARGEST..=LARGEST).contains(&mass) {
        return Ok(mass);
    }
    let mut what = format!(
        "must be a mass in kg above 0 (from 1e-100 to 1e100), is {}",
        shown::number(mass)
    );
    if mass == f64::INFINITY {
        what += "; a body that nothing moves is `immovable = true`";
    }
    Err(place.error(value.span(), "mass", what))
}
