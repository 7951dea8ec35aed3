//! Scenes as every engine gets them, and who steps them.

mod ball;
mod collisions;
mod crowd;
mod engine;
mod heap;
mod known;
mod ours;
mod pair;
#[cfg(feature = "rapier3d-f64")]
mod rapier;
mod resting;

use std::sync::Arc;

use sim_core::{DVec3, Mesh};

pub use ball::{RADIUS, bouncing_ball};
pub use collisions::COLLISIONS;
pub use crowd::crowd;
pub use engine::{Engine, Who};
pub use heap::heap;
pub use known::{Family, Goal, Known, Run};
pub use ours::{continuous, world};
pub use pair::Pair;
#[cfg(feature = "rapier3d-f64")]
pub use rapier::Rapier;
#[cfg(feature = "rapier3d-f64")]
pub(crate) use rapier::vector;
pub use resting::{RESTING, landing_way, sliding_way};

/// The acceleration of what falls, m/s².
pub const GRAVITY: f64 = kit::worlds::GRAVITY;

/// Half of a cube, or radius of a ball, where there are many, m.
pub const HALF: f64 = 0.25;

/// What a body is to others.
#[derive(Clone, Debug)]
pub enum Form {
    /// Which way out of it is.
    Wall(DVec3),
    /// Its radius, m.
    Ball(f64),
    /// A cube as engines know it: half of a side, m.
    Cube(f64),
    /// Anything of triangles.
    Mesh(Arc<Mesh>),
    /// A mesh that nothing moves.
    Ground(Arc<Mesh>),
}

/// A body at the start.
#[derive(Clone, Debug)]
pub struct Item {
    /// None of a point that meets nothing.
    pub form: Option<Form>,
    /// m
    pub position: DVec3,
    /// m/s
    pub velocity: DVec3,
    /// Of a scene whose bodies turn, rad/s.
    pub spin: DVec3,
    /// Whether it may sweep others that move as well.
    pub is_bullet: bool,
}

impl Item {
    /// A body on its way.
    pub fn new(form: Form, position: DVec3, velocity: DVec3) -> Item {
        Item {
            form: Some(form),
            position,
            velocity,
            spin: DVec3::ZERO,
            is_bullet: true,
        }
    }

    /// One at rest, or slow enough for no engine to need its continuous detection.
    pub fn resting(form: Form, position: DVec3) -> Item {
        Item {
            is_bullet: false,
            ..Item::new(form, position, DVec3::ZERO)
        }
    }

    /// Whether nothing moves it.
    pub fn is_fixed(&self) -> bool {
        matches!(self.form, Some(Form::Wall(_) | Form::Ground(_)))
    }

    /// How far it reaches from its middle along each axis, m; walls reach nowhere.
    pub fn half(&self) -> DVec3 {
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
#[derive(Clone, Debug)]
pub struct Scene {
    /// All bodies.
    pub items: Vec<Item>,
    /// Length of a step, s.
    pub dt: f64,
    /// m/s²
    pub gravity: DVec3,
    /// Of all contacts.
    pub restitution: f64,
    /// Of all contacts.
    pub friction: f64,
    /// Whether bodies turn.
    pub turns: bool,
    /// Whether engines may pass over what is at rest.
    pub may_sleep: bool,
}

impl Scene {
    /// Bodies at 60 Hz that nothing pulls.
    pub fn new(items: Vec<Item>) -> Scene {
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

    /// The same under gravity along y.
    pub fn falling(items: Vec<Item>) -> Scene {
        Scene {
            gravity: -GRAVITY * DVec3::Y,
            ..Scene::new(items)
        }
    }

    /// The bodies that may move.
    pub fn movable(&self) -> impl Iterator<Item = usize> {
        let items = self.items.iter().enumerate();
        items.filter(|(_, item)| !item.is_fixed()).map(|(i, _)| i)
    }
}
