//! The first contact of two shapes that have no triangles, or one of which is a half-space, on a
//! trajectory that is a parabola.
//!
//! Above a half-space the height is a quadratic function of time. Between spheres the square
//! of the distance is a polynomial of degree four. In Bernstein's basis it has no root if
//! all of its coefficients are positive; otherwise its interval is halved (Lane, Riesenfeld 1981,
//! "Bounds on a polynomial"). So the search misses no contact, however shallow.

use glam::DVec3;

use super::form::{Contact, Form, reach, unit};

/// The motion of the second of two shapes relative to the first. Its position at time `t` is
/// `offset + t (velocity + t acceleration / 2)`, in m, m/s and m/s².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parabola {
    pub(crate) offset: DVec3,
    pub(crate) velocity: DVec3,
    pub(crate) acceleration: DVec3,
    /// Bounds on the rounding of distances, m, and of speeds, m/s.
    pub(crate) grain: (f64, f64),
}

impl Parabola {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.offset + t * (self.velocity + 0.5 * t * self.acceleration)
    }

    /// The closing speed of the second shape along a normal, m/s.
    pub(crate) fn closing(&self, t: f64, normal: DVec3) -> f64 {
        -normal.dot(self.velocity + t * self.acceleration)
    }

    fn reversed(&self) -> Parabola {
        Parabola {
            offset: -self.offset,
            velocity: -self.velocity,
            acceleration: -self.acceleration,
            grain: self.grain,
        }
    }

    /// Classifies the start of the motion by the gap there and its first two derivatives.
    fn start(&self, gap: f64, speed: f64, acceleration: f64, length: f64) -> Start {
        let (grain, still) = self.grain;
        if gap > 0.0 {
            let is_coming = speed < -still || speed <= still && acceleration < 0.0;
            return match is_coming && gap <= 4.0 * grain {
                true => Start::Near,
                false => Start::Apart,
            };
        }
        if speed > still {
            return Start::Leaving;
        }
        // Rounding has closed the gap. Does the motion close it further?
        let change = length * (speed + 0.5 * length * acceleration);
        if change < -0.25 * grain {
            Start::Touching
        } else {
            Start::Beside
        }
    }
}

enum Start {
    Apart,
    /// Apart by no more than rounding and approaching: the contact is immediate.
    Near,
    /// Touching, and closing or pressed together.
    Touching,
    /// Touching and leaving; the shape may come back.
    Leaving,
    /// Touching without pressure.
    Beside,
}

/// Whether this module computes the contacts of two shapes.
pub(crate) fn has_roots(first: Form<'_>, second: Form<'_>) -> bool {
    match (first, second) {
        // Two points have no surface from which to part.
        (Form::Sphere(first), Form::Sphere(second)) => first + second > 0.0,
        (Form::HalfSpace(_), _) | (_, Form::HalfSpace(_)) => true,
        (Form::Mesh(_), Form::Mesh(_) | Form::Sphere(_)) | (Form::Sphere(_), Form::Mesh(_)) => {
            false
        }
    }
}

/// The first contact of two shapes that are apart, within `length`, s; the time of the contact is in s.
pub(crate) fn first_on_parabola(
    first: Form<'_>,
    second: Form<'_>,
    way: &Parabola,
    length: f64,
) -> Option<Contact> {
    match (first, second) {
        (Form::HalfSpace(_), Form::HalfSpace(_)) => None,
        (Form::HalfSpace(normal), other) => above_plane(normal, other, way, length),
        (Form::Sphere(first), Form::Sphere(second)) => spheres(first, second, way, length),
        // These have no roots here ([`has_roots`]), and are searched on chords.
        (Form::Mesh(_), Form::Mesh(_) | Form::Sphere(_)) | (Form::Sphere(_), Form::Mesh(_)) => None,
        (Form::Mesh(_) | Form::Sphere(_), Form::HalfSpace(_)) => {
            let contact = first_on_parabola(second, first, &way.reversed(), length)?;
            Some(Contact {
                point: contact.point + way.at(contact.time),
                normal: -contact.normal,
                ..contact
            })
        }
    }
}

