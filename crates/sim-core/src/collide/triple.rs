//! Triple products of differences of points, and their quotients: exact signs, and numbers rounded down.

use core::cmp::Ordering;
use glam::DVec3;

use super::plane::{Cross, Estimate};
use crate::expansion::{Expansion, two_product, two_sum};

/// A vector `0 - 1` without rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference(pub(super) DVec3, pub(super) DVec3);

impl Difference {
    pub(super) fn rounded(self) -> DVec3 {
        self.0 - self.1
    }

    #[inline]
    fn exact(self) -> Exact {
        let (p, q) = (self.0.to_array(), self.1.to_array());
        [0, 1, 2].map(|i| two_sum(p[i], -q[i]))
    }
}

impl From<DVec3> for Difference {
    fn from(v: DVec3) -> Difference {
        Difference(v, DVec3::ZERO)
    }
}

/// 2^-900: if a product is larger, products of the digits of its two factors do not underflow.
const LEAST_PRODUCT: f64 = f64::from_bits((1023 - 900) << 52);

/// The most terms of a triple product: six products of three pairs, each of four terms.
const TERMS: usize = 6 * 8 * 4;

/// The most terms if the differences are exact in f64: six products of four terms. Twice as many if the differences
/// of one row are not.
const FEW: usize = 6 * 4;

/// The exact sign of `det(u, v, w) = (u × v)·w`.
#[inline]
pub(super) fn sign(rows: [Difference; 3]) -> Ordering {
    let [u, v, w] = rows.map(Difference::rounded);
    sign_of(Cross::of(u, v).dot(w), rows)
}

/// [`sign`], given the estimate.
#[inline(always)]
pub(super) fn sign_of(estimate: Estimate, rows: [Difference; 3]) -> Ordering {
    estimate.sign().unwrap_or_else(|| exact_sign(rows))
}

#[inline(never)]
fn exact_sign(rows: [Difference; 3]) -> Ordering {
    let rows = rows.map(Difference::exact);
    match rows.iter().filter(|row| !is_short(row)).count() {
        0 => exact::<FEW>(&rows).sign(),
        1 => exact::<{ 2 * FEW }>(&rows).sign(),
        _ => long_sign(&rows),
    }
}

#[cold]
#[inline(never)]
fn long_sign(rows: &[Exact; 3]) -> Ordering {
    exact::<TERMS>(rows).sign()
}

/// A difference as rounded components and their rounding errors.
type Exact = [(f64, f64); 3];

/// Whether all rounding errors are zero.
#[inline(always)]
fn is_short(row: &Exact) -> bool {
    row[0].1 == 0.0 && row[1].1 == 0.0 && row[2].1 == 0.0
}

/// The determinant; [`TERMS`] and [`FEW`] give the number of terms.
///
/// There is no underflow, because components are multiples of 2^-340, and no overflow, because they are at most 2e100.
#[inline]
fn exact<const N: usize>(&[u, v, w]: &[Exact; 3]) -> Expansion<N> {
    let mut sum = Expansion::ZERO;
    for (i, u) in u.into_iter().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for (minus, v, w) in [(false, v[j], w[k]), (true, v[k], w[j])] {
            if w == (0.0, 0.0) {
                continue;
            }
            for x in [u.0, u.1] {
                for y in [v.0, v.1] {
                    if x == 0.0 || y == 0.0 {
                        continue;
                    }
                    let (high, low) = two_product(if minus { -x } else { x }, y);
                    for z in [w.0, w.1] {
                        if z != 0.0 {
                            if low != 0.0 {
                                sum.add_product(low, z);
                            }
                            sum.add_product(high, z);
                        }
                    }
                }
            }
        }
    }
    sum
}

/// `u × v` to within some units in the last place of its largest component, scaled so that this component is one; or
/// zero.
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
/// The gap is a vector from the moving feature to the other one. `u` and `v` span the directions along which the
/// features touch when the gap closes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    pub(super) u: Difference,
    pub(super) v: Difference,
    pub(super) gap: Difference,
    pub(super) motion: DVec3,
    over: Estimate,
    under: Estimate,
}

impl Time {
    #[inline]
    pub(super) fn new(u: Difference, v: Difference, gap: Difference, motion: DVec3) -> Time {
        let cross = Cross::of(u.rounded(), v.rounded());
        Time {
            u,
            v,
            gap,
            motion,
            over: cross.dot(gap.rounded()),
            under: cross.dot(motion),
        }
    }

    fn rows_over(&self) -> [Difference; 3] {
        [self.u, self.v, self.gap]
    }

    fn rows_under(&self) -> [Difference; 3] {
        [self.u, self.v, self.motion.into()]
    }

    /// The side of `u × v` to which the motion leads; `Equal` means that there is no time.
    #[inline]
    pub(super) fn course(&self) -> Ordering {
        sign_of(self.under, self.rows_under())
    }

    /// Whether the time is 0, given that it is not negative.
    #[inline]
    pub(super) fn is_start(&self) -> bool {
        sign_of(self.over, self.rows_over()) == Ordering::Equal
    }

