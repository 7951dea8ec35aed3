//! Pairs of bodies that were placed in overlap.
//!
//! One search finds these pairs for all newly placed bodies, before the next step or on request. A separate search for
//! each new body would compare it with all bodies before it.

use alloc::{boxed::Box, collections::BTreeMap, vec::Vec};
use once_cell::race::OnceBox;

use super::World;
use crate::collide::Broad;

/// Up to this many bodies are compared with all others one by one: to sort all bodies takes longer.
const FEW: usize = 8;

/// Pairs in overlap since they were placed, and the bodies whose overlaps are not known yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Overlaps {
    /// Pairs that began in overlap, in order; without pairs of newly placed bodies.
    pub(super) pairs: Vec<(usize, usize)>,
    placed: Placed,
    /// The depth of pairs where they were placed, m.
    depth_at_start: BTreeMap<(usize, usize), f64>,
}

impl Overlaps {
    /// Restores the pairs, in order, and the depths of some of them where they were placed, m.
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

    /// The depth of two overlapping bodies where they were placed, m.
    pub(super) fn depth_at_start(&self, pair: (usize, usize)) -> Option<f64> {
        self.depth_at_start.get(&pair).copied()
    }

    /// Stores the depth of two bodies where they were placed.
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

    /// Removes a body without known overlaps; the indices of the bodies after it decrease by one.
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

/// Bodies that were placed since the last search for overlaps.
#[derive(Clone, Debug, Default)]
pub(super) struct Placed {
    bodies: Vec<usize>,
    /// For each body, whether it is in the list.
    is_listed: Vec<bool>,
    /// All pairs in overlap, once they were requested. Several threads that read the world may compute it.
    overlapping: OnceBox<Vec<(usize, usize)>>,
}

impl World {
    /// Pairs of bodies that met where they were placed and have not parted since, in order; bodies that touch meet.
    /// [`World::overlaps`] returns those that overlap by more than rounding, and their depths.
    ///
    /// Such pairs may part, and get no deeper. In the discrete modes an elastic impulse along the line of their
    /// centres keeps them from approaching. [`World::separate`] moves them apart.
    pub fn overlapping(&self) -> &[(usize, usize)] {
        if self.overlaps.placed.bodies.is_empty() {
            return &self.overlaps.pairs;
        }
        let found = || Box::new(self.all_overlapping());
        self.overlaps.placed.overlapping.get_or_init(found)
    }

    /// Finds the overlaps of newly placed bodies.
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

    /// Removes the contacts and overlaps of a body that is about to be placed.
    pub(super) fn forget_contacts_of(&mut self, body: usize) {
        self.keep_found_overlaps();
        self.overlaps.retain(|&(i, j)| i != body && j != body);
        self.contacts
            .retain(|contact| contact.bodies.0 != body && contact.bodies.1 != body);
        self.continuous.wake_all();
    }

    /// If the overlaps were requested, keeps them, so that they need not be searched again.
    fn keep_found_overlaps(&mut self) {
        if self.overlaps.placed.overlapping.get().is_some() {
            self.seek_overlaps();
        }
    }

    /// Registers that a body was placed; keeps the overlaps of others.
    pub(super) fn note_placed(&mut self, body: usize) {
        self.keep_found_overlaps();
        self.continuous.placed = true;
        self.continuous.is_dormant = false;
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

    /// All pairs in overlap: the known ones, and those of newly placed bodies. Always uses the trees: a naive step
    /// does not measure the placing of bodies.
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
                    // Test a pair of two newly placed bodies once.
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

    /// Removes pairs that were placed in overlap and have parted since.
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

    /// All pairs in overlap, tested one by one.
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
        // Without other bodies, each would have left long ago.
        assert!(
            world.overlapping().len() < 100,
            "{}",
            world.overlapping().len()
        );
    }
}
