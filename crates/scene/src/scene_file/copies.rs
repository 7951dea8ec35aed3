//! `copies`: many bodies from one table, at random positions without overlap.

use std::ops::Range;

use glam::DVec3;
use toml::Spanned;

use super::number::Triple;
use super::parse::{LARGEST, Place};
use super::text::Body;
use crate::error::SceneError;
use crate::scene::{SceneBody, SceneShape};
use crate::shown;
use crate::world::{Baked, baked_field};

/// The most copies of one body.
const MOST: usize = 10_000;
/// The number of random positions tried for a copy before the box counts as full.
const TRIES: usize = 10_000;

/// The fields of a table that concern copies.
pub(super) struct Copies {
    count: Spanned<usize>,
    speed_span: Range<usize>,
    /// The least and greatest corner of the box that contains the copies.
    inside: (DVec3, DVec3),
    speed: f64,
    seed: u64,
}

/// The fields about copies, if the table has some.
pub(super) fn parse(place: &Place, text: &Body) -> Result<Option<Copies>, SceneError> {
    let Some(count) = text.copies.clone() else {
        let stray = [
            text.inside.as_ref().map(|value| ("inside", value.span())),
            text.speed.as_ref().map(|value| ("speed", value.span())),
            text.seed.as_ref().map(|value| ("seed", value.span())),
        ];
        return match stray.into_iter().flatten().next() {
            Some((field, span)) => {
                let what = "is about copies: say how many there are, such as `copies = 100`";
                Err(place.error(span, field, what))
            }
            None => Ok(None),
        };
    };
    if !(1..=MOST).contains(count.get_ref()) {
        let what = format!("must be from 1 to {MOST}, is {}", count.get_ref());
        return Err(place.error(count.span(), "copies", what));
    }
    if let Some(value) = &text.half_space {
        let what = "half-spaces have no copies: give each a table of its own";
        return Err(place.error(value.span(), "half-space", what));
    }
    if let Some(value) = &text.position {
        let what = "copies are placed `inside` a box: leave it out";
        return Err(place.error(value.span(), "position", what));
    }
    let Some(corners) = &text.inside else {
        let what = "`inside` is missing: the corners of the box that the copies are in, such as \
                    `inside = [[-2, 0, -2], [2, 4, 2]]`";
        return Err(place.error(count.span(), "copies", what));
    };
    let speed = text.speed.as_ref().map_or(0.0, |value| value.get_ref().0);
    let speed_span = text.speed.as_ref().map_or(count.span(), Spanned::span);
    if !(0.0..=LARGEST).contains(&speed) {
        let what = format!(
            "must be a speed in m/s from 0 to 1e100, is {}",
            shown::number(speed)
        );
        return Err(place.error(speed_span, "speed", what));
    }
    Ok(Some(Copies {
        inside: inside(place, corners)?,
        count,
        speed_span,
        speed,
        seed: text.seed.as_ref().map_or(0, |value| *value.get_ref()),
    }))
}

fn inside(place: &Place, corners: &Spanned<Vec<Triple>>) -> Result<(DVec3, DVec3), SceneError> {
    let wrong = |what: &str| Err(place.error(corners.span(), "inside", what));
    let &[Triple(one), Triple(other)] = &corners.get_ref()[..] else {
        return wrong("must be two corners, such as [[-2, 0, -2], [2, 4, 2]]");
    };
    let within = |corner: DVec3| corner.abs().cmple(DVec3::splat(LARGEST)).all();
    if !within(one) || !within(other) {
        return wrong("must be two corners of numbers within ±1e100");
    }
    Ok((one.min(other), one.max(other)))
}

