//! Writes a scene as TOML text.

use glam::DVec3;
use sim_core::Settings;
use toml::Spanned;

use super::force;
use super::number::{Number, Scale, Triple};
use super::parse::collision_name;
use super::text::{Body, File, Header};
use crate::colour;
use crate::scene::{Scene, SceneBody, SceneShape};

/// The scene file of a scene.
pub(crate) fn write(scene: &Scene) -> String {
    // The rate is easier to read, so it is written if it gives exactly the same step.
    let rate = (1.0 / scene.dt).round();
    let has_rate = 1.0 / rate == scene.dt;
    let header = Header {
        title: Some(scene.title.clone()),
        about: Some(scene.about.clone()).filter(|about| !about.is_empty()),
        rate: has_rate.then(|| spanned(Number(rate))),
        dt: (!has_rate).then(|| spanned(Number(scene.dt))),
        method: Some(spanned(scene.method.name.to_owned())),
        collision: Some(spanned(collision_name(scene.collision).to_owned())),
        tolerance: (scene.tolerance != Settings::default().tolerance)
            .then(|| spanned(Number(scene.tolerance))),
        ends: scene.ends.map(|ends| spanned(Number(ends))),
    };
    let file = File {
        header,
        body: scene.bodies.iter().map(body).collect(),
        force: scene
            .forces
            .iter()
            .filter_map(|force| force::write(force, |body| scene.body_name(body)))
            .collect(),
    };
    toml::to_string(&file).expect("strings, numbers and arrays of them have a TOML form")
}

fn body(body: &SceneBody) -> Body {
    let is_half_space = matches!(body.shape, SceneShape::HalfSpace { .. });
    let mut text = Body {
        name: spanned(body.name.clone()),
        mesh: None,
        sphere: None,
        half_space: None,
        position: Some(spanned(Triple(body.position))),
        rotation: None,
        scale: None,
        velocity: Some(spanned(Triple(body.velocity))),
        force: Some(spanned(Triple(body.force))),
        mass: (!is_half_space && !body.immovable).then(|| spanned(Number(body.mass))),
        immovable: (!is_half_space && body.immovable).then(|| spanned(true)),
        restitution: (body.restitution != 1.0).then(|| spanned(Number(body.restitution))),
        friction: (body.friction != 0.0).then(|| spanned(Number(body.friction))),
        groups: body.groups.as_deref().map(names),
        collides_with: body.collides_with.as_deref().map(names),
        turns: body.turn.map(|_| spanned(true)),
        spin: body.turn.map(|turn| spanned(Triple(turn.spin))),
        torque: body
            .turn
            .filter(|turn| turn.torque != DVec3::ZERO)
            .map(|turn| spanned(Triple(turn.torque))),
        inertia: body
            .turn
            .and_then(|turn| turn.inertia)
            .map(|moments| spanned(Triple(moments))),
        colour: body.colour.map(|c| spanned(colour::format(c))),
        copies: None,
        inside: None,
        speed: None,
        seed: None,
    };
    match &body.shape {
        SceneShape::Mesh(mesh) => {
            text.mesh = Some(spanned(mesh.name().to_owned()));
            text.rotation = Some(spanned(Triple(body.rotation)));
            text.scale = Some(spanned(Scale(body.scale)));
        }
        SceneShape::Sphere { radius } => text.sphere = Some(spanned(Number(*radius))),
        SceneShape::HalfSpace { normal } => text.half_space = Some(spanned(Triple(*normal))),
    }
    text
}

fn names(groups: &[String]) -> Vec<Spanned<String>> {
    groups.iter().cloned().map(spanned).collect()
}

/// A value without a position in a text.
fn spanned<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}
