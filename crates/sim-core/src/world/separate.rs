//! Moving overlapping bodies apart.
//!
//! First all bodies move together, by as little as possible. Each pair that meets gets a plane perpendicular to the
//! shortest translation that separates it. Bodies move to the nearest positions, in the norm weighted by their
//! masses, on the far sides of all planes. Pairs that meet at these positions get a new plane, and so on until no two
//! bodies meet. If the planes allow no such position, as for a body between two immovable ones that face each other,
//! bodies are placed one after the other, heavy ones first. Each takes the shortest of many directions to a position
//! where it meets no body placed before it.

use alloc::{collections::BTreeMap, vec::Vec};
use glam::DVec3;

use super::{World, layout::Layout, penetration::compass};
use crate::{
    Shape,
    collide::{first_contact, snap},
};

/// The most rounds in which planes are added.
const ROUNDS: usize = 64;
/// The most sweeps over the planes in a round. There are fewer sweeps if there are many planes; the next round
/// continues.
const SWEEPS: usize = 20_000;
/// The most visits of planes in a round.
const LOOKS: usize = 2_000_000;
/// If the missing distance has not fallen to this part, the planes have no common far side.
const UNSOLVED: f64 = 1e-4;
/// Factor by which a plane's correction is exceeded in a sweep, because other planes undo a part of it.
const RELAXATION: f64 = 1.5;

/// The reason why overlapping bodies cannot be moved apart.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SeparateError {
    /// A body does not fit between half-spaces.
    #[error(
        "body {body} does not fit between the half-spaces {walls:?}: make it smaller, or move one of them"
    )]
    Caught {
        /// Index of the body.
        body: usize,
        /// The half-spaces between which it does not fit.
        walls: Vec<usize>,
    },
    /// No position was found for a body, though there may be one.
    #[error(
        "no place was found for body {body}, which overlaps bodies {others:?}: move it, or one of them"
    )]
    NoRoom {
        /// Index of the body.
        body: usize,
        /// The bodies that it overlaps and from which it cannot be moved apart.
        others: Vec<usize>,
    },
}

/// A plane that keeps two bodies apart: `level` is the least offset along the normal, m.
struct Plane {
    bodies: (usize, usize),
    normal: DVec3,
    level: f64,
    /// The sum of its pushes so far, kg m.
    pushed: f64,
}

impl World {
    /// Moves overlapping bodies apart, so that none overlap. Returns the bodies that were moved, in order. Velocities
    /// do not change. A body that did not overlap moves only if others are moved into it.
    ///
    /// Of two bodies the lighter one moves farther, by the ratio of their masses; immovable bodies stay. The sum of
    /// mass times square of the distance is the least that moves all bodies along their shortest translations
    /// ([`World::overlaps`]). Afterwards these bodies touch, as if placed face to face.
    ///
    /// On an error the world stays as it was.
    pub fn separate(&mut self) -> Result<Vec<usize>, SeparateError> {
        if self.overlapping().is_empty() {
            return Ok(Vec::new());
        }
        self.build_bvhs();
        let separation = Separation {
            layout: self.layout(),
        };
        let at = &self.current.position;
        let place = match separation.places_together(at) {
            Some(place) => place,
            None => separation.places_one_by_one(at)?,
        };
        let moved: Vec<usize> = (0..self.bodies.len())
            .filter(|&i| place[i] != at[i])
            .collect();
        for &body in &moved {
            self.current.position[body] = place[body];
            self.previous.position[body] = place[body];
            self.forget_contacts_of(body);
            self.note_placed(body);
        }
        self.integrator.forget_growth();
        Ok(moved)
    }
}

/// Overlapping bodies that are moved apart.
struct Separation<'a> {
    layout: Layout<'a>,
}