impl Copies {
    /// The copies of `body`, named `cube 1`, `cube 2` and so on. Each lies within the box and is apart from the other
    /// copies and from the bodies before. The same seed gives the same positions on every platform.
    pub(super) fn place(
        &self,
        place: &Place,
        body: &SceneBody,
        before: &[SceneBody],
        obstacles: &mut Obstacles,
    ) -> Result<Vec<SceneBody>, SceneError> {
        let wrong = |what: String| place.error(self.count.span(), "copies", what);
        let refused = |(field, error)| place.error(self.count.span(), field, error);
        obstacles.note(before).map_err(refused)?;
        let obstacle = obstacles.of(body).map_err(refused)?;
        let Obstacle::Box { min, max } = obstacle else {
            return Err(wrong("half-spaces have no copies".to_owned()));
        };
        let (min, max) = (min - body.position, max - body.position);
        let (least, greatest) = (self.inside.0 - min, self.inside.1 - max);
        if !least.cmple(greatest).all() {
            let size = max - min;
            return Err(wrong(format!(
                "the box `inside` is smaller than the body, which takes up [{}, {}, {}] m: enlarge it",
                shown::number(size.x),
                shown::number(size.y),
                shown::number(size.z)
            )));
        }
        let count = *self.count.get_ref();
        let mut taken = Taken::new((least + min, greatest + max), max - min, count);
        obstacles
            .all
            .iter()
            .for_each(|&obstacle| taken.add(obstacle));
        let mut random = Random(self.seed);
        let mut copies = Vec::with_capacity(count);
        for number in 1..=count {
            let free = (0..TRIES).find_map(|_| {
                let parts = DVec3::from([(); 3].map(|()| random.unit()));
                let position = least + parts * (greatest - least);
                let (min, max) = (position + min, position + max);
                let is_free = taken.is_free(min, max);
                is_free.then_some((position, Obstacle::Box { min, max }))
            });
            let Some((position, here)) = free else {
                return Err(wrong(format!(
                    "only {} fit into the box `inside` without touching: enlarge it or ask for fewer",
                    number - 1
                )));
            };
            taken.add(here);
            let velocity = body.velocity + self.speed * random.direction();
            if !velocity.abs().cmple(DVec3::splat(LARGEST)).all() {
                let what =
                    "must be so that with `velocity` no copy has a speed above 1e100 m/s: lower it";
                return Err(place.error(self.speed_span.clone(), "speed", what));
            }
            copies.push(SceneBody {
                name: format!("{} {number}", body.name),
                position,
                velocity,
                ..body.clone()
            });
        }
        Ok(copies)
    }
}

/// The obstacles for copies: all bodies of a file so far.
#[derive(Default)]
pub(super) struct Obstacles {
    all: Vec<Obstacle>,
    pub(super) baked: Baked,
}

/// A region in which no copy may be.
#[derive(Clone, Copy)]
enum Obstacle {
    /// The bounding box of a body.
    Box { min: DVec3, max: DVec3 },
    /// The half-space behind a plane.
    HalfSpace { point: DVec3, normal: DVec3 },
}

impl Obstacles {
    /// Adds obstacles for the bodies that have none yet.
    fn note(&mut self, bodies: &[SceneBody]) -> Result<(), (&'static str, String)> {
        for body in &bodies[self.all.len()..] {
            let obstacle = self.of(body)?;
            self.all.push(obstacle);
        }
        Ok(())
    }

    /// The obstacle of a body, or the field that makes it invalid and the reason.
    fn of(&mut self, body: &SceneBody) -> Result<Obstacle, (&'static str, String)> {
        let (min, max) = match &body.shape {
            SceneShape::Mesh(mesh) => {
                let mesh = self.baked.turned(mesh, body);
                let mesh = mesh.map_err(|error| (baked_field(&error), error.to_string()))?;
                let bounds = mesh.bounds();
                (bounds.min.as_dvec3(), bounds.max.as_dvec3())
            }
            SceneShape::Sphere { radius } => (DVec3::splat(-radius), DVec3::splat(*radius)),
            SceneShape::HalfSpace { normal } => {
                return Ok(Obstacle::HalfSpace {
                    point: body.position,
                    normal: *normal,
                });
            }
        };
        Ok(Obstacle::Box {
            min: body.position + min,
            max: body.position + max,
        })
    }
}

/// The most cells in which an obstacle is listed.
const LISTED: usize = 64;

