//! The first contacts of bodies that have just been placed.
//!
//! Bodies that are placed face to face overlap in exact arithmetic, or miss each other by a rounding. Both are
//! contacts. Overlapping bodies are moved apart by the least sufficient displacements, in the norm of their masses,
//! all at once. For each pair there is a position nearby at which it is apart. The exact search from that position to
//! the present one gives a plane. The displacements are computed with all planes found so far, until no bodies meet.
//! An overlap that cannot be removed by as much as the f32 rounding of vertices stays an overlap, and is held as it
//! is.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::{World, layout::Layout, penetration::Penetration};
use super::contact_set::ContactConstraint;
use super::{island::Places, solver::ContactSolver};
use crate::{
    collide::{Form, first_contact, parting_normals, reach, snap},
    impulse::project,
};

/// The greatest number of rounds in which planes are added; each round adds one for each pair that still meets.
const MAX_ROUNDS: usize = 64;

/// The greatest number of directions tried to move a pair apart.
const MAX_DIRECTIONS: usize = 12;

/// Two bodies that overlap where they were placed.
pub(in crate::world) struct Meeting {
    bodies: (usize, usize),
    /// An offset of the second from the first at which they are apart.
    apart: DVec3,
    /// The greatest relative displacement of the two bodies, m.
    reach: f64,
}

/// A plane that keeps two bodies apart: the least offset along its normal.
pub(in crate::world) struct Plane {
    bodies: (usize, usize),
    normal: DVec3,
    level: f64,
    point: DVec3,
}

impl World {
    /// Moves bodies apart that have overlapped by no more than a rounding since they were placed.
    pub(super) fn separate_placed(&mut self) {
        if !self.continuous.placed || self.overlaps.pairs.is_empty() {
            return;
        }
        self.part_turning();
        let at = self.previous.position.clone();
        let layout = self.layout();
        let pairs = self.overlaps.pairs.iter();
        let meeting = pairs.filter_map(|&(i, j)| layout.place_apart((i, j), at[j] - at[i]));
        let mut meeting: Vec<Meeting> = meeting.collect();
        if !meeting.is_empty()
            && let Some((moved, planes)) = layout.parted(&mut meeting, &at)
        {
            for (current, (moved, at)) in
                self.current.position.iter_mut().zip(moved.iter().zip(&at))
            {
                *current += *moved - *at;
            }
            self.previous.position = moved;
            for plane in planes {
                let gap = self.layout().hover_gap(plane.bodies.0, plane.bodies.1);
                let contact = ContactConstraint::new(plane.bodies, plane.normal, gap, plane.point);
                self.contacts.insert(contact, &self.bodies);
            }
        }
        self.overlaps
            .retain(|&(i, j)| self.bodies.meet_in(&self.previous, i, j));
        self.note_depths();
    }

    /// Stores the depths of bodies placed in overlap, and keeps these bodies from closing.
    fn note_depths(&mut self) {
        let mut last: Option<((usize, usize), Penetration)> = None;
        for (i, j) in self.overlaps.pairs.clone() {
            // The depth of a turning body in another one is not known.
            if self.bodies.pair_tumbles(i, j) || self.overlaps.depth_at_start((i, j)).is_some() {
                continue;
            }
            let layout = self.layout();
            let same = last.filter(|&(known, _)| layout.are_copies((i, j), known));
            let at = &self.previous.position;
            let out = same.map_or_else(|| layout.penetration(i, j, at[j] - at[i]), |(_, out)| out);
            last = Some(((i, j), out));
            self.overlaps.note_depth((i, j), out.depth);
            if self.bodies.is_movable(i) || self.bodies.is_movable(j) {
                let contact = self.layout().overlap_contact((i, j), out.normal);
                self.contacts.insert(contact, &self.bodies);
            }
        }
    }
}