impl Separation<'_> {
    /// Pairs that meet at given positions, one of which is movable.
    fn meeting_at(&self, place: &[DVec3]) -> Vec<(usize, usize)> {
        let mut pairs = self
            .layout
            .bodies
            .near_pairs(place, |body| 8.0 * self.layout.hover_gap(body, body));
        pairs.retain(|&(i, j)| self.layout.meet(i, j, place[j] - place[i]));
        pairs
    }

    /// The nearest positions, in the norm of masses, at which no bodies meet; `None` if none are found.
    fn places_together(&self, at: &[DVec3]) -> Option<Vec<DVec3>> {
        let mut place = at.to_vec();
        let mut planes: BTreeMap<(usize, usize), Plane> = BTreeMap::new();
        let mut found = None;
        for _ in 0..ROUNDS {
            let meeting = self.meeting_at(&place);
            if meeting.is_empty() {
                let is_tight = !self.tighten(planes.values_mut(), &place);
                found = Some(place);
                if is_tight {
                    break;
                }
                place = at.to_vec();
            }
            for bodies in meeting {
                let (i, j) = bodies;
                let offset = place[j] - place[i];
                let out = self.layout.penetration(i, j, offset);
                let level = out.normal.dot(offset) + out.depth + self.layout.hover_gap(i, j);
                let plane = Plane {
                    bodies,
                    normal: out.normal,
                    level,
                    pushed: 0.0,
                };
                planes.insert(bodies, plane);
            }
            let mut all: Vec<&mut Plane> = planes.values_mut().collect();
            if !self.push_beyond(&mut all, &mut place) {
                break;
            }
        }
        found
    }

    /// Turns planes to the surfaces that the bodies would touch now. Returns whether a pair that a plane has pushed
    /// does not touch: round bodies were moved along another plane as well.
    fn tighten<'a>(&self, planes: impl Iterator<Item = &'a mut Plane>, place: &[DVec3]) -> bool {
        let mut is_wide = false;
        for plane in planes.filter(|plane| plane.pushed > 0.0) {
            let ((i, j), before) = (plane.bodies, plane.normal);
            let (offset, hover) = (place[j] - place[i], self.layout.hover_gap(i, j));
            let length = offset.length() + hover;
            let Some((first, second)) = self.layout.bodies.forms(i, j) else {
                continue;
            };
            let way = -length * before;
            if let Some(contact) = first_contact(first, second, snap(offset), snap(way))
                && contact.time * length > 8.0 * hover
            {
                plane.normal = contact.normal;
                plane.level = contact.normal.dot(offset + contact.time * way) + hover;
                is_wide = true;
            }
        }
        is_wide
    }

    /// Moves bodies to the far sides of planes, with the least motion in the norm of masses (Hildreth 1957, "A
    /// quadratic programming procedure": plane after plane, repeatedly). Returns whether the planes may have a common
    /// far side.
    fn push_beyond(&self, planes: &mut [&mut Plane], place: &mut [DVec3]) -> bool {
        let inverse = |body: usize| 1.0 / self.layout.bodies.mass[body];
        let sweeps = SWEEPS.min(1 + LOOKS / planes.len());
        let (mut first, mut worst) = (0.0_f64, 0.0_f64);
        for plane in &mut *planes {
            plane.pushed = 0.0;
        }
        for sweep in 0..sweeps {
            worst = 0.0;
            let mut is_done = true;
            for plane in &mut *planes {
                let (i, j) = plane.bodies;
                let missing = plane.level - plane.normal.dot(place[j] - place[i]);
                worst = worst.max(missing);
                // Done if no distance is missing, and the pairs of pushed planes touch.
                let slack = 0.25 * self.layout.hover_gap(i, j);
                is_done &= missing <= slack && (plane.pushed == 0.0 || missing >= -slack);
                let push = RELAXATION * missing / (inverse(i) + inverse(j));
                let pushed = (plane.pushed + push).max(0.0);
                let push = pushed - plane.pushed;
                plane.pushed = pushed;
                place[i] -= push * inverse(i) * plane.normal;
                place[j] += push * inverse(j) * plane.normal;
            }
            if sweep == 0 {
                first = worst;
            }
            if is_done {
                return true;
            }
        }
        // For few planes these sweeps were enough to reach a common far side. For many planes the next round continues.
        worst <= UNSOLVED * first || sweeps < SWEEPS
    }

    /// Positions at which no bodies meet, found for one body after the other.
    fn places_one_by_one(&self, at: &[DVec3]) -> Result<Vec<DVec3>, SeparateError> {
        let mut place = at.to_vec();
        let (mut there, mut movable): (Vec<usize>, Vec<usize>) = self
            .layout
            .bodies
            .solid
            .iter()
            .partition(|&&body| !self.layout.bodies.is_movable(body));
        movable.sort_by(|&i, &j| {
            self.layout.bodies.mass[j]
                .total_cmp(&self.layout.bodies.mass[i])
                .then(i.cmp(&j))
        });
        for body in movable {
            place[body] = self.free_place(body, &there, &place)?;
            there.push(body);
        }
        Ok(place)
    }

    /// The nearest position of a body along one of many directions at which it meets none of some others.
    fn free_place(
        &self,
        body: usize,
        there: &[usize],
        place: &[DVec3],
    ) -> Result<DVec3, SeparateError> {
        let blockers = |at: DVec3| -> Vec<usize> {
            let meets = |&&other: &&usize| {
                let (i, j) = (body.min(other), body.max(other));
                let offset = if body < other {
                    place[other] - at
                } else {
                    at - place[other]
                };
                let is_wall = self
                    .layout
                    .bodies
                    .extent(i)
                    .half
                    .max(self.layout.bodies.extent(j).half)
                    == f64::INFINITY;
                let swept = |body: usize, at: DVec3| self.layout.bodies.swept_box(body, at, at);
                self.layout.bodies.may_meet(i, j)
                    && (is_wall || swept(body, at).meets(&swept(other, place[other])))
                    && self.layout.meet(i, j, offset)
            };
            there.iter().filter(meets).copied().collect()
        };
        let walls: Vec<usize> = there
            .iter()
            .copied()
            .filter(|&other| {
                matches!(
                    self.layout.bodies.shape(other),
                    Some(Shape::HalfSpace { .. })
                ) && self.layout.bodies.may_meet(body, other)
            })
            .collect();
        let inside = |at: DVec3| self.out_of_walls(body, at, &walls, place);
        let first = inside(place[body]).ok_or_else(|| SeparateError::Caught {
            body,
            walls: self.walls_about(body, place[body], &walls, place),
        })?;
        let others = blockers(first);
        if others.is_empty() {
            return Ok(first);
        }
        let mut ways: Vec<DVec3> = compass().collect();
        for &other in &others {
            ways.extend(self.layout.ways_out(other, body, first - place[other]));
        }
        let free = |length: f64, way: DVec3| {
            let at = inside(first + length * way)?;
            blockers(at).is_empty().then_some(at)
        };
        let size = |other: usize| self.layout.bodies.extent(other).farthest;
        let most = there.iter().fold(8.0 * size(body), |most, &other| {
            most.max(4.0 * (size(body) + size(other) + (place[other] - first).length()))
        });
        let mut far = self.layout.hover_gap(body, others[0]);
        while far <= most {
            let nearest = ways
                .iter()
                .filter_map(|&way| {
                    let mut found = free(far, way)?;
                    let (mut low, mut high) = (0.5 * far, far);
                    for _ in 0..40 {
                        let middle = 0.5 * (low + high);
                        match free(middle, way) {
                            Some(at) => (high, found) = (middle, at),
                            None => low = middle,
                        }
                    }
                    Some(found)
                })
                .min_by(|a, b| (a - first).length().total_cmp(&(b - first).length()));
            if let Some(nearest) = nearest {
                return Ok(nearest);
            }
            far *= 2.0;
        }
        Err(SeparateError::NoRoom { body, others })
    }

    /// The planes that limit the position of a body outside half-spaces.
    fn wall_planes(&self, body: usize, walls: &[usize], place: &[DVec3]) -> Vec<(DVec3, f64)> {
        let of = |&wall: &usize| {
            let &Shape::HalfSpace { normal } = self.layout.bodies.shape(wall)? else {
                return None;
            };
            let reach = self.layout.reach_against(body, normal)?;
            let level = normal.dot(place[wall]) + reach + self.layout.hover_gap(wall, body);
            Some((normal, level))
        };
        walls.iter().filter_map(of).collect()
    }

    /// The position outside all half-spaces that is nearest to a given one, if there is one.
    fn out_of_walls(
        &self,
        body: usize,
        at: DVec3,
        walls: &[usize],
        place: &[DVec3],
    ) -> Option<DVec3> {
        if matches!(
            self.layout.bodies.shape(body),
            Some(Shape::HalfSpace { .. })
        ) {
            return Some(at);
        }
        let planes = self.wall_planes(body, walls, place);
        let mut pushed = alloc::vec![0.0_f64; planes.len()];
        let mut at = at;
        for _ in 0..SWEEPS {
            let mut is_done = true;
            for ((&(normal, level), pushed), &wall) in planes.iter().zip(&mut pushed).zip(walls) {
                let missing = level - normal.dot(at);
                is_done &= missing <= 0.25 * self.layout.hover_gap(wall, body);
                let sum = (*pushed + missing).max(0.0);
                at += (sum - *pushed) * normal;
                *pushed = sum;
            }
            if is_done {
                return Some(at);
            }
        }
        None
    }

    /// A minimal subset of the half-spaces that leaves a body no position.
    fn walls_about(&self, body: usize, at: DVec3, walls: &[usize], place: &[DVec3]) -> Vec<usize> {
        // Drop each half-space without which there is still no position.
        let mut few = walls.to_vec();
        for &wall in walls {
            let others: Vec<usize> = few.iter().copied().filter(|&other| other != wall).collect();
            if self.out_of_walls(body, at, &others, place).is_none() {
                few = others;
            }
        }
        few
    }
}
