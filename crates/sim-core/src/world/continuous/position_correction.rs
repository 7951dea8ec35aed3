//! Bodies that touch by rounding are moved apart by as little.
//!
//! Between steps no two bodies meet. The last bit of a position may still bring two together that
//! slide along each other, or that have been placed exactly face to face; they are moved apart
//! along a normal of where they touch, by units in the last place; those that have just been placed, by
//! as much as the f32 of their vertices is rounded. An overlap is deeper than that and stays one.
//!
//! A point that has come to the other side of a closed mesh counts as one that meets it.

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

use super::super::{layout::Layout, record::Record, scene::Scene, state::State, stepping::Cause};
use super::{contact_set::ContactSet, solver::ContactSolver};
use crate::{
    Shape,
    collide::{first_contact, locate, parting_normals, segment_meets, snap},
    rotation::spin,
};

/// Units in the last place, a few parts in 10^12, before it is an overlap.
const MAX_CORRECTION: f64 = 1024.0;

/// Normals of which the lines are looked at in which their faces cross, at most. It bounds cost only.
const MOST_CROSSED: usize = 8;
/// Rounds in which a body that is moved out of one may get into another.
const ROUNDS: usize = 8;

/// Beside what a body has been put back to its place at the start of the step.
#[derive(Clone, Copy)]
enum Frame {
    Still,
    /// An immovable body that may have moved.
    Of(usize),
}

/// Who has been put back, and how.
#[derive(Default)]
struct Back {
    with: Vec<Option<Frame>>,
}

impl Frame {
    fn wall(self) -> Option<usize> {
        match self {
            Frame::Still => None,
            Frame::Of(wall) => Some(wall),
        }
    }
}

impl Back {
    fn of(&self, body: usize) -> Option<Frame> {
        self.with.get(body).copied().flatten()
    }
}

/// Bodies at the end of a step, of which no two may meet.
pub(super) struct Correction<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) end: &'a mut State,
    pub(super) contacts: &'a ContactSet,
    pub(super) record: &'a mut Record,
}

/// Directions along the lines in which faces cross, by some of their normals: so sheets part whose borders touch.
fn along_crossings(normals: &[DVec3]) -> Vec<DVec3> {
    let mut along: Vec<DVec3> = Vec::new();
    let some = &normals[..normals.len().min(MOST_CROSSED)];
    for (k, first) in some.iter().enumerate() {
        for second in &some[..k] {
            if let Some(way) = first.cross(*second).try_normalize()
                && !along.contains(&way)
            {
                along.extend([way, -way]);
            }
        }
    }
    along
}

