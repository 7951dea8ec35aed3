//! How long a direction keeps the hulls of two sets of points apart.
//!
//! A direction may be constant, turn with one shape as the normal of its face does, or stay perpendicular to an edge of
//! each shape. The last two kinds separate points that lie in a face, or roll on an edge, for as long as these are
//! apart. Along a direction `n` every point has a height `n·p`. Let `h`, `v` and `c` be the height and its first two
//! derivatives, and let `J` bound the third derivative of the difference of two heights. Then the gap between the
//! lowest point of one set and the highest point of the other is at least
//!
//! `min (h + v t + (c - k) t²/2) - max (h + v t + (c - k) t²/2) - J t³/6`,
//!
//! for any `k`. Cut each `c - k` at 0: to at most 0 in the minimum and to at least 0 in the maximum. The bound still
//! holds and is concave, so where it is positive it has been positive since the start. The same holds if bounds on the
//! second derivatives take the place of the second derivatives and of `J`. So the root of one function tells how long a
//! direction separates all pairs of points, at the cost of one sum over the points.

use glam::DVec3;

use super::{
    NEAR,
    certificate::{Margin, UNIT},
    nearest::{Pair, nearest},
    pieces::{Kind, MOST_POINTS, Points},
    view::{Spinning, View},
};

/// The gap between two sets, and how long it certainly stays open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// The distance of the sets now, m; a lower bound on it if they are not near each other.
    pub(super) distance: f64,
    /// The greatest distance that counts as a contact, m.
    pub(super) near: f64,
    /// The sets are apart for this time, s.
    pub(super) lasts: f64,
    /// Whether some direction separates the sets now.
    pub(super) is_apart: bool,
    /// Whether the nearest points move apart along the separating direction, fast enough compared with the closing
    /// speed of points near them for the search to follow them.
    pub(super) opens: bool,
    /// A lower bound on the speed at which the nearest points part along the separating direction, m/s; computed only
    /// if the sets are near.
    pub(super) parting: f64,
    pub(super) normal: DVec3,
    pub(super) points: [DVec3; 2],
    pub(super) faces: [Option<u32>; 2],
}

/// For boxes nearer than this times the distance of a contact, the line between their nearest points is tried too.
const NEARLY: f64 = 1024.0;

/// Nearest points that part more slowly than this part of the closing speed of points near them are in contact. To
/// follow them would take a number of certificates inversely proportional to this constant.
const FOLLOWED: f64 = 1.0 / 1024.0;

/// A certificate that covers this part of the time left is not improved. Changes the cost only.
const ENOUGH: f64 = 0.125;

/// A separating direction: its value now (a unit vector), its derivatives now, and bounds on its length and on those of
/// its first three derivatives for the time left.
#[derive(Clone, Copy)]
struct Direction {
    along: DVec3,
    first: DVec3,
    second: DVec3,
    most: [f64; 4],
    /// The set with which the direction turns; the heights of its points are constant.
    owner: Option<usize>,
}

impl Direction {
    fn at_rest(along: DVec3) -> Direction {
        Direction {
            along,
            first: DVec3::ZERO,
            second: DVec3::ZERO,
            most: [1.0, 0.0, 0.0, 0.0],
            owner: None,
        }
    }

    fn turning_with(owner: usize, along: DVec3, with: &Spinning) -> Direction {
        let first = with.spin.cross(along);
        Direction {
            along,
            first,
            second: with.turning.cross(along) + with.spin.cross(first),
            most: [1.0, with.fastest, with.second, with.third],
            owner: Some(owner),
        }
    }

