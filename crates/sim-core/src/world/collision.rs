//! Which bodies meet at the end of a step, and what becomes of them.
//!
//! As in the course: bodies that meet exchange an impulse along the contact normal and go back
//! to where the step began. Putting one back may make it meet a third, so pairs are looked at
//! until none meets. That ends, because each round puts back at least one body more, and at the
//! beginning of the step nothing met. It leaves the invariant that the next step relies on: no
//! two bodies meet, but for pairs that were put into the world in overlap.

use alloc::{vec, vec::Vec};
use glam::DVec3;

use super::{Collision, World};
use crate::{
    Aabb, Feature, Shape,
    collide::{self, Contact, naive, snap},
    impulse,
};

/// An exchange of an impulse between two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// The step in which it happened, from 1.
    pub step: u64,
    /// When it happened, s; in the discrete modes, that of the first contact on the straight way from
    /// the start of the step to its end.
    pub time: f64,
    /// The bodies.
    pub bodies: (usize, usize),
    /// Point of contact in the world, m.
    pub point: DVec3,
    /// Unit normal, from the first body to the second.
    pub normal: DVec3,
    /// Impulse on the second body along the normal, and on the first against it, N s.
    pub impulse: f64,
    /// Speeds along the normal at which they approached and at which they part, m/s.
    pub speeds: (f64, f64),
    /// What touched, where both are meshes and it is known.
    pub feature: Option<Feature>,
}

impl World {
    /// Lets bodies that meet bounce, and puts them back to where the step began.
    pub(super) fn collide(&mut self) {
        // What this mode does to bodies in contact it does where a step ends.
        self.contacts.clear();
        self.continuous.placed = true;
        if self.any_pair(World::collides) {
            self.bounce_all();
        }
        self.part_overlapping();
    }

    /// Bounces and puts back until no pair collides.
    fn bounce_all(&mut self) {
        let mut put_back = vec![false; self.len()];
        // A pair is news while one of its bodies has been put back since it was looked at.
        let mut news = vec![true; self.len()];
        while news.contains(&true) {
            let mut moved = vec![false; self.len()];
            self.any_pair(|world, i, j| {
                let is_news = news[i] || news[j] || moved[i] || moved[j];
                let at_start = put_back[i] && put_back[j];
                if is_news && !at_start && world.collides(i, j) {
                    world.bounce(i, j);
                    for body in [i, j] {
                        moved[body] |= !put_back[body];
                        put_back[body] = true;
                        world.current.position[body] = world.previous.position[body];
                    }
                }
                false
            });
            news = moved;
        }
    }

    /// Whether `holds` for some pair of bodies with meshes; later pairs are not looked at.
    fn any_pair(&mut self, mut holds: impl FnMut(&mut World, usize, usize) -> bool) -> bool {
        for second in 1..self.solid.len() {
            for first in 0..second {
                let (i, j) = (self.solid[first], self.solid[second]);
                if holds(self, i, j) {
                    return true;
                }
            }
        }
        false
    }

    /// Whether two bodies meet that were apart.
    fn collides(&mut self, i: usize, j: usize) -> bool {
        self.may_collide(i, j) && self.meet(i, j)
    }

    /// Whether two bodies with shapes can have an impact: not if nothing moves either, nor if they
    /// began in overlap and have not parted since.
    pub(super) fn may_collide(&self, i: usize, j: usize) -> bool {
        let is_movable = self.mass[i].is_finite() || self.mass[j].is_finite();
        is_movable && !self.overlapping.contains(&(i, j))
    }

    /// Whether two bodies meet where they are now.
    pub(super) fn meet(&mut self, i: usize, j: usize) -> bool {
        let meshes = match self.settings.collision {
            Collision::Naive => self.mesh(i).zip(self.mesh(j)),
            Collision::Bvh | Collision::Continuous => None,
        };
        let offset = self.current.position[j] - self.current.position[i];
        match meshes {
            Some((first, second)) => naive::intersect(first, second, offset),
            None => self.meet_at(i, j, offset),
        }
    }

    /// Whether two bodies meet, through trees, with the second one at `offset` from the first.
    pub(super) fn meet_at(&mut self, i: usize, j: usize, offset: DVec3) -> bool {
        if let Some((first, second)) = self.mesh(i).zip(self.mesh(j))
            && !first.bounds().meets(&second.bounds(), snap(offset))
        {
            return false;
        }
        self.need_bvh(i);
        self.need_bvh(j);
        self.meet_built(i, j, offset)
    }

    /// The same with the trees there.
    pub(super) fn meet_built(&self, i: usize, j: usize, offset: DVec3) -> bool {
        let offset = snap(offset);
        let forms = self.form(i).zip(self.form(j));
        forms.is_some_and(|(first, second)| collide::meet(first, second, offset))
    }

    /// Exchanges an impulse along the normal of the feature that touched first.
    pub(super) fn bounce(&mut self, i: usize, j: usize) {
        self.need_bvh(i);
        self.need_bvh(j);
        let (start, end) = (&self.previous.position, &self.current.position);
        let offset = start[j] - start[i];
        let motion = (end[j] - end[i]) - offset;
        let contact = self
            .form(i)
            .zip(self.form(j))
            .and_then(|(first, second)| collide::first_contact(first, second, offset, motion));
        // Bodies that meet after a motion have touched on the way. Should rounding hide where,
        // the motion itself is turned back.
        let turned_back = || {
            Some(Contact {
                time: 1.0,
                point: offset + motion,
                normal: -motion.try_normalize()?,
                feature: None,
                face: None,
            })
        };
        if let Some(contact) = contact.or_else(turned_back) {
            let point = start[i].lerp(end[i], contact.time) + contact.point;
            let time = self.time() + contact.time * self.settings.dt;
            self.exchange_now((i, j), &Contact { point, ..contact }, time);
        }
    }

