//! The contact constraints, which are kept from step to step.

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

use super::super::bodies::Bodies;

/// A plane that keeps two bodies apart. The second body may not move against the normal faster than the target
/// allows, nor be accelerated against it by more than the surface recedes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::world) struct ContactConstraint {
    /// The lower body first.
    pub(in crate::world) bodies: (usize, usize),
    /// Unit normal, from the first body to the second.
    pub(in crate::world) normal: DVec3,
    /// The distance of the bodies at the last measurement, m.
    pub(in crate::world) gap: f64,
    /// The least speed along the normal for the rest of the step, m/s; negative if the gap may close.
    pub(super) target: f64,
    /// Whether the normal turns below a sliding body.
    pub(super) is_turning: bool,
    /// The speed with which forces would close the contact in a step, m/s.
    pub(in crate::world) load_speed: f64,
    /// The time at which the surface ends or begins to turn, s from the step's start; infinite if it does neither.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_number"))]
    pub(super) ends_at: f64,
    /// The contact point, relative to the first body, m.
    pub(in crate::world) point: DVec3,
    /// The impulse on the second body along the normal in the last solution, N s.
    pub(in crate::world) impulse: f64,
    /// The friction force on the second body in the last solution, N.
    pub(in crate::world) friction: DVec3,
    /// Whether friction held the contact in the last solution, or sliding has just ended. True for a new contact.
    pub(super) sticks: bool,
    /// Whether the bodies overlap. Then the constraint keeps them from moving farther into each other, and nothing
    /// else is known of their surfaces.
    pub(in crate::world) is_overlap: bool,
    /// Whether the constraint is one of those with which overlapping bodies move as one in this step.
    pub(super) is_hold: bool,
    /// The contact at the end of the step, if the surface keeps its normal until then.
    pub(super) ahead: Option<Measure>,
}

/// A contact as it is measured at an offset of the second body from the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::world) struct Measure {
    /// The offset, m.
    pub(super) offset: DVec3,
    /// The distance along the normal of the constraint, m.
    pub(super) gap: f64,
    /// Unit normal of the surface.
    pub(super) normal: DVec3,
    /// The contact point, relative to the first body, m.
    pub(super) point: DVec3,
}

impl ContactConstraint {
    /// A contact that has not been solved: its bodies, the lower one first; the unit normal from the first to the
    /// second; the gap, m; and the contact point, relative to the first body, m.
    pub(super) fn new(
        bodies: (usize, usize),
        normal: DVec3,
        gap: f64,
        point: DVec3,
    ) -> ContactConstraint {
        ContactConstraint {
            bodies,
            normal,
            gap,
            target: 0.0,
            is_turning: false,
            load_speed: 0.0,
            ends_at: f64::INFINITY,
            point,
            impulse: 0.0,
            friction: DVec3::ZERO,
            sticks: true,
            is_overlap: false,
            is_hold: false,
            ahead: None,
        }
    }
}

#[cfg(feature = "serde")]
impl ContactConstraint {
    /// Whether all of its numbers are finite and within the range of a world. `ends_at` may be infinite.
    pub(in crate::world) fn is_sound(&self) -> bool {
        let vectors = [self.normal, self.point, self.friction];
        let numbers = [self.gap, self.target, self.load_speed, self.impulse];
        let ahead = self.ahead.into_iter();
        let of_ahead = ahead
            .clone()
            .flat_map(|of| [of.offset, of.normal, of.point]);
        let vectors = vectors.into_iter().chain(of_ahead);
        let all = vectors.flat_map(|vector| vector.to_array());
        all.chain(numbers)
            .chain(ahead.map(|of| of.gap))
            .all(|number| number.abs() <= super::super::error::LARGEST)
            && self.ends_at >= 0.0
    }
}

/// Two contacts of the same bodies are the same one if the cosine of the angle between their normals is at least
/// this: 0.8 degrees.
const SAME_NORMAL: f64 = 0.9999;

