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
    collide::{naive, snap, touch, tree},
    impulse,
};

/// An exchange of an impulse between two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// The step in which it happened, from 1.
    pub step: u64,
    /// Time of the first contact on the straight way from the start of the step to its end, s.
    pub time: f64,
    /// The bodies.
    pub bodies: (usize, usize),
    /// Point of first contact in the world, m.
    pub point: DVec3,
    /// Unit normal, from the first body to the second.
    pub normal: DVec3,
    /// Impulse on the second body along the normal, and on the first against it, N s.
    pub impulse: f64,
}

impl World {
    /// Lets bodies that meet bounce, and puts them back to where the step began.
    pub(super) fn collide(&mut self) {
        if self.solid.len() < 2 {
            return;
        }
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
        !self.overlapping.contains(&(i, j)) && self.meet(i, j)
    }

    /// Whether the surfaces of two bodies meet where they are now.
    pub(super) fn meet(&mut self, i: usize, j: usize) -> bool {
        match self.settings.collision {
            Collision::Naive => {
                let offset = self.current.position[j] - self.current.position[i];
                let meshes = self.mesh(i).zip(self.mesh(j));
                meshes.is_some_and(|(first, second)| naive::intersect(first, second, offset))
            }
            Collision::Bvh => self.meet_by_trees(i, j),
        }
    }

    /// The same through the trees.
    fn meet_by_trees(&mut self, i: usize, j: usize) -> bool {
        let offset = snap(self.current.position[j] - self.current.position[i]);
        let Some((first, second)) = self.mesh(i).zip(self.mesh(j)) else {
            return false;
        };
        if !first.bounds().meets(&second.bounds(), offset) {
            return false;
        }
        self.need_bvh(i);
        self.need_bvh(j);
        let trees = self.bvh(i).zip(self.bvh(j));
        trees.is_some_and(|(first, second)| tree::intersect(first, second, offset))
    }

    /// Exchanges an impulse along the normal of the feature that touched first.
    fn bounce(&mut self, i: usize, j: usize) {
        self.need_bvh(i);
        self.need_bvh(j);
        let (start, end) = (&self.previous.position, &self.current.position);
        let offset = start[j] - start[i];
        let motion = (end[j] - end[i]) - offset;
        let touch = self
            .bvh(i)
            .zip(self.bvh(j))
            .and_then(|(first, second)| touch::first_touch(first, second, offset, motion))
            .map(|touch| (touch.time, touch.point, touch.normal));
        // Bodies that meet after a motion have touched on the way. Should rounding hide where,
        // the motion itself is turned back.
        let turned_back = || Some((1.0, offset + motion, -motion.try_normalize()?));
        if let Some((time, point, normal)) = touch.or_else(turned_back) {
            let point = start[i].lerp(end[i], time) + point;
            let time = self.time() + time * self.settings.dt;
            self.exchange((i, j), normal, point, time);
        }
    }

    /// Reverses the relative normal velocity of two bodies, if they approach.
    fn exchange(&mut self, (i, j): (usize, usize), normal: DVec3, point: DVec3, time: f64) {
        let velocity = &mut self.current.velocity;
        let (m1, m2) = (self.mass[i], self.mass[j]);
        let Some(impulse) = impulse::elastic(m1, velocity[i], m2, velocity[j], normal) else {
            return;
        };
        velocity[i] -= impulse / m1 * normal;
        velocity[j] += impulse / m2 * normal;
        self.impacts += 1;
        self.last_impact = Some(Impact {
            step: self.steps + 1,
            time,
            bodies: (i, j),
            point,
            normal,
            impulse,
        });
    }

    /// Forgets pairs that have parted since they began in overlap, and keeps the others from
    /// moving closer: an elastic impulse along the line of their centres, nothing put back.
    fn part_overlapping(&mut self) {
        let pairs = core::mem::take(&mut self.overlapping);
        let still: Vec<_> = pairs
            .into_iter()
            .filter(|&(i, j)| self.meet(i, j))
            .collect();
        for &(i, j) in &still {
            let (from, to) = (self.centre(i), self.centre(j));
            let normal = (to - from).try_normalize().unwrap_or(DVec3::X);
            let time = self.time() + self.settings.dt;
            self.exchange((i, j), normal, 0.5 * (from + to), time);
        }
        self.overlapping = still;
    }

    /// Middle of a body's box, m.
    fn centre(&self, body: usize) -> DVec3 {
        let middle = self
            .mesh(body)
            .map_or(DVec3::ZERO, |mesh| mesh.bounds().centre());
        self.current.position[body] + middle
    }

    /// Notes the pairs that a newly placed body is in overlap with. Always through the trees:
    /// placing bodies is not what naive steps are measured for.
    pub(super) fn note_overlaps_of(&mut self, body: usize) {
        for place in 0..self.solid.len() {
            let other = self.solid[place];
            let pair = (body.min(other), body.max(other));
            if other != body && self.meet_by_trees(pair.0, pair.1) {
                self.overlapping.push(pair);
            }
        }
        self.overlapping.sort_unstable();
    }
}
