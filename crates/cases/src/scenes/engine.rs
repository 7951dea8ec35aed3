//! The engines that step scenes: one trait for ours and for peers.

use sim_core::{Bundled, Collision, DQuat, DVec3, StepError};

use super::{Scene, ours};

/// A running scene.
pub trait Engine {
    /// Makes a step.
    fn step(&mut self) -> Result<(), StepError>;

    /// Makes a step, and returns the time of its first impact, s.
    fn step_noting(&mut self) -> Result<Option<f64>, StepError>;

    /// Position of a body, m.
    fn position(&self, body: usize) -> DVec3;

    /// Velocity of a body, m/s.
    fn velocity(&self, body: usize) -> DVec3;

    /// Rotation from the frame of a body's shape to the world.
    fn rotation(&self, body: usize) -> DQuat;

    /// Angular velocity of a body in the world, rad/s.
    fn spin(&self, body: usize) -> DVec3;

    /// Kinetic energy of all bodies, J.
    fn kinetic_energy(&self) -> f64;

    /// The cost of solving contacts together in the last step, if known.
    fn bundled(&self) -> Option<Bundled> {
        None
    }
}

/// An engine by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who {
    /// Ours, with impacts at their times of impact.
    Continuous,
    /// Ours, with collisions at the end of a step.
    Discrete,
    /// `rapier3d-f64`.
    #[cfg(feature = "rapier3d-f64")]
    Rapier,
}

impl Who {
    /// All engines that are compiled in.
    pub const ALL: &[Who] = &[
        Who::Continuous,
        Who::Discrete,
        #[cfg(feature = "rapier3d-f64")]
        Who::Rapier,
    ];

    /// Whether the engine has persisting contacts: the discrete mode has none.
    pub fn has_contacts(self) -> bool {
        self != Who::Discrete
    }

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Who::Continuous => "continuous",
            Who::Discrete => "discrete",
            #[cfg(feature = "rapier3d-f64")]
            Who::Rapier => "Rapier f64",
        }
    }

    /// Starts a scene.
    pub fn start(self, scene: &Scene) -> Box<dyn Engine> {
        match self {
            Who::Continuous => Box::new(ours::continuous(scene)),
            Who::Discrete => Box::new(ours::world(scene, Collision::Bvh, "velocity-verlet")),
            #[cfg(feature = "rapier3d-f64")]
            Who::Rapier => Box::new(super::Rapier::new(scene)),
        }
    }
}
