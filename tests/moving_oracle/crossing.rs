//! First contacts of meshes on a lattice: whether surfaces cross right after, in integers, and whether they slip past
//! each other if one is moved slightly.

use kit::meshes::{builtin, scaled};
use kit::random::Random;
use sim_core::collide::touch::{first_touch, time_of_impact};
use sim_core::collide::{Touch, tree};
use sim_core::{Bvh, DVec3, Mesh, Vec3};

type Point = [i64; 3];
type Triangle = [Point; 3];

/// A mesh with few, small integer coordinates.
#[derive(Clone, Debug)]
struct Lattice {
    vertices: Vec<Point>,
    triangles: Vec<[u32; 3]>,
}

impl Lattice {
    fn mesh(&self) -> Option<Mesh> {
        let float = |p: &Point| Vec3::from_array(p.map(|x| x as f32));
        let vertices = self.vertices.iter().map(float).collect();
        Mesh::new(vertices, self.triangles.clone()).ok()
    }

    fn corners(&self) -> impl Iterator<Item = Triangle> + '_ {
        let corner = |v: u32| self.vertices[v as usize];
        self.triangles.iter().map(move |t| t.map(corner))
    }
}

fn det(u: [i128; 3], v: [i128; 3], w: [i128; 3]) -> i128 {
    u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
}

/// The side of a plane through three points on which a fourth one lies.
fn side([a, b, c]: [[i128; 3]; 3], d: [i128; 3]) -> i128 {
    let from = |p: [i128; 3]| [0, 1, 2].map(|i| p[i] - d[i]);
    det(from(a), from(b), from(c)).signum()
}

/// Whether an edge of one triangle passes through the interior of the other one.
fn cross(s: [[i128; 3]; 3], t: [[i128; 3]; 3]) -> bool {
    let one = |s: [[i128; 3]; 3], t: [[i128; 3]; 3]| {
        (0..3).any(|i| {
            let (p, q) = (s[i], s[(i + 1) % 3]);
            let around = |j: usize| side([p, q, t[j]], t[(j + 1) % 3]);
            side(t, p) * side(t, q) < 0
                && around(0) != 0
                && around(0) == around(1)
                && around(1) == around(2)
        })
    };
    one(s, t) || one(t, s)
}

/// Whether a point is in a triangle, or at least on its line if it has no area.
fn is_in(t: [[i128; 3]; 3], p: [i128; 3]) -> bool {
    let sides = |axis: usize| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        [0, 1, 2].map(|k| {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            ((a[i] - p[i]) * (b[j] - p[j]) - (a[j] - p[j]) * (b[i] - p[i])).signum()
        })
    };
    let is_within = |sides: [i128; 3]| !(sides.contains(&1) && sides.contains(&-1));
    side(t, p) == 0 && (0..3).all(|axis| is_within(sides(axis)))
}

/// Two meshes, the second one displaced and moving.
struct Pair {
    first: Lattice,
    second: Lattice,
    offset: Point,
    motion: Point,
}

/// A time as a fraction.
#[derive(Clone, Copy, Debug)]
struct Fraction(i128, i128);

/// Times of contact are quotients of determinants, which are at most `MOST` for these meshes, so two different times
/// differ by at least `1 / MOST²`.
const MOST: i64 = 1200;
const SOON: Fraction = Fraction(1, 1 << 22);

impl Fraction {
    /// The time of contact that rounds to this one.
    fn of(time: f64) -> Fraction {
        let near = |under: &i64| {
            let over = (time * *under as f64).round();
            (over / *under as f64 - time).abs() <= f64::EPSILON
        };
        let under = (1..=MOST).find(near).expect("a time of contact");
        Fraction((time * under as f64).round() as i128, under.into())
    }

    fn plus(self, other: Fraction) -> Fraction {
        Fraction(self.0 * other.1 + other.0 * self.1, self.1 * other.1)
    }
}

