//! The broad phase: the search for pairs of boxes that meet.
//!
//! A body that sweeps little of its own size in a step keeps its *neighbours* for some steps (Verlet 1967, "Computer
//! experiments on classical fluids", sec. II). Neighbours are the bodies whose fat AABBs meet: boxes widened by the
//! motion of bodies in a few steps. As long as a box stays within its fat AABB, no other body need be tested. Boxes
//! that have left their fat AABBs are tested against all boxes ([`rows`]); once there are many of them, all fat AABBs
//! and neighbours are built anew.

mod near;
mod neighbours;
mod rows;
mod volume;

use alloc::vec::Vec;
use core::mem;
use glam::DVec3;

pub(crate) use near::BoxTree;
use neighbours::Neighbours;
use rows::Rows;
pub(crate) use volume::{Front, Swept};

/// Boxes are widened by the mean motion in this many steps,
const STEPS: f64 = 8.0;
/// but at most by this part of their mean size: in three dimensions the number of pairs grows with the third power.
const WIDEST: f64 = 0.5;
/// At most one in this many boxes may have left its fat AABB.
const LEAVERS: usize = 8;

/// Boxes and planes of bodies, filled anew in each step. The stored data saves time and changes no answer, so a copy
/// starts without it.
#[derive(Debug, Default)]
pub(crate) struct Broad {
    /// The bodies that have a box.
    bodies: Vec<usize>,
    /// For each body its box, as filled and replaced.
    now: Vec<Swept>,
    /// For each body its fat AABB.
    wide: Vec<Swept>,
    /// The width by which the fat AABBs exceed the boxes, m, and the number of fills since they were made.
    margin: DVec3,
    age: u32,
    /// The fat AABBs; for bodies that have left theirs, the current boxes.
    rows: Rows,
    /// The bodies that have left their fat AABBs.
    leavers: Vec<usize>,
    has_left: Vec<bool>,
    neighbours: Option<Neighbours>,
    walls: Vec<Wall>,
}

/// A plane, and the bodies whose fat AABBs reach it.
#[derive(Clone, Debug)]
struct Wall {
    now: Front,
    /// The farthest level of the plane along its normal for which these bodies are valid, rounding included, m.
    level: f64,
    bodies: Vec<usize>,
}

impl Clone for Broad {
    fn clone(&self) -> Broad {
        Broad::default()
    }
}

impl Broad {
    /// Replaces all boxes and planes by those of some bodies: planes of half-spaces, boxes of others. If the number
    /// of bodies is that of the last fill, they are the same bodies.
    pub(crate) fn fill(
        &mut self,
        bodies: &[usize],
        swept: impl Fn(usize) -> Swept,
        front: impl Fn(usize) -> Option<Front>,
    ) {
        let is_known = bodies.len() == self.bodies.len() + self.walls.len();
        if !is_known {
            self.forget(bodies, &front);
        }
        for body in self.leavers.drain(..) {
            self.has_left[body] = false;
            self.rows.replace(self.wide[body]);
        }
        for &body in &self.bodies {
            self.now[body] = swept(body);
            if !self.wide[body].holds(&self.now[body]) {
                self.leavers.push(body);
            }
        }
        self.age += 1;
        // Only the lists of neighbours are kept from step to step.
        let is_listed = is_known && self.neighbours.is_some();
        if is_listed && LEAVERS * self.leavers.len() <= self.bodies.len() {
            for &body in &self.leavers {
                self.has_left[body] = true;
                self.rows.replace(self.now[body]);
            }
        } else {
            self.widen(is_known);
        }
        for wall in &mut self.walls {
            if let Some(front) = front(wall.now.body) {
                wall.take(
                    front,
                    &self.rows,
                    (&self.leavers, &self.has_left, &self.wide),
                );
            }
        }
    }

    /// Whether it has no bodies, because it has not been filled.
    pub(crate) fn is_empty(&self) -> bool {
        self.bodies.is_empty() && self.walls.is_empty()
    }

    /// Starts anew with other bodies.
    fn forget(&mut self, bodies: &[usize], front: impl Fn(usize) -> Option<Front>) {
        self.bodies.clear();
        self.walls.clear();
        for &body in bodies {
            match front(body) {
                None => self.bodies.push(body),
                Some(now) => self.walls.push(Wall {
                    now,
                    level: f64::NEG_INFINITY,
                    bodies: Vec::new(),
                }),
            }
        }
        let last = bodies.iter().copied().max();
        let count = last.map_or(0, |last| last + 1);
        self.now.clear();
        self.now.resize(count, Swept::NOWHERE);
        self.wide.clear();
        self.wide.resize(count, Swept::NOWHERE);
        self.has_left.clear();
        self.has_left.resize(count, false);
        self.leavers.clear();
    }

