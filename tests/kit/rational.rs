//! Vectors of rationals, for the oracles.

use num_rational::BigRational;

/// A rational number.
pub type Q = BigRational;
/// A vector of rational numbers.
pub type Point = [Q; 3];

/// The exact value of a number.
pub fn rational(x: f64) -> Q {
    Q::from_float(x).expect("numbers are finite")
}

/// 0.
pub fn zero() -> Q {
    Q::from_integer(0.into())
}

/// `a - b`.
pub fn sub(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

/// `a · b`.
pub fn dot(a: &Point, b: &Point) -> Q {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// `a × b`.
pub fn cross(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}