impl Correction<'_> {
    /// Makes sure that no two bodies meet that came near in the step.
    pub(super) fn separate_meeting(
        &mut self,
        near: &mut Vec<(usize, usize)>,
    ) -> Result<(), (usize, Cause)> {
        near.sort_unstable();
        near.dedup();
        if near.iter().any(|&(i, j)| self.meet_now(i, j)) {
            let order = self.scene.in_order(near.iter().flat_map(|&(i, j)| [i, j]));
            near.sort_by_cached_key(|&pair| order.between(pair, DVec3::ZERO));
            if !self.part_all(near) && !self.part_together(near) {
                return self.roll_back_meeting(near);
            }
        }
        Ok(())
    }

    fn layout(&self) -> Layout<'_> {
        Layout {
            bodies: self.scene.bodies,
            at: &self.end.position,
            turned: &self.end.turned,
            before: self.scene.before,
            contacts: self.contacts,
            overlaps: self.scene.overlaps,
        }
    }

    /// Moves pairs apart that meet by rounding, one after the other, and tells whether none meets then.
    fn part_all(&mut self, near: &[(usize, usize)]) -> bool {
        for _ in 0..ROUNDS {
            let mut met = false;
            for &(i, j) in near {
                if self.meet_now(i, j) {
                    let most = self.layout().position_resolution(i, j) * MAX_CORRECTION;
                    if !self.part(i, j, most) {
                        return false;
                    }
                    met = true;
                }
            }
            if !met {
                return true;
            }
        }
        false
    }

    /// The same all at once, for bodies among others that leave each other no room.
    fn part_together(&mut self, near: &[(usize, usize)]) -> bool {
        let at = self.end.position.clone();
        let mut meeting = Vec::new();
        for &(i, j) in near {
            if self.meet_now(i, j) {
                match self.layout().place_apart((i, j), at[j] - at[i]) {
                    Some(pair) => meeting.push(pair),
                    None => return false,
                }
            }
        }
        let Some((moved, _)) = self.layout().parted(&mut meeting, &at) else {
            return false;
        };
        self.end.position = moved;
        if near.iter().any(|&(i, j)| self.meet_now(i, j)) {
            self.end.position = at;
            return false;
        }
        true
    }

    /// Rolls back what meets by more than rounding.
    fn roll_back_meeting(&mut self, near: &[(usize, usize)]) -> Result<(), (usize, Cause)> {
        let mut back = Back::default();
        for round in 0..=ROUNDS {
            let mut met = false;
            for &(i, j) in near {
                if self.meet_now(i, j) {
                    let most = self.layout().position_resolution(i, j) * MAX_CORRECTION;
                    let is_back = back.of(i).or(back.of(j)).is_some();
                    if is_back || round == ROUNDS || !self.part(i, j, most) {
                        self.roll_back((i, j), &mut back)?;
                    }
                    met = true;
                }
            }
            if !met {
                break;
            }
        }
        Ok(())
    }

    fn meet_now(&mut self, i: usize, j: usize) -> bool {
        self.scene.may_collide(i, j)
            && (self.scene.bodies.meet_in(self.end, i, j) || self.has_changed_sides(i, j))
    }

    /// Whether a sphere that is no larger than what rounding hides has gone through the surface of a closed mesh.
    /// Larger ones would have to meet it on the way.
    fn has_changed_sides(&self, i: usize, j: usize) -> bool {
        let bodies = self.scene.bodies;
        let (mesh, sphere, radius) = match (bodies.shape(i), bodies.shape(j)) {
            (Some(Shape::Mesh(_)), Some(&Shape::Sphere { radius })) => (i, j, radius),
            (Some(&Shape::Sphere { radius }), Some(Shape::Mesh(_))) => (j, i, radius),
            _ => return false,
        };
        if radius > self.layout().flush(i, j) || bodies.pair_tumbles(i, j) {
            return false;
        }
        let Some(tree) = bodies.bvh(mesh) else {
            return false;
        };
        let seen = |state: &State| state.position[sphere] - state.position[mesh];
        let (before, after) = (seen(self.scene.before), seen(self.end));
        segment_meets(tree, before, after) == Some(true)
            && locate(tree, before) != locate(tree, after)
    }

    /// Moves two bodies apart by the least that does it, but for a factor of two, if that is no more
    /// than a length.
    fn part(&mut self, i: usize, j: usize, most: f64) -> bool {
        let before = (self.end.position[i], self.end.position[j]);
        let forms = self.scene.bodies.forms(i, j);
        let offset = before.1 - before.0;
        let mut normals = forms.map_or_else(Vec::new, |(a, b)| parting_normals(a, b, offset));
        let borders = along_crossings(&normals);
        normals.extend(borders);
        normals.push(self.layout().apart_along(i, j));
        let resolution = self
            .layout()
            .position_resolution(i, j)
            .max(f64::MIN_POSITIVE);
        // Back to where they came from: a sheet has two sides.
        let came = (self.scene.before.position[j] - self.scene.before.position[i]) - offset;
        normals.retain(|normal| normal.dot(came) >= -8.0 * resolution);
        let mut by = 0.5 * resolution;
        while by <= most.max(resolution) {
            for &normal in &normals {
                self.move_current_apart((i, j), by * normal);
                if !self.meet_now(i, j) {
                    return true;
                }
                (self.end.position[i], self.end.position[j]) = before;
            }
            by *= 2.0;
        }
        false
    }

    /// What rounding does not explain is answered as in the discrete mode: an impulse is exchanged,
    /// and bodies go back to where the step began, where nothing met, no faster than they were there; so
    /// does all that they meet there. Immovable ones go on, and take what they meet along.
    fn roll_back(&mut self, pair: (usize, usize), back: &mut Back) -> Result<(), (usize, Cause)> {
        back.with.resize(self.scene.bodies.len(), None);
        let solid = self.scene.in_order(self.scene.bodies.solid.iter().copied());
        let mut pairs = alloc::vec![pair];
        while let Some((i, j)) = pairs.pop() {
            if !self.meet_now(i, j) {
                continue;
            }
            if let Some(contact) = self.scene.contact_on_way(self.end, i, j) {
                let impact = self.scene.exchange_on_way((i, j), &contact, self.end);
                impact
                    .into_iter()
                    .for_each(|impact| self.record.note(impact));
            }
            let frame = |body: usize| match self.scene.bodies.is_movable(body) {
                true => back.of(body),
                false => Some(Frame::Of(body)),
            };
            let frame = match (frame(i), frame(j)) {
                (Some(one), Some(other)) if self.moves_of(one) != self.moves_of(other) => {
                    let body = if self.scene.bodies.is_movable(i) {
                        i
                    } else {
                        j
                    };
                    let (one, other) = (one.wall().unwrap_or(i), other.wall().unwrap_or(j));
                    let between = (one.min(other), one.max(other));
                    return Err((body, Cause::Squeezed(between)));
                }
                (Some(frame), _) | (None, Some(frame)) => frame,
                (None, None) => Frame::Still,
            };
            for body in [i, j] {
                if self.scene.bodies.is_movable(body) && back.of(body).is_none() {
                    back.with[body] = Some(frame);
                    let start = self.scene.before.position[body];
                    self.end.position[body] = start + self.moves_of(frame);
                    self.turn_back(body);
                    // What forces have given it on the way that it has not gone.
                    let before = self.scene.before.velocity[body];
                    if before.length() < self.end.velocity[body].length() {
                        self.end.velocity[body] = before;
                    }
                    let others = solid.bodies.iter().filter(|&&other| other != body);
                    pairs.extend(others.map(|&other| (body.min(other), body.max(other))));
                }
            }
        }
        Ok(())
    }

    /// Turns a body as it was where the step began, with no more energy of turning than it had there.
    fn turn_back(&mut self, body: usize) {
        let bodies = self.scene.bodies;
        if let Some(slot) = bodies.turners.slot(body) {
            let before = self.scene.before.turned[slot];
            let now = &mut self.end.turned[slot];
            let moments = bodies.turners.inertia[slot].moments();
            let energy = |momentum| spin(moments, before.rotation, momentum).dot(momentum);
            if energy(before.momentum) < energy(now.momentum) {
                now.momentum = before.momentum;
            }
            now.rotation = before.rotation;
        }
    }

    /// How far what bodies have been put back beside has moved in the step.
    fn moves_of(&self, frame: Frame) -> DVec3 {
        frame.wall().map_or(DVec3::ZERO, |wall| {
            self.end.position[wall] - self.scene.before.position[wall]
        })
    }

    fn move_current_apart(&mut self, (i, j): (usize, usize), by: DVec3) {
        let (first, second) = shares(
            self.scene.bodies.is_movable(i),
            self.scene.bodies.is_movable(j),
        );
        self.end.position[i] -= first * by;
        self.end.position[j] += second * by;
    }
}