    /// Makes all fat AABBs anew, from the mean motion in a step since they were made.
    fn widen(&mut self, is_known: bool) {
        self.leavers.clear();
        let (mut moved, mut size) = (DVec3::ZERO, DVec3::ZERO);
        for &body in &self.bodies {
            let Swept { min, max, .. } = self.now[body];
            moved += (min - (self.wide[body].min + self.margin)).abs();
            size += max - min;
        }
        let margin = STEPS / f64::from(self.age) * moved;
        let is_slow = is_known && margin.cmple(WIDEST * size).all();
        let count = self.bodies.len() as f64;
        self.margin = if is_slow { margin / count } else { DVec3::ZERO };
        self.age = 0;
        for &body in &self.bodies {
            self.wide[body] = self.now[body].grown_by(self.margin);
        }
        let wide = &self.wide;
        self.rows.fill(&self.bodies, is_known, |body| wide[body]);
        let mut neighbours = self.neighbours.take().unwrap_or_default();
        self.neighbours = is_slow.then(|| {
            neighbours.fill(&self.rows, wide.len());
            neighbours
        });
        for wall in &mut self.walls {
            wall.level = f64::NEG_INFINITY;
        }
    }

    /// Each pair of bodies whose boxes meet, or whose box and plane meet, the lower body first; as filled, without
    /// replacements.
    pub(crate) fn each_pair(&self, mut found: impl FnMut(usize, usize)) {
        match &self.neighbours {
            None => self.rows.each_pair(&mut found),
            Some(neighbours) => {
                for (i, j) in neighbours.pairs() {
                    if self.now[i].meets(&self.now[j]) && !self.has_left[i] && !self.has_left[j] {
                        found(i, j);
                    }
                }
                for &body in &self.leavers {
                    self.each_in_rows(body, |other| {
                        // A pair of two bodies that have left their fat AABBs is found twice.
                        if !self.has_left[other] || body < other {
                            found(body.min(other), body.max(other));
                        }
                    });
                }
            }
        }
        for wall in &self.walls {
            let body = wall.now.body;
            self.each_before(wall, |other| found(body.min(other), body.max(other)));
        }
    }

    /// Replaces the box of a body.
    pub(crate) fn replace(&mut self, swept: Swept) {
        let body = swept.body;
        self.now[body] = swept;
        if self.has_left[body] || !self.wide[body].holds(&swept) {
            self.rows.replace(swept);
            if !mem::replace(&mut self.has_left[body], true) {
                self.leavers.push(body);
            }
        }
    }

    /// Replaces the plane of a body.
    pub(crate) fn replace_front(&mut self, front: Front) {
        let mut walls = self.walls.iter_mut();
        if let Some(wall) = walls.find(|wall| wall.now.body == front.body) {
            wall.take(
                front,
                &self.rows,
                (&self.leavers, &self.has_left, &self.wide),
            );
        }
    }

    /// Each other body whose box or plane meets that of a body.
    pub(crate) fn each_partner(&self, body: usize, mut found: impl FnMut(usize)) {
        if let Some(wall) = self.walls.iter().find(|wall| wall.now.body == body) {
            return self.each_before(wall, found);
        }
        match self.neighbours.as_ref().filter(|_| !self.has_left[body]) {
            None => self.each_in_rows(body, &mut found),
            Some(neighbours) => {
                let others = neighbours.of(body).filter(|&other| !self.has_left[other]);
                for other in others.chain(self.leavers.iter().copied()) {
                    if self.now[other].meets(&self.now[body]) {
                        found(other);
                    }
                }
            }
        }
        for wall in &self.walls {
            if wall.now.may_meet(&self.now[body]) {
                found(wall.now.body);
            }
        }
    }

    fn each_in_rows(&self, body: usize, mut found: impl FnMut(usize)) {
        let own = &self.now[body];
        self.rows.each_partner(own, |other| {
            if self.now[other].meets(own) {
                found(other);
            }
        });
    }

    fn each_before(&self, wall: &Wall, mut found: impl FnMut(usize)) {
        let stayed = wall.bodies.iter().filter(|&&body| !self.has_left[body]);
        for &body in stayed.chain(&self.leavers) {
            if wall.now.may_meet(&self.now[body]) {
                found(body);
            }
        }
    }
}

