//! Bodies in each other: how deep they are, that they get no deeper, and that they can be moved apart.

mod depth;
mod features;
mod held;
mod separate;

use kit::worlds::meet;
use sim_core::{DVec3, Shape};

/// The weight of all, m/s².
const WEIGHT: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// The least distance along a direction from which on two shapes are apart, within 1e-13 of the size.
fn touching(first: &Shape, second: &Shape, direction: DVec3) -> f64 {
    // Within the way they may be apart as well, as a mesh is hollow.
    let mut high = 64.0;
    while !meet(first, second, high * direction) {
        high *= 0.95;
    }
    let mut low = high;
    high /= 0.95;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match meet(first, second, middle * direction) {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}