impl ContactSolver<'_> {
    /// Moves the starts of two trajectories apart.
    pub(super) fn move_apart(&mut self, (i, j): (usize, usize), by: DVec3) {
        let (first, second) = shares(
            self.scene.bodies.is_movable(i),
            self.scene.bodies.is_movable(j),
        );
        let position = &mut self.paths.start.position;
        position[i] -= first * by;
        position[j] += second * by;
    }

    /// The same at a time, where others leave room: half of it is left to them. What the one has no room for
    /// the other one moves. Tells how far apart they have been moved, m.
    pub(super) fn move_apart_in_room(
        &mut self,
        (i, j): (usize, usize),
        by: DVec3,
        time: f64,
    ) -> Result<f64, (usize, Cause)> {
        let mut room = [0.0; 2];
        for (room, (body, other, way)) in room.iter_mut().zip([(i, j, -by), (j, i, by)]) {
            if self.scene.bodies.is_movable(body) {
                let free = self.free_part(body, other, way, time)?;
                *room = if free < 1.0 { 0.5 * free } else { 1.0 };
            }
        }
        let share = shares(
            self.scene.bodies.is_movable(i),
            self.scene.bodies.is_movable(j),
        );
        let lacking = ((share.0 - room[0]).max(0.0), (share.1 - room[1]).max(0.0));
        let first = (share.0 + lacking.1).min(room[0]);
        let second = (share.1 + lacking.0).min(room[1]);
        let position = &mut self.paths.start.position;
        position[i] -= first * by;
        position[j] += second * by;
        Ok((first + second) * by.length())
    }

    /// The part of a way that a body goes from where its trajectory starts before it meets another body than
    /// one, at a time.
    fn free_part(
        &mut self,
        body: usize,
        except: usize,
        way: DVec3,
        time: f64,
    ) -> Result<f64, (usize, Cause)> {
        let knows_near = self.knows_near();
        let mut partners = mem::take(&mut self.near.partners);
        let mut probe = mem::take(&mut self.paths.probe);
        partners.clear();
        match knows_near {
            true => self
                .near
                .broad
                .each_partner(body, |other| partners.push(other)),
            // Where bodies have just been placed, those that it touches.
            false => partners.extend(self.contacts.of_body(body).iter().map(|&index| {
                let (i, j) = self.contacts.all()[index as usize].bodies;
                i + j - body
            })),
        }
        let mut free = Ok(1.0_f64);
        for &other in &partners {
            if other == except || !self.scene.may_collide(body.min(other), body.max(other)) {
                continue;
            }
            self.scene.bodies.need_bvh(body);
            self.scene.bodies.need_bvh(other);
            let found = self
                .view()
                .motion()
                .motion_at(other, time, &mut probe)
                .map(|(at, _)| {
                    let offset = self.paths.start.position[body] - at;
                    let forms = self.scene.bodies.forms(other, body)?;
                    first_contact(forms.0, forms.1, snap(offset), snap(way))
                });
            free = match found {
                Ok(contact) => free.map(|free| contact.map_or(free, |found| free.min(found.time))),
                Err(cause) => Err(cause),
            };
            if free.is_err() {
                break;
            }
        }
        (self.near.partners, self.paths.probe) = (partners, probe);
        free
    }
}

/// Parts of a displacement that two bodies take, of which one may stay where it is.
pub(super) fn shares(first_moves: bool, second_moves: bool) -> (f64, f64) {
    match (first_moves, second_moves) {
        (true, true) => (0.5, 0.5),
        (true, false) => (1.0, 0.0),
        (false, true) => (0.0, 1.0),
        (false, false) => (0.0, 0.0),
    }
}
