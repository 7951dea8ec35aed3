//! Vectors of rationals, for the oracles.

use num_rational::BigRational;

pub(crate) type Q = BigRational;
pub(crate) type Point = [Q; 3];

pub(crate) fn rational(x: f64) -> Q {
    Q::from_float(x).expect("numbers are finite")
}

pub(crate) fn zero() -> Q {
    Q::from_integer(0.into())
}

pub(crate) fn sub(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

pub(crate) fn dot(a: &Point, b: &Point) -> Q {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(crate) fn cross(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}
