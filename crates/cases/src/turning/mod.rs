//! Turning bodies whose motion is known: free flight, flips, times of first contact, and forces at points.

pub mod contacts;
pub mod levers;
pub mod racket;
pub mod tumbling;

use sim_core::DVec3;

use crate::scenes::Who;

/// The engines whose free flight is tested; all of our modes fly alike.
pub const ENGINES: &[Who] = &[
    Who::Continuous,
    #[cfg(feature = "rapier3d-f64")]
    Who::Rapier,
];

/// Principal moments of a box of 1 kg with these half extents, kg m².
fn moments(half: [f32; 3]) -> DVec3 {
    let [x, y, z] = half.map(|h| f64::from(h) * f64::from(h));
    DVec3::new(y + z, z + x, x + y) / 3.0
}

/// The maximum; infinity if one of them is NaN, which `f64::max` would ignore.
fn worse(a: f64, b: f64) -> f64 {
    match a.is_nan() || b.is_nan() {
        true => f64::INFINITY,
        false => a.max(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_the_worst() {
        assert_eq!(worse(1.0, 2.0), 2.0);
        assert_eq!(worse(1.0, f64::NAN), f64::INFINITY);
        assert_eq!(worse(f64::NAN, 1.0), f64::INFINITY);
    }
}