    /// The direction across an edge of each shape; `None` if the edges are parallel.
    fn across(edges: [DVec3; 2], with: [&Spinning; 2]) -> Option<Direction> {
        let [e, f] = edges.map(DVec3::normalize);
        let along = e.cross(f);
        let sine = along.length();
        if sine.is_nan() || sine < f64::EPSILON {
            return None;
        }
        let rates = |edge: DVec3, with: &Spinning| {
            let first = with.spin.cross(edge);
            (first, with.turning.cross(edge) + with.spin.cross(first))
        };
        let ((e1, e2), (f1, f2)) = (rates(e, with[0]), rates(f, with[1]));
        let [a, b] = with;
        let stretched = 1.0 / sine;
        Some(Direction {
            along: along * stretched,
            first: (e1.cross(f) + e.cross(f1)) * stretched,
            second: (e2.cross(f) + 2.0 * e1.cross(f1) + e.cross(f2)) * stretched,
            most: [
                stretched,
                stretched * (a.fastest + b.fastest),
                stretched * (a.second + 2.0 * a.fastest * b.fastest + b.second),
                stretched
                    * (a.third + 3.0 * (a.second * b.fastest + a.fastest * b.second) + b.third),
            ],
            owner: None,
        })
    }

    fn reversed(self) -> Direction {
        Direction {
            along: -self.along,
            first: -self.first,
            second: -self.second,
            ..self
        }
    }
}

/// The motion of points that share a spin: about an origin that follows a parabola.
#[derive(Clone, Copy)]
struct Motion<'a> {
    origin: DVec3,
    velocity: DVec3,
    acceleration: DVec3,
    spinning: &'a Spinning,
}

/// Bounds on the second and third derivatives of heights, without the part that is common to all points.
#[derive(Clone, Copy, Default)]
struct Bend {
    second: f64,
    third: f64,
}

/// A set of points relative to its centre of mass, along the axes of the view.
struct Placed<const L: usize> {
    x: [f64; L],
    y: [f64; L],
    z: [f64; L],
    /// The greatest distance of a point from the centre of mass, m.
    farthest: f64,
}

/// Heights along a direction, and their first two derivatives.
struct Course<const L: usize> {
    at: [f64; L],
    speed: [f64; L],
    bend: [f64; L],
}

impl<const L: usize> Placed<L> {
    fn of(points: &[DVec3; MOST_POINTS]) -> Placed<L> {
        let mut placed = Placed {
            x: [0.0; L],
            y: [0.0; L],
            z: [0.0; L],
            farthest: 0.0,
        };
        let mut square: f64 = 0.0;
        for (k, p) in points[..L].iter().enumerate() {
            (placed.x[k], placed.y[k], placed.z[k]) = (p.x, p.y, p.z);
            square = square.max(p.length_squared());
        }
        placed.farthest = libm::sqrt(square) * (1.0 + 4.0 * f64::EPSILON);
        placed
    }

    #[inline]
    fn heights(&self, n: DVec3, base: f64) -> [f64; L] {
        core::array::from_fn(|k| base + (n.x * self.x[k] + n.y * self.y[k] + n.z * self.z[k]))
    }

    /// The heights with their derivatives at the view's time.
    fn course(&self, at: [f64; L], direction: &Direction, motion: &Motion<'_>) -> Course<L> {
        let &Direction {
            along,
            first,
            second,
            ..
        } = direction;
        let Spinning { spin, turning, .. } = *motion.spinning;
        let swept = along.cross(spin);
        let speed = first.dot(motion.origin) + along.dot(motion.velocity);
        let bend = second.dot(motion.origin)
            + 2.0 * first.dot(motion.velocity)
            + along.dot(motion.acceleration);
        Course {
            at,
            speed: self.heights(first + swept, speed),
            bend: self.heights(
                second + 2.0 * first.cross(spin) + along.cross(turning) + swept.cross(spin),
                bend,
            ),
        }
    }

    fn bend(&self, direction: &Direction, motion: &Motion<'_>, left: f64) -> Bend {
        let Spinning {
            fastest,
            second,
            third,
            ..
        } = *motion.spinning;
        let far = self.farthest;
        let bent = motion.acceleration.length();
        let by_time = [
            motion.velocity.length() + bent * left + fastest * far,
            bent + second * far,
            third * far,
        ];
        let away = motion.origin.length() + far + by_time[0] * left;
        let [n0, n1, n2, n3] = direction.most;
        // If the direction is constant, the acceleration of the origin is known, and the same for all points.
        let own = if n1 == 0.0 { second * far } else { by_time[1] };
        Bend {
            second: n2 * away + 2.0 * n1 * by_time[0] + n0 * own,
            third: n3 * away + 3.0 * (n2 * by_time[0] + n1 * by_time[1]) + n0 * by_time[2],
        }
    }
}