/// Obstacles by position, in a grid over the box of the copies. The cell index grows monotonically with the coordinate,
/// however coordinates are rounded, so two boxes that share a point share a cell.
struct Taken {
    region: (DVec3, DVec3),
    /// Cells along each axis, and cells per metre.
    cells: [usize; 3],
    density: DVec3,
    in_cell: Vec<Vec<Obstacle>>,
    /// Obstacles that cover too many cells, and half-spaces.
    everywhere: Vec<Obstacle>,
}

impl Taken {
    /// An empty grid over a region for a number of copies of a size: about as many cells as copies, none smaller than a
    /// copy.
    fn new((min, max): (DVec3, DVec3), size: DVec3, copies: usize) -> Taken {
        let most = (copies as f64).cbrt().ceil();
        // Larger than the rounding errors of the positions of copies.
        let margin = 16.0 * f64::EPSILON * (min.abs() + max.abs());
        let (min, max) = (min - margin, max + margin);
        let cells = ((max - min) / size).clamp(DVec3::ONE, DVec3::splat(most));
        // NaN, from a copy of no size in a box of no size, counts as 1.
        let cells = cells.to_array().map(|cells| cells.max(1.0) as usize);
        let density = DVec3::from(cells.map(|cells| cells as f64)) / (max - min);
        Taken {
            region: (min, max),
            cells,
            density: DVec3::select(density.is_finite_mask(), density, DVec3::ZERO),
            in_cell: vec![Vec::new(); cells.iter().product()],
            everywhere: Vec::new(),
        }
    }

    /// The range of cells that a box covers along each axis.
    fn cells(&self, min: DVec3, max: DVec3) -> [(usize, usize); 3] {
        let place = |at: DVec3, axis: usize| {
            let place = (at[axis] - self.region.0[axis]) * self.density[axis];
            // The conversion saturates out-of-range values.
            (place as usize).min(self.cells[axis] - 1)
        };
        [0, 1, 2].map(|axis| (place(min, axis), place(max, axis)))
    }

    fn add(&mut self, obstacle: Obstacle) {
        let Obstacle::Box { min, max } = obstacle else {
            return self.everywhere.push(obstacle);
        };
        if obstacle.is_apart(self.region.0, self.region.1) {
            return;
        }
        let cells = self.cells(min, max);
        if cells
            .iter()
            .map(|(first, last)| last - first + 1)
            .product::<usize>()
            > LISTED
        {
            return self.everywhere.push(obstacle);
        }
        for index in indices(self.cells, cells) {
            self.in_cell[index].push(obstacle);
        }
    }

    /// Whether a box is clear of all obstacles.
    fn is_free(&self, min: DVec3, max: DVec3) -> bool {
        let is_apart = |other: &Obstacle| other.is_apart(min, max);
        self.everywhere.iter().all(is_apart)
            && indices(self.cells, self.cells(min, max))
                .all(|index| self.in_cell[index].iter().all(is_apart))
    }
}

/// The indices of the cells in ranges along each axis, in a grid with these numbers of cells.
fn indices([_, ny, nz]: [usize; 3], [x, y, z]: [(usize, usize); 3]) -> impl Iterator<Item = usize> {
    let range = |(first, last): (usize, usize)| first..=last;
    range(x)
        .flat_map(move |i| range(y).flat_map(move |j| range(z).map(move |k| (i * ny + j) * nz + k)))
}

impl Obstacle {
    /// Whether a box is clear of this obstacle.
    fn is_apart(&self, least: DVec3, greatest: DVec3) -> bool {
        match *self {
            Obstacle::Box { min, max } => max.cmplt(least).any() || greatest.cmplt(min).any(),
            Obstacle::HalfSpace { point, normal } => {
                let deepest = DVec3::select(normal.cmpgt(DVec3::ZERO), least, greatest);
                (deepest - point).dot(normal) > 0.0
            }
        }
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014, Fast splittable pseudorandom number generators). Only exact operations follow
/// it, so the numbers are the same on every platform.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in `[0, 1)`.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A uniformly distributed direction: of the first random point of a cube that lies in the inscribed ball.
    fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::from([(); 3].map(|()| 2.0 * self.unit() - 1.0));
            if (0.01..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}