impl Pair {
    fn at(&self, Fraction(over, under): Fraction) -> [Vec<[[i128; 3]; 3]>; 2] {
        let still = |t: Triangle| t.map(|p| p.map(|x| i128::from(x) * under));
        let moved = |t: Triangle| {
            t.map(|p| {
                [0, 1, 2].map(|i| {
                    i128::from(p[i] + self.offset[i]) * under + i128::from(self.motion[i]) * over
                })
            })
        };
        [
            self.first.corners().map(still).collect(),
            self.second.corners().map(moved).collect(),
        ]
    }

    fn cross_at(&self, time: Fraction) -> bool {
        let [first, second] = self.at(time);
        first.iter().any(|&s| second.iter().any(|&t| cross(s, t)))
    }

    /// The points where vertices of either mesh are in triangles of the other one, without duplicates.
    fn vertices_touch_at(&self, time: Fraction) -> Vec<[i128; 3]> {
        let [first, second] = self.at(time);
        let mut points = vec![];
        for (of, others) in [(&first, &second), (&second, &first)] {
            for &p in of.iter().flatten() {
                if others.iter().any(|&t| is_in(t, p)) && !points.contains(&p) {
                    points.push(p);
                }
            }
        }
        points
    }

    /// `None` if there is nothing to test.
    fn check(&self) -> Option<Result<(), String>> {
        let [first, second] = [&self.first, &self.second].map(Lattice::mesh);
        let (first, second) = (Bvh::build(&first?), Bvh::build(&second?));
        let float = |p: Point| DVec3::from_array(p.map(|x| x as f64));
        let (offset, motion) = (float(self.offset), float(self.motion));
        if tree::intersect(&first, &second, offset) {
            return None;
        }
        let time = time_of_impact(&first, &second, offset, motion)?;
        let touch = first_touch(&first, &second, offset, motion);
        let back = first_touch(&second, &first, -offset, -motion);
        if back.map(|t| t.time) != touch.map(|t| t.time) {
            return Some(Err(format!("{touch:?}, the other way round {back:?}")));
        }
        Some(self.judge(time, touch, |by: DVec3| {
            time_of_impact(&first, &second, offset + by, motion)
        }))
    }

    fn judge(
        &self,
        time: f64,
        touch: Option<Touch>,
        moved: impl Fn(DVec3) -> Option<f64>,
    ) -> Result<(), String> {
        let motion = DVec3::from_array(self.motion.map(|x| x as f64));
        if let Some(touch) = &touch {
            let is_unit = (touch.normal.length() - 1.0).abs() < 1e-15;
            if !(is_unit && touch.normal.dot(motion) < 0.0 && touch.time >= time) {
                return Err(format!("{touch:?} at {time}"));
            }
        }
        let exact = Fraction::of(time);
        let is_found = touch.is_some_and(|touch| touch.time == time);
        if !is_found && self.cross_at(exact.plus(SOON)) {
            return Err(format!("crosses after {exact:?}, {touch:?}"));
        }
        // Later contacts, after sliding.
        let until = touch.map_or(1.0, |touch| touch.time);
        let is_later = |k: &i64| (*k as f64) / 32.0 > time && (*k as f64) / 32.0 < until;
        let later = (0..=32).filter(is_later);
        for k in later {
            if !is_found && self.cross_at(Fraction(k.into(), 32)) {
                return Err(format!("crosses at {k}/32, {touch:?}"));
            }
        }
        let slips = (0..SIDEWAYS).any(|i| {
            let angle = std::f64::consts::TAU * (f64::from(i) + 0.37) / f64::from(SIDEWAYS);
            let across = motion.any_orthogonal_vector().normalize();
            let (x, y) = (across, across.cross(motion).normalize());
            let by = (2.0_f64).powi(-36) * (angle.cos() * x + angle.sin() * y);
            let time_of_moved = moved(by);
            time_of_moved.is_none_or(|moved| (moved - time).abs() > 2.0_f64.powi(-22))
        });
        match (is_found, slips) {
            (true, true) => Err(format!("slips past at {exact:?}, {touch:?}")),
            // Past one point on one side, and past another one on the other side.
            (false, false) if self.vertices_touch_at(exact).len() > 1 => Ok(()),
            (false, false) => Err(format!("does not slip past at {exact:?}, {touch:?}")),
            _ => Ok(()),
        }
    }
}

const SIDEWAYS: u32 = 24;

