//! Drift of energy and momentum over a long time, in worlds stepped as by a program.

use std::f64::consts::PI;

use sim_core::{Method, Settings, World};

use crate::problems::{kepler, pleiades as stars};

/// Steps of each orbit.
pub const STEPS: usize = 1000;

/// Eccentricity of the orbit.
pub const ECCENTRICITY: f64 = 0.6;

/// The errors of a method in the invariants of a planet's motion.
#[derive(Debug)]
pub struct Drift {
    /// The errors of each completed orbit.
    pub orbits: Vec<Orbit>,
    /// The reason why there are no more orbits, if there is one.
    pub failure: Option<String>,
}

/// The greatest relative errors within an orbit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Orbit {
    /// The error of the sum of kinetic and potential energy.
    pub energy: f64,
    /// The error of the angular momentum about the centre.
    pub angular_momentum: f64,
}

impl Drift {
    /// Growth of the energy error per orbit: the slope of a least-squares line through all orbits.
    pub fn energy_slope(&self) -> f64 {
        let n = self.orbits.len() as f64;
        let middle = 0.5 * (n - 1.0);
        let deviations = || (0..self.orbits.len()).map(|i| i as f64 - middle);
        let weighed = deviations().zip(&self.orbits).map(|(d, o)| d * o.energy);
        weighed.sum::<f64>() / deviations().map(|d| d * d).sum::<f64>()
    }

    /// The greatest energy error of all.
    pub fn energy(&self) -> f64 {
        self.orbits.iter().map(|o| o.energy).fold(0.0, f64::max)
    }
}

fn settings(method: &'static Method, dt: f64) -> Settings {
    Settings {
        dt,
        method,
        ..Settings::default()
    }
}

/// Steps a planet for some orbits.
pub fn orbits(method: &'static Method, count: usize) -> Drift {
    let mut drift = Drift {
        orbits: Vec::new(),
        failure: None,
    };
    let mut world = match kepler::world(settings(method, 2.0 * PI / STEPS as f64), ECCENTRICITY) {
        Ok(world) => world,
        Err(error) => {
            drift.failure = Some(error.to_string());
            return drift;
        }
    };
    let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
    let spin = |world: &World| world.position(0).cross(world.velocity(0)).z;
    let (energy_at_start, spin_at_start) = (energy(&world), spin(&world));
    let off = |now: f64, start: f64| (now / start - 1.0).abs();
    for _ in 0..count {
        let mut orbit = Orbit::default();
        for _ in 0..STEPS {
            if let Err(error) = world.step() {
                drift.failure = Some(error.to_string());
                return drift;
            }
            orbit.energy = orbit.energy.max(off(energy(&world), energy_at_start));
            let change = off(spin(&world), spin_at_start);
            orbit.angular_momentum = orbit.angular_momentum.max(change);
        }
        drift.orbits.push(orbit);
    }
    drift
}

/// Change of the total momentum of the Pleiades in 3 s, relative to the sum of all `m |v|`.
pub fn pleiades(method: &'static Method) -> Result<f64, String> {
    let world = stars::world(settings(method, 1e-3));
    let mut world = world.map_err(|error| error.to_string())?;
    let start = world.momentum();
    let sizes = (0..world.len()).map(|i| world.mass(i) * world.velocity(i).length());
    let size: f64 = sizes.sum();
    for _ in 0..3000 {
        world.step().map_err(|error| error.to_string())?;
    }
    Ok((world.momentum() - start).length() / size)
}