impl<const L: usize> Course<L> {
    /// The height of the lowest point after time `t`, and the least speed of the points at that height. The second
    /// derivative of a point's height is `bend - common`, or 0 if that is positive.
    #[inline]
    fn lowest(&self, t: f64, common: f64) -> (f64, f64) {
        let (mut lowest, mut slope) = (f64::INFINITY, f64::INFINITY);
        for ((at, speed), bend) in self.at.iter().zip(&self.speed).zip(&self.bend) {
            let bend = (bend - common).min(0.0);
            let height = at + t * (speed + 0.5 * t * bend);
            if height <= lowest {
                let steepest = if height < lowest {
                    f64::INFINITY
                } else {
                    slope
                };
                slope = steepest.min(speed + t * bend);
                lowest = height;
            }
        }
        (lowest, slope)
    }

    /// The same along the opposite direction, so that the highest point becomes the lowest.
    fn reversed(self) -> Course<L> {
        Course {
            at: self.at.map(|at| -at),
            speed: self.speed.map(|speed| -speed),
            bend: self.bend.map(|bend| -bend),
        }
    }
}

/// A lower bound on the gap after time `t`, and its slope. The gap lies above the highest point of the set `below`,
/// which is given reversed, and below the lowest point of the set `above`.
fn gap_after<const M: usize, const N: usize>(
    (below, above): (&Course<M>, &Course<N>),
    (common, floor): (f64, &Floor),
    t: f64,
) -> (f64, f64) {
    let (below, above) = (below.lowest(t, -common), above.lowest(t, common));
    let least = floor.at(t);
    (above.0 + below.0 + least.0, above.1 + below.1 + least.1)
}

/// Lower bounds on the gap and its derivatives, without the parts that the points have in `Course`.
#[derive(Clone, Copy)]
struct Floor {
    gap: f64,
    speed: f64,
    second: f64,
    third: f64,
}

impl Floor {
    #[inline]
    fn at(&self, t: f64) -> (f64, f64) {
        let (half, third) = (0.5 * t * self.second, t * t * self.third / 6.0);
        (
            self.gap + t * (self.speed + half + third),
            self.speed + 2.0 * half + 3.0 * third,
        )
    }
}

/// The most rounds in which `root` narrows its interval, and the relative width at which it stops. Both change the
/// cost only.
const ROUNDS: u32 = 8;
const DRAWN: f64 = 1.0 / 65536.0;

/// A lower bound on the first root of a concave function that is positive at 0; infinity if the root is not before
/// `left`. The function returns its value and its slope.
fn root(left: f64, of: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut low, (mut gap, mut slope)) = (0.0, of(0.0));
    let (mut high, mut below) = (left, of(left).0);
    if below > 0.0 {
        return f64::INFINITY;
    }
    for _ in 0..ROUNDS {
        // A tangent is above the function,
        let tangent = low - gap / slope;
        if slope < 0.0 && tangent < high {
            (high, below) = (tangent, of(tangent).0.min(0.0));
        }
        // and a chord is below it. The chord may be far below if the function is flat at first. Where tangent and chord
        // meet, rounding decides; half of the interval is below the function as well.
        let share = gap / (gap - below);
        let middle = low + 0.5 * (high - low);
        for time in [
            low + (high - low) * share.min(1.0 - SHORT),
            libm::sqrt(low * high).max(low + share * (high - low)),
            middle,
        ] {
            if time <= low || time >= high || high - low <= DRAWN * low {
                continue;
            }
            let there = of(time);
            if there.0 > 0.0 {
                (low, (gap, slope)) = (time, there);
            } else {
                (high, below) = (time, there.0);
            }
        }
        if high - low <= DRAWN * low {
            break;
        }
    }
    low * (1.0 - 32.0 * UNIT)
}

