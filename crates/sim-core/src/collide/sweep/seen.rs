//! Triangles around a point of contact, projected along the motion.

use alloc::vec::Vec;
use core::cmp::Ordering;
use glam::DVec3;

use crate::collide::triple::{Difference, sign};

/// The place of a point in a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) enum At {
    Corner(usize),
    /// On the side between this corner and the next one.
    Side(usize),
    Inside,
}

impl At {
    /// The place where a line passes through a triangle, from its sides of the triangle's edges.
    pub(super) fn line(sides: [Ordering; 3]) -> At {
        let on = |i: usize| sides[i] == Ordering::Equal;
        match [on(0), on(1), on(2)] {
            [false, false, false] => At::Inside,
            [true, false, false] => At::Side(0),
            [false, true, false] => At::Side(1),
            [false, false, true] => At::Side(2),
            [_, true, true] => At::Corner(2),
            [true, false, true] => At::Corner(0),
            [true, true, false] => At::Corner(1),
        }
    }

    /// Vectors that span the triangle's cone at the point. Those that matter lead from the point to corners.
    pub(super) fn ways(self, corners: [DVec3; 3]) -> [Difference; 3] {
        let origin = match self {
            At::Corner(i) | At::Side(i) => i,
            At::Inside => 0,
        };
        let mut ways = corners.map(|corner| Difference(corner, corners[origin]));
        if let At::Side(i) = self {
            ways[i] = Difference(corners[i], corners[(i + 1) % 3]);
        }
        ways
    }
}

/// The cone of a triangle at one of its points: all linear combinations of some vectors with factors of at least 0.
pub(super) struct Cone {
    ways: [Difference; 3],
    seen: Seen,
}

/// The projection of a cone along the motion. [`turn`] defines a left turn.
enum Seen {
    All,
    /// From one ray to the left up to another one, at most a half-plane.
    Sector(Difference, Difference),
    /// The triangle is parallel to the motion; its rays are those of the vectors that are not.
    Rays,
}

fn turn(u: Difference, v: Difference, motion: Difference) -> Ordering {
    // Adjacent triangles share an edge.
    if (u.0, u.1) == (v.0, v.1) {
        return Ordering::Equal;
    }
    sign([u, v, motion])
}

impl Cone {
    /// The cone of a triangle, given its vectors from the point to the corners other than the point.
    pub(super) fn new([a, b, c]: [DVec3; 3], ways: [Difference; 3], motion: DVec3, at: At) -> Cone {
        let sector = |at: At| match at {
            At::Corner(i) => Some((ways[(i + 1) % 3], ways[(i + 2) % 3])),
            At::Side(i) => Some((ways[(i + 1) % 3], ways[i])),
            At::Inside => None,
        };
        let order = turn(Difference(b, a), Difference(c, a), motion.into());
        let seen = match order {
            Ordering::Equal => Seen::Rays,
            _ => match (sector(at), order) {
                (None, _) => Seen::All,
                (Some((right, left)), Ordering::Greater) => Seen::Sector(right, left),
                (Some((left, right)), _) => Seen::Sector(right, left),
            },
        };
        Cone { ways, seen }
    }
}

