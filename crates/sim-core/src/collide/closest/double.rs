//! Numbers with twice the digits of f64, stored as a rounded number and its rounding error (Dekker 1971, "A
//! floating-point technique for extending the available precision"): for determinants that cancel.

use core::ops::{Add, Mul, Sub};
use glam::DVec3;

use crate::expansion::{two_product, two_sum};

/// `high + low`, with an error of some 2^-104 of the terms of a sum or factors of a product.
#[derive(Clone, Copy, Debug)]
pub(super) struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// `x - y`, exactly.
    fn difference(x: f64, y: f64) -> Double {
        let (high, low) = two_sum(x, -y);
        Double { high, low }
    }

    /// A pair of numbers, the second one smaller, normalised so that their digits do not overlap.
    fn normal(high: f64, low: f64) -> Double {
        let sum = high + low;
        Double {
            high: sum,
            low: low - (sum - high),
        }
    }

    pub(super) fn rounded(self) -> f64 {
        self.high + self.low
    }
}

impl Add for Double {
    type Output = Double;

    fn add(self, other: Double) -> Double {
        let (high, low) = two_sum(self.high, other.high);
        let (more, least) = two_sum(self.low, other.low);
        let sum = Double::normal(high, low + more);
        Double::normal(sum.high, sum.low + least)
    }
}

impl Sub for Double {
    type Output = Double;

    fn sub(self, other: Double) -> Double {
        let negative = Double {
            high: -other.high,
            low: -other.low,
        };
        self + negative
    }
}

impl Mul for Double {
    type Output = Double;

    fn mul(self, other: Double) -> Double {
        let (high, low) = two_product(self.high, other.high);
        Double::normal(high, low + (self.high * other.low + self.low * other.high))
    }
}

/// A vector of such numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vector([Double; 3]);

impl Vector {
    /// `to - from`, exactly.
    pub(super) fn between(from: DVec3, to: DVec3) -> Vector {
        Vector([0, 1, 2].map(|k| Double::difference(to[k], from[k])))
    }

    pub(super) fn cross(self, other: Vector) -> Vector {
        let (Vector([a, b, c]), Vector([x, y, z])) = (self, other);
        Vector([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    pub(super) fn dot(self, other: Vector) -> Double {
        let (Vector([a, b, c]), Vector([x, y, z])) = (self, other);
        a * x + b * y + c * z
    }

    pub(super) fn rounded(self) -> DVec3 {
        DVec3::from_array(self.0.map(Double::rounded))
    }
}