fn above_plane(normal: DVec3, other: Form<'_>, way: &Parabola, length: f64) -> Option<Contact> {
    let (speed, acceleration) = (normal.dot(way.velocity), normal.dot(way.acceleration));
    let least = speed.min(speed + length * acceleration);
    if least >= 0.0 && acceleration >= 0.0 {
        return None;
    }
    let (reach, corner) = reach(other, normal);
    let height = normal.dot(way.offset) - reach;
    let start = way.start(height, speed, acceleration, length);
    let time = match start {
        Start::Touching => 0.0,
        Start::Beside => return None,
        Start::Apart | Start::Near | Start::Leaving => {
            let height = height.max(0.0);
            let root = libm::sqrt(speed * speed - 2.0 * acceleration * height);
            // The root at which the height falls. Each form avoids the difference of nearly equal numbers.
            match speed <= 0.0 {
                true => 2.0 * height / (root - speed),
                false => (speed + root) / -acceleration,
            }
        }
    };
    // There is no contact without a root, or if the shape only grazes the plane there.
    let is_turn = time > 0.0 && way.closing(time, normal) <= 0.0;
    if is_turn || !(0.0..=length).contains(&time) {
        return None;
    }
    let time = if matches!(start, Start::Near) {
        0.0
    } else {
        time
    };
    let at = way.at(time) + corner;
    Some(Contact {
        time,
        point: at - normal.dot(at) * normal,
        normal,
        feature: None,
        face: None,
    })
}

fn spheres(first: f64, second: f64, way: &Parabola, length: f64) -> Option<Contact> {
    let sum = first + second;
    let (r, v, a) = (way.offset, way.velocity, way.acceleration);
    let distance = libm::sqrt(r.dot(r));
    let outward = unit(r)?;
    let gap = distance - sum;
    // The second derivative of the distance: tangential motion increases it.
    let (speed, turning) = (
        outward.dot(v),
        (v.dot(v) - outward.dot(v) * outward.dot(v)) / distance,
    );
    let start = way.start(gap, speed, outward.dot(a) + turning, length);
    // The square of the distance less the square of the radii's sum, with the time scaled to 0 to 1.
    let (h, h2) = (length, length * length);
    let terms = [
        gap * (distance + sum),
        h * 2.0 * r.dot(v),
        h2 * (v.dot(v) + r.dot(a)),
        h2 * h * v.dot(a),
        h2 * h2 * 0.25 * a.dot(a),
    ];
    let part = match start {
        Start::Touching => 0.0,
        Start::Apart => first_root(bernstein(terms))?,
        Start::Near => 0.0 * first_root(bernstein(terms))?,
        // Divide by `t` to remove the root at the start.
        Start::Leaving => {
            let [_, rest @ ..] = terms;
            first_root(bernstein(rest))?
        }
        Start::Beside => {
            let [_, _, bend, rest @ ..] = terms;
            first_root(bernstein([bend.max(0.0), rest[0], rest[1]]))?
        }
    };
    let mut time = part * length;
    if part > 0.0 {
        for _ in 0..2 {
            let at = way.at(time);
            let closing = way.closing(time, unit(at)?);
            if closing > 0.0 {
                time = (time + (libm::sqrt(at.dot(at)) - sum) / closing).clamp(0.0, length);
            }
        }
    }
    let normal = unit(way.at(time))?;
    if part > 0.0 && way.closing(time, normal) <= 0.0 {
        return None;
    }
    Some(Contact {
        time,
        point: first * normal,
        normal,
        feature: None,
        face: None,
    })
}

/// Converts a polynomial on 0 to 1 from coefficients of powers, lowest first, to Bernstein's basis.
fn bernstein<const N: usize>(powers: [f64; N]) -> [f64; N] {
    let shares = const { shares::<N>() };
    core::array::from_fn(|i| {
        let mut sum = powers[0];
        for k in 1..=i {
            sum += shares[i][k] * powers[k];
        }
        sum
    })
}