impl Layout<'_> {
    /// An offset at which a pair is apart that meets at `offset`, if there is one within a rounding.
    pub(in crate::world) fn place_apart(
        &self,
        bodies: (usize, usize),
        offset: DVec3,
    ) -> Option<Meeting> {
        let (i, j) = bodies;
        self.bodies.need_bvh(i);
        self.bodies.need_bvh(j);
        let forms = self.bodies.forms(i, j)?;
        let farthest = self.flush(i, j);
        // A sum of three directions is the longest displacement that is tried.
        if self.is_surely_deeper(bodies, offset, 3.0 * farthest) {
            return None;
        }
        let is_apart = |to: DVec3| !self.bodies.meet_built(i, j, offset + to);
        let mut directions: Vec<DVec3> = Vec::new();
        // Directions sorted by how deep the bodies are in each other along them: normals of planes that separate the
        // bodies come first.
        let depth = |normal: DVec3| {
            let (first, second) = (reach(forms.0, -normal).0, reach(forms.1, normal).0);
            first + second - normal.dot(offset)
        };
        let surfaces = parting_normals(forms.0, forms.1, offset).into_iter();
        let mut surfaces: Vec<_> = surfaces.map(|normal| (depth(normal), normal)).collect();
        surfaces.sort_by(|a, b| a.0.total_cmp(&b.0));
        let surfaces = surfaces
            .into_iter()
            .map(|(_, normal)| normal)
            .take(MAX_DIRECTIONS);
        for normal in surfaces.chain([self.apart_along(i, j)]) {
            // Each direction counts once in the sums below.
            if !directions.contains(&normal) {
                directions.push(normal);
            }
        }
        let found = |by: DVec3| {
            is_apart(by).then_some(Meeting {
                bodies,
                apart: offset + by,
                reach: 2.0 * by.length(),
            })
        };
        let singles = || directions.iter().copied();
        let pairs = || {
            singles()
                .enumerate()
                .flat_map(|(k, a)| singles().skip(k + 1).map(move |b| a + b))
        };
        let triples = || {
            let pairs = singles().enumerate().flat_map(|(k, a)| {
                singles()
                    .enumerate()
                    .skip(k + 1)
                    .map(move |(l, b)| (l, a + b))
            });
            pairs.flat_map(|(l, ab)| singles().skip(l + 1).map(move |c| ab + c))
        };
        let shortest = || {
            let out = self.penetration(i, j, offset);
            (out.depth <= farthest).then_some((out.depth + self.hover_gap(i, j)) * out.normal)
        };
        let all = singles().chain(pairs()).chain(triples());
        let all = all.map(|direction| farthest * direction);
        all.chain(core::iter::once_with(shortest).flatten())
            .find_map(found)
    }

    /// Positions at which the pairs that meet are apart, and the pairs that they would come to meet, with the planes
    /// that keep them apart; `None` if there are none nearby.
    pub(in crate::world) fn parted(
        &self,
        meeting: &mut Vec<Meeting>,
        at: &[DVec3],
    ) -> Option<(Vec<DVec3>, Vec<Plane>)> {
        let mut place = at.to_vec();
        let mut planes: Vec<Plane> = Vec::new();
        for round in 0..MAX_ROUNDS {
            // No body is moved before the first round. After it, bodies may have come near others.
            let near = match round {
                0 => Vec::new(),
                _ => self.bodies.near_pairs(&place, |body| {
                    16.0 * self.hover_gap(body, body) + 1e-6 * self.bodies.extent(body).farthest
                }),
            };
            for &(i, j) in &near {
                let is_known = meeting.iter().any(|known| known.bodies == (i, j));
                let (before, now) = (at[j] - at[i], place[j] - place[i]);
                if !is_known
                    && before != now
                    && self.bodies.meet_built(i, j, now)
                    && !self.bodies.meet_built(i, j, before)
                {
                    let reach = f64::from(f32::EPSILON)
                        * 64.0
                        * (self.bodies.extent(i).farthest + self.bodies.extent(j).farthest)
                        * near.len() as f64;
                    meeting.push(Meeting {
                        bodies: (i, j),
                        apart: before,
                        reach,
                    });
                }
            }
            let mut is_new = false;
            for pair in meeting.iter() {
                let (i, j) = pair.bodies;
                let offset = place[j] - place[i];
                if round > 0 && !self.bodies.meet_built(i, j, offset) {
                    continue;
                }
                is_new = true;
                let forms = self.bodies.forms(i, j)?;
                // The motion goes on beyond the present position, because times are rounded for shapes with closed
                // forms.
                let motion = 2.0 * (offset - pair.apart);
                let contact = first_contact(forms.0, forms.1, snap(pair.apart), snap(motion))?;
                let touching = pair.apart + contact.time * motion;
                let level = contact.normal.dot(touching) + self.hover_gap(i, j);
                planes.push(Plane {
                    bodies: pair.bodies,
                    normal: contact.normal,
                    level,
                    point: contact.point,
                });
            }
            if !is_new {
                return Some((place, planes));
            }
            let contacts = planes.iter().map(|plane| (plane.bodies, plane.normal));
            let places = Places::between(self.bodies, self.before, contacts);
            let mut displaced = alloc::vec![DVec3::ZERO; places.bodies.len()];
            let missing: Vec<f64> = planes
                .iter()
                .map(|plane| {
                    let (i, j) = plane.bodies;
                    plane.level - plane.normal.dot(at[j] - at[i])
                })
                .collect();
            project(
                &places.joined,
                &places.inverse_mass,
                &mut displaced,
                &missing,
            );
            for (&body, &by) in places.bodies.iter().zip(&displaced) {
                place[body] = at[body] + by;
            }
            for pair in meeting.iter() {
                let (i, j) = pair.bodies;
                let by = (place[j] - place[i]) - (at[j] - at[i]);
                if by.length() > pair.reach || by.is_nan() {
                    return None;
                }
            }
        }
        None
    }
}