/// Whether two surfaces that touch in a point, given by their triangles there, slip past each other along the motion
/// after a small move of one of them.
///
/// Near the point a surface is a cone. Its projection along the motion is a set of rays from the point. After an
/// arbitrarily small move, one set misses the other if and only if it lies in a gap of the other: a sector without
/// rays of the other set, except at its ends. Proof: a set that misses the other one is connected. So it lies in one
/// sector between rays of the other set, and so do all its directions, the ends included. Conversely, either the gap
/// or the rest of the plane is convex, and a move along its bisector is enough: of the one set into the gap, or of
/// the other set out of it. Only if one set is a single ray does its gap reach both sides of this ray, and the other
/// set may contain the ray inside.
///
/// Surfaces do not slip past each other if they are apart before they touch and an edge of one then at once passes
/// through the inside of a triangle of the other. The place where the edge passes through projects onto a ray of both
/// surfaces, or onto the point. If the triangle projects to a sector, it contains the ray, and so has no gap there.
/// If the triangle is parallel to the motion, it projects to rays, and an edge on these is in its plane. So the edge
/// passes through in the point, and has rays to both sides. Between them, in the triangle, is the direction of the
/// motion, with rays of the triangle to both sides as well.
pub(super) fn slips_past(first: &[Cone], second: &[Cone], motion: DVec3) -> bool {
    let motion = Difference::from(motion);
    // Decides most cases: a ray of one surface is inside a triangle of the other.
    if has_ray_of(first, second, motion) || has_ray_of(second, first, motion) {
        return false;
    }
    let Some(circle) = Circle::new([first, second], motion) else {
        return false;
    };
    let is_of = |of: usize, place: usize| circle.covered[place % circle.len()][of];
    let places = || 0..circle.len();
    for (one, other) in [(0, 1), (1, 0)] {
        let is_within = |i: usize| {
            [circle.len() - 1, 0, 1]
                .iter()
                .all(|on| is_of(other, i + on))
        };
        if places().all(|i| is_of(one, i)) || places().any(|i| is_of(one, i) && is_within(i)) {
            return false;
        }
    }
    let mut ends = places().filter(|&i| is_of(0, i)).peekable();
    let whole = places().filter(|&i| is_of(1, i)).count();
    ends.peek().is_none()
        || ends.any(|start| {
            let gap = (1..circle.len())
                .take_while(|on| !is_of(0, start + on))
                .count();
            let last = (gap + 1).min(circle.len() - 1);
            (0..=last).filter(|on| is_of(1, start + on)).count() == whole
        })
}

/// Whether a triangle of one surface has, inside its projection, a ray of the other surface.
fn has_ray_of(cones: &[Cone], others: &[Cone], motion: Difference) -> bool {
    cones.iter().any(|cone| match cone.seen {
        Seen::All => true,
        Seen::Sector(right, left) => others.iter().flat_map(|other| other.ways).any(|way| {
            turn(right, way, motion) == Ordering::Greater
                && turn(way, left, motion) == Ordering::Greater
        }),
        Seen::Rays => false,
    })
}

/// The directions around a point, cut at the ends of the sectors of both surfaces. Even places are these rays; an odd
/// place is the sector to the left of a ray, up to the next one.
struct Circle {
    /// Whether the first and the second surface cover the place.
    covered: Vec<[bool; 2]>,
}

impl Circle {
    fn len(&self) -> usize {
        self.covered.len()
    }

    /// `None` if one of the surfaces covers all directions.
    fn new(surfaces: [&[Cone]; 2], motion: Difference) -> Option<Circle> {
        let most = 3 * (surfaces[0].len() + surfaces[1].len());
        let mut sectors: Vec<(usize, [usize; 2])> = Vec::with_capacity(most);
        let mut ends: Vec<(u8, Difference, usize)> = Vec::with_capacity(2 * most);
        let mut add = |of: usize, right: Difference, left: Difference| {
            // Sorted by quarters that begin at one of the rays, so that two rays in a quarter are less than half a
            // turn apart.
            let start = ends.first().map_or(right, |&(_, start, _)| start);
            let quarter = |way: Difference| match turn(start, way, motion) {
                Ordering::Equal if along(start, way, motion) == Ordering::Less => 2,
                Ordering::Equal => 0,
                Ordering::Greater => 1,
                Ordering::Less => 3,
            };
            ends.push((quarter(right), right, 2 * sectors.len()));
            ends.push((quarter(left), left, 2 * sectors.len() + 1));
            sectors.push((of, [0; 2]));
        };
        for (of, cones) in surfaces.into_iter().enumerate() {
            for cone in cones {
                match cone.seen {
                    Seen::All => return None,
                    Seen::Sector(right, left) => add(of, right, left),
                    Seen::Rays => {
                        let leads = |way: &Difference| along(*way, *way, motion) != Ordering::Equal;
                        let rays = cone.ways.into_iter().filter(leads);
                        rays.for_each(|way| add(of, way, way));
                    }
                }
            }
        }
        let order = |x: &(u8, Difference, usize), y: &(u8, Difference, usize)| {
            x.0.cmp(&y.0).then_with(|| match x.0 {
                0 | 2 => Ordering::Equal,
                _ => turn(y.1, x.1, motion),
            })
        };
        ends.sort_unstable_by(order);
        let mut count = 0;
        for run in ends.chunk_by(|x, y| order(x, y) == Ordering::Equal) {
            for &(_, _, end) in run {
                sectors[end / 2].1[end % 2] = 2 * count;
            }
            count += 1;
        }
        let mut covered = alloc::vec![[false; 2]; 2 * count];
        for (of, [from, to]) in sectors {
            let mut place = from;
            covered[place][of] = true;
            while place != to {
                place = (place + 1) % (2 * count);
                covered[place][of] = true;
            }
        }
        Some(Circle { covered })
    }
}