/// `C(i, k) / C(degree, k)` by row `i` and column `k`.
const fn shares<const N: usize>() -> [[f64; N]; N] {
    let mut shares = [[1.0; N]; N];
    let mut i = 0;
    while i < N {
        let mut k = 1;
        while k <= i {
            shares[i][k] = shares[i][k - 1] * (i + 1 - k) as f64 / (N - k) as f64;
            k += 1;
        }
        i += 1;
    }
    shares
}

/// Halvings of the interval in the search for a root.
const HALVINGS: u32 = 52;

/// The first point from 0 to 1 at which a polynomial in Bernstein's basis becomes negative.
fn first_root<const N: usize>(coefficients: [f64; N]) -> Option<f64> {
    first_root_in(coefficients, (0.0, 1.0), HALVINGS)
}

fn first_root_in<const N: usize>(
    coefficients: [f64; N],
    (low, high): (f64, f64),
    halvings: u32,
) -> Option<f64> {
    if coefficients.iter().all(|&c| c >= 0.0) {
        return None;
    }
    if coefficients[0] <= 0.0 || halvings == 0 {
        return Some(low);
    }
    // If the signs change once, there is one root (Descartes' rule in Bernstein's basis).
    let first_below = coefficients.iter().position(|&c| c < 0.0).unwrap_or(N);
    if coefficients[first_below..].iter().all(|&c| c < 0.0) {
        return Some(low + (high - low) * only_root(&coefficients));
    }
    // De Casteljau: the left half has the first coefficient of each row, the right half the last one.
    let (mut left, mut right) = (coefficients, coefficients);
    let mut row = coefficients;
    for level in 1..N {
        for i in 0..N - level {
            row[i] = 0.5 * row[i] + 0.5 * row[i + 1];
        }
        left[level] = row[0];
        right[N - 1 - level] = row[N - 1 - level];
    }
    let middle = 0.5 * (low + high);
    first_root_in(left, (low, middle), halvings - 1)
        .or_else(|| first_root_in(right, (middle, high), halvings - 1))
}

/// The most steps in the search for the only root: two for each binary digit.
const LOOKS: usize = 106;

/// The root of a polynomial that is positive at 0, negative at 1 and has one root between. It uses Newton's method, and
/// bisection if a step leaves the interval or is not at most half of the last step.
fn only_root<const N: usize>(coefficients: &[f64; N]) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let (mut at, mut last) = (0.5, 1.0);
    for _ in 0..LOOKS {
        let (value, slope) = value_and_slope(coefficients, at);
        match value > 0.0 {
            true => low = at,
            false => high = at,
        }
        let newton = at - value / slope;
        let is_good = newton >= low && newton <= high && (newton - at).abs() <= 0.5 * last;
        let next = if is_good { newton } else { 0.5 * (low + high) };
        last = (next - at).abs();
        at = next;
        if last <= f64::EPSILON {
            break;
        }
    }
    at
}