/// A chord is shortened by this part, so that its end is below the function.
const SHORT: f64 = 1.0 / 65536.0;

/// Two sets at the time of a view, and the best certificate so far.
struct Sets<'a, const M: usize, const N: usize> {
    view: &'a View,
    first: Placed<M>,
    second: Placed<N>,
    radius: f64,
    margin: Margin,
    near: f64,
    halt: f64,
    /// The widest gap so far, and its direction.
    widest: (f64, DVec3),
    lasts: f64,
    direction: Option<Direction>,
}

/// The motions of both sets relative to the centre of mass of the first set, or of the second.
fn motions(view: &View, from_second: bool) -> [Motion<'_>; 2] {
    let motion = |sign: f64, spinning| Motion {
        origin: sign * view.offset,
        velocity: sign * view.velocity,
        acceleration: sign * view.acceleration,
        spinning,
    };
    match from_second {
        false => [motion(0.0, &view.first), motion(1.0, &view.second)],
        true => [motion(-1.0, &view.first), motion(0.0, &view.second)],
    }
}

impl<const M: usize, const N: usize> Sets<'_, M, N> {
    /// Tries a direction, oriented from the first set to the second. Keeps it if it separates the sets for longer than
    /// all before.
    #[inline(never)]
    fn attempt(&mut self, direction: Direction) {
        let motions = motions(self.view, direction.owner == Some(1));
        let n = direction.along;
        let low = self.first.heights(n, n.dot(motions[0].origin));
        let high = self.second.heights(n, n.dot(motions[1].origin));
        let top = low.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let bottom = high.into_iter().fold(f64::INFINITY, f64::min);
        let gap = bottom - top - self.radius - 32.0 * UNIT * self.margin.size;
        if gap.is_nan() || gap <= 0.0 {
            return;
        }
        if gap > self.widest.0 {
            self.widest = (gap, n);
        }
        let left = self.view.left;
        let (mut a, mut b) = (
            self.first.course(low, &direction, &motions[0]),
            self.second.course(high, &direction, &motions[1]),
        );
        let (mut bend_a, mut bend_b) = (
            self.first.bend(&direction, &motions[0], left),
            self.second.bend(&direction, &motions[1], left),
        );
        match direction.owner {
            Some(0) => (a.speed, a.bend, bend_a) = ([0.0; M], [0.0; M], Bend::default()),
            Some(_) => (b.speed, b.bend, bend_b) = ([0.0; N], [0.0; N], Bend::default()),
            None => (),
        }
        let [n0, n1, n2, _] = direction.most;
        let size = self.view.offset.length() + self.first.farthest + self.second.farthest;
        let speed = self.margin.speed * n0 + n1 * size;
        let bend = self.margin.bend * n0 + 2.0 * n1 * self.margin.speed + n2 * size;
        // Sets that come from farther than a contact stop early, with room for another rounding.
        let room = match gap > self.near - 32.0 * UNIT * self.margin.size {
            true => self.halt * UNIT * self.margin.size,
            false => 0.0,
        };
        let floor = Floor {
            gap: -self.radius - 32.0 * UNIT * self.margin.size - room,
            speed: -32.0 * UNIT * speed,
            second: -64.0 * UNIT * bend,
            third: -(bend_a.third + bend_b.third),
        };
        // One certificate by the second derivatives and a bound on the third,
        let common = a.bend[(0..M).find(|&k| low[k] == top).unwrap_or(0)];
        let mut a = a.reversed();
        let by_third = |t: f64| gap_after((&a, &b), (common, &floor), t);
        let mut lasts = self.lasts;
        // skipped if it fails before the end of the best so far;
        if lasts == 0.0 || by_third(lasts.min(left)).0 > 0.0 {
            lasts = lasts.max(root(left, by_third));
        }
        // another one by a bound on the second derivatives.
        let bent = bend_a.second + bend_b.second;
        if lasts < left && -floor.third * left > 3.0 * bent {
            let common = match n1 == 0.0 {
                true => n.dot(motions[1].acceleration - motions[0].acceleration),
                false => 0.0,
            };
            let floor = Floor {
                second: (common - bent - 64.0 * UNIT * bend).min(0.0),
                third: 0.0,
                ..floor
            };
            (a.bend, b.bend) = ([0.0; M], [0.0; N]);
            let by_second = |t: f64| gap_after((&a, &b), (0.0, &floor), t);
            lasts = lasts.max(root(left, by_second));
        }
        if lasts > self.lasts {
            (self.lasts, self.direction) = (lasts, Some(direction));
        }
    }

    /// The greatest closing speed of points near the separating plane of a direction.
    fn closing(&self, direction: &Direction) -> f64 {
        let motions = motions(self.view, direction.owner == Some(1));
        let n = direction.along;
        let low = self.first.heights(n, n.dot(motions[0].origin));
        let high = self.second.heights(n, n.dot(motions[1].origin));
        let a = self.first.course(low, direction, &motions[0]);
        let b = self.second.course(high, direction, &motions[1]);
        let top = low.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let bottom = high.into_iter().fold(f64::INFINITY, f64::min);
        let reach = 4.0 * self.near;
        let up = (0..M).filter(|&k| top - low[k] <= reach);
        let down = (0..N).filter(|&k| high[k] - bottom <= reach);
        let rises = up.map(|k| a.speed[k]).fold(f64::NEG_INFINITY, f64::max);
        let falls = down.map(|k| b.speed[k]).fold(f64::INFINITY, f64::min);
        rises - falls + 32.0 * UNIT * self.margin.speed
    }
}

