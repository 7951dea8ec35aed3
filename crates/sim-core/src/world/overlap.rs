//! Pairs of bodies that are in overlap where they have been placed.
//!
//! They are sought once for all bodies that have been placed, before the next step or when somebody
//! asks: one by one, each new body would have to be compared with all before it.

use alloc::{boxed::Box, collections::BTreeMap, vec::Vec};
use glam::DVec3;
use once_cell::race::OnceBox;

use super::{World, order};
use crate::{
    Aabb, Extent, Shape,
    collide::{Broad, Contact, Front, Swept},
    impulse,
};

/// So many bodies or fewer are compared with all others one by one: to put all in order takes longer.
const FEW: usize = 8;

/// Bodies that have been placed since overlaps were last sought.
#[derive(Clone, Debug, Default)]
pub(super) struct Placed {
    bodies: Vec<usize>,
    /// By body, whether it is one of them.
    is_listed: Vec<bool>,
    /// All pairs in overlap, once somebody has asked. It can be found while the world is looked at
    /// from several threads.
    overlapping: OnceBox<Vec<(usize, usize)>>,
}

impl World {
    /// Pairs of bodies that meet where they have been put into the world, and have not parted since, in
    /// order; to touch is to meet. [`World::overlaps`] tells those that are in each other by more than
    /// rounding, and how deep.
    ///
    /// Such pairs may part, and get no deeper; in the discrete modes an elastic impulse along their
    /// centres keeps them from moving closer. [`World::separate`] moves them apart.
    pub fn overlapping(&self) -> &[(usize, usize)] {
        if self.placed.bodies.is_empty() {
            return &self.overlapping;
        }
        let found = || Box::new(self.all_overlapping());
        self.placed.overlapping.get_or_init(found)
    }

    /// Seeks overlaps of the bodies that have been placed.
    #[inline(always)]
    pub(super) fn seek_overlaps(&mut self) {
        if !self.placed.bodies.is_empty() {
            self.seek_overlaps_of_placed();
        }
    }

    #[cold]
    fn seek_overlaps_of_placed(&mut self) {
        self.overlapping = self.overlapping().to_vec();
        for body in self.placed.bodies.drain(..) {
            self.placed.is_listed[body] = false;
        }
        self.placed.overlapping = OnceBox::new();
    }

    /// Forgets whom a body touches or overlaps: it is about to be placed.
    pub(super) fn forget_contacts_of(&mut self, body: usize) {
        self.keep_found_overlaps();
        self.overlapping.retain(|&(i, j)| i != body && j != body);
        self.forget_depths();
        self.contacts
            .retain(|contact| contact.bodies.0 != body && contact.bodies.1 != body);
        self.continuous.wake_all();
    }

    /// What has been asked for need not be sought again.
    fn keep_found_overlaps(&mut self) {
        if self.placed.overlapping.get().is_some() {
            self.seek_overlaps();
        }
    }

    /// Notes that a body has been placed, which forgets nothing of others.
    pub(super) fn note_placed(&mut self, body: usize) {
        self.keep_found_overlaps();
        self.continuous.placed = true;
        if !self.bodies.has_shape(body) {
            return;
        }
        let Placed {
            bodies, is_listed, ..
        } = &mut self.placed;
        if is_listed.len() <= body {
            is_listed.resize(body + 1, false);
        }
        if !core::mem::replace(&mut is_listed[body], true) {
            bodies.push(body);
        }
    }

    /// All pairs in overlap: those that are known, and those of bodies that have been placed. Always
    /// through the trees: placing bodies is not what naive steps are measured for.
    fn all_overlapping(&self) -> Vec<(usize, usize)> {
        let mut pairs = self.overlapping.clone();
        let mut ask = |i: usize, j: usize| {
            let is_movable = self.bodies.is_movable(i) || self.bodies.is_movable(j);
            let offset = self.current.position[j] - self.current.position[i];
            if is_movable && self.bodies.meet_at(i, j, offset) {
                pairs.push((i, j));
            }
        };
        let is_placed = |body: usize| self.placed.is_listed.get(body) == Some(&true);
        let at = |body: usize| self.current.position[body];
        if self.placed.bodies.len() <= FEW {
            for &body in &self.placed.bodies {
                let own = self.swept_box(body, at(body), at(body));
                for &other in &self.bodies.solid {
                    // Of two that have been placed, the pair is asked once.
                    if other == body || is_placed(other) && other < body {
                        continue;
                    }
                    let is_wall = self
                        .bodies
                        .extent(body)
                        .half
                        .max(self.bodies.extent(other).half)
                        == f64::INFINITY;
                    if is_wall || own.meets(&self.swept_box(other, at(other), at(other))) {
                        ask(body.min(other), body.max(other));
                    }
                }
            }
        } else {
            let mut broad = Broad::default();
            broad.fill(
                &self.bodies.solid,
                |body| self.swept_box(body, at(body), at(body)),
                |body| self.swept_front(body, at(body), at(body)),
            );
            broad.each_pair(|i, j| {
                if is_placed(i) || is_placed(j) {
                    ask(i, j);
                }
            });
        }
        pairs.sort_unstable();
        pairs
    }

