//! The discrete modes, as in the course: collisions at the end of a step only.
//!
//! Bodies that meet exchange an impulse along the contact normal and go back to the start of the step. A body that goes
//! back may meet a third one, so this repeats until no two bodies meet. It ends, because each round puts back at least
//! one more body, and no bodies met at the start of the step. The result restores the invariant that the next step
//! relies on: no two bodies meet, except pairs that were placed in overlap.
//!
//! Pairs that touch first on their trajectories go first, and pairs that touch at the same time go together. So
//! the result does not depend on the order of bodies. `turning` has the differences for turning bodies.

mod turning;

use alloc::{
    collections::{BTreeMap, BinaryHeap},
    vec::Vec,
};
use core::{cmp::Ordering, mem};
use glam::DVec3;

use super::{
    World,
    order::{self, Key},
    profile::Phase,
    record::Record,
    scene::{Scene, scene},
    state::State,
};
use crate::{
    collide::{Broad, Contact},
    impulse::{self, Joined, reflect},
    pieces::Pieces,
};

/// Up to this many bodies, all pairs are tested: to sort the bodies takes longer.
const FEW: usize = 16;

/// The data that is kept from step to step to find near pairs. It only saves time, and a copy starts without it.
#[derive(Debug, Default)]
pub(super) struct Discrete {
    broad: Broad,
    /// Pairs whose boxes meet during the step, and pairs that meet at its end.
    near: Vec<(usize, usize)>,
    meeting: Vec<(usize, usize)>,
    /// Meetings to be resolved, and those that are resolved together.
    meetings: BinaryHeap<Meeting>,
    group: Vec<Meeting>,
    /// The bodies put back in this step, and those put back last; empty between steps.
    is_back: Vec<bool>,
    put_back: Vec<usize>,
}

impl Clone for Discrete {
    fn clone(&self) -> Discrete {
        Discrete::default()
    }
}

/// Two bodies that meet.
#[derive(Debug)]
struct Meeting {
    /// The time at which they touch, as a part of the step.
    time: f64,
    bodies: (usize, usize),
    /// Whether each body had been put back when this meeting was found.
    were_back: (bool, bool),
    /// The contact, with its point in the world; `None` if the bodies do not move relative to each other.
    contact: Option<Contact>,
    /// The distance up to which features touch there, m; 0 if neither body turns.
    near: f64,
}

impl Ord for Meeting {
    /// The earliest meeting is the greatest; at equal times the one of the lowest bodies.
    fn cmp(&self, other: &Meeting) -> Ordering {
        let time = other.time.total_cmp(&self.time);
        time.then(other.bodies.cmp(&self.bodies))
    }
}

impl PartialOrd for Meeting {
    fn partial_cmp(&self, other: &Meeting) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Meeting {
    fn eq(&self, other: &Meeting) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Meeting {}

/// The end of a step: bodies are already at their end positions.
pub(super) struct DiscreteStep<'a> {
    scene: Scene<'a>,
    end: &'a mut State,
    memory: &'a mut Discrete,
    record: &'a mut Record,
}

impl World {
    /// Resolves the collisions of bodies that meet, and puts these bodies back to the start of the step.
    pub(super) fn collide_discretely(&mut self) {
        // This mode treats contacts at the end of the step only.
        self.contacts.clear();
        self.continuous.placed = true;
        let mut step = self.discrete_step();
        step.record.enter(Phase::Narrow);
        step.collide();
        step.record.enter(Phase::Respond);
        if !step.scene.overlaps.pairs.is_empty() {
            self.overlaps.pairs = step.part_overlapping();
        }
    }

    fn discrete_step(&mut self) -> DiscreteStep<'_> {
        DiscreteStep {
            scene: scene!(self),
            end: &mut self.current,
            memory: &mut self.discrete,
            record: &mut self.record,
        }
    }
}

