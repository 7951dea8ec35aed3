//! Figures of a running world: what a step costs, and how far the result has drifted.

use std::time::Duration;

use sim_core::{DVec3, Force, World};

/// A mean in which old values fade: each new one counts a tenth.
#[derive(Clone, Copy, Debug, Default)]
pub struct Smoothed(Option<f64>);

impl Smoothed {
    /// Takes in a new duration.
    pub fn add(&mut self, value: Duration) {
        let value = value.as_secs_f64();
        self.0 = Some(self.0.map_or(value, |mean| mean + 0.1 * (value - mean)));
    }

    /// The mean, s; none before the first value.
    pub fn seconds(&self) -> Option<f64> {
        self.0
    }
}

/// Speed of the last frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// Real time that one step takes.
    pub cost: Smoothed,
    /// Real time from frame to frame while running.
    pub frame: Smoothed,
    /// Steps taken in the last frame.
    pub steps_per_frame: u32,
    /// Real time given up since the start, because steps came too late or took too long.
    pub behind: Duration,
    /// Frames since time was last given up, while it still shows.
    since_behind: Option<u32>,
}

impl Figures {
    /// Notes the real time that a frame gave up.
    pub fn fell_behind(&mut self, dropped: Duration) {
        self.behind += dropped;
        // A second at 60 frames: long enough to be read.
        self.since_behind = match self.since_behind {
            _ if !dropped.is_zero() => Some(0),
            Some(frames) if frames < 60 => Some(frames + 1),
            _ => None,
        };
    }

    /// Whether the simulation is slower than real time just now.
    pub fn is_behind(&self) -> bool {
        self.since_behind.is_some()
    }
}

/// The state of a world at the moment that drift is counted from.
///
/// What constant forces and weight do is known: the work `F . dx`, the impulse `F t`, and between
/// collisions the path `x + v t + F t^2 / 2m`. What other forces do is known where they have a
/// potential, to the energy, and where they act between bodies, to the momentum. Drift is what
/// remains after that is taken away, the error of method and collisions.
#[derive(Clone, Debug)]
pub struct Reference {
    time: f64,
    energy: f64,
    /// Potential energy of forces that are not constant, J.
    potential: f64,
    momentum: DVec3,
    impacts: u64,
    /// Position and velocity of each body.
    motion: Vec<(DVec3, DVec3)>,
}

/// Errors since a [`Reference`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Relative change of kinetic plus potential energy; none while it is not finite.
    pub energy: Option<f64>,
    /// Whether friction or an inelastic impact may have taken energy away, or a moving body that
    /// nothing moves have given it: then the change is no error.
    pub dissipates: bool,
    /// Error of the momentum less the impulse of the forces, relative to the sum of `m |v|`;
    /// known as long as nothing but constant forces acts from outside, and nothing has hit what
    /// may be immovable.
    pub momentum: Option<f64>,
    /// Largest distance of a body from its exact path, m; known as long as nothing collides and
    /// no force but constant ones acts.
    pub position: Option<f64>,
}

impl Reference {
    /// Counts drift from the present state of `world`.
    pub fn of(world: &World) -> Self {
        Self {
            time: world.time(),
            energy: world.kinetic_energy(),
            potential: varying_potential(world),
            momentum: world.momentum(),
            impacts: world.impacts(),
            motion: (0..world.len())
                .map(|i| (world.position(i), world.velocity(i)))
                .collect(),
        }
    }

    /// The drift of `world`, which must have the same bodies.
    pub fn drift(&self, world: &World) -> Drift {
        let elapsed = world.time() - self.time;
        let weight = weight(world);
        let mut work = 0.0;
        let mut impulse = DVec3::ZERO;
        let mut speed = 0.0;
        let mut away: f64 = 0.0;
        for (i, &(start, velocity)) in self.motion.iter().enumerate() {
            if world.mass(i).is_infinite() {
                continue;
            }
            let force = world.force(i) + world.mass(i) * weight;
            work += force.dot(world.position(i) - start);
            impulse += force * elapsed;
            speed += world.mass(i) * world.velocity(i).length();
            let bend = force / world.mass(i) * (0.5 * elapsed * elapsed);
            let exact = start + velocity * elapsed + bend;
            away = away.max((world.position(i) - exact).length());
        }
        let (energy, potential) = (world.kinetic_energy(), varying_potential(world));
        let change = energy - self.energy - work + (potential - self.potential);
        // A body at its turning point is at rest: the energy is elsewhere then.
        let parts = [energy, self.energy, work, potential, self.potential];
        let scale = parts
            .into_iter()
            .fold(0.0, |most: f64, part| most.max(part.abs()));
        let momentum = (world.momentum() - impulse - self.momentum).length();
        let momentum = ratio(momentum, speed.max(self.momentum.length()));
        let (forces, same_impacts) = (world.forces(), world.impacts() == self.impacts);
        let mut bodies = 0..world.len();
        let changes_in_impacts = |i| {
            let is_driven = world.mass(i).is_infinite() && world.velocity(i) != DVec3::ZERO;
            world.restitution(i) < 1.0 || is_driven
        };
        // One rough body among smooth ones slides freely.
        let is_rough = bodies.clone().filter(|&i| world.friction(i) > 0.0).count() > 1;
        let changes = is_rough || bodies.clone().any(changes_in_impacts);
        let dissipates_in_impacts = !same_impacts && changes;
        let closed = same_impacts || bodies.all(|i| world.mass(i).is_finite());
        let kept = |force| is_weight(force) || is_internal(force);
        Drift {
            energy: Some(ratio(change, scale)).filter(|change| change.is_finite()),
            dissipates: dissipates_in_impacts || forces.iter().any(dissipates),
            momentum: (closed && forces.iter().all(kept)).then_some(momentum),
            position: (same_impacts && forces.iter().all(is_weight)).then_some(away),
        }
    }
}

/// The part of the potential energy that is not that of a constant force, J.
fn varying_potential(world: &World) -> f64 {
    if world.forces().iter().all(is_weight) {
        return 0.0;
    }
    let weight = weight(world);
    let constant = |i| (world.force(i) + world.mass(i) * weight).dot(world.position(i));
    let movable = (0..world.len()).filter(|&i| world.mass(i).is_finite());
    world.potential_energy() + movable.map(constant).sum::<f64>()
}

/// Acceleration by all weights, m/s².
fn weight(world: &World) -> DVec3 {
    let weights = world.forces().iter().filter_map(|force| match force {
        Force::Gravity { acceleration } => Some(*acceleration),
        _ => None,
    });
    weights.sum()
}

fn is_weight(force: &Force) -> bool {
    matches!(force, Force::Gravity { .. })
}

/// Whether it acts between bodies, so that their momentum stays.
fn is_internal(force: &Force) -> bool {
    matches!(
        force,
        Force::Spring { .. } | Force::Gravitation { .. } | Force::Pair { .. }
    )
}

/// Whether it may change the energy for good.
fn dissipates(force: &Force) -> bool {
    match *force {
        Force::Gravity { .. } | Force::Attraction { .. } | Force::Gravitation { .. } => false,
        Force::Anchor { damping, .. } | Force::Spring { damping, .. } => damping > 0.0,
        Force::LinearDrag { coefficient, .. } | Force::QuadraticDrag { coefficient, .. } => {
            coefficient > 0.0
        }
        Force::Body { .. } | Force::Pair { .. } => true,
    }
}

/// `error / scale`, and 0 where nothing moved.
fn ratio(error: f64, scale: f64) -> f64 {
    if scale > 0.0 { error / scale } else { 0.0 }
}
