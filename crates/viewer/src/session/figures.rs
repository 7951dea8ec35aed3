//! Figures of a running world: the cost of a step, and the drift of energy and momentum.

use std::time::Duration;

use sim_core::{DVec3, Force, World};

use crate::number;

/// An exponential moving average: each new value has the weight 0.1.
#[derive(Clone, Copy, Debug, Default)]
pub struct Smoothed(Option<f64>);

impl Smoothed {
    /// Adds a duration.
    pub fn add(&mut self, value: Duration) {
        let value = value.as_secs_f64();
        self.0 = Some(self.0.map_or(value, |mean| mean + 0.1 * (value - mean)));
    }

    /// The mean, s; `None` before the first value.
    pub fn seconds(&self) -> Option<f64> {
        self.0
    }
}

/// The speed of the last frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// Real time that one step takes.
    pub cost: Smoothed,
    /// Real time from frame to frame while running.
    pub frame: Smoothed,
    /// Steps taken in the last frame.
    pub steps_per_frame: u32,
    /// Real time dropped since the start, because steps came too late or took too long.
    pub behind: Duration,
    /// Frames since time was last dropped, while that is shown.
    since_behind: Option<u32>,
}

impl Figures {
    /// Records the real time that a frame dropped.
    pub fn fell_behind(&mut self, dropped: Duration) {
        self.behind += dropped;
        // One second at 60 frames per second: long enough to be read.
        self.since_behind = match self.since_behind {
            _ if !dropped.is_zero() => Some(0),
            Some(frames) if frames < 60 => Some(frames + 1),
            _ => None,
        };
    }

    /// Whether the simulation is slower than real time now.
    pub fn is_behind(&self) -> bool {
        self.since_behind.is_some()
    }
}

/// The state of a world relative to which drift is computed.
///
/// The effects of constant forces and weight are known: the work `F . dx` and the impulse `F t`. The energy of other
/// forces is known if they have a potential, and their effect on the momentum is known if they act between movable
/// bodies. Drift is the rest, the error of method and collisions.
/// what remains after that is taken away, the error of method and collisions.
#[derive(Clone, Debug)]
pub struct Reference {
    time: f64,
    energy: f64,
    /// Potential energy of the forces that are not constant, J.
    potential: f64,
    /// Sum of kinetic and potential energy, J; 0 if it is only rounding error.
    total: f64,
    momentum: DVec3,
    impacts: u64,
    /// The number of steps that ended with bodies in contact.
    contact_steps: u64,
    /// Position and speed of each body.
    motion: Vec<(DVec3, f64)>,
}

/// Errors since a [`Reference`]. Relative errors are relative to the value at the start plus the known changes, never
/// to the present motion: that contains the error, and an unbounded error would appear as one of 100 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Change of kinetic plus potential energy, J; `None` if it is not finite.
    pub energy: Option<f64>,
    /// The change relative to the energy at the start; `None` if that is 0.
    pub relative_energy: Option<f64>,
    /// Whether friction or an inelastic impact may have dissipated energy; a loss is then no error.
    pub dissipates: bool,
    /// Whether a moving immovable body or an external law may have added or removed energy; then no change is an error.
    pub driven: bool,
    /// Error of the momentum minus the impulse of the forces, kg m/s. It is known while all external forces are
    /// constant and no body has hit one that may be immovable.
    pub momentum: Option<f64>,
    /// The error relative to `pushes`; `None` if that is 0.
    pub relative_momentum: Option<f64>,
    /// The sum of `m |v|` at the start and of the constant forces' `|F| t` since, kg m/s.
    pub pushes: f64,
}

impl Reference {
    /// A reference at the present state of `world`.
    pub fn of(world: &World) -> Self {
        Self {
            time: world.time(),
            energy: world.kinetic_energy(),
            potential: varying_potential(world),
            total: total_energy(world),
            momentum: world.momentum(),
            impacts: world.impacts(),
            contact_steps: world.contact_steps(),
            motion: (0..world.len())
                .map(|i| (world.position(i), world.velocity(i).length()))
                .collect(),
        }
    }