impl DiscreteStep<'_> {
    /// Resolves the collisions of bodies that meet, and puts these bodies back to the start of the step.
    fn collide(&mut self) {
        self.find_meeting_pairs();
        if !self.memory.meeting.is_empty() {
            self.bounce_all();
        }
    }

    /// Finds the pairs that meet now and were apart at the start.
    fn find_meeting_pairs(&mut self) {
        let mut meeting = mem::take(&mut self.memory.meeting);
        meeting.clear();
        if self.is_few() {
            for (second, &j) in self.scene.bodies.solid.iter().enumerate() {
                for &i in &self.scene.bodies.solid[..second] {
                    if self.collides(i, j) {
                        meeting.push((i, j));
                    }
                }
            }
        } else {
            self.record.enter(Phase::Broad);
            self.find_near_pairs();
            self.record.enter(Phase::Narrow);
            let near = self.memory.near.iter().copied();
            meeting.extend(near.filter(|&(i, j)| self.collides(i, j)));
        }
        self.memory.meeting = meeting;
    }

    /// Finds the pairs that may meet during the step.
    fn find_near_pairs(&mut self) {
        let mut broad = mem::take(&mut self.memory.broad);
        let way = |body: usize| (self.scene.before.position[body], self.end.position[body]);
        broad.fill(
            &self.scene.bodies.solid,
            |body| self.scene.bodies.swept_box(body, way(body).0, way(body).1),
            |body| {
                self.scene
                    .bodies
                    .swept_front(body, way(body).0, way(body).1)
            },
        );
        let near = &mut self.memory.near;
        near.clear();
        broad.each_pair(|i, j| near.push((i, j)));
        self.memory.broad = broad;
    }

    fn is_few(&self) -> bool {
        self.scene.bodies.solid.len() <= FEW
    }

    /// Resolves collisions and puts bodies back until no pair collides.
    fn bounce_all(&mut self) {
        // Taken out of the memory while `self` is changed.
        let mut meetings = mem::take(&mut self.memory.meetings);
        let mut group = mem::take(&mut self.memory.group);
        let mut is_back = mem::take(&mut self.memory.is_back);
        let mut put_back = mem::take(&mut self.memory.put_back);
        is_back.clear();
        is_back.resize(self.scene.bodies.len(), false);
        let pairs = self.memory.meeting.iter();
        meetings.extend(pairs.map(|&pair| self.meeting_of(pair, &is_back)));
        while let Some(first) = next(&mut meetings, f64::INFINITY, &is_back) {
            // Equal times, up to rounding.
            let until = first.time + 4.0 * f64::EPSILON * first.time;
            group.push(first);
            while let Some(meeting) = next(&mut meetings, until, &is_back) {
                group.push(meeting);
            }
            self.record.enter(Phase::Respond);
            self.exchange_at_once(&group);
            self.record.enter(Phase::Narrow);
            for body in group
                .drain(..)
                .flat_map(|meeting| [meeting.bodies.0, meeting.bodies.1])
            {
                if !mem::replace(&mut is_back[body], true) {
                    self.put_back(body);
                    put_back.push(body);
                }
            }
            for body in put_back.drain(..) {
                self.each_near(body, |other| {
                    // At the start of the step no bodies met.
                    if !is_back[other] && self.collides(body, other) {
                        let pair = (body.min(other), body.max(other));
                        meetings.push(self.meeting_of(pair, &is_back));
                    }
                });
            }
        }
        let discrete = &mut self.memory;
        (discrete.meetings, discrete.group) = (meetings, group);
        (discrete.is_back, discrete.put_back) = (is_back, put_back);
    }

    /// Puts a body back to its position and rotation at the start of the step.
    fn put_back(&mut self, body: usize) {
        self.end.position[body] = self.scene.before.position[body];
        if let Some(slot) = self.scene.bodies.turners.slot(body) {
            self.end.turned[slot].rotation = self.scene.before.turned[slot].rotation;
        }
    }

    /// Visits every other body whose box meets that of a body during the step.
    fn each_near(&self, body: usize, mut found: impl FnMut(usize)) {
        if self.is_few() {
            let others = self.scene.bodies.solid.iter().copied();
            others.filter(|&other| other != body).for_each(found);
        } else {
            self.memory.broad.each_partner(body, &mut found);
        }
    }

    /// Whether two bodies meet that were apart at the start of the step.
    fn collides(&self, i: usize, j: usize) -> bool {
        self.scene.may_collide(i, j) && self.scene.meet(self.end, i, j)
    }

    fn meeting_of(&self, (i, j): (usize, usize), is_back: &[bool]) -> Meeting {
        let were_back = (is_back[i], is_back[j]);
        let (contact, near) = match self.scene.bodies.pair_tumbles(i, j) {
            true => self.turning_contact_on_way((i, j), were_back),
            false => (self.scene.contact_on_way(self.end, i, j), 0.0),
        };
        Meeting {
            time: contact.as_ref().map_or(1.0, |contact| contact.time),
            bodies: (i, j),
            were_back,
            contact,
            near,
        }
    }

    /// Resolves the collisions of bodies that touch at the same time, by their restitution.
    fn exchange_at_once(&mut self, group: &[Meeting]) {
        if let [only] = group
            && !self.scene.bodies.pair_tumbles(only.bodies.0, only.bodies.1)
        {
            if let Some(contact) = &only.contact {
                self.note_exchange(only.bodies, contact);
            }
            return;
        }
        let touching = group.iter().filter_map(|meeting| self.touching(meeting));
        let mut touching: Vec<Touching> = touching.collect();
        touching.sort_by(Touching::in_order);
        let bodies = sorted(touching.iter().flat_map(|touching| touching.bodies));
        let place = |body: usize| bodies.partition_point(|&other| other < body);
        // An impulse on an immovable body has no effect on others.
        let mut pieces = Pieces::new(bodies.len());
        for Touching { bodies: [i, j], .. } in &touching {
            if self.scene.bodies.is_movable(*i) && self.scene.bodies.is_movable(*j) {
                pieces.join(place(*i), place(*j));
            }
        }
        let mut piece_of = |touching: &Touching| {
            let [i, j] = touching.bodies;
            pieces.first(place(if self.scene.bodies.is_movable(i) {
                i
            } else {
                j
            }))
        };
        let mut in_pieces: Vec<(usize, Touching)> = touching
            .into_iter()
            .map(|touching| (piece_of(&touching), touching))
            .collect();
        in_pieces.sort_by_key(|&(piece, _)| piece);
        for piece in in_pieces.chunk_by(|a, b| a.0 == b.0) {
            let turns = |(_, touching): &(usize, Touching)| {
                let [i, j] = touching.bodies;
                self.scene.bodies.pair_tumbles(i, j)
            };
            match piece {
                _ if piece.iter().any(turns) => self.reflect_turning(piece),
                [(_, only)] => self.note_exchange(only.pair(), &only.contact),
                _ => self.reflect_piece(piece),
            }
        }
    }

    /// The contact of a meeting, seen from the body that is first by its motion.
    fn touching(&self, meeting: &Meeting) -> Option<Touching> {
        let (contact, (i, j)) = (meeting.contact?, meeting.bodies);
        let keys = [self.scene.motion_key(i), self.scene.motion_key(j)];
        let is_turned = keys[1] < keys[0];
        Some(Touching {
            is_turned,
            bodies: if is_turned { [j, i] } else { [i, j] },
            keys: if is_turned { [keys[1], keys[0]] } else { keys },
            normal: if is_turned {
                -contact.normal
            } else {
                contact.normal
            },
            contact,
            near: meeting.near,
            were_back: match is_turned {
                true => [meeting.were_back.1, meeting.were_back.0],
                false => [meeting.were_back.0, meeting.were_back.1],
            },
        })
    }

    fn note_exchange(&mut self, bodies: (usize, usize), contact: &Contact) {
        let impact = self.scene.exchange_on_way(bodies, contact, self.end);
        impact
            .into_iter()
            .for_each(|impact| self.record.note(impact));
    }

    /// Resolves the collisions of a connected set of bodies with the least restitution of all its pairs.
    fn reflect_piece(&mut self, piece: &[(usize, Touching)]) {
        let piece = || piece.iter().map(|(_, touching)| touching);
        // In the order of the contacts, which are sorted by the motion of the bodies.
        let mut bodies: Vec<usize> = Vec::new();
        let mut places: BTreeMap<usize, usize> = BTreeMap::new();
        for body in piece().flat_map(|touching| touching.bodies) {
            places.entry(body).or_insert_with(|| {
                bodies.push(body);
                bodies.len() - 1
            });
        }
        let joined = piece().map(|touching| Joined {
            bodies: (places[&touching.bodies[0]], places[&touching.bodies[1]]),
            normal: touching.normal,
        });
        let joined: Vec<Joined> = joined.collect();
        let restitution = piece()
            .map(|touching| {
                self.scene
                    .bodies
                    .pair_restitution(touching.bodies[0], touching.bodies[1])
            })
            .fold(1.0, f64::min);
        let inverse_mass: Vec<f64> = bodies
            .iter()
            .map(|&body| 1.0 / self.scene.bodies.mass[body])
            .collect();
        let velocity = bodies.iter().map(|&body| self.end.velocity[body]);
        let before: Vec<DVec3> = velocity.collect();
        let mut after = before.clone();
        let impulses = reflect(&joined, &inverse_mass, &mut after, restitution);
        for (&body, &velocity) in bodies.iter().zip(&after) {
            self.end.velocity[body] = velocity;
        }
        for ((touching, joined), impulse) in piece().zip(&joined).zip(impulses) {
            if impulse > 0.0 {
                let speeds = (-joined.opening(&before), joined.opening(&after));
                let (pair, contact) = (touching.pair(), &touching.contact);
                let at = self.scene.on_way(pair, contact, self.end);
                let impact = self.scene.impact(pair, contact, (impulse, speeds), at);
                self.record.note(impact);
            }
        }
    }

    /// Keeps overlapping pairs from approaching, by an elastic impulse along the line of their centres. Returns the
    /// pairs that have not parted.
    fn part_overlapping(&mut self) -> Vec<(usize, usize)> {
        let mut pairs = self.scene.overlaps.pairs.to_vec();
        pairs.retain(|&(i, j)| self.scene.meet(self.end, i, j));
        if !pairs.is_empty() {
            self.exchange_in_overlap(&pairs);
        }
        pairs
    }

    /// Resolves all approaching pairs at once. If several pairs share a body, each pair gets the part of its impulse
    /// with which all parts together are at most one. The velocities are then a mean of velocities that each conserve
    /// the energy, so no energy is gained.
    fn exchange_in_overlap(&mut self, pairs: &[(usize, usize)]) {
        let velocity = &self.end.velocity;
        let closing: Vec<((usize, usize), DVec3)> = pairs
            .iter()
            .filter_map(|&(i, j)| {
                Some((
                    (i, j),
                    self.scene.bodies.line_apart(&self.end.position, (i, j))?,
                ))
            })
            .filter(|&((i, j), normal)| (velocity[j] - velocity[i]).dot(normal) < 0.0)
            .collect();
        let mut shares: BTreeMap<usize, u32> = BTreeMap::new();
        for &((i, j), _) in &closing {
            for body in [i, j]
                .into_iter()
                .filter(|&body| self.scene.bodies.is_movable(body))
            {
                *shares.entry(body).or_insert(0) += 1;
            }
        }
        let (mut changes, mut noted) = (Vec::new(), Vec::new());
        for ((i, j), normal) in closing {
            let centre = |body: usize| self.scene.bodies.centre(&self.end.position, body);
            let point = 0.5 * (centre(i) + centre(j));
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
                // No other pair shares these two bodies.
                self.note_exchange((i, j), &contact);
                continue;
            }
            let velocity = &self.end.velocity;
            let (before, masses) = (
                (velocity[i], velocity[j]),
                (self.scene.bodies.mass[i], self.scene.bodies.mass[j]),
            );
            let restitution = self.scene.bodies.pair_restitution(i, j);
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
        // In an order that depends on the terms alone.
        changes.sort_by_cached_key(|&(body, change)| (body, order::of_vector(change)));
        for of_body in changes.chunk_by(|a, b| a.0 == b.0) {
            let change: DVec3 = of_body.iter().map(|&(_, change)| change).sum();
            self.end.velocity[of_body[0].0] += change;
        }
        for ((i, j), contact, impulse, closing) in noted {
            let velocity = &self.end.velocity;
            let parting = (velocity[j] - velocity[i]).dot(contact.normal);
            let at = self.scene.on_way((i, j), &contact, self.end);
            let exchanged = (impulse, (closing, parting));
            let impact = self.scene.impact((i, j), &contact, exchanged, at);
            self.record.note(impact);
        }
    }
}