    /// A box around a body on a straight way from a place to another.
    pub(super) fn swept_box(&self, body: usize, from: DVec3, to: DVec3) -> Swept {
        let Extent {
            low,
            high,
            farthest,
            ..
        } = self.bodies.extent(body);
        // More than is lost in rounding, here and where vertices are placed.
        let margin = 8.0 * f64::EPSILON * (from.abs() + to.abs() + 2.0 * farthest);
        Swept {
            min: from.min(to) + low - margin,
            max: from.max(to) + high + margin,
            body,
        }
    }

    /// The farthest that the plane of a body comes on a straight way, if it is a half-space.
    pub(super) fn swept_front(&self, wall: usize, from: DVec3, to: DVec3) -> Option<Front> {
        let &Shape::HalfSpace { normal } = self.bodies.shape(wall)? else {
            return None;
        };
        Some(Front {
            normal,
            body: wall,
            level: normal.dot(from).max(normal.dot(to)),
            // More than is lost in rounding.
            slack: 16.0 * f64::EPSILON * (from.length() + to.length()),
        })
    }

    /// Forgets pairs that have parted since they began in overlap.
    pub(super) fn forget_parted_overlaps(&mut self) {
        if self.overlapping.is_empty() {
            return;
        }
        let mut pairs = core::mem::take(&mut self.overlapping);
        pairs.retain(|&(i, j)| {
            let offset = self.current.position[j] - self.current.position[i];
            self.bodies.meet_at(i, j, offset)
        });
        self.contacts.retain(|constraint| {
            !constraint.is_overlap || pairs.binary_search(&constraint.bodies).is_ok()
        });
        self.overlapping = pairs;
        self.forget_depths();
    }
    /// Forgets pairs that have parted since they began in overlap, and keeps the others from
    /// moving closer: an elastic impulse along the line of their centres, nothing put back.
    pub(super) fn part_overlapping(&mut self) {
        if self.overlapping.is_empty() {
            return;
        }
        let mut pairs = core::mem::take(&mut self.overlapping);
        pairs.retain(|&(i, j)| self.meet(i, j));
        if !pairs.is_empty() {
            self.exchange_in_overlap(&pairs);
        }
        self.overlapping = pairs;
    }

    /// Lets all pairs that move closer exchange an impulse at once. Where several share a body, each
    /// gives the part of its impulse that makes all of them no more than one: the velocities are then
    /// a mean of some that each keep the energy, so that none is gained.
    fn exchange_in_overlap(&mut self, pairs: &[(usize, usize)]) {
        let velocity = &self.current.velocity;
        let closing: Vec<((usize, usize), DVec3)> = pairs
            .iter()
            .filter_map(|&(i, j)| Some(((i, j), self.line_apart(i, j)?)))
            .filter(|&((i, j), normal)| (velocity[j] - velocity[i]).dot(normal) < 0.0)
            .collect();
        let mut shares: BTreeMap<usize, u32> = BTreeMap::new();
        for &((i, j), _) in &closing {
            for body in [i, j]
                .into_iter()
                .filter(|&body| self.bodies.is_movable(body))
            {
                *shares.entry(body).or_insert(0) += 1;
            }
        }
        let time = self.time() + self.settings.dt;
        let (mut changes, mut noted) = (Vec::new(), Vec::new());
        for ((i, j), normal) in closing {
            let point = 0.5 * (self.centre(i) + self.centre(j));
            let contact = Contact {
                time: 1.0,
                point,
                normal,
                feature: None,
                face: None,
            };
            let shared = |body: usize| shares.get(&body).copied().unwrap_or(1);
            let most = shared(i).max(shared(j));
            if most == 1 {
                // Nobody else has a say in these two.
                self.exchange_now((i, j), &contact, time);
                continue;
            }
            let velocity = &self.current.velocity;
            let (before, masses) = (
                (velocity[i], velocity[j]),
                (self.bodies.mass[i], self.bodies.mass[j]),
            );
            let restitution = self.bodies.pair_restitution(i, j);
            let given = impulse::between(
                (masses.0, before.0),
                (masses.1, before.1),
                normal,
                restitution,
            );
            let Some(given) = given else { continue };
            let impulse = given.impulse / f64::from(most);
            changes.push((i, -(impulse / masses.0) * normal));
            changes.push((j, impulse / masses.1 * normal));
            noted.push(((i, j), contact, impulse, (before.0 - before.1).dot(normal)));
        }
        // In an order that comes from the terms alone.
        changes.sort_by_cached_key(|&(body, change)| (body, order::of_vector(change)));
        for of_body in changes.chunk_by(|a, b| a.0 == b.0) {
            let change: DVec3 = of_body.iter().map(|&(_, change)| change).sum();
            self.current.velocity[of_body[0].0] += change;
        }
        for ((i, j), contact, impulse, closing) in noted {
            let velocity = &self.current.velocity;
            let parting = (velocity[j] - velocity[i]).dot(contact.normal);
            self.note_impact((i, j), &contact, impulse, (closing, parting), time);
        }
    }