/// The value and the slope of a polynomial in Bernstein's basis (de Casteljau).
fn value_and_slope<const N: usize>(coefficients: &[f64; N], at: f64) -> (f64, f64) {
    let mut row = *coefficients;
    let mut slope = 0.0;
    for level in 1..N {
        slope = (N - 1) as f64 * (row[1] - row[0]);
        for i in 0..N - level {
            row[i] += at * (row[i + 1] - row[i]);
        }
    }
    (row[0], slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_random::Random;

    fn way(offset: DVec3, velocity: DVec3, acceleration: DVec3) -> Parabola {
        Parabola {
            offset,
            velocity,
            acceleration,
            grain: (1e-14, 1e-14),
        }
    }

    /// The time at which one shape is first within another, by small steps; the error is half the last step.
    fn stepped(way: &Parabola, gap: impl Fn(DVec3) -> f64, length: f64) -> Option<f64> {
        const STEPS: u32 = 20_000;
        let at = |i: u32| length * f64::from(i) / f64::from(STEPS);
        (1..=STEPS).map(at).find(|&t| gap(way.at(t)) <= 0.0)
    }

    #[test]
    fn roots_are_those_of_small_steps() {
        let mut random = Random(9);
        let mut vector = || random.in_cube();
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..2000 {
            let way = way(2.0 * vector(), 2.0 * vector(), 8.0 * vector());
            let normal = unit(vector()).unwrap();
            let forms = [
                (Form::Sphere(0.3), Form::Sphere(0.5)),
                (Form::HalfSpace(normal), Form::Sphere(0.2)),
                (Form::Sphere(0.2), Form::HalfSpace(normal)),
            ];
            for (first, second) in forms {
                let gap = |r: DVec3| match (first, second) {
                    (Form::Sphere(_), Form::Sphere(_)) => r.length() - 0.8,
                    (Form::Sphere(_), _) => -r.dot(normal) - 0.2,
                    _ => r.dot(normal) - 0.2,
                };
                if gap(way.offset) <= 0.0 {
                    continue;
                }
                let found = first_on_parabola(first, second, &way, 1.0);
                match (found, stepped(&way, gap, 1.0)) {
                    (Some(contact), _) => {
                        let time = contact.time;
                        assert!(gap(way.at(time)).abs() < 1e-14);
                        assert!(way.closing(time, contact.normal) >= 0.0);
                        let before = stepped(&way, gap, 1.0).unwrap_or(1.0);
                        assert!(time <= before && before - time < 1e-2);
                        hits += 1;
                    }
                    (None, missed) => {
                        assert_eq!(missed, None);
                        misses += 1;
                    }
                }
            }
        }
        assert!(hits > 500 && misses > 1000);
    }

    #[test]
    fn the_only_root_is_that_of_halvings() {
        let mut random = Random(3);
        let mut found = 0;
        for _ in 0..20_000 {
            let mut numbers = [0; 5].map(|_| libm::pow(random.unit(), 6.0));
            // The signs change once.
            let positive = 1 + random.below(4);
            numbers[positive..].iter_mut().for_each(|c| *c = -*c);
            let root = only_root(&numbers);
            let (below, above) = ((root - 4e-15).max(0.0), (root + 4e-15).min(1.0));
            let size = numbers.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
            let rounding = 8.0 * f64::EPSILON * size;
            assert!(
                value_and_slope(&numbers, below).0 >= -rounding,
                "{numbers:?}: {root}"
            );
            assert!(
                value_and_slope(&numbers, above).0 <= rounding,
                "{numbers:?}: {root}"
            );
            found += 1;
        }
        assert_eq!(found, 20_000);
    }

    #[test]
    fn what_leaves_comes_back_and_what_lies_is_pressed() {
        let ball = (Form::Sphere(0.5), Form::Sphere(0.5));
        let floor = (Form::HalfSpace(DVec3::Y), Form::Sphere(1.0));
        for (first, second) in [ball, floor] {
            let time = |speed: f64, fall: f64| {
                let way = way(DVec3::Y, speed * DVec3::Y, -fall * DVec3::Y);
                first_on_parabola(first, second, &way, 1.0).map(|contact| contact.time)
            };
            assert!((time(2.0, 8.0).unwrap() - 0.5).abs() < 1e-15);
            assert_eq!(time(2.0, 1.0), None);
            assert_eq!(time(0.0, 1.0), Some(0.0));
            assert_eq!(time(-1.0, 1.0), Some(0.0));
            assert_eq!(time(0.0, 0.0), None);
            assert_eq!(time(0.0, -1.0), None);
        }
        // The ball rolls down, held by half of the force that would keep it there: fast enough, it leaves.
        let (first, second) = ball;
        let rolls = way(DVec3::Y, 2.0 * DVec3::X, -2.0 * DVec3::Y);
        assert!(first_on_parabola(first, second, &rolls, 0.1).is_none());
    }
}
