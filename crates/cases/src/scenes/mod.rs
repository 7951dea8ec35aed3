//! Scenes in the form given to every engine, and the engines.

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

/// The acceleration of gravity, m/s².
pub const GRAVITY: f64 = kit::worlds::GRAVITY;

/// Half the edge of a cube, or the radius of a ball, in scenes of many bodies, m.
pub const HALF: f64 = 0.25;

/// The shape of a body.
#[derive(Clone, Debug)]
pub enum Form {
    /// A wall with its outward normal.
    Wall(DVec3),
    /// A ball of a radius, m.
    Ball(f64),
    /// A cube, as a primitive of the engine if it has one: half its edge, m.
    Cube(f64),
    /// A mesh.
    Mesh(Arc<Mesh>),
    /// An immovable mesh.
    Ground(Arc<Mesh>),
}

/// The initial state of a body.
#[derive(Clone, Debug)]
pub struct Item {
    /// `None` for a point, which collides with nothing.
    pub form: Option<Form>,
    /// The position, m.
    pub position: DVec3,
    /// The velocity, m/s.
    pub velocity: DVec3,
    /// The spin, in a scene of turning bodies, rad/s.
    pub spin: DVec3,
    /// Whether continuous detection applies against other moving bodies too.
    pub is_bullet: bool,
}

impl Item {
    /// A moving body.
    pub fn new(form: Form, position: DVec3, velocity: DVec3) -> Item {
        Item {
            form: Some(form),
            position,
            velocity,
            spin: DVec3::ZERO,
            is_bullet: true,
        }
    }

    /// A body at rest, or one so slow that no engine needs continuous detection for it.
    pub fn resting(form: Form, position: DVec3) -> Item {
        Item {
            is_bullet: false,
            ..Item::new(form, position, DVec3::ZERO)
        }
    }

    /// Whether it is immovable.
    pub fn is_fixed(&self) -> bool {
        matches!(self.form, Some(Form::Wall(_) | Form::Ground(_)))
    }

    /// Its half extents along each axis, m; 0 for walls.
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

/// A scene of bodies of 1 kg and immovable walls. Unless stated otherwise, contacts are elastic and frictionless, and
/// bodies do not rotate.
#[derive(Clone, Debug)]
pub struct Scene {
    /// All bodies.
    pub items: Vec<Item>,
    /// Length of a step, s.
    pub dt: f64,
    /// Gravity, m/s².
    pub gravity: DVec3,
    /// Restitution of all contacts.
    pub restitution: f64,
    /// Friction of all contacts.
    pub friction: f64,
    /// Whether bodies rotate.
    pub turns: bool,
    /// Whether engines may let bodies at rest sleep.
    pub may_sleep: bool,
}

impl Scene {
    /// A scene at 60 Hz without gravity.
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

    /// A scene under gravity along y.
    pub fn falling(items: Vec<Item>) -> Scene {
        Scene {
            gravity: -GRAVITY * DVec3::Y,
            ..Scene::new(items)
        }
    }

    /// The movable bodies.
    pub fn movable(&self) -> impl Iterator<Item = usize> {
        let items = self.items.iter().enumerate();
        items.filter(|(_, item)| !item.is_fixed()).map(|(i, _)| i)
    }
}
