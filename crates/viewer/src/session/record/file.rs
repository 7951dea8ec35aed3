//! Recorded runs as files: TOML text with the scene, the inputs and the hashes.

use std::fmt;
use std::path::{Path, PathBuf};

use scene::{Scene, SceneError, file, shown};
use serde::{Deserialize, Serialize};
use sim_core::{Collision, DVec3, Force, Method, Settings};

use super::{Input, MOST_STEPS, Record};

/// The version of the file format that this program writes.
const VERSION: u32 = 1;
/// The largest file that is read, bytes.
const MAX_BYTES: u64 = 1 << 28;
const HEAD: &str = "# A recorded run. `cowbell replay FILE` shows it again, `cowbell replay FILE --verify` checks it.\n";

/// The reason why a file gives no record.
#[derive(Debug)]
pub struct RecordError {
    path: PathBuf,
    what: String,
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {}",
            shown::path(&self.path),
            shown::part(&self.what)
        )
    }
}

impl std::error::Error for RecordError {}

/// The contents of the file, in its order.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RunText {
    cowbell_run: u32,
    name: String,
    scene: String,
    /// One hash of sixteen digits per line: of the start, and after each step.
    hashes: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    input: Vec<InputText>,
}

/// An input after a number of steps: exactly one of the fields.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct InputText {
    step: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    body: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    spin: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    force: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mass: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    immovable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    restitution: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    friction: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    settings: Option<SettingsText>,
    /// A scene of the same bodies, of which only the forces are used.
    #[serde(skip_serializing_if = "Option::is_none")]
    forces: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    separate: Option<bool>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SettingsText {
    dt: f64,
    method: String,
    collision: String,
    tolerance: f64,
}

const COLLISIONS: [(&str, Collision); 3] = [
    ("continuous", Collision::Continuous),
    ("bvh", Collision::Bvh),
    ("naive", Collision::Naive),
];

/// Whether a path is that of a recorded run, by its extension.
pub fn is_run_file(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("run"))
}

impl Record {
    /// The text of a file at `path` that reproduces this record. Forces whose law is code have no text.
    pub fn text_at(&self, path: &Path) -> Result<String, SceneError> {
        let mut input = Vec::new();
        for (step, done) in &self.inputs {
            input.push(InputText {
                step: *step,
                ..self.input_text(done, path)?
            });
        }
        let text = RunText {
            cowbell_run: VERSION,
            name: self.scene.name.clone(),
            scene: self.scene.text_at(path)?,
            hashes: self.hashes.iter().map(|h| format!("{h:016x}\n")).collect(),
            input,
        };
        // Serializing cannot fail: text and numbers come first, tables last.
        let text = toml::to_string_pretty(&text).unwrap_or_default();
        Ok(HEAD.to_owned() + &text)
    }

    fn input_text(&self, input: &Input, path: &Path) -> Result<InputText, SceneError> {
        let mut text = InputText::default();
        let mut name =
            |body: usize| text.body = self.scene.bodies.get(body).map(|b| b.name.clone());
        match input {
            &Input::Position(body, value) => {
                name(body);
                text.position = Some(value.to_array());
            }
            &Input::Velocity(body, value) => {
                name(body);
                text.velocity = Some(value.to_array());
            }
            &Input::Spin(body, value) => {
                name(body);
                text.spin = Some(value.to_array());
            }
            &Input::Force(body, value) => {
                name(body);
                text.force = Some(value.to_array());
            }
            &Input::Mass(body, value) => {
                name(body);
                text.mass = Some(value);
            }
            &Input::Immovable(body) => {
                name(body);
                text.immovable = Some(true);
            }
            &Input::Restitution(body, value) => {
                name(body);
                text.restitution = Some(value);
            }
            &Input::Friction(body, value) => {
                name(body);
                text.friction = Some(value);
            }
            Input::Settings(settings) => {
                let known = COLLISIONS
                    .iter()
                    .find(|(_, how)| *how == settings.collision);
                text.settings = Some(SettingsText {
                    dt: settings.dt,
                    method: settings.method.name.to_owned(),
                    collision: known.map_or("", |(name, _)| name).to_owned(),
                    tolerance: settings.tolerance,
                });
            }
            Input::Forces(forces) => {
                let mut scene = self.scene.clone();
                scene.forces.clone_from(forces);
                text.forces = Some(scene.text_at(path)?);
            }
            Input::Separate => text.separate = Some(true),
        }
        Ok(text)
    }