/// The contact constraints, and the constraints of each movable body.
#[derive(Clone, Debug, Default)]
pub(in crate::world) struct ContactSet {
    all: Vec<ContactConstraint>,
    /// By body, indices of `all`; empty for immovable bodies.
    of_body: Vec<Vec<u32>>,
    /// By body, whether its contacts are solved once a step, with their gaps, in this step and in the next one. Both
    /// are empty if no body is bundled.
    bundled: Vec<bool>,
    bundled_next: Vec<bool>,
}

impl ContactSet {
    pub(in crate::world) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    pub(in crate::world) fn all(&self) -> &[ContactConstraint] {
        &self.all
    }

    pub(super) fn get_mut(&mut self, index: usize) -> &mut ContactConstraint {
        &mut self.all[index]
    }

    /// The indices of the constraints of a movable body.
    pub(super) fn of_body(&self, body: usize) -> &[u32] {
        self.of_body.get(body).map_or(&[], Vec::as_slice)
    }

    /// The constraints between two bodies, of which one is movable.
    pub(in crate::world) fn of_pair(
        &self,
        i: usize,
        j: usize,
    ) -> impl Iterator<Item = &ContactConstraint> {
        let few = if self.of_body(i).is_empty() { j } else { i };
        let pair = (i.min(j), i.max(j));
        let of_one = self.of_body(few).iter();
        let constraints = of_one.map(|&index| &self.all[index as usize]);
        constraints.filter(move |known| known.bodies == pair)
    }

    /// The constraints that keep the same bodies apart along the same normal as another one.
    fn like<'a>(&'a self, other: &'a ContactConstraint) -> impl Iterator<Item = usize> + 'a {
        let (i, j) = other.bodies;
        let few = if self.of_body(i).is_empty() { j } else { i };
        let indices = self.of_body(few).iter().map(|&index| index as usize);
        indices.filter(|&index| {
            let known = &self.all[index];
            known.bodies == other.bodies && known.normal.dot(other.normal) >= SAME_NORMAL
        })
    }

    /// Whether a constraint other than `index` and those in `gone` keeps the same bodies apart along the same normal.
    pub(super) fn is_known(
        &self,
        new: &ContactConstraint,
        (index, gone): (usize, &[usize]),
    ) -> bool {
        let is_other = |&other: &usize| other != index && !gone.contains(&other);
        self.like(new).any(|other| is_other(&other))
    }

    /// Adds a constraint. It replaces a constraint of the same bodies along the same normal.
    pub(in crate::world) fn insert(&mut self, new: ContactConstraint, bodies: &Bodies) {
        let (i, j) = new.bodies;
        let known = self.like(&new).next();
        if let Some(known) = known {
            self.all[known] = new;
            return;
        }
        let index = self.all.len() as u32;
        self.all.push(new);
        for body in [i, j] {
            if bodies.is_movable(body) {
                if self.of_body.len() <= body {
                    self.of_body.resize(body + 1, Vec::new());
                }
                self.of_body[body].push(index);
            }
        }
    }

    /// Keeps the constraints for which a condition holds.
    pub(in crate::world) fn retain(
        &mut self,
        mut holds: impl FnMut(&mut ContactConstraint) -> bool,
    ) {
        let mut index = 0;
        while index < self.all.len() {
            if holds(&mut self.all[index]) {
                index += 1;
            } else {
                self.remove(index);
            }
        }
    }

    /// Removes a body without constraints; the bodies after it move up.
    pub(in crate::world) fn remove_body(&mut self, body: usize) {
        for constraint in &mut self.all {
            let (i, j) = &mut constraint.bodies;
            *i -= usize::from(*i > body);
            *j -= usize::from(*j > body);
        }
        if body < self.of_body.len() {
            self.of_body.remove(body);
        }
        for flags in [&mut self.bundled, &mut self.bundled_next] {
            if body < flags.len() {
                flags.remove(body);
            }
        }
    }