    /// Whether the time is in [0, 1], exactly, given a course other than `Equal`.
    #[inline]
    pub(super) fn is_within(&self, course: Ordering) -> bool {
        let side = sign_of(self.over, self.rows_over());
        if side == Ordering::Equal {
            return true;
        }
        side == course
            && match self.over.magnitude_cmp(self.under) {
                Some(order) => order == Ordering::Less,
                None => self.is_at_most_one(course),
            }
    }

    #[cold]
    fn is_at_most_one(&self, course: Ordering) -> bool {
        let rest = self.with_terms(|over, under| rest_sign(over, under, 1.0));
        rest != course
    }

    /// Calls `then` with the terms of numerator and denominator.
    #[inline(always)]
    fn with_terms<T>(&self, then: impl FnOnce(&[f64], &[f64]) -> T) -> T {
        let [u, v, gap] = self.rows_over().map(Difference::exact);
        let motion = self.motion.to_array().map(|x| (x, 0.0));
        let (over, under) = ([u, v, gap], [u, v, motion]);
        match (is_short(&u) && is_short(&v), is_short(&gap)) {
            (true, true) => {
                let (over, under) = (exact::<FEW>(&over), exact::<FEW>(&under));
                then(over.terms(), under.terms())
            }
            (true, false) => {
                let (over, under) = (exact::<{ 2 * FEW }>(&over), exact::<FEW>(&under));
                then(over.terms(), under.terms())
            }
            (false, _) => {
                let (over, under) = (exact::<TERMS>(&over), exact::<TERMS>(&under));
                then(over.terms(), under.terms())
            }
        }
    }

    /// A quick lower and upper bound on a time that is not negative.
    #[inline]
    pub(super) fn bounds(&self) -> (f64, f64) {
        let (over, under) = (self.over, self.under);
        // Cover the roundings of sums, quotient and product.
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
    /// So equal times give equal numbers, whatever quotients they are. The result may be up to eight units in the
    /// last place less only if products in the check would over- or underflow (coordinates above 1e94, or the last
    /// term of the denominator times the quotient below 2^-900).
    pub(super) fn rounded_down(&self) -> f64 {
        self.with_terms(floor_of_quotient)
    }
}

/// The quotient of two sums, in [0, 1], rounded as in [`Time::rounded_down`].
pub(super) fn floor_of_quotient(over: &[f64], under: &[f64]) -> f64 {
    let (Some(&least), Some(&most)) = (under.first(), under.last()) else {
        return 0.0;
    };
    if over.is_empty() {
        return 0.0;
    }
    let mut time = over.iter().sum::<f64>() / under.iter().sum::<f64>();
    if least.abs() * time < LEAST_PRODUCT || most.abs() > 1e285 {
        let time = time * (1.0 - 3.0 * f64::EPSILON);
        return time.next_down().clamp(0.0, 1.0);
    }
    let order = |time: f64| {
        let rest = rest_sign(over, under, time);
        if most > 0.0 { rest } else { rest.reverse() }
    };
    match order(time) {
        Ordering::Equal => time,
        Ordering::Less => {
            time = time.next_down();
            while order(time) == Ordering::Less {
                time = time.next_down();
            }
            time
        }
        Ordering::Greater => {
            while order(time.next_up()) != Ordering::Less {
                time = time.next_up();
            }
            time
        }
    }
}

/// The sign of `over - time under`: from the largest term of each and the sum of the others, if that is enough.
fn rest_sign(over: &[f64], under: &[f64], time: f64) -> Ordering {
    let top = |terms: &[f64]| match *terms {
        [ref others @ .., most] => (most, others.iter().sum()),
        [] => (0.0, 0.0),
    };
    let ((o, o_next), (u, u_next)): ((f64, f64), (f64, f64)) = (top(over), top(under));
    let (high, low) = two_product(time, u);
    let (rest, lost) = two_sum(o, -high);
    let next = time * u_next;
    let value = rest + (((lost - low) + o_next) - next);
    // Five roundings, and those of sums whose terms at least double from one to the next.
    let size = lost.abs() + low.abs() + o_next.abs() + next.abs();
    let error = (16.0 * size + 2.0 * rest.abs()) * f64::EPSILON;
    if value.abs() > error || error == 0.0 {
        return if value > 0.0 {
            Ordering::Greater
        } else if value < 0.0 {
            Ordering::Less
        } else {
            Ordering::Equal
        };
    }
    let most = over.len() + 2 * under.len();
    if most <= SOME {
        exact_rest_sign::<SOME>(over, under, time)
    } else {
        exact_rest_sign::<{ 3 * TERMS }>(over, under, time)
    }
}

/// Nearly all sums have fewer terms than this.
const SOME: usize = 24;

#[inline(never)]
fn exact_rest_sign<const N: usize>(over: &[f64], under: &[f64], time: f64) -> Ordering {
    let mut rest = Expansion::<N>::ZERO;
    over.iter().for_each(|&x| rest.add(x));
    under.iter().for_each(|&x| rest.add_product(-time, x));
    rest.sign()
}