    /// Reads a record from a file.
    pub fn read(path: &Path) -> Result<Record, RecordError> {
        let refused = |what: String| RecordError {
            path: path.to_owned(),
            what,
        };
        let bytes = file::read(path, MAX_BYTES)
            .map_err(|refusal| refused(format!("cannot read the recorded run: {refusal}")))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| refused("it is not UTF-8 text: record the run again".to_owned()))?;
        Record::parse(&text, path).map_err(refused)
    }

    fn parse(text: &str, path: &Path) -> Result<Record, String> {
        let text: RunText = toml::from_str(text).map_err(|error| {
            let before = error.span().map_or("", |span| &text[..span.start]);
            let line = before.matches('\n').count() + 1;
            format!("line {line}: {}", error.message())
        })?;
        if text.cowbell_run != VERSION {
            return Err(format!(
                "cowbell-run = {}: this program reads {VERSION}; use the one that recorded it",
                text.cowbell_run
            ));
        }
        let mut scene =
            Scene::parse(&text.scene, path).map_err(|error| format!("its scene: {error}"))?;
        scene.name = text.name;
        let mut hashes = Vec::new();
        for (n, word) in text.hashes.split_ascii_whitespace().enumerate() {
            let hash = u64::from_str_radix(word, 16)
                .ok()
                .filter(|_| word.len() == 16);
            hashes.push(hash.ok_or_else(|| {
                format!("hashes: that of step {n} is `{word}`, not 16 hexadecimal digits")
            })?);
        }
        if hashes.is_empty() || hashes.len() > MOST_STEPS + 1 {
            return Err(format!(
                "hashes: there are {}, and must be from 1 to {}",
                hashes.len(),
                MOST_STEPS + 1
            ));
        }
        let mut inputs: Vec<(u64, Input)> = Vec::new();
        for (n, input) in text.input.into_iter().enumerate() {
            let step = input.step;
            let last = inputs.last().map_or(0, |&(step, _)| step);
            if step < last || step >= hashes.len() as u64 {
                return Err(format!(
                    "input {}: step {step} must be from {last} to {}",
                    n + 1,
                    hashes.len() - 1
                ));
            }
            let input = input.read(&scene, path);
            inputs.push((
                step,
                input.map_err(|what| format!("input {}: {what}", n + 1))?,
            ));
        }
        Ok(Record {
            scene,
            inputs,
            hashes,
        })
    }
}

impl InputText {
    fn read(self, scene: &Scene, path: &Path) -> Result<Input, String> {
        let name = self.body.clone();
        let body = || {
            let name = name.as_deref().ok_or("it names no body")?;
            let place = scene.bodies.iter().position(|body| body.name == name);
            place.ok_or_else(|| format!("there is no body `{name}`"))
        };
        let mut found = Vec::new();
        if let Some(at) = self.position {
            found.push(Input::Position(body()?, DVec3::from(at)));
        }
        if let Some(velocity) = self.velocity {
            found.push(Input::Velocity(body()?, DVec3::from(velocity)));
        }
        if let Some(spin) = self.spin {
            found.push(Input::Spin(body()?, DVec3::from(spin)));
        }
        if let Some(force) = self.force {
            found.push(Input::Force(body()?, DVec3::from(force)));
        }
        if let Some(mass) = self.mass {
            // In records from before bodies had kinds, an infinite mass means an immovable body.
            found.push(match mass == f64::INFINITY {
                true => Input::Immovable(body()?),
                false => Input::Mass(body()?, mass),
            });
        }
        if self.immovable == Some(true) {
            found.push(Input::Immovable(body()?));
        }
        if let Some(restitution) = self.restitution {
            found.push(Input::Restitution(body()?, restitution));
        }
        if let Some(friction) = self.friction {
            found.push(Input::Friction(body()?, friction));
        }
        if let Some(settings) = self.settings {
            found.push(Input::Settings(settings.read()?));
        }
        if let Some(text) = self.forces {
            found.push(Input::Forces(forces(&text, scene, path)?));
        }
        if self.separate == Some(true) {
            found.push(Input::Separate);
        }
        match found.len() {
            1 => Ok(found.swap_remove(0)),
            0 => Err("it changes nothing".to_owned()),
            _ => Err("it changes several things: give each an input of its own".to_owned()),
        }
    }
}

impl SettingsText {
    fn read(self) -> Result<Settings, String> {
        let method = Method::named(&self.method)
            .ok_or_else(|| format!("there is no method `{}`", self.method))?;
        let known = COLLISIONS.iter().find(|(name, _)| *name == self.collision);
        let (_, collision) = known
            .ok_or_else(|| format!("collision `{}`: continuous, bvh or naive", self.collision))?;
        Ok(Settings {
            dt: self.dt,
            method,
            collision: *collision,
            tolerance: self.tolerance,
        })
    }
}

fn forces(text: &str, scene: &Scene, path: &Path) -> Result<Vec<Force>, String> {
    let other = Scene::parse(text, path).map_err(|error| format!("forces: {error}"))?;
    let names = |scene: &Scene| -> Vec<String> {
        scene.bodies.iter().map(|body| body.name.clone()).collect()
    };
    match names(&other) == names(scene) {
        true => Ok(other.forces),
        false => Err("forces: its bodies are not those of the scene".to_owned()),
    }
}