/// A lattice point next to the origin.
fn point(random: &mut Random) -> Point {
    [0; 3].map(|_| random.whole(-1, 1))
}

/// Triangles around a vertex, some upwards and some downwards, optionally closed below.
fn saddle(random: &mut Random) -> Lattice {
    let ring = [
        [1, 0],
        [1, 1],
        [0, 1],
        [-1, 1],
        [-1, 0],
        [-1, -1],
        [0, -1],
        [1, -1],
    ];
    let mut vertices = vec![[0; 3]];
    for (i, [x, y]) in ring.into_iter().enumerate() {
        // The straight ones and some of the slanted ones.
        if i % 2 == 0 || random.below(3) == 0 {
            vertices.push([x, y, random.whole(-1, 1)]);
        }
    }
    let count = vertices.len() as u32 - 1;
    let mut triangles = vec![];
    let is_closed = random.below(2) == 0;
    let sectors = if is_closed || random.below(2) == 0 {
        count
    } else {
        random.whole(1, count.into()) as u32
    };
    vertices.push([0, 0, -3]);
    for i in 0..sectors {
        let (a, b) = (1 + i, 1 + (i + 1) % count);
        triangles.push([0, a, b]);
        if is_closed {
            triangles.push([count + 1, b, a]);
        }
    }
    Lattice {
        vertices,
        triangles,
    }
}

/// A sheet in a plane along `way`, with an edge or a corner in front.
fn sheet(random: &mut Random, way: Point) -> Lattice {
    let along = loop {
        let along = point(random);
        let is_parallel = (0..3).all(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            along[j] * way[k] == along[k] * way[j]
        });
        if !is_parallel {
            break along;
        }
    };
    let (from, to) = (random.whole(-2, 0), random.whole(1, 2));
    let at = |u: i64, back: i64| [0, 1, 2].map(|i| u * along[i] - back * way[i]);
    let (lag, far) = (random.whole(0, 1), random.whole(0, 2));
    match random.below(3) {
        0 => Lattice {
            vertices: vec![at(from, 0), at(to, lag), at(far - 1, 1 + lag)],
            triangles: vec![[0, 1, 2]],
        },
        1 => Lattice {
            vertices: vec![at(from, 0), at(to, 0), at(to, 1), at(from, 1)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        },
        // Two, at an angle, with a front edge that has a corner.
        _ => Lattice {
            vertices: vec![at(from, lag), [0; 3], at(to, lag), at(0, 2)],
            triangles: vec![[0, 1, 3], [1, 2, 3]],
        },
    }
}

fn soup(random: &mut Random) -> Lattice {
    let count = random.whole(3, 6) as u32;
    let vertices = (0..count).map(|_| point(random)).collect();
    let triangles = (0..random.whole(1, 4)).map(|_| {
        let first = random.below(count as usize) as u32;
        let step = 1 + random.below(count as usize - 2) as u32;
        [first, (first + step) % count, (first + step + 1) % count]
    });
    let differ = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    Lattice {
        vertices,
        triangles: triangles.filter(differ).collect(),
    }
}

