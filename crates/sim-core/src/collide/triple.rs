//! Triple products of differences of points, and their quotients: signs exactly, numbers rounded
//! down.

use core::cmp::Ordering;
use glam::DVec3;

use super::{
    expansion::{Expansion, two_product, two_sum},
    plane::{Cross, Estimate},
};

/// A vector `0 - 1` without rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference(pub(super) DVec3, pub(super) DVec3);

impl Difference {
    pub(super) fn rounded(self) -> DVec3 {
        self.0 - self.1
    }

    /// Each component as a rounded difference and what rounding took.
    fn exact(self) -> [(f64, f64); 3] {
        let (p, q) = (self.0.to_array(), self.1.to_array());
        [0, 1, 2].map(|i| two_sum(p[i], -q[i]))
    }
}

impl From<DVec3> for Difference {
    fn from(v: DVec3) -> Difference {
        Difference(v, DVec3::ZERO)
    }
}

/// 2^-900: the digits of two factors whose product is larger have products without underflow.
const LEAST_PRODUCT: f64 = f64::from_bits((1023 - 900) << 52);

/// The most terms of a triple product: six products of three pairs, each of four terms.
const TERMS: usize = 6 * 8 * 4;

/// The exact sign of `det(u, v, w) = (u × v)·w`.
#[inline]
pub(super) fn sign(rows: [Difference; 3]) -> Ordering {
    let [u, v, w] = rows.map(Difference::rounded);
    sign_of(Cross::of(u, v).dot(w), rows)
}

/// [`sign`] where the estimate is known.
#[inline(always)]
pub(super) fn sign_of(estimate: Estimate, rows: [Difference; 3]) -> Ordering {
    estimate.sign().unwrap_or_else(|| exact_sign(rows))
}

#[cold]
fn exact_sign(rows: [Difference; 3]) -> Ordering {
    exact(rows).sign()
}

/// Nothing underflows, as components are multiples of 2^-340, nor overflows, as they are at most
/// 2e100.
fn exact(rows: [Difference; 3]) -> Expansion<TERMS> {
    let [u, v, w] = rows.map(Difference::exact);
    let mut sum = Expansion::ZERO;
    for (i, u) in u.into_iter().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for (minus, v, w) in [(false, v[j], w[k]), (true, v[k], w[j])] {
            for x in [u.0, u.1] {
                for y in [v.0, v.1] {
                    if x == 0.0 || y == 0.0 {
                        continue;
                    }
                    let (high, low) = two_product(if minus { -x } else { x }, y);
                    for z in [w.0, w.1] {
                        if z != 0.0 {
                            sum.add_product(low, z);
                            sum.add_product(high, z);
                        }
                    }
                }
            }
        }
    }
    sum
}

/// `u × v` to within some units in the last place of its largest component, scaled so that this is
/// one, or zero.
pub(super) fn direction(u: Difference, v: Difference) -> DVec3 {
    let (u, v) = (u.exact(), v.exact());
    let component = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let mut sum = Expansion::<16>::ZERO;
        for (minus, x, y) in [(false, u[j], v[k]), (true, u[k], v[j])] {
            for x in [x.0, x.1] {
                for y in [y.0, y.1] {
                    if x != 0.0 && y != 0.0 {
                        sum.add_product(if minus { -x } else { x }, y);
                    }
                }
            }
        }
        sum.rounded()
    };
    let cross = DVec3::new(component(0), component(1), component(2));
    let largest = cross.abs().max_element();
    if largest == 0.0 {
        return DVec3::ZERO;
    }
    cross / largest
}

/// The time at which a gap closes: `det(u, v, gap) / det(u, v, motion)`.
///
/// The gap leads from what moves to what it meets, so that it closes where `u` and `v` span the
/// directions along which they touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    pub(super) u: Difference,
    pub(super) v: Difference,
    pub(super) gap: Difference,
    pub(super) motion: DVec3,
}

impl Time {
    fn over(&self) -> [Difference; 3] {
        [self.u, self.v, self.gap]
    }

