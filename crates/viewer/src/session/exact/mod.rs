//! The exact solution: the positions of bodies without errors of method or step, as far as it is known.
//!
//! It is known for bodies under constant forces that bounce off immovable half-spaces and boxes; under linear drag and
//! springs without rest length to fixed points; and around one centre of attraction. It is known until the boxes of
//! two bodies that could affect each other meet.

mod bounce;
mod kepler;
mod linear;

use sim_core::{Aabb, DVec3, Force, Mesh, Shape, World};

use bounce::{Bounce, Face};
use linear::Linear;

use super::turns;

/// The most bodies whose paths are followed, because every pair is watched.
const MOST_BODIES: usize = 32;
/// The most faces against which one path is followed.
const MOST_FACES: usize = 200;
/// The most time slices in which one call watches for bodies that meet.
const MOST_SLICES: f64 = 200_000.0;

/// The exact paths of the bodies of a world, from its initial state here.
#[derive(Clone, Debug)]
pub struct Exact {
    /// The time of that state, s.
    start: f64,
    paths: Vec<Path>,
    /// The time up to which each path is known, s.
    known: Vec<f64>,
    /// The time up to which meetings of bodies have been excluded, s, and the positions then.
    watched: f64,
    boxes: Vec<Extent>,
    /// The numbers of impacts and of steps with contacts before.
    met: (u64, u64),
    /// The pairs that may meet and affect each other.
    pairs: Vec<(usize, usize)>,
}

/// The law of a body's motion.
#[derive(Clone, Debug)]
enum Path {
    /// No law that is solved here.
    Unknown,
    /// An immovable body: position and velocity.
    Driven(DVec3, DVec3),
    /// Constant forces, and faces off which the body bounces.
    Bounce(Bounce),
    /// Springs and drag.
    Linear(Linear, DVec3, DVec3),
    /// A centre and its strength, initial position and velocity.
    Kepler(DVec3, f64, DVec3, DVec3),
}

/// A body's box about its position, m; infinite for a half-space.
#[derive(Clone, Copy, Debug)]
struct Extent {
    low: DVec3,
    high: DVec3,
}

impl Exact {
    /// The paths from the present state of a world.
    pub fn of(world: &World) -> Self {
        let count = world.len();
        // A turning body meets others with other features than those at the start.
        let followed = count <= MOST_BODIES && (count == 1 || !turns(world));
        let paths: Vec<Path> = (0..count)
            .map(|i| match followed {
                true => Path::of(world, i),
                false => Path::Unknown,
            })
            .collect();
        let known = paths.iter().map(|path| match path {
            Path::Unknown => f64::NEG_INFINITY,
            _ => f64::INFINITY,
        });
        let mut pairs = Vec::new();
        for i in 0..if followed { count } else { 0 } {
            for j in i + 1..count {
                if may_answer(world, i, j) || may_answer(world, j, i) {
                    pairs.push((i, j));
                }
            }
        }
        Self {
            start: world.time(),
            known: known.collect(),
            paths,
            watched: world.time(),
            met: (world.impacts(), world.contact_steps()),
            boxes: (0..count).map(|i| extent(world, i)).collect(),
            pairs,
        }
    }

    /// Watches up to `time`, s, whether bodies meet. `slice` is a time in which nothing moves far, s.
    pub fn watch(&mut self, time: f64, slice: f64) {
        let long = time - self.watched;
        if self.pairs.is_empty() || long <= 0.0 {
            self.watched = self.watched.max(time);
            return;
        }
        let slices = (long / slice).round().clamp(1.0, MOST_SLICES);
        let from = self.watched;
        let mut before = self.places(from);
        for n in 1..=slices as u64 {
            let until = from + long * n as f64 / slices;
            let after = self.places(until);
            let middle = self.places(0.5 * (self.watched + until));
            for n in 0..self.pairs.len() {
                let (i, j) = self.pairs[n];
                if self.known[i].min(self.known[j]) <= self.watched {
                    continue;
                }
                let apart = |a: &[Option<DVec3>]| Some(a[j]? - a[i]?);
                let ways = (apart(&before), apart(&middle), apart(&after));
                let (Some(a), Some(b), Some(c)) = ways else {
                    continue;
                };
                // A curved path leaves the box of its ends by at most twice the deviation at its middle.
                let bulge = 2.0 * (b - 0.5 * (a + c)).abs();
                let (low, high) = (a.min(c) - bulge, a.max(c) + bulge);
                let (first, second) = (self.boxes[i], self.boxes[j]);
                if (low + second.low).cmple(first.high).all()
                    && (high + second.high).cmpge(first.low).all()
                {
                    self.forget(i, j);
                }
            }
            (before, self.watched) = (after, until);
        }
        self.watched = time;
    }

