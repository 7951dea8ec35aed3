//! Pairs of bodies that were placed in overlap.
//!
//! One search finds them for all newly placed bodies, before the next step or on request. A search for each
//! new body alone would compare it with all bodies before it.

use alloc::{boxed::Box, collections::BTreeMap, vec::Vec};
use once_cell::race::OnceBox;

use super::World;
use crate::collide::Broad;

/// So many bodies or fewer are compared with all others one by one: to put all in order takes longer.
const FEW: usize = 8;

/// Pairs that are in overlap since they were placed, and who is to be looked at.
#[derive(Clone, Debug, Default)]
pub(super) struct Overlaps {
    /// Pairs that began in overlap, in order; without those of bodies that have just been placed.
    pub(super) pairs: Vec<(usize, usize)>,
    placed: Placed,
    /// How deep they were in each other where they were placed, m.
    depth_at_start: BTreeMap<(usize, usize), f64>,
}

impl Overlaps {
    /// Pairs in order, and how deep some of them were where they were placed, m.
    #[cfg(feature = "serde")]
    pub(super) fn known(
        pairs: Vec<(usize, usize)>,
        depth_at_start: BTreeMap<(usize, usize), f64>,
    ) -> Overlaps {
        Overlaps {
            pairs,
            depth_at_start,
            placed: Placed::default(),
        }
    }

    /// How deep two bodies in overlap were in each other where they were placed, m.
    pub(super) fn depth_at_start(&self, pair: (usize, usize)) -> Option<f64> {
        self.depth_at_start.get(&pair).copied()
    }

    /// Notes how deep bodies are in each other where they have been placed.
    pub(super) fn note_depth(&mut self, pair: (usize, usize), depth: f64) {
        self.depth_at_start.entry(pair).or_insert(depth);
    }

    /// Keeps the pairs for which a condition holds.
    pub(super) fn retain(&mut self, holds: impl FnMut(&(usize, usize)) -> bool) {
        self.pairs.retain(holds);
        let pairs = &self.pairs;
        self.depth_at_start
            .retain(|pair, _| pairs.binary_search(pair).is_ok());
    }

    /// Takes out a body of which no overlap is known; those after it move up.
    pub(super) fn remove_body(&mut self, body: usize) {
        let moved = |other: usize| other - usize::from(other > body);
        for (i, j) in &mut self.pairs {
            (*i, *j) = (moved(*i), moved(*j));
        }
        let depths = core::mem::take(&mut self.depth_at_start).into_iter();
        self.depth_at_start = depths
            .map(|((i, j), depth)| ((moved(i), moved(j)), depth))
            .collect();
        let placed = &mut self.placed;
        placed.bodies.retain(|&other| other != body);
        placed
            .bodies
            .iter_mut()
            .for_each(|other| *other = moved(*other));
        if body < placed.is_listed.len() {
            placed.is_listed.remove(body);
        }
    }
}

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
        if self.overlaps.placed.bodies.is_empty() {
            return &self.overlaps.pairs;
        }
        let found = || Box::new(self.all_overlapping());
        self.overlaps.placed.overlapping.get_or_init(found)
    }

    /// Seeks overlaps of the bodies that have been placed.
    #[inline(always)]
    pub(super) fn seek_overlaps(&mut self) {
        if !self.overlaps.placed.bodies.is_empty() {
            self.seek_overlaps_of_placed();
        }
    }

    #[cold]
    fn seek_overlaps_of_placed(&mut self) {
        self.overlaps.pairs = self.overlapping().to_vec();
        for body in self.overlaps.placed.bodies.drain(..) {
            self.overlaps.placed.is_listed[body] = false;
        }
        self.overlaps.placed.overlapping = OnceBox::new();
    }

    /// Forgets whom a body touches or overlaps: it is about to be placed.
    pub(super) fn forget_contacts_of(&mut self, body: usize) {
        self.keep_found_overlaps();
        self.overlaps.retain(|&(i, j)| i != body && j != body);
        self.contacts
            .retain(|contact| contact.bodies.0 != body && contact.bodies.1 != body);
        self.continuous.wake_all();
    }

    /// What has been asked for need not be sought again.
    fn keep_found_overlaps(&mut self) {
        if self.overlaps.placed.overlapping.get().is_some() {
            self.seek_overlaps();
        }
    }

    /// Notes that a body has been placed, which forgets nothing of others.
    pub(super) fn note_placed(&mut self, body: usize) {
        self.keep_found_overlaps();
        self.continuous.placed = true;
        self.index.forget();
        if !self.bodies.has_shape(body) {
            return;
        }
        let Placed {
            bodies, is_listed, ..
        } = &mut self.overlaps.placed;
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
        let mut pairs = self.overlaps.pairs.clone();
        let mut ask = |i: usize, j: usize| {
            if self.bodies.may_meet(i, j) && self.bodies.meet_in(&self.current, i, j) {
                pairs.push((i, j));
            }
        };
        let is_placed = |body: usize| self.overlaps.placed.is_listed.get(body) == Some(&true);
        let at = |body: usize| self.current.position[body];
        if self.overlaps.placed.bodies.len() <= FEW {
            for &body in &self.overlaps.placed.bodies {
                let own = self.bodies.swept_box(body, at(body), at(body));
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
                    if is_wall || own.meets(&self.bodies.swept_box(other, at(other), at(other))) {
                        ask(body.min(other), body.max(other));
                    }
                }
            }
        } else {
            let mut broad = Broad::default();
            broad.fill(
                &self.bodies.solid,
                |body| self.bodies.swept_box(body, at(body), at(body)),
                |body| self.bodies.swept_front(body, at(body), at(body)),
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

    /// Forgets pairs that have parted since they began in overlap.
    pub(super) fn forget_parted_overlaps(&mut self) {
        if self.overlaps.pairs.is_empty() {
            return;
        }
        self.overlaps
            .retain(|&(i, j)| self.bodies.meet_in(&self.current, i, j));
        let pairs = &self.overlaps.pairs;
        self.contacts.retain(|constraint| {
            !constraint.is_overlap || pairs.binary_search(&constraint.bodies).is_ok()
        });
    }
}

#[cfg(test)]
mod tests {
    use alloc::{sync::Arc, vec::Vec};
    use glam::DVec3;

    use super::*;
    use crate::{Body, BodyKind, Settings, Shape, test_meshes::cube, test_random::Random};

    /// All pairs in overlap, one by one.
    fn brute_force(world: &World) -> Vec<(usize, usize)> {
        let pairs = (0..world.len()).flat_map(|i| (i + 1..world.len()).map(move |j| (i, j)));
        let is_overlap = |&(i, j): &(usize, usize)| {
            let is_movable = world.kind(i).is_movable() || world.kind(j).is_movable();
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
                let kind = match pick(4) {
                    0 => BodyKind::Static,
                    _ => BodyKind::Dynamic,
                };
                match (pick(8), world.len()) {
                    (0, 1..) => {
                        let body = pick(world.len());
                        world.set_position(body, place).unwrap();
                    }
                    (1, 1..) => {
                        let body = pick(world.len());
                        world.set_kind(body, kind).unwrap();
                    }
                    (2, _) if pick(8) == 0 => {
                        let expected = brute_force(&world);
                        world.seek_overlaps();
                        assert_eq!(world.overlaps.pairs, expected);
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
                                kind,
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