    /// Lets two bodies that approach part by their restitution, now.
    fn exchange_now(&mut self, (i, j): (usize, usize), contact: &Contact, time: f64) {
        let before = (self.current.velocity[i], self.current.velocity[j]);
        let restitution = self.pair_restitution(i, j);
        let masses = (self.mass[i], self.mass[j]);
        let after = self.exchange((i, j), contact, (masses, before), restitution, time);
        (self.current.velocity[i], self.current.velocity[j]) = after;
    }

    /// The velocities of two bodies after they have parted by a restitution, if they approach, from
    /// their masses and velocities before. The contact's point is in the world.
    pub(super) fn exchange(
        &mut self,
        bodies: (usize, usize),
        contact: &Contact,
        ((m1, m2), (v1, v2)): ((f64, f64), (DVec3, DVec3)),
        restitution: f64,
        time: f64,
    ) -> (DVec3, DVec3) {
        let normal = contact.normal;
        let Some(given) = impulse::between((m1, v1), (m2, v2), normal, restitution) else {
            return (v1, v2);
        };
        let mut after = given.after;
        let speeds = ((v1 - v2).dot(normal), (after.1 - after.0).dot(normal));
        if !self.friction.is_empty() {
            let friction = self.pair_friction(bodies.0, bodies.1);
            after = impulse::rub((m1, m2), after, normal, friction, given.impulse);
        }
        self.note_impact(bodies, contact, given.impulse, speeds, time);
        after
    }

    pub(super) fn note_impact(
        &mut self,
        bodies: (usize, usize),
        contact: &Contact,
        impulse: f64,
        speeds: (f64, f64),
        time: f64,
    ) {
        self.impacts += 1;
        let masses = (self.mass[bodies.0], self.mass[bodies.1]);
        self.continuous
            .progress
            .note_impulse(impulse, speeds.0, masses);
        let impact = Impact {
            step: self.steps + 1,
            time,
            bodies,
            point: contact.point,
            normal: contact.normal,
            impulse,
            speeds,
            feature: contact.feature,
        };
        if let Some(report) = &mut self.report {
            report.push(impact.clone());
        }
        self.last_impact = Some(impact);
    }

    pub(super) fn pair_restitution(&self, i: usize, j: usize) -> f64 {
        self.restitution(i).min(self.restitution(j))
    }

    /// The coefficient of friction between two bodies: the geometric mean of theirs, and 0 where one
    /// is smooth, whatever the other is.
    pub(super) fn pair_friction(&self, i: usize, j: usize) -> f64 {
        let (first, second) = (self.friction(i), self.friction(j));
        if first == 0.0 || second == 0.0 {
            return 0.0;
        }
        // Of the product, so that two equal coefficients give themselves to the bit.
        libm::sqrt(first * second)
    }

    /// Forgets pairs that have parted since they began in overlap.
    pub(super) fn forget_parted_overlaps(&mut self) {
        if self.overlapping.is_empty() {
            return;
        }
        let mut pairs = core::mem::take(&mut self.overlapping);
        pairs.retain(|&(i, j)| {
            let offset = self.current.position[j] - self.current.position[i];
            self.meet_at(i, j, offset)
        });
        self.contacts
            .retain(|constraint| !constraint.is_overlap || pairs.contains(&constraint.bodies));
        self.overlapping = pairs;
    }

    /// Forgets pairs that have parted since they began in overlap, and keeps the others from
    /// moving closer: an elastic impulse along the line of their centres, nothing put back.
    pub(super) fn part_overlapping(&mut self) {
        let pairs = core::mem::take(&mut self.overlapping);
        let still: Vec<_> = pairs
            .into_iter()
            .filter(|&(i, j)| self.meet(i, j))
            .collect();
        for &(i, j) in &still {
            let (from, to) = (self.centre(i), self.centre(j));
            let contact = Contact {
                time: 1.0,
                point: 0.5 * (from + to),
                normal: self.apart_along(i, j),
                feature: None,
                face: None,
            };
            self.exchange_now((i, j), &contact, self.time() + self.settings.dt);
        }
        self.overlapping = still;
    }

    /// Where two bodies in overlap should part to: out of a half-space, or along the line of their
    /// centres.
    pub(super) fn apart_along(&self, i: usize, j: usize) -> DVec3 {
        match (self.shape(i), self.shape(j)) {
            (Some(&Shape::HalfSpace { normal }), _) => normal,
            (_, Some(&Shape::HalfSpace { normal })) => -normal,
            _ => {
                let between = self.centre(j) - self.centre(i);
                between.try_normalize().unwrap_or(DVec3::X)
            }
        }
    }

    /// Middle of a body's box, m.
    fn centre(&self, body: usize) -> DVec3 {
        let middle = self
            .mesh(body)
            .map_or(DVec3::ZERO, |mesh| Aabb::centre(&mesh.bounds()));
        self.current.position[body] + middle
    }

    /// Notes the pairs that a newly placed body is in overlap with. Always through the trees:
    /// placing bodies is not what naive steps are measured for.
    pub(super) fn note_overlaps_of(&mut self, body: usize) {
        self.continuous.placed = true;
        for place in 0..self.solid.len() {
            let other = self.solid[place];
            let pair = (body.min(other), body.max(other));
            let offset = self.current.position[pair.1] - self.current.position[pair.0];
            if other != body
                && self.may_collide(pair.0, pair.1)
                && self.meet_at(pair.0, pair.1, offset)
            {
                self.overlapping.push(pair);
            }
        }
        self.overlapping.sort_unstable();
    }
}