    /// Position and velocity of body `i` at a time that has been watched, s; `None` if they are not known.
    pub fn at(&mut self, i: usize, time: f64) -> Option<(DVec3, DVec3)> {
        if time > *self.known.get(i)? {
            return None;
        }
        let after = time - self.start;
        let found = match self.paths.get_mut(i)? {
            Path::Unknown => None,
            Path::Driven(place, velocity) => Some((*place + after * *velocity, *velocity)),
            Path::Bounce(bounce) => bounce.at(after),
            Path::Linear(linear, place, velocity) => Some(linear.at(*place, *velocity, after)),
            Path::Kepler(centre, strength, place, velocity) => {
                let found = kepler::at(*place - *centre, *velocity, *strength, after);
                found.map(|(away, velocity)| (*centre + away, velocity))
            }
        };
        if found.is_none() {
            self.known[i] = self.known[i].min(time);
        }
        found
    }

    /// Largest distance of a body of `world` from its exact position, m, among the bodies whose position is known;
    /// `None` if there are none. Immovable bodies do not count.
    pub fn error(&mut self, world: &World) -> Option<f64> {
        self.watch(world.time(), world.settings().dt);
        if (world.impacts(), world.contact_steps()) != self.met {
            // Some bodies have met, perhaps including some with unknown paths.
            for n in 0..self.pairs.len() {
                let (i, j) = self.pairs[n];
                if self.known[i].min(self.known[j]) < world.time() {
                    self.forget(i, j);
                }
            }
        }
        let mut error: Option<f64> = None;
        for i in (0..world.len()).filter(|&i| world.kind(i).is_movable()) {
            if let Some((place, _)) = self.at(i, world.time()) {
                let away = (world.position(i) - place).length();
                error = Some(error.map_or(away, |most| most.max(away)));
            }
        }
        error
    }

    /// Whether the position of every body is known at a time that has been watched, s.
    pub fn knows_all(&mut self, time: f64) -> bool {
        (0..self.paths.len()).all(|i| self.at(i, time).is_some())
    }

    fn places(&mut self, time: f64) -> Vec<Option<DVec3>> {
        let count = self.paths.len();
        (0..count)
            .map(|i| self.at(i, time).map(|(place, _)| place))
            .collect()
    }

    fn forget(&mut self, i: usize, j: usize) {
        for body in [i, j] {
            if !matches!(self.paths[body], Path::Driven(..)) {
                self.known[body] = self.known[body].min(self.watched);
            }
        }
    }
}