/// The directions that the features of a set give: normals of faces, and edges.
#[derive(Clone, Copy)]
struct Own {
    normals: [DVec3; 3],
    edges: [DVec3; 3],
    count: usize,
    is_flat: bool,
}

impl Own {
    fn of(points: &Points<'_>, placed: &[DVec3; MOST_POINTS], axes: [DVec3; 3]) -> Own {
        match points.kind {
            Kind::Point => Own {
                normals: [DVec3::ZERO; 3],
                edges: [DVec3::ZERO; 3],
                count: 0,
                is_flat: false,
            },
            Kind::Triangle(_) => {
                let edges = [0, 1, 2].map(|k| placed[(k + 1) % 3] - placed[k]);
                Own {
                    normals: [edges[0].cross(edges[1]); 3],
                    edges,
                    count: 1,
                    is_flat: true,
                }
            }
            Kind::Cuboid(_) => Own {
                normals: axes,
                edges: axes,
                count: 3,
                is_flat: false,
            },
        }
    }

    fn normals(&self) -> &[DVec3] {
        &self.normals[..self.count]
    }

    fn edges(&self) -> &[DVec3] {
        if self.count == 0 { &[] } else { &self.edges }
    }
}

impl View {
    /// The gap between two sets, and how long it stays open. `known` has the only direction along which the sets may be
    /// separated, and one that is tried first. `care` has the roundings of a gap that are left where the sets stop
    /// ([`Care::halt`](super::Care::halt)), and how near the sets must be for the question whether they part
    /// ([`Care::reach`](super::Care::reach)).
    pub(super) fn sets_apart(
        &self,
        a: &Points<'_>,
        b: &Points<'_>,
        known: (Option<DVec3>, Option<DVec3>),
        care: (f64, f64),
    ) -> Gap {
        let is_big = |points: &Points<'_>| matches!(points.kind, Kind::Cuboid(_));
        match (is_big(a), is_big(b)) {
            (false, false) => self.apart::<4, 4>(a, b, known, care),
            (true, false) => self.apart::<8, 4>(a, b, known, care),
            (false, true) => self.apart::<4, 8>(a, b, known, care),
            (true, true) => self.apart::<8, 8>(a, b, known, care),
        }
    }