/// Whether surfaces that touch, given by their triangles there, share a point as soon as the second one moves along a
/// vector. With `certainly`, only if they do for all vectors near it.
pub(super) fn meet_after(first: &[Cone], second: &[Cone], way: DVec3, certainly: bool) -> bool {
    first.iter().any(|one| {
        second.iter().any(|other| {
            // The vector leads from a point of the second surface to a point of the first.
            let [a, b, c] = one.ways;
            let [d, e, f] = other.ways.map(|Difference(to, from)| Difference(from, to));
            let ways = [a, b, c, d, e, f];
            let is_amid = || {
                let mut fan = Fan::new(way);
                ways.iter().for_each(|&way| fan.add(way));
                fan.is_all()
            };
            (!certainly || is_amid()) && is_sum(&ways, way.into())
        })
    })
}

/// Whether a vector is a linear combination, with factors of at least 0, of three of the given ones that span the
/// space.
fn is_sum(ways: &[Difference; 6], way: Difference) -> bool {
    let spans = |i: usize, j: usize, k: usize| {
        let [u, v, w] = [ways[i], ways[j], ways[k]];
        let whole = sign([u, v, w]);
        let is_positive = |rows| [whole, Ordering::Equal].contains(&sign(rows));
        whole != Ordering::Equal
            && is_positive([way, v, w])
            && is_positive([u, way, w])
            && is_positive([u, v, way])
    };
    (0..6).any(|i| (i + 1..6).any(|j| (j + 1..6).any(|k| spans(i, j, k))))
}

/// Directions in the projection along the motion: the least sector that contains all of them.
struct Fan {
    motion: Difference,
    sector: Sector,
}

#[derive(Clone, Copy)]
enum Sector {
    Nothing,
    Ray(Difference),
    /// Two opposite directions.
    Line(Difference),
    /// Less than a half-plane, counter-clockwise from the first direction to the second.
    Acute(Difference, Difference),
    /// To the left of a direction.
    Half(Difference),
    All,
}

impl Fan {
    fn new(motion: DVec3) -> Fan {
        Fan {
            motion: motion.into(),
            sector: Sector::Nothing,
        }
    }

    fn is_all(&self) -> bool {
        matches!(self.sector, Sector::All)
    }

    fn add(&mut self, v: Difference) {
        use Ordering::{Equal, Greater, Less};
        let turn = |u: Difference| sign([u, v, self.motion]);
        self.sector = match self.sector {
            Sector::All => return,
            Sector::Nothing => match along(v, v, self.motion) {
                Equal => return,
                _ => Sector::Ray(v),
            },
            Sector::Ray(u) => match turn(u) {
                Greater => Sector::Acute(u, v),
                Less => Sector::Acute(v, u),
                Equal if along(u, v, self.motion) == Less => Sector::Line(u),
                Equal => return,
            },
            Sector::Line(u) => match turn(u) {
                Greater => Sector::Half(u),
                Less => Sector::Half(Difference(u.1, u.0)),
                Equal => return,
            },
            Sector::Acute(right, left) => match (turn(right), turn(left)) {
                (Greater | Equal, Less) | (Greater | Equal, Equal) => return,
                (Greater, Greater) => Sector::Acute(right, v),
                (Less, Less) => Sector::Acute(v, left),
                (Equal, Greater) => Sector::Half(right),
                (Less, Equal) => Sector::Half(v),
                (Less, Greater) => Sector::All,
            },
            Sector::Half(right) => match turn(right) {
                Less => Sector::All,
                _ => return,
            },
        };
    }
}

/// Compares two directions that are parallel in the projection along the motion: whether they have the same sense, or
/// `Equal` if one of them vanishes there.
fn along(u: Difference, v: Difference, motion: Difference) -> Ordering {
    for axis in DVec3::AXES.map(Difference::from) {
        let [u, v] = [u, v].map(|way| sign([way, axis, motion]));
        if u != Ordering::Equal {
            return match v {
                Ordering::Equal => v,
                _ if u == v => Ordering::Greater,
                _ => Ordering::Less,
            };
        }
    }
    Ordering::Equal
}
