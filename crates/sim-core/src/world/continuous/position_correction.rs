//! Bodies that overlap by rounding are moved apart by as little.
//!
//! Between steps no two bodies meet. The last bit of a position may still bring two bodies into overlap that slide
//! along each other, or that were placed exactly face to face. They are moved apart along a normal of the touching
//! surfaces, by units in the last place; bodies that were just placed, by the f32 rounding of their vertices. A
//! deeper overlap stays an overlap.
//!
//! A point that has come to the other side of a closed mesh counts as overlapping with it.

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

/// The greatest correction, in units in the last place: a few parts in 10^12. A deeper overlap is not rounding.
const MAX_CORRECTION: f64 = 1024.0;

/// The greatest number of normals whose faces are crossed with each other. It limits only the cost.
const MOST_CROSSED: usize = 8;
/// The number of rounds, because a body that is moved out of one body may get into another.
const ROUNDS: usize = 8;

/// The reference relative to which a body was put back to its place at the start of the step.
#[derive(Clone, Copy)]
enum Frame {
    Still,
    /// An immovable body that may have moved.
    Of(usize),
}

/// The bodies that were rolled back, and their frames.
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

/// The position correction at the end of a step, after which no two bodies may meet.
pub(super) struct Correction<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) end: &'a mut State,
    pub(super) contacts: &'a ContactSet,
    pub(super) record: &'a mut Record,
}

/// Directions along the lines in which faces cross, from some of their normals. Along these, sheets separate whose
/// borders touch.
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
    /// Ensures that no two bodies meet that came near each other in the step.
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

    /// Moves pairs apart that meet by rounding, one after the other. Returns whether no pair meets afterwards.
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

    /// The same for all pairs at once, for bodies between others that leave each other no room.
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

    /// Rolls back the bodies that meet by more than rounding.
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

    /// Whether a sphere no larger than rounding has gone through the surface of a closed mesh. A larger sphere would
    /// have met it on the way.
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

    /// Moves two bodies apart by the least sufficient length, up to a factor of two, if this is no more than `most`.
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
        // Only directions back to where the bodies came from, because a sheet has two sides.
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

    /// Resolves an overlap that rounding does not explain as the discrete mode does. The bodies exchange an impulse
    /// and go back to the start of the step, where none met, and are no faster than they were there. All bodies that
    /// they meet there do the same. Immovable bodies keep their motion and take along the bodies that they meet.
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
                    // Removes the speed that forces gave the body on the way that it has not gone.
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

    /// Sets the rotation of a body back to that at the start of the step, with no more rotational energy than it had
    /// there.
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

    /// The displacement of a frame in the step.
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

    /// The same at a time, as far as other bodies leave room: half of the free distance is left to them. If one body
    /// lacks room, the other one moves farther. Returns the distance by which the bodies were moved apart, m.
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

    /// The fraction of a displacement that a body can move from the start of its trajectory before it meets a body
    /// other than `except`, at a time.
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
            // If bodies were just placed, the bodies that it touches.
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

/// The shares of a displacement that two bodies take, of which one may be immovable.
pub(super) fn shares(first_moves: bool, second_moves: bool) -> (f64, f64) {
    match (first_moves, second_moves) {
        (true, true) => (0.5, 0.5),
        (true, false) => (1.0, 0.0),
        (false, true) => (0.0, 1.0),
        (false, false) => (0.0, 0.0),
    }
}