    fn apart<const M: usize, const N: usize>(
        &self,
        a: &Points<'_>,
        b: &Points<'_>,
        (only, hint): (Option<DVec3>, Option<DVec3>),
        (halt, reach): (f64, f64),
    ) -> Gap {
        let arms = b.at.map(|p| self.turn * p);
        let second = arms.map(|p| self.offset + p);
        let radius = a.radius + b.radius;
        let (placed_a, placed_b) = (Placed::<M>::of(&a.at), Placed::<N>::of(&arms));
        let margin = self.margin([placed_a.farthest, placed_b.farthest + radius]);
        let near = NEAR * UNIT * margin.size;
        let mut sets = Sets {
            view: self,
            first: placed_a,
            second: placed_b,
            radius,
            margin,
            near,
            halt,
            widest: (0.0, DVec3::ZERO),
            lasts: 0.0,
            direction: None,
        };
        let own = [
            Own::of(a, &a.at, DVec3::AXES),
            Own::of(
                b,
                &arms,
                [self.turn.x_axis, self.turn.y_axis, self.turn.z_axis],
            ),
        ];
        let pair = match only {
            Some(normal) => {
                sets.attempt(Direction::at_rest(normal));
                Some(below(normal, b, &second))
            }
            None => {
                let pair = sets.between((a, &a.at), (b, &second), &own, hint);
                // The nearest points decide whether the sets part.
                let (widest, along) = sets.widest;
                let is_asked = pair.is_none() && widest <= reach * near;
                pair.or_else(|| is_asked.then(|| nearest((a, &a.at), (b, &second), along)))
            }
        };
        let length = pair.map_or(sets.widest.0, |pair| pair.length - radius);
        let mut gap = Gap {
            distance: length.max(0.0),
            near,
            lasts: sets.lasts,
            is_apart: sets.widest.0 > 0.0,
            opens: false,
            parting: 0.0,
            normal: sets.widest.1,
            points: pair.map_or([DVec3::ZERO; 2], |pair| pair.points),
            faces: pair.map_or([None; 2], |pair| pair.faces),
        };
        if let Some(direction) = &sets.direction {
            gap.normal = direction.along;
            if gap.distance <= reach * near {
                let [at_a, at_b] = gap.points;
                let parting = self.velocity + self.second.spin.cross(at_b - self.offset)
                    - self.first.spin.cross(at_a);
                let parting = direction.along.dot(parting) - 32.0 * UNIT * margin.speed;
                gap.opens = parting >= FOLLOWED * sets.closing(direction);
                gap.parting = parting;
            }
        }
        if let Some(normal) = only {
            gap.normal = normal;
        } else if let (true, Some(pair)) = (gap.normal == DVec3::ZERO, pair) {
            let straight = (pair.points[1] - pair.points[0]).try_normalize();
            gap.normal = straight.unwrap_or(DVec3::ZERO);
        }
        gap
    }
}