impl Path {
    fn of(world: &World, i: usize) -> Path {
        let (place, velocity, mass) = (world.position(i), world.velocity(i), world.mass(i));
        if !world.kind(i).is_movable() {
            return Path::Driven(place, velocity);
        }
        let mut push = world.force(i) / mass;
        let (mut drag, mut stiffness, mut pull) = (0.0, 0.0, DVec3::ZERO);
        let mut attraction = None;
        for force in world.forces() {
            let acts = force.bodies().next().is_none() || force.bodies().any(|body| body == i);
            match *force {
                Force::Gravity { acceleration } => push += acceleration,
                _ if !acts => {}
                // Such a force rotates the body, or acts elsewhere than at its centre.
                _ if force.point().is_some() || force.points().is_some() => return Path::Unknown,
                Force::LinearDrag { coefficient, .. } => drag += coefficient,
                Force::QuadraticDrag {
                    coefficient: 0.0, ..
                } => {}
                Force::Anchor {
                    anchor,
                    rest_length: 0.0,
                    stiffness: k,
                    damping,
                    ..
                } => {
                    stiffness += k;
                    pull += k * anchor;
                    drag += damping;
                }
                Force::Attraction {
                    centre, strength, ..
                } if attraction.is_none() => attraction = Some((centre, strength)),
                Force::Gravitation { .. } if alone(world, i) => {}
                _ => return Path::Unknown,
            }
        }
        let free = drag == 0.0 && stiffness == 0.0;
        match attraction {
            Some((centre, strength)) if strength > 0.0 => {
                if free && push == DVec3::ZERO && place != centre {
                    Path::Kepler(centre, strength, place, velocity)
                } else {
                    Path::Unknown
                }
            }
            _ if free => match faces(world, i) {
                Some(faces) => Path::Bounce(Bounce::new(place, velocity, push, faces)),
                None => Path::Unknown,
            },
            _ => {
                let linear = Linear {
                    centre: if stiffness > 0.0 {
                        pull / stiffness
                    } else {
                        DVec3::ZERO
                    },
                    push,
                    stiffness: stiffness / mass,
                    damping: drag / mass,
                };
                Path::Linear(linear, place, velocity)
            }
        }
    }
}

/// Whether there is no other movable body.
fn alone(world: &World, i: usize) -> bool {
    (0..world.len()).all(|j| j == i || !world.kind(j).is_movable())
}

/// Whether two bodies are in groups that collide.
fn collide(world: &World, i: usize, j: usize) -> bool {
    world.groups(i).collide(world.groups(j))
}

/// Whether the impacts of body `i`, which moves freely, on `j` are resolved by the path.
fn is_face(world: &World, i: usize, j: usize) -> bool {
    if !world.kind(i).is_movable() || world.kind(j).is_movable() || !collide(world, i, j) {
        return false;
    }
    let box_like = |body: usize| match world.shape(body) {
        Some(Shape::Mesh(mesh)) => is_box(mesh),
        _ => true,
    };
    match world.shape(j) {
        Some(Shape::HalfSpace { .. }) => true,
        Some(Shape::Mesh(mesh)) => is_box(mesh) && box_like(i),
        Some(Shape::Sphere { .. }) | None => false,
    }
}

/// Whether `i` could meet `j` in a way that no path describes.
fn may_answer(world: &World, i: usize, j: usize) -> bool {
    if !world.kind(i).is_movable() || !collide(world, i, j) {
        return false;
    }
    // Two points never meet.
    if world.shape(i).is_none() && world.shape(j).is_none() {
        return false;
    }
    !(is_free(world, i) && is_face(world, i, j))
}

/// Whether only constant forces act on a body.
fn is_free(world: &World, i: usize) -> bool {
    world.forces().iter().all(|force| {
        let acts = force.bodies().next().is_none() || force.bodies().any(|body| body == i);
        !acts || matches!(force, Force::Gravity { .. })
    })
}