/// The contact of two bodies.
struct Touching {
    /// The body that is first by its motion, and the other one.
    bodies: [usize; 2],
    keys: [Key; 2],
    /// From the first body to the other.
    normal: DVec3,
    /// The contact, seen from the body of lower index.
    contact: Contact,
    /// For these bodies, as in [`Meeting`].
    near: f64,
    were_back: [bool; 2],
    /// Whether the first body has the higher index.
    is_turned: bool,
}

impl Touching {
    fn pair(&self) -> (usize, usize) {
        let [first, second] = self.bodies;
        match self.is_turned {
            true => (second, first),
            false => (first, second),
        }
    }

    fn in_order(&self, other: &Touching) -> Ordering {
        let keys = self.keys.cmp(&other.keys);
        keys.then_with(|| order::of_vector(self.normal).cmp(&order::of_vector(other.normal)))
    }
}

/// Bodies in the order of their indices, each once.
fn sorted(bodies: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut bodies: Vec<usize> = bodies.collect();
    bodies.sort_unstable();
    bodies.dedup();
    bodies
}

/// The next meeting no later than a time whose bodies have not been put back since it was found.
fn next(meetings: &mut BinaryHeap<Meeting>, until: f64, is_back: &[bool]) -> Option<Meeting> {
    while meetings.peek()?.time <= until {
        let meeting = meetings.pop()?;
        let (i, j) = meeting.bodies;
        if meeting.were_back == (is_back[i], is_back[j]) {
            return Some(meeting);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use alloc::{sync::Arc, vec::Vec};

    use super::*;
    use crate::{
        Body, BodyKind, Collision, Settings, Shape,
        test_meshes::{cube, sphere},
        test_random::Random,
    };

    /// Balls, cubes and bumpy balls in a room of walls; some are fast, some immovable, some in overlap.
    pub(in crate::world) fn crowd(seed: u64, count: usize, collision: Collision) -> World {
        let mut random = Random(seed);
        let (cube, bumpy) = (Arc::new(cube()), Arc::new(sphere(5)));
        let mut world = World::new(Settings {
            collision,
            ..Settings::default()
        })
        .unwrap();
        let half = 3 + count as i64 / 20;
        for normal in [DVec3::Y, DVec3::NEG_Y, DVec3::new(1.0, 0.25, 0.0)] {
            let wall = Body {
                shape: Some(Shape::HalfSpace { normal }),
                position: -(half as f64 + 0.5) * normal,
                kind: BodyKind::Static,
                ..Body::default()
            };
            world.add(wall).unwrap();
        }
        for i in 0..count {
            let is_immovable = i % 11 == 10;
            let speed = match i % 7 {
                _ if is_immovable => 0.0,
                0 => 0.4,
                _ => 0.05,
            };
            world
                .add(Body {
                    shape: Some(match i % 3 {
                        0 => Shape::Sphere { radius: 0.25 },
                        1 => cube.clone().into(),
                        _ => bumpy.clone().into(),
                    }),
                    position: 1e-2 * random.vector(100 * half),
                    velocity: speed * random.vector(100),
                    mass: 1.0 + (i % 4) as f64,
                    kind: if is_immovable {
                        BodyKind::Static
                    } else {
                        BodyKind::Dynamic
                    },
                    restitution: if i % 5 == 0 { 0.5 } else { 1.0 },
                    ..Body::default()
                })
                .unwrap();
        }
        world
    }

    fn pairs(world: &World, is: impl Fn(usize, usize) -> bool) -> Vec<(usize, usize)> {
        let pairs = (0..world.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        pairs.filter(|&(i, j)| is(i, j)).collect()
    }

    /// The pairs that meet and were apart, tested one by one.
    fn colliding(world: &mut World) -> Vec<(usize, usize)> {
        let pairs = pairs(world, |_, _| true);
        let step = world.discrete_step();
        let colliding = pairs.into_iter().filter(|&(i, j)| step.collides(i, j));
        colliding.collect()
    }

    #[test]
    fn pairs_that_meet_are_those_of_brute_force() {
        let (mut met, mut back) = (0, 0);
        for (seed, count) in (1..).zip([2, 12, 20, 60, 150]) {
            for collision in [Collision::Bvh, Collision::Naive] {
                let mut world = crowd(seed, count, collision);
                for _ in 0..30 {
                    world.seek_overlaps();
                    // Steps up to the point where collisions are detected.
                    mem::swap(&mut world.previous, &mut world.current);
                    world.integrate().unwrap();
                    let mut step = world.discrete_step();
                    step.find_meeting_pairs();
                    let mut meeting = step.memory.meeting.clone();
                    meeting.sort_unstable_by_key(|&(i, j)| (j, i));
                    assert_eq!(meeting, colliding(&mut world));
                    met += meeting.len();
                    // Pairs that may meet after one or both were put back must be near.
                    let there = [world.previous.clone(), world.current.clone()];
                    for (one, other) in [(0, 0), (0, 1), (1, 0)] {
                        let mut moved = world.clone();
                        let meet = |moved: &mut World, i: usize, j: usize| {
                            moved.current.position[i] = there[one].position[i];
                            moved.current.position[j] = there[other].position[j];
                            let at = &moved.current.position;
                            moved.bodies.meet_at(i, j, at[j] - at[i])
                        };
                        for (i, j) in pairs(&world, |_, _| true) {
                            if meet(&mut moved, i, j) {
                                let mut is_near = false;
                                world
                                    .discrete_step()
                                    .each_near(i, |near| is_near |= near == j);
                                assert!(is_near, "{i} {j}");
                                back += 1;
                            }
                        }
                    }
                    world.collide_discretely();
                    world.elapsed.steps += 1;
                }
            }
        }
        assert!(met > 150 && back > 500, "{met} {back}");
    }

    #[test]
    fn no_two_meet_after_a_step_and_none_gains_energy() {
        let mut impacts = 0;
        for (seed, count) in (1..).zip([12, 20, 60, 150]) {
            let mut world = crowd(seed, count, Collision::Bvh);
            for _ in 0..60 {
                let energy = world.kinetic_energy();
                world.step().unwrap();
                assert_eq!(colliding(&mut world), [], "{seed}");
                assert!(world.kinetic_energy() <= energy * (1.0 + 1e-12), "{seed}");
            }
            impacts += world.impacts();
        }
        assert!(impacts > 150, "{impacts}");
    }

    #[test]
    fn a_copy_goes_on_to_the_bit_as_the_world_does() {
        for collision in [Collision::Bvh, Collision::Continuous] {
            let mut world = crowd(3, 40, collision);
            for step in 0..40 {
                let mut copy = world.clone();
                assert_eq!(copy.state_hash(), world.state_hash());
                world.step().unwrap();
                copy.step().unwrap();
                assert_eq!(copy.state_hash(), world.state_hash(), "{step}");
            }
        }
    }
}
