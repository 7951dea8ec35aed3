//! Exact sums and products of f64.
//!
//! A number is stored as a sum of f64 that do not overlap, the smallest first (Shewchuk 1997,
//! "Adaptive precision floating-point arithmetic and fast robust geometric predicates", sec. 2).

use core::cmp::Ordering;

/// A sum of at most `N` terms, exact as long as nothing over- or underflows.
#[derive(Clone)]
pub(crate) struct Expansion<const N: usize> {
    /// The first `len` terms do not overlap, increase, and are not zero.
    terms: [f64; N],
    len: usize,
}

impl<const N: usize> Expansion<N> {
    pub(crate) const ZERO: Expansion<N> = Expansion {
        terms: [0.0; N],
        len: 0,
    };

    pub(crate) fn terms(&self) -> &[f64] {
        &self.terms[..self.len]
    }

    /// Adds a number; at most `N` numbers that are not zero (Shewchuk's GROW-EXPANSION, without the zeros).
    #[inline]
    pub(crate) fn add(&mut self, x: f64) {
        if x == 0.0 {
            return;
        }
        let (mut sum, mut kept) = (x, 0);
        for i in 0..self.len {
            let (high, low) = two_sum(sum, self.terms[i]);
            sum = high;
            if low != 0.0 {
                self.terms[kept] = low;
                kept += 1;
            }
        }
        if sum != 0.0 {
            self.terms[kept] = sum;
            kept += 1;
        }
        self.len = kept;
    }

    /// Adds a product of two numbers, as two terms.
    #[inline(always)]
    pub(crate) fn add_product(&mut self, x: f64, y: f64) {
        let (high, low) = two_product(x, y);
        self.add(low);
        self.add(high);
    }

    pub(crate) fn sign(&self) -> Ordering {
        match self.terms().last() {
            Some(&largest) if largest > 0.0 => Ordering::Greater,
            Some(_) => Ordering::Less,
            None => Ordering::Equal,
        }
    }

    /// The sum to within some units in the last place: each term is below the lowest digit of the next.
    pub(crate) fn rounded(&self) -> f64 {
        self.terms().iter().sum()
    }
}

/// `x + y` as a rounded sum and its rounding error.
#[inline(always)]
pub(crate) fn two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    let of_y = sum - x;
    let of_x = sum - of_y;
    (sum, (x - of_x) + (y - of_y))
}

/// `x y` as a rounded product and its rounding error; `x` and `y` up to 2^990.
#[inline(always)]
pub(crate) fn two_product(x: f64, y: f64) -> (f64, f64) {
    let product = x * y;
    let ((a, b), (c, d)) = (halves(x), halves(y));
    (product, b * d - (((product - a * c) - b * c) - a * d))
}

/// Splits the digits of a number into two halves (Veltkamp; Shewchuk's SPLIT).
#[inline(always)]
fn halves(x: f64) -> (f64, f64) {
    const SPLITTER: f64 = ((1 << 27) + 1) as f64;
    let scaled = SPLITTER * x;
    let high = scaled - (scaled - x);
    (high, x - high)
}
