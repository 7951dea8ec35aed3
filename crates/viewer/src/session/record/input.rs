//! The inputs by which a user can change a running world.

use sim_core::{BodyKind, DVec3, Force, SeparateError, Settings, World, WorldError};

/// One change. It has the same effect the first time and in a replay.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// The settings of the world.
    Settings(Settings),
    /// The position of a body's origin, m.
    Position(usize, DVec3),
    /// Its velocity, m/s.
    Velocity(usize, DVec3),
    /// Its angular velocity, rad/s.
    Spin(usize, DVec3),
    /// The constant force on it, N.
    Force(usize, DVec3),
    /// Its mass, kg; the body becomes movable.
    Mass(usize, f64),
    /// Makes a body immovable.
    Immovable(usize),
    /// Its coefficient of restitution.
    Restitution(usize, f64),
    /// Its coefficient of friction.
    Friction(usize, f64),
    /// All forces except the constant ones.
    Forces(Vec<Force>),
    /// Moves overlapping bodies apart.
    Separate,
}

/// The reason why a change was refused.
#[derive(Clone, Debug)]
pub enum InputError {
    /// The world refused it.
    World(WorldError),
    /// Bodies cannot be moved apart.
    Separate(SeparateError),
}

impl From<WorldError> for InputError {
    fn from(error: WorldError) -> Self {
        Self::World(error)
    }
}

impl Input {
    /// Makes the change; returns the bodies that were moved apart. A refused change leaves the world as it was.
    pub fn apply(&self, world: &mut World) -> Result<Vec<usize>, InputError> {
        match *self {
            Self::Settings(settings) => world.set_settings(settings)?,
            Self::Position(body, origin) => {
                let to_centre = match world.turns(body) {
                    true => world.position(body) - world.origin(body),
                    false => DVec3::ZERO,
                };
                world.set_position(body, origin + to_centre)?;
            }
            Self::Spin(body, spin) => world.set_spin(body, spin)?,
            Self::Velocity(body, velocity) => set_velocity(world, body, velocity)?,
            Self::Force(body, force) => world.set_force(body, force)?,
            Self::Mass(body, mass) => {
                world.set_mass(body, mass)?;
                world.set_kind(body, BodyKind::Dynamic)?;
            }
            Self::Immovable(body) => world.set_kind(body, BodyKind::Kinematic)?,
            Self::Restitution(body, part) => world.set_restitution(body, part)?,
            Self::Friction(body, friction) => world.set_friction(body, friction)?,
            Self::Forces(ref forces) => *world = with_forces(world, forces)?,
            Self::Separate => return world.separate().map_err(InputError::Separate),
        }
        Ok(Vec::new())
    }
}

/// Gives a body a velocity; an immovable body so far at rest becomes a moving one.
fn set_velocity(world: &mut World, body: usize, velocity: DVec3) -> Result<(), WorldError> {
    let stands = body < world.len() && world.kind(body) == BodyKind::Static;
    if stands {
        world.set_kind(body, BodyKind::Kinematic)?;
    }
    let done = world.set_velocity(body, velocity);
    if stands && done.is_err() {
        world.set_kind(body, BodyKind::Static)?;
    }
    done
}

/// The same world under other forces.
fn with_forces(world: &World, forces: &[Force]) -> Result<World, WorldError> {
    let mut changed = world.clone();
    while let Some(last) = changed.forces().len().checked_sub(1) {
        changed.remove_force(last)?;
    }
    for force in forces {
        changed.add_force(force.clone())?;
    }
    Ok(changed)
}