impl<const M: usize, const N: usize> Sets<'_, M, N> {
    /// Tries the constant direction along a vector, oriented from the first set to the second (`between` is a vector
    /// from a point of the first to a point of the second).
    fn along(&mut self, vector: DVec3, between: DVec3) {
        // Scaled first, because squares of lengths may overflow or underflow.
        let scaled = vector / vector.abs().max_element();
        let n = scaled / scaled.length();
        if n.is_finite() {
            let n = if n.dot(between) < 0.0 { -n } else { n };
            self.attempt(Direction::at_rest(n));
        }
    }

    /// Tries all directions that may separate two sets. Returns the nearest points if they were computed.
    fn between(
        &mut self,
        (a, first): (&Points<'_>, &[DVec3; MOST_POINTS]),
        (b, second): (&Points<'_>, &[DVec3; MOST_POINTS]),
        own: &[Own; 2],
        hint: Option<DVec3>,
    ) -> Option<Pair> {
        let left = self.view.left;
        let between = second[0] - first[0];
        let is_done = |sets: &Self| sets.lasts >= ENOUGH * left;
        if let Some(hint) = hint {
            self.along(hint, between);
            if is_done(self) {
                return None;
            }
        }
        let has_room = matches!(a.kind, Kind::Cuboid(_)) || matches!(b.kind, Kind::Cuboid(_));
        let mut pair = None;
        if has_room {
            // The means of the corners are the centres of the sets.
            let middle = |at: &[DVec3; MOST_POINTS], count: usize| {
                at[..count].iter().sum::<DVec3>() / count as f64
            };
            self.along(middle(second, N) - middle(first, M), between);
        } else {
            let nearest = nearest((a, first), (b, second), DVec3::ZERO);
            self.along(nearest.points[1] - nearest.points[0], between);
            pair = Some(nearest);
        }
        if is_done(self) {
            return pair;
        }
        // Of sets near each other, only the directions of features have enough correct digits.
        for normal in own.iter().flat_map(Own::normals) {
            self.along(*normal, between);
        }
        if has_room && is_done(self) {
            return pair;
        }
        for e in own[0].edges() {
            for f in own[1].edges() {
                self.along(e.cross(*f), between);
            }
        }
        for own in own.iter().filter(|own| own.is_flat) {
            for edge in own.edges {
                self.along(own.normals[0].cross(edge), between);
            }
        }
        // Directions that turn with a shape. No constant direction separates for long a shape that lies in a face or
        // tips over an edge.
        if has_room && !is_done(self) {
            self.along_turning(own, between);
            if is_done(self) {
                return pair;
            }
        }
        if has_room && self.widest.0 <= NEARLY * self.near {
            let nearest = nearest((a, first), (b, second), self.widest.1);
            self.along(nearest.points[1] - nearest.points[0], between);
            pair = Some(nearest);
        }
        // If a corner is nearest to an edge, or to a corner at the end of an edge, try the direction between the
        // nearest points, made exactly perpendicular to the edge.
        if let Some(pair) = pair {
            let straight = pair.points[1] - pair.points[0];
            for side in own.iter().flat_map(Own::edges) {
                let length = side.length_squared();
                if length > 0.0 {
                    let across = straight - straight.dot(*side) / length * *side;
                    self.along(across - across.dot(*side) / length * *side, between);
                }
            }
        }
        if !has_room && !is_done(self) {
            self.along_turning(own, between);
        }
        pair
    }

    fn along_turning(&mut self, own: &[Own; 2], between: DVec3) {
        let view = self.view;
        let spins = [&view.first, &view.second];
        let oriented = |direction: Direction| match direction.along.dot(between) < 0.0 {
            true => direction.reversed(),
            false => direction,
        };
        for (owner, with) in spins.into_iter().enumerate() {
            if with.spin == DVec3::ZERO {
                continue;
            }
            let mut attempt = |vector: DVec3| {
                if let Some(n) = vector.try_normalize() {
                    self.attempt(oriented(Direction::turning_with(owner, n, with)));
                }
            };
            for normal in own[owner].normals() {
                attempt(*normal);
            }
            if own[owner].is_flat {
                for edge in own[owner].edges {
                    attempt(own[owner].normals[0].cross(edge));
                }
            }
        }
        if spins.iter().all(|with| with.spin == DVec3::ZERO) {
            return;
        }
        for e in own[0].edges() {
            for f in own[1].edges() {
                if let Some(direction) = Direction::across([*e, *f], spins) {
                    self.attempt(oriented(direction));
                }
            }
        }
    }
}

/// The lowest point of a set above a plane through the first centre of mass.
fn below(normal: DVec3, of: &Points<'_>, points: &[DVec3; MOST_POINTS]) -> Pair {
    let mut lowest = 0;
    for (k, &p) in points.iter().enumerate() {
        if normal.dot(p) < normal.dot(points[lowest]) {
            lowest = k;
        }
    }
    let height = normal.dot(points[lowest]);
    let foot = points[lowest] - height * normal;
    let (triangles, count) = of.triangles();
    let mut faces = triangles[..count].iter();
    let face = faces.find(|(by, _)| by.contains(&(lowest as u8)));
    Pair {
        length: height,
        points: [foot, points[lowest]],
        faces: [None, face.map(|&(_, face)| face)],
    }
}