    fn under(&self) -> [Difference; 3] {
        [self.u, self.v, self.motion.into()]
    }

    fn cross(&self) -> Cross {
        Cross::of(self.u.rounded(), self.v.rounded())
    }

    /// On which side of `u × v` the motion leads; if on neither, there is no time.
    pub(super) fn course(&self) -> Ordering {
        sign_of(self.cross().dot(self.motion), self.under())
    }

    /// Whether it is 0, given that it is not negative.
    pub(super) fn is_start(&self) -> bool {
        sign_of(self.cross().dot(self.gap.rounded()), self.over()) == Ordering::Equal
    }

    /// Whether it is in [0, 1], exactly, on a course that leads anywhere.
    pub(super) fn is_within(&self, course: Ordering) -> bool {
        let cross = self.cross();
        let (over, under) = (cross.dot(self.gap.rounded()), cross.dot(self.motion));
        let side = sign_of(over, self.over());
        if side == Ordering::Equal {
            return true;
        }
        side == course
            && match over.magnitude_cmp(under) {
                Some(order) => order == Ordering::Less,
                None => self.is_at_most_one(course),
            }
    }

    #[cold]
    fn is_at_most_one(&self, course: Ordering) -> bool {
        let mut rest = Expansion::<{ 2 * TERMS }>::ZERO;
        exact(self.under())
            .terms()
            .iter()
            .for_each(|&x| rest.add(x));
        exact(self.over())
            .terms()
            .iter()
            .for_each(|&x| rest.add(-x));
        rest.sign() != course.reverse()
    }

    /// Not above and not below it, quickly; of a time that is not negative.
    pub(super) fn bounds(&self) -> (f64, f64) {
        let cross = self.cross();
        let (over, under) = (cross.dot(self.gap.rounded()), cross.dot(self.motion));
        // For the roundings of sums, quotient and product.
        const DOWN: f64 = 1.0 - 4.0 * f64::EPSILON;
        const UP: f64 = 1.0 + 4.0 * f64::EPSILON;
        let low = (over.value.abs() - over.error) / (under.value.abs() + under.error) * DOWN;
        let least = under.value.abs() - under.error;
        let high = if least > 0.0 {
            (over.value.abs() + over.error) / least * UP
        } else {
            f64::INFINITY
        };
        (low.max(0.0), high)
    }

    /// The greatest f64 that is not above the time, for times in [0, 1].
    ///
    /// So equal times are equal whatever they are the quotients of. Only where products in the check
    /// would over- or underflow (coordinates above 1e94, or the last term of the denominator times
    /// the quotient below 2^-900) it may be up to eight units in the last place less.
    pub(super) fn rounded_down(&self) -> f64 {
        let (over, under) = (exact(self.over()), exact(self.under()));
        let course = under.sign();
        let (Some(&least), Some(&most)) = (under.terms().first(), under.terms().last()) else {
            return 0.0;
        };
        if over.terms().is_empty() {
            return 0.0;
        }
        let mut time = over.rounded() / under.rounded();
        if least.abs() * time < LEAST_PRODUCT || most.abs() > 1e285 {
            let time = time * (1.0 - 3.0 * f64::EPSILON);
            return time.next_down().clamp(0.0, 1.0);
        }
        let is_late = |time: f64| {
            let mut rest = Expansion::<{ 3 * TERMS }>::ZERO;
            over.terms().iter().for_each(|&x| rest.add(x));
            under
                .terms()
                .iter()
                .for_each(|&x| rest.add_product(-time, x));
            (
                rest.sign() == course.reverse(),
                rest.sign() == Ordering::Equal,
            )
        };
        let (mut late, is_equal) = is_late(time);
        if is_equal {
            return time;
        }
        if late {
            while late {
                time = time.next_down();
                late = is_late(time).0;
            }
            return time;
        }
        while !is_late(time.next_up()).0 {
            time = time.next_up();
        }
        time
    }
}
