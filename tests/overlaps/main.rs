//! Overlapping bodies: their depth, that it does not grow, and that they can be moved apart.

mod depth;
mod features;
mod held;
mod separate;

use kit::worlds::meet;
use sim_core::{DVec3, Shape};

/// Gravity on all bodies, m/s².
const WEIGHT: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// The least distance along a direction beyond which two shapes are apart, within 1e-13 of the size.
fn touching(first: &Shape, second: &Shape, direction: DVec3) -> f64 {
    // At smaller distances they may be apart too, because a mesh is hollow.
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
