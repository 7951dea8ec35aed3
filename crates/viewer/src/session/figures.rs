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

/// The state of a world at the moment that drift is counted from.
///
/// Forces here are constant vectors, so what they do is known: the work `F . dx`, the impulse
/// `F t`, and between collisions the path `x + v t + F t^2 / 2m`. Drift is what remains after
/// they are taken away, the error of method and collisions.
#[derive(Clone, Debug)]
pub struct Reference {
    time: f64,
    energy: f64,
    momentum: DVec3,
    impacts: u64,
    /// Position and velocity of each body.
    motion: Vec<(DVec3, DVec3)>,
}

/// Errors since a [`Reference`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Relative error of the kinetic energy less the work of the forces.
    pub energy: f64,
    /// Error of the momentum less the impulse of the forces, relative to the sum of `m |v|`.
    pub momentum: f64,
    /// Largest distance of a body from its exact path, m; known as long as nothing collides.
    pub position: Option<f64>,
}

impl Reference {
    /// Counts drift from the present state of `world`.
    pub fn of(world: &World) -> Self {
        Self {
            time: world.time(),
            energy: world.kinetic_energy(),
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
        let mut work = 0.0;
        let mut impulse = DVec3::ZERO;
        let mut speed = 0.0;
        let mut away: f64 = 0.0;
        for (i, &(start, velocity)) in self.motion.iter().enumerate() {
            let force = world.force(i);
            work += force.dot(world.position(i) - start);
            impulse += force * elapsed;
            speed += world.mass(i) * world.velocity(i).length();
            let bend = force / world.mass(i) * (0.5 * elapsed * elapsed);
            let exact = start + velocity * elapsed + bend;
            away = away.max((world.position(i) - exact).length());
        }
        let energy = world.kinetic_energy();
        Drift {
            energy: ratio(energy - work - self.energy, energy.max(self.energy)),
            momentum: ratio(
                (world.momentum() - impulse - self.momentum).length(),
                speed.max(self.momentum.length()),
            ),
            position: (world.impacts() == self.impacts).then_some(away),
        }
    }
}

/// `error / scale`, and 0 where nothing moved.
fn ratio(error: f64, scale: f64) -> f64 {
    if scale > 0.0 { error / scale } else { 0.0 }
}
