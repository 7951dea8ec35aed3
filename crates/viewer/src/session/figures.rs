//! Figures of a running world: what a step costs, and how far the result has drifted.

use std::time::Duration;

use sim_core::{DVec3, World};

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

/// Energy and momentum at the moment that drift is counted from.
///
/// Forces here are constant vectors, so what they add is known: the work `F . dx` and the
/// impulse `F dt`. Drift is what remains after they are taken away, the error of method and
/// collisions; in exact arithmetic and with an exact method it is 0.
#[derive(Clone, Debug)]
pub struct Reference {
    time: f64,
    energy: f64,
    momentum: DVec3,
    positions: Vec<DVec3>,
}

/// Relative errors since a [`Reference`]; dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Of the kinetic energy less the work of the forces.
    pub energy: f64,
    /// Of the momentum less the impulse of the forces, as a part of the sum of `m |v|`.
    pub momentum: f64,
}

impl Reference {
    /// Counts drift from the present state of `world`.
    pub fn of(world: &World) -> Self {
        Self {
            time: world.time(),
            energy: world.kinetic_energy(),
            momentum: world.momentum(),
            positions: (0..world.len()).map(|i| world.position(i)).collect(),
        }
    }

    /// The drift of `world`, which must have the same bodies.
    pub fn drift(&self, world: &World) -> Drift {
        let elapsed = world.time() - self.time;
        let mut work = 0.0;
        let mut impulse = DVec3::ZERO;
        let mut speed = 0.0;
        for (i, &start) in self.positions.iter().enumerate() {
            work += world.force(i).dot(world.position(i) - start);
            impulse += world.force(i) * elapsed;
            speed += world.mass(i) * world.velocity(i).length();
        }
        let energy = world.kinetic_energy();
        Drift {
            energy: ratio(energy - work - self.energy, energy.max(self.energy)),
            momentum: ratio(
                (world.momentum() - impulse - self.momentum).length(),
                speed.max(self.momentum.length()),
            ),
        }
    }
}

/// `error / scale`, and 0 where nothing moved.
fn ratio(error: f64, scale: f64) -> f64 {
    if scale > 0.0 { error / scale } else { 0.0 }
}