impl Wall {
    /// Replaces the plane, and finds its bodies anew if it comes farther than before.
    fn take(
        &mut self,
        front: Front,
        rows: &Rows,
        (leavers, has_left, wide): (&[usize], &[bool], &[Swept]),
    ) {
        let last = mem::replace(&mut self.now, front);
        if front.level + front.slack > self.level {
            let ahead = STEPS * (front.level - last.level).max(0.0);
            let farthest = Front {
                level: front.level + ahead,
                ..front
            };
            self.level = farthest.level + farthest.slack;
            self.bodies.clear();
            rows.each_before(&farthest, |body| {
                if !has_left[body] {
                    self.bodies.push(body);
                }
            });
            // They may come back.
            let leavers = leavers.iter().copied();
            self.bodies
                .extend(leavers.filter(|&body| farthest.may_meet(&wide[body])));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_random::Random;
    use alloc::vec;

    fn swept(random: &mut Random, body: usize) -> Swept {
        let (min, size) = (10.0 * random.in_unit_cube(), 2.0 * random.in_unit_cube());
        let max = min + size * size;
        Swept { min, max, body }
    }

    /// Compares all queries with brute force.
    fn check(broad: &Broad, all: &[Swept], fronts: &[Front], with_pairs: bool) -> usize {
        let mut expected = vec![];
        for (j, second) in all.iter().enumerate() {
            let firsts = (0..j).filter(|&i| all[i].meets(second));
            expected.extend(firsts.map(|i| (i, j)));
            let fronts = fronts.iter().filter(|front| front.may_meet(second));
            expected.extend(fronts.map(|front| (j, front.body)));
        }
        expected.sort_unstable();
        if with_pairs {
            let mut pairs = vec![];
            broad.each_pair(|i, j| pairs.push((i, j)));
            pairs.sort_unstable();
            assert_eq!(pairs, expected);
        }
        for body in 0..all.len() + fronts.len() {
            let mut partners = vec![];
            broad.each_partner(body, |other| partners.push(other));
            partners.sort_unstable();
            let others = expected.iter().filter_map(|&(i, j)| match body {
                _ if i == body => Some(j),
                _ if j == body => Some(i),
                _ => None,
            });
            assert_eq!(partners, others.collect::<Vec<_>>());
        }
        expected.len()
    }

    #[test]
    fn pairs_and_partners_are_those_of_brute_force() {
        let cases = [0, 1, 2, 3, 10, 300, 600].map(|count| [(count, 1), (count, 12)]);
        // The number of bodies, and one in how many moves.
        for (count, moving) in cases.into_iter().flatten() {
            let bodies: Vec<usize> = (0..count + 2).collect();
            let mut random = Random(7 + count as u64);
            let mut broad = Broad::default();
            let mut all: Vec<Swept> = (0..count).map(|body| swept(&mut random, body)).collect();
            let velocity: Vec<_> = (0..count)
                .map(|body| match body % moving {
                    0 => random.in_unit_cube() - random.in_unit_cube(),
                    _ => DVec3::ZERO,
                })
                .collect();
            let fronts = |step: usize| {
                [(DVec3::X, 2.0), (DVec3::new(0.0, -0.6, 0.8), -3.0)].map(|(normal, level)| Front {
                    normal,
                    level: level + 0.04 * step as f64 * normal.x,
                    slack: 0.0,
                    body: if normal == DVec3::X { count } else { count + 1 },
                })
            };
            let (mut listed, mut left) = (0, 0);
            for step in 0..24 {
                let fronts = fronts(step);
                // Slowly; at times fast, or one body far away and back.
                let by = if step % 9 == 8 { 6.0 } else { 0.02 };
                for (swept, velocity) in all.iter_mut().zip(&velocity) {
                    (swept.min, swept.max) = (swept.min + by * velocity, swept.max + by * velocity);
                }
                let away = DVec3::splat(if step % 2 == 0 { 3.0 } else { -3.0 });
                if let Some(far) = all.first_mut() {
                    (far.min, far.max) = (far.min + away, far.max + away);
                }
                let front = |body: usize| fronts.iter().copied().find(|front| front.body == body);
                broad.fill(&bodies, |body| all[body], front);
                let pairs = check(&broad, &all, &fronts, true);
                assert!(count < 300 || pairs > 100);
                listed += usize::from(broad.neighbours.is_some());
                left += broad.leavers.len();
                // Some bodies are replaced, one of them twice, by near or by quite different boxes; a plane is
                // replaced too.
                let mut new = all.clone();
                for body in (0..count)
                    .step_by(7)
                    .chain([0; 2])
                    .filter(|&body| body < count)
                {
                    let shift = 0.05 * (random.in_unit_cube() - random.in_unit_cube());
                    new[body] = match body % 2 {
                        0 => swept(&mut random, body),
                        _ => Swept {
                            min: new[body].min + shift,
                            max: new[body].max + shift,
                            body,
                        },
                    };
                    broad.replace(new[body]);
                }
                let mut moved = fronts;
                moved[1].level += 0.7;
                broad.replace_front(moved[1]);
                check(&broad, &new, &moved, false);
            }
            assert!(count < 300 || (listed > 12 && listed < 24 && left > 5));
        }
    }
}