    /// Removes a constraint; the last one takes its index.
    pub(super) fn remove(&mut self, index: usize) {
        let (gone, last) = (self.all.swap_remove(index), self.all.len());
        for body in [gone.bodies.0, gone.bodies.1] {
            if let Some(list) = self.of_body.get_mut(body) {
                list.retain(|&other| other as usize != index);
            }
        }
        if let Some(moved) = self.all.get(index) {
            for body in [moved.bodies.0, moved.bodies.1] {
                if let Some(list) = self.of_body.get_mut(body) {
                    for other in list.iter_mut().filter(|other| **other as usize == last) {
                        *other = index as u32;
                    }
                }
            }
        }
    }

    /// Removes constraints, given by their indices, and returns them in that order.
    pub(super) fn remove_all(&mut self, mut indices: Vec<usize>) -> Vec<ContactConstraint> {
        let removed = indices.iter().map(|&index| self.all[index]).collect();
        // From the highest index down, because `remove` moves the last constraint to the index of the removed one.
        indices.sort_unstable_by(|a, b| b.cmp(a));
        for index in indices {
            self.remove(index);
        }
        removed
    }

    pub(super) fn is_bundled(&self, body: usize) -> bool {
        self.bundled.get(body).is_some_and(|&bundled| bundled)
    }

    pub(super) fn bundled_bodies(&self) -> usize {
        self.bundled.iter().filter(|&&bundled| bundled).count()
    }

    /// Bundles the contacts of some bodies for the rest of the step.
    pub(super) fn bundle(&mut self, bodies: &[usize]) {
        set(&mut self.bundled, bodies);
    }

    /// Keeps bodies that are bundled in this step bundled in the next one.
    pub(super) fn keep_bundled(&mut self, bodies: &[usize]) {
        set(&mut self.bundled_next, bodies);
    }

    /// Prepares the set for the next step.
    pub(super) fn end_step(&mut self) {
        for (body, next) in self.bundled_next.iter_mut().enumerate() {
            // The list of this step is shorter if no later body was bundled.
            *next &= self.bundled.get(body).is_some_and(|&bundled| bundled);
        }
        mem::swap(&mut self.bundled, &mut self.bundled_next);
        self.bundled_next.clear();
    }

    /// The constraints by body, and the bodies whose constraints are bundled.
    #[cfg(feature = "serde")]
    pub(in crate::world) fn places(&self) -> (&[Vec<u32>], Vec<usize>) {
        let bundled = (0..self.bundled.len()).filter(|&body| self.bundled[body]);
        (&self.of_body, bundled.collect())
    }

    /// A set of constraints from snapshot data: `of_body` must list each constraint at its movable bodies. Returns
    /// `None` if it does not.
    #[cfg(feature = "serde")]
    pub(in crate::world) fn in_places(
        all: Vec<ContactConstraint>,
        of_body: Vec<Vec<u32>>,
        bundled: &[usize],
        bodies: &Bodies,
    ) -> Option<ContactSet> {
        let mut expected = alloc::vec![Vec::new(); of_body.len()];
        for (index, constraint) in (0..).zip(&all) {
            for body in [constraint.bodies.0, constraint.bodies.1] {
                if bodies.is_movable(body) {
                    expected.get_mut(body)?.push(index);
                }
            }
        }
        let mut sorted = of_body.clone();
        sorted.iter_mut().for_each(|list| list.sort_unstable());
        let mut set = ContactSet {
            all,
            of_body,
            ..ContactSet::default()
        };
        set.bundle(bundled);
        (sorted == expected && set.bundled.len() <= bodies.len()).then_some(set)
    }

    pub(in crate::world) fn clear(&mut self) {
        self.all.clear();
        self.bundled.clear();
        self.of_body.iter_mut().for_each(Vec::clear);
    }

    /// Copies the constraints of another set, but keeps its own memory.
    pub(super) fn copy_from(&mut self, other: &ContactSet) {
        self.all.clone_from(&other.all);
        self.of_body.clone_from(&other.of_body);
        self.bundled.clone_from(&other.bundled);
    }
}

fn set(flags: &mut Vec<bool>, bodies: &[usize]) {
    for &body in bodies {
        if flags.len() <= body {
            flags.resize(body + 1, false);
        }
        flags[body] = true;
    }
}