impl ContactSolver<'_> {
    /// Finds the contacts of bodies that were placed touching, without overlap.
    pub(super) fn find_initial_contacts(&mut self) {
        let at = self.paths.start.position.clone();
        let pairs = self
            .scene
            .bodies
            .near_pairs(&at, |body| 8.0 * self.view().layout().hover_gap(body, body));
        for (i, j) in pairs {
            if !self.scene.may_collide(i, j) {
                continue;
            }
            self.scene.bodies.need_bvh(i);
            self.scene.bodies.need_bvh(j);
            let hover = self.view().layout().hover_gap(i, j);
            let Some((first, second)) = self.scene.bodies.forms(i, j) else {
                continue;
            };
            // If rounding is larger than a body, its contacts are unknown.
            let size = self
                .scene
                .bodies
                .extent(i)
                .half
                .min(self.scene.bodies.extent(j).half);
            if size > 0.0 && hover > size {
                continue;
            }
            let offset = at[j] - at[i];
            let mut found = Vec::new();
            for direction in directions_between(first, second, offset) {
                let motion = -8.0 * hover * direction;
                let Some(contact) = first_contact(first, second, snap(offset), snap(motion)) else {
                    continue;
                };
                let gap = -contact.time * contact.normal.dot(motion);
                if gap <= 4.0 * hover {
                    found.push(contact);
                }
            }
            for contact in found {
                let gap = self.view().layout().hover_gap(i, j);
                self.add_contact(ContactConstraint::new(
                    (i, j),
                    contact.normal,
                    gap,
                    contact.point,
                ));
            }
        }
    }
}

/// Directions from the first of two shapes along which contacts are searched. Any normal has an angle of less than 55
/// degrees to one of them.
fn directions_between(first: Form<'_>, second: Form<'_>, offset: DVec3) -> Vec<DVec3> {
    match (first, second) {
        (Form::HalfSpace(normal), _) => alloc::vec![normal],
        (_, Form::HalfSpace(normal)) => alloc::vec![-normal],
        (Form::Sphere(_), Form::Sphere(_)) => offset.try_normalize().into_iter().collect(),
        _ => DVec3::AXES.iter().flat_map(|&axis| [axis, -axis]).collect(),
    }
}