    /// The drift of `world`, which must have the same bodies.
    pub fn drift(&self, world: &World) -> Drift {
        let elapsed = world.time() - self.time;
        let weight = weight(world);
        let mut work = 0.0;
        let mut impulse = DVec3::ZERO;
        let mut pushes = 0.0;
        for i in movable(world) {
            let (start, speed) = self.motion[i];
            let force = world.force(i) + world.mass(i) * weight;
            work += force.dot(world.position(i) - start);
            impulse += force * elapsed;
            pushes += world.mass(i) * speed + force.length() * elapsed;
        }
        let energy = (world.kinetic_energy() - self.energy - work)
            + (varying_potential(world) - self.potential);
        let energy = Some(energy).filter(|change| change.is_finite());
        let forces = world.forces();
        // Whether any bodies have met or been in contact.
        let has_met =
            world.impacts() != self.impacts || world.contact_steps() != self.contact_steps;
        let mut bodies = 0..world.len();
        let inelastic = has_met && bodies.clone().any(|i| world.restitution(i) < 1.0);
        // One rough body among smooth ones slides without friction.
        let rough = has_met && bodies.clone().filter(|&i| world.friction(i) > 0.0).count() > 1;
        let pushed = has_met && bodies.clone().any(|i| is_driven(world, i));
        let closed = !has_met || bodies.all(|i| world.kind(i).is_movable());
        let kept = |force| is_weight(force) || is_internal(world, force);
        let momentum = (world.momentum() - impulse - self.momentum).length();
        let momentum = (closed && forces.iter().all(kept)).then_some(momentum);
        Drift {
            energy,
            relative_energy: energy.and_then(|change| ratio(change, self.total.abs())),
            dissipates: inelastic || rough || forces.iter().any(|force| force.nature().dissipates),
            driven: pushed || forces.iter().any(|force| drives(world, force)),
            momentum,
            relative_momentum: momentum.and_then(|error| ratio(error, pushes)),
            pushes,
        }
    }
}

impl Drift {
    /// Whether the change of the energy is an error: every change is, unless something may drive the bodies; only a
    /// gain is, if something may dissipate energy.
    pub fn energy_is_error(&self) -> bool {
        let gains = self.energy.is_some_and(|change| change > 0.0);
        !self.driven && (!self.dissipates || gains)
    }

    /// The change of the energy as text, relative if possible, and in J.
    pub fn energy_text(&self) -> String {
        let Some(change) = self.energy else {
            return "unknown: unbounded".to_owned();
        };
        relative_and_absolute(self.relative_energy, change, "J")
    }

    /// The error of the momentum as text; `None` if it is not known.
    pub fn momentum_text(&self) -> Option<String> {
        let error = self.momentum?;
        Some(relative_and_absolute(
            self.relative_momentum,
            error,
            "kg m/s",
        ))
    }
}

fn relative_and_absolute(relative: Option<f64>, absolute: f64, unit: &str) -> String {
    let absolute = format!("{} {unit}", number::error(absolute));
    match relative {
        Some(relative) => format!("{} ({absolute})", number::error(relative)),
        None => format!("{absolute} (0 at the start)"),
    }
}

fn movable(world: &World) -> impl Iterator<Item = usize> {
    (0..world.len()).filter(|&i| world.kind(i).is_movable())
}

/// Sum of kinetic and potential energy, J; 0 if it is at most the rounding error of its parts, as for bodies at rest on
/// both sides of the height of zero potential.
fn total_energy(world: &World) -> f64 {
    let weight = weight(world);
    let constant = |i| (world.force(i) + world.mass(i) * weight).dot(world.position(i));
    let total = world.kinetic_energy() + world.potential_energy();
    let parts = world.kinetic_energy()
        + varying_potential(world).abs()
        + movable(world).map(|i| constant(i).abs()).sum::<f64>();
    // One unit of rounding for each body in a sum of potentials, and some for its products.
    let rounding = f64::EPSILON * (world.len() + 4) as f64 * parts;
    if total.abs() > rounding { total } else { 0.0 }
}

/// The potential energy of the forces that are not constant, J.
fn varying_potential(world: &World) -> f64 {
    if world.forces().iter().all(is_weight) {
        return 0.0;
    }
    let weight = weight(world);
    let constant = |i| (world.force(i) + world.mass(i) * weight).dot(world.position(i));
    world.potential_energy() + movable(world).map(constant).sum::<f64>()
}

/// Sum of the accelerations of all weights, m/s².
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

/// Whether a force acts between movable bodies alone, so that it conserves their momentum. Forces between every two
/// bodies name none, and leave out immovable ones.
fn is_internal(world: &World, force: &Force) -> bool {
    force.is_mutual() && force.bodies().all(|i| world.kind(i).is_movable())
}

/// Whether a force may add energy: by its law, or as a tie to a moving immovable body.
fn drives(world: &World, force: &Force) -> bool {
    let is_moved = force.is_mutual() && force.bodies().any(|i| is_driven(world, i));
    force.nature().drives || is_moved
}

/// Whether an immovable body moves: it keeps its velocity and spin, whatever it meets.
fn is_driven(world: &World, i: usize) -> bool {
    let moves = world.velocity(i) != DVec3::ZERO || world.spin(i) != DVec3::ZERO;
    !world.kind(i).is_movable() && moves
}

/// `error / scale`, if the scale is not 0.
fn ratio(error: f64, scale: f64) -> Option<f64> {
    (scale > 0.0).then(|| error / scale)
}
