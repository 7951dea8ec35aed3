//! Case 6: a planet for a hundred orbits.

use sim_core::Method;

use super::{Finding, Tried};
use crate::drift::{self, Orbit};

const ORBITS: usize = 100;

/// The relative energy error allowed for methods that do not conserve energy.
const ENERGY: f64 = 1e-6;

/// The relative growth of it per orbit that symplectic methods may have.
const SLOPE: f64 = 1e-14;

/// Or this fraction of the error itself, if that is more: the greatest error of an orbit depends on how close a step
/// comes to the perihelion. With real drift the growth is a hundredth of the error.
const RESOLUTION: f64 = 1e-6;

pub(super) fn test(method: &'static Method) -> Tried {
    let drift = drift::orbits(method, ORBITS);
    if let Some(failure) = &drift.failure {
        anyhow::bail!("orbit {}: {failure}", drift.orbits.len() + 1);
    }
    let (energy, slope) = (drift.energy(), drift.energy_slope());
    if !method.symplectic {
        let why = format!("energy error grows by {slope:.1e} an orbit");
        return Ok(Finding::within(energy, ENERGY, why));
    }
    let largest = |orbits: &[Orbit]| orbits.iter().map(|orbit| orbit.energy).fold(0.0, f64::max);
    let (first, second) = drift.orbits.split_at(ORBITS / 2);
    let (first, second) = (largest(first), largest(second));
    let why = format!(
        "energy error {energy:.1e}, in the second half of the orbits {:.3} times that in the first",
        second / first
    );
    Ok(Finding::within(
        slope.abs(),
        SLOPE.max(RESOLUTION * energy),
        why,
    ))
}
