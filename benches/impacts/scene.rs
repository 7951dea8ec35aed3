//! Scenes as every engine gets them.

use std::sync::Arc;

use kit::random::Random;
use sim_core::{DVec3, Mesh};

#[derive(Clone)]
pub(crate) enum Form {
    /// Which way out of it is.
    Wall(DVec3),
    Ball(f64),
    /// A cube as engines know it: half of a side, m.
    Cube(f64),
    Mesh(Arc<Mesh>),
    /// A mesh that nothing moves.
    Ground(Arc<Mesh>),
}

#[derive(Clone)]
pub(crate) struct Item {
    pub(crate) form: Option<Form>,
    pub(crate) position: DVec3,
    pub(crate) velocity: DVec3,
    /// Of a scene whose bodies turn, rad/s.
    pub(crate) spin: DVec3,
    /// Whether it may sweep others that move as well.
    pub(crate) is_bullet: bool,
}

impl Item {
    pub(crate) fn is_fixed(&self) -> bool {
        matches!(self.form, Some(Form::Wall(_) | Form::Ground(_)))
    }

    /// How far it reaches from its middle along each axis, m; walls reach nowhere.
    pub(crate) fn half(&self) -> DVec3 {
        match &self.form {
            &Some(Form::Ball(half) | Form::Cube(half)) => DVec3::splat(half),
            Some(Form::Mesh(mesh) | Form::Ground(mesh)) => {
                let bounds = mesh.bounds();
                bounds.max.as_dvec3().max(-bounds.min.as_dvec3())
            }
            Some(Form::Wall(_)) | None => DVec3::ZERO,
        }
    }
}

/// Bodies of 1 kg, elastic and without friction unless said, that do not turn unless said, and immovable walls.
#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) items: Vec<Item>,
    pub(crate) dt: f64,
    pub(crate) gravity: DVec3,
    pub(crate) restitution: f64,
    pub(crate) friction: f64,
    pub(crate) turns: bool,
    /// Whether engines may pass over what is at rest.
    pub(crate) may_sleep: bool,
}

impl Scene {
    pub(crate) fn new(items: Vec<Item>) -> Scene {
        Scene {
            items,
            dt: 1.0 / 60.0,
            gravity: DVec3::ZERO,
            restitution: 1.0,
            friction: 0.0,
            turns: false,
            may_sleep: false,
        }
    }
}

pub(crate) fn item(form: Form, position: DVec3, velocity: DVec3) -> Item {
    Item {
        form: Some(form),
        position,
        velocity,
        spin: DVec3::ZERO,
        is_bullet: true,
    }
}

pub(crate) fn builtin(name: &str) -> Arc<Mesh> {
    scene::mesh_file::builtin(name).expect("built in")
}

/// Half of a crowd's cubes, or radius of its balls, m.
pub(crate) const HALF: f64 = 0.25;

/// Bodies in a closed box, apart at the start, with speeds up to 2 m/s along each axis; an eighth
/// of the space is theirs if they are cubes. Also half of the box's side, m.
pub(crate) fn crowd(count: usize, form: &Form) -> (Scene, f64) {
    let side = (count as f64).cbrt().ceil() as usize;
    let half_box = 0.5 * side as f64;
    let mut random = Random::splitmix(count as u64);
    let mut vector = || random.vector();
    let mut items: Vec<Item> = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|axis| [axis, -axis])
        .map(|normal| item(Form::Wall(normal), -half_box * normal, DVec3::ZERO))
        .collect();
    for i in 0..count {
        let cell = [i % side, i / side % side, i / side / side].map(|c| c as f64 + 0.5);
        let position = DVec3::from_array(cell) - half_box + 0.2 * vector();
        // Slow enough to be found without; walls are swept by all that is fast.
        items.push(Item {
            is_bullet: false,
            ..item(form.clone(), position, 2.0 * vector())
        });
    }
    (Scene::new(items), half_box)
}