fn tetrahedron(random: &mut Random) -> Lattice {
    let vertices: Vec<Point> = (0..4).map(|_| point(random)).collect();
    let wide = |i: usize| vertices[i].map(i128::from);
    let mut triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    if side([wide(0), wide(1), wide(2)], wide(3)) > 0 {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Lattice {
        vertices,
        triangles,
    }
}

fn pair(random: &mut Random) -> Pair {
    let mut way = [0; 3];
    while way == [0; 3] {
        way = point(random);
    }
    let kind = random.below(6);
    let first = match kind {
        0..=2 => saddle(random),
        3 => tetrahedron(random),
        _ => soup(random),
    };
    let second = match random.below(if kind < 4 { 5 } else { 8 }) {
        0..=2 => sheet(random, way),
        3 => tetrahedron(random),
        4 => saddle(random),
        _ => soup(random),
    };
    let mut aim = point(random);
    if random.below(2) == 0 {
        aim = [0; 3];
    }
    let steps = random.whole(3, 4);
    let offset = [0, 1, 2].map(|i| aim[i] - steps * way[i]);
    let motion = way.map(|x| x * 2 * steps);
    Pair {
        first,
        second,
        offset,
        motion,
    }
}

/// Tests many pairs that mostly touch at vertices and edges.
#[test]
fn first_touches_are_where_surfaces_come_to_cross() {
    let count = std::env::var("PAIRS").map_or(10_000, |count| count.parse().expect("a number"));
    let mut random = Random::xorshift(0x9e37_79b9_7f4a_7c15, 1);
    let (mut judged, mut wrong) = (0, vec![]);
    while judged < count {
        let pair = pair(&mut random);
        let Some(verdict) = pair.check() else {
            continue;
        };
        judged += 1;
        if let Err(what) = verdict {
            wrong.push(format!(
                "{what}\n{:?}\n{:?}\noffset {:?} motion {:?}",
                pair.first, pair.second, pair.offset, pair.motion
            ));
        }
    }
    let shown = wrong.iter().take(8).cloned().collect::<Vec<_>>();
    assert!(
        wrong.is_empty(),
        "{} of {judged}:\n{}",
        wrong.len(),
        shown.join("\n\n")
    );
}

fn lattice(vertices: &[Point], triangles: &[[u32; 3]]) -> Lattice {
    Lattice {
        vertices: vertices.to_vec(),
        triangles: triangles.to_vec(),
    }
}

/// A sheet that descends in its own plane, edge first, on the vertex between two ridges and two valleys, open and
/// closed: only edges touch.
#[test]
fn a_sheet_does_not_fall_through_a_saddle() {
    let vertices = [
        [0, 0, 0],
        [1, 0, 1],
        [0, 1, -1],
        [-1, 0, 1],
        [0, -1, -1],
        [0, 0, -4],
    ];
    let upper = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
    let lower = [[5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];
    let open = lattice(&vertices, &upper);
    let closed = lattice(&vertices, &[upper, lower].concat());
    let corners = [[0, -2, 0], [0, 2, 0], [0, 2, 1], [0, -2, 1]];
    let one = lattice(&corners, &[[0, 1, 2], [0, 2, 3]]);
    let both = lattice(&corners, &[[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]]);
    for first in [&open, &closed] {
        for second in [&one, &both] {
            let [a, b] = [first, second].map(|m| Bvh::build(&m.mesh().expect("a mesh")));
            let (from, down) = (DVec3::Z * 2.0, DVec3::Z * -8.0);
            assert_eq!(time_of_impact(&a, &b, from, down), Some(0.25));
            let touch = first_touch(&a, &b, from, down).expect("in the way");
            assert_eq!(touch.time, 0.25);
            assert!(touch.normal.z > 0.5, "{touch:?}");
            let touch = first_touch(&b, &a, -from, -down).expect("in the way");
            assert_eq!(touch.time, 0.25);
            assert!(touch.normal.z < -0.5, "{touch:?}");
            // Placed there, or moved past the crossing.
            let at_once = first_touch(&a, &b, DVec3::ZERO, down).expect("in the way");
            assert_eq!(at_once.time, 0.0);
            assert_eq!(first_touch(&a, &b, DVec3::ZERO, -down), None);
        }
    }
}

/// A corner that reaches a wall from inside, on the border between the wall's triangles.
#[test]
fn what_is_inside_a_shell_does_not_leave_between_triangles() {
    let shell = scaled(&builtin("cube.obj"), DVec3::splat(8.0));
    let corners = [[1, 0, 0], [0, 1, 1], [0, -1, 1], [0, 0, -1]];
    let spike = lattice(&corners, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]);
    let (shell, spike) = (
        Bvh::build(&shell),
        Bvh::build(&spike.mesh().expect("a mesh")),
    );
    for axis in DVec3::AXES {
        for sign in [1.0, -1.0] {
            let motion = sign * 8.0 * axis;
            let impact = time_of_impact(&shell, &spike, DVec3::ZERO, motion);
            assert!(impact.is_some());
            let touch = first_touch(&shell, &spike, DVec3::ZERO, motion).expect("in the way");
            assert_eq!((Some(touch.time), touch.normal), (impact, -sign * axis));
        }
    }
}
