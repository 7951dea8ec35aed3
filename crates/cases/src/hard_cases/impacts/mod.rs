//! Cases 9 to 27 and 29: impacts.

pub mod balls;
pub mod chains;
pub(super) mod crowd;
pub mod meshes;
pub(super) mod pairs;
pub mod symmetry;

use sim_core::{DVec3, World};

use super::{Finding, Tried};

const ULP: f64 = f64::EPSILON;
const DT: f64 = 1.0 / 60.0;
const PHASES: u32 = 16;

/// The maximum of some figures; NaN counts as the greatest.
fn worst(figures: impl IntoIterator<Item = f64>) -> f64 {
    figures
        .into_iter()
        .fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// The greater of two changes: of the kinetic energy, relative, and of the momentum, relative to the sum of the bodies'
/// momenta.
fn lost(world: &World, start: &World) -> f64 {
    let energy = world.kinetic_energy() / start.kinetic_energy() - 1.0;
    let all = (0..start.len()).filter(|&i| start.kind(i).is_movable());
    let momenta: f64 = all
        .map(|i| start.mass(i) * start.velocity(i).length())
        .sum();
    let momentum = (world.momentum() - start.momentum()).length() / momenta;
    energy.abs().max(momentum)
}

fn motions(world: &World) -> Vec<(DVec3, DVec3)> {
    (0..world.len())
        .map(|i| (world.position(i), world.velocity(i)))
        .collect()
}

/// Greatest difference of positions and velocities, by component.
fn apart(first: &[(DVec3, DVec3)], second: &[(DVec3, DVec3)]) -> f64 {
    worst(first.iter().zip(second).map(|(a, b)| {
        let (x, v) = ((a.0 - b.0).abs(), (a.1 - b.1).abs());
        x.max_element().max(v.max_element())
    }))
}