/// The planes off which body `i` bounces; `None` if there are too many, or if it begins inside a body.
fn faces(world: &World, i: usize) -> Option<Vec<Face>> {
    let mut faces = Vec::new();
    for j in (0..world.len()).filter(|&j| is_face(world, i, j)) {
        let rough = world.friction(i) > 0.0 && world.friction(j) > 0.0;
        let restitution = world.restitution(i).min(world.restitution(j));
        let face = |place: DVec3, normal: DVec3, sure: DVec3, most: DVec3| Face {
            place,
            velocity: world.velocity(j),
            normal,
            sure,
            most,
            restitution,
            rough,
        };
        let away = world.position(i) - world.position(j);
        match world.shape(j) {
            Some(&Shape::HalfSpace { normal }) => {
                let place = world.position(j) + support(world, i, -normal) * normal;
                let wide = DVec3::INFINITY;
                let gap = (world.position(i) - place).dot(normal);
                if gap < -1e-9 * (1e-3 + world.position(i).abs().max_element()) {
                    return None;
                }
                faces.push(face(place, normal, wide, wide));
            }
            Some(Shape::Mesh(mesh)) => {
                let Aabb { min, max } = mesh.bounds();
                let (min, max) = (min.as_dvec3(), max.as_dvec3());
                let own = extent(world, i);
                // The positions that the origin cannot take, relative to the other's: its box grown by the reflected
                // box of the body.
                let (low, high) = (min - own.high, max - own.low);
                let middle = 0.5 * (low + high);
                let half = 0.5 * (high - low);
                let round = matches!(world.shape(i), Some(Shape::Sphere { .. }));
                let sure = if round {
                    0.5 * (max - min)
                } else {
                    half * (1.0 - 1e-9)
                };
                let inside = (away - middle).abs().cmplt(half * (1.0 - 1e-9)).all();
                if inside {
                    return None;
                }
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let open = axis * f64::INFINITY;
                    let open = DVec3::select(axis.cmpgt(DVec3::ZERO), open, DVec3::ZERO);
                    for normal in [axis, -axis] {
                        let place = world.position(j) + middle + half * normal;
                        faces.push(face(place, normal, sure.max(open), half.max(open)));
                    }
                }
            }
            Some(Shape::Sphere { .. }) | None => {}
        }
        if faces.len() > MOST_FACES {
            return None;
        }
    }
    Some(faces)
}

/// The support of body `i`: its extent from its origin along a unit vector, m.
fn support(world: &World, i: usize, along: DVec3) -> f64 {
    match world.shape(i) {
        Some(Shape::Mesh(mesh)) => {
            let corners = mesh.vertices().iter();
            let reach = corners.map(|corner| corner.as_dvec3().dot(along));
            reach.fold(f64::NEG_INFINITY, f64::max)
        }
        Some(&Shape::Sphere { radius }) => radius,
        Some(Shape::HalfSpace { .. }) | None => 0.0,
    }
}

fn extent(world: &World, i: usize) -> Extent {
    let (low, high) = match world.shape(i) {
        Some(&Shape::HalfSpace { normal }) => half_space_extent(normal),
        shape => {
            let bounds = shape.and_then(Shape::bounds);
            bounds.map_or((DVec3::ZERO, DVec3::ZERO), |[low, high]| (low, high))
        }
    };
    Extent { low, high }
}

/// The extent of a half-space: infinite, except on the side of a normal along an axis.
fn half_space_extent(normal: DVec3) -> (DVec3, DVec3) {
    let upright = |part: f64, other: f64| part.abs() > 1.0 - 1e-12 && other == part.signum();
    let end = |part: f64, side: f64| {
        if upright(part, side) {
            0.0
        } else {
            side * f64::INFINITY
        }
    };
    let low = normal.to_array().map(|part| end(part, -1.0));
    let high = normal.to_array().map(|part| end(part, 1.0));
    (low.into(), high.into())
}

/// Whether a mesh is an axis-aligned box: all its vertices and faces are those of its bounds.
fn is_box(mesh: &Mesh) -> bool {
    let Aabb { min, max } = mesh.bounds();
    let on_side = |side: usize, part: f32| {
        let (axis, bound) = (side % 3, if side < 3 { min } else { max });
        part == bound[axis]
    };
    let corner = |v: &glam::Vec3| (0..3).all(|axis| v[axis] == min[axis] || v[axis] == max[axis]);
    let mut sides = [0; 6];
    for triangle in 0..mesh.triangles().len() {
        let corners = mesh.corners(triangle);
        let side = (0..6).find(|&side| corners.iter().all(|v| on_side(side, v[side % 3])));
        match side {
            Some(side) => sides[side] += 1,
            None => return false,
        }
    }
    mesh.is_closed() && mesh.vertices().iter().all(corner) && sides == [2; 6]
}