    /// Where two bodies in overlap should part to: out of a half-space, or along the line of their
    /// centres.
    pub(super) fn apart_along(&self, i: usize, j: usize) -> DVec3 {
        self.line_apart(i, j).unwrap_or(DVec3::X)
    }

    /// The same; `None` where their centres are in one place, and no direction is closer.
    fn line_apart(&self, i: usize, j: usize) -> Option<DVec3> {
        match (self.bodies.shape(i), self.bodies.shape(j)) {
            (Some(&Shape::HalfSpace { normal }), _) => Some(normal),
            (_, Some(&Shape::HalfSpace { normal })) => Some(-normal),
            _ => (self.centre(j) - self.centre(i)).try_normalize(),
        }
    }

    /// Middle of a body's box, m.
    fn centre(&self, body: usize) -> DVec3 {
        let middle = self
            .mesh(body)
            .map_or(DVec3::ZERO, |mesh| Aabb::centre(&mesh.bounds()));
        self.current.position[body] + middle
    }
}

#[cfg(test)]
mod tests {
    use alloc::{sync::Arc, vec::Vec};

    use super::*;
    use crate::{Body, Settings, test_meshes::cube, test_random::Random};

    /// All pairs in overlap, one by one.
    fn brute_force(world: &World) -> Vec<(usize, usize)> {
        let pairs = (0..world.len()).flat_map(|i| (i + 1..world.len()).map(move |j| (i, j)));
        let is_overlap = |&(i, j): &(usize, usize)| {
            let is_movable = world.mass(i).is_finite() || world.mass(j).is_finite();
            is_movable
                && world
                    .bodies
                    .meet_at(i, j, world.position(j) - world.position(i))
        };
        pairs.filter(is_overlap).collect()
    }

    #[test]
    fn overlaps_are_those_of_brute_force_whenever_they_are_asked_for() {
        let cube = Arc::new(cube());
        let (mut found, mut asked) = (0, 0);
        for seed in 1..60 {
            let mut random = Random(seed);
            let mut world = World::new(Settings::default()).unwrap();
            let mut pick = |most: usize| (random.up_to(1 << 30) + (1 << 30)) as usize % most;
            for _ in 0..120 {
                let place = 0.25 * DVec3::from([pick(16), pick(16), pick(16)].map(|x| x as f64));
                let heavy = if pick(4) == 0 { f64::INFINITY } else { 1.0 };
                match (pick(8), world.len()) {
                    (0, 1..) => {
                        let body = pick(world.len());
                        world.set_position(body, place).unwrap();
                    }
                    (1, 1..) => {
                        let body = pick(world.len());
                        world.set_mass(body, heavy).unwrap();
                    }
                    (2, _) if pick(8) == 0 => {
                        let expected = brute_force(&world);
                        world.seek_overlaps();
                        assert_eq!(world.overlapping, expected);
                    }
                    (3, _) if pick(4) == 0 => {
                        let expected = brute_force(&world);
                        assert_eq!(world.overlapping(), expected);
                        assert_eq!(world.clone().overlapping(), expected);
                        (found, asked) = (found + expected.len(), asked + 1);
                    }
                    _ => {
                        let shape = match pick(5) {
                            0 => Some(Shape::Sphere { radius: 0.25 }),
                            1 if pick(4) == 0 => Some(Shape::HalfSpace {
                                normal: DVec3::new(0.0, 1.0, pick(2) as f64),
                            }),
                            2 => None,
                            _ => Some(cube.clone().into()),
                        };
                        world
                            .add(Body {
                                shape,
                                position: place,
                                mass: heavy,
                                ..Body::default()
                            })
                            .unwrap();
                    }
                }
            }
            assert_eq!(world.overlapping(), brute_force(&world));
        }
        assert!(found > 1000 && asked > 100, "{found} {asked}");
    }

    #[test]
    fn many_pairs_in_overlap_gain_no_energy() {
        let mut random = Random(5);
        let mut world = World::new(Settings {
            collision: crate::Collision::Bvh,
            ..Settings::default()
        })
        .unwrap();
        for _ in 0..30 {
            world
                .add(Body {
                    shape: Some(Shape::Sphere { radius: 1.0 }),
                    position: 1e-2 * random.vector(100),
                    velocity: 1e-2 * random.vector(100),
                    ..Body::default()
                })
                .unwrap();
        }
        assert!(world.overlapping().len() > 300);
        for _ in 0..600 {
            let energy = world.kinetic_energy();
            world.step().unwrap();
            assert!(world.kinetic_energy() <= energy * (1.0 + 1e-14));
        }
        // Alone, each would have left long ago.
        assert!(
            world.overlapping().len() < 100,
            "{}",
            world.overlapping().len()
        );
    }
}
