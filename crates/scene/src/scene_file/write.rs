//! A scene to TOML text.

use sim_core::Settings;
use toml::Spanned;

use super::force;
use super::number::{Number, Scale, Triple};
use super::parse::collision_name;
use super::text::{Body, File, Header};
use crate::colour;
use crate::scene::{Scene, SceneBody};

/// The scene file of a scene.
pub(crate) fn write(scene: &Scene) -> String {
    // The rate is the friendlier number, where it says the same.
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
    Body {
        name: spanned(body.name.clone()),
        mesh: spanned(body.mesh.name().to_owned()),
        position: Some(spanned(Triple(body.position))),
        rotation: Some(spanned(Triple(body.rotation))),
        scale: Some(spanned(Scale(body.scale))),
        velocity: Some(spanned(Triple(body.velocity))),
        force: Some(spanned(Triple(body.force))),
        mass: Some(spanned(Number(body.mass))),
        colour: body.colour.map(|c| spanned(colour::format(c))),
    }
}

/// A value that stands in no text yet.
fn spanned<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}
