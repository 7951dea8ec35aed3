//! The forces of turning bodies in contact ([`super::turning_rest`]).
//!
//! They are the forces after which no gap is less than its room, at the end of the step and at times within it, and
//! no gap begins to close: `0 <= f ⟂ g(τ) - room >= 0`. Here `g(t)` is the gap of the touching features in the true
//! motion of the bodies. Newton's method finds the forces, by a sequence of complementarity problems.
//!
//! **Energy.** A force does the work `f D`, where `D(s)` is the distance that its point moves along it until the time
//! `s`. With the lever arms and normals of the start `D(s) = g(s) - g(0) - c s²/2`, and with those of the end
//! `g(s) - g(0) + c (τ s - s²/2)`, up to terms of third order, where `c` is the second derivative of the gap if the
//! bodies kept their velocities. Each contact takes the one with which it does no work, except for the room that it
//! lacks, at whatever time the step is cut: contacts never give energy to second order. For this the lever arms of
//! the end are those of the points that are opposite each other then, not of those that were opposite at the start.
//! The rest is of third order, or arises when a contact opens. It is known, because the bodies are on parabolas, and
//! forces that give energy are rejected ([`Pressing::find`]).
//!
//! Flat faces, and bodies that do not turn, have `c = 0` and are exact. Otherwise the loss is `f |c| τ²/2` in a step,
//! and vanishes with its length.

use alloc::{vec, vec::Vec};
use glam::{DQuat, DVec3};

use super::super::state::Turned;
use super::turning_response::Touching;
use crate::{
    impulse::arms::{self, Arms, Twist, Yielding},
    rotation::Flight,
};

/// The times at which bodies are examined while forces are constant, as fractions of the duration: its start, its
/// end, and times within.
pub(super) const PARTS: [f64; 4] = [0.0, 1.0, 0.5, 0.125];

/// The greatest number of rounds in which forces are computed. A gap that is still too small then leads to an early
/// impact.
pub(super) const ROUNDS: usize = 12;

/// The greatest angle by which a body turns while forces are constant, rad.
const MOST_TURN: f64 = 1.0;

/// A contact, given by a point of each body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchored {
    pub(super) bodies: (usize, usize),
    /// From the centres of mass, in the frames of the shapes, m.
    pub(super) points: [DVec3; 2],
    /// In the frame of the owner, the body to whose surface the normal belongs.
    pub(super) normal: DVec3,
    pub(super) owner: usize,
    /// The directions of crossing edges, in the frames of their shapes.
    pub(super) edges: Option<[DVec3; 2]>,
    pub(super) room: f64,
}

/// The motion of a body of an island.
pub(super) struct Mover {
    pub(super) body: usize,
    pub(super) turns: Option<Turns>,
    pub(super) position: DVec3,
    pub(super) velocity: DVec3,
    /// The inverse mass, 1/kg; zero for an immovable body.
    pub(super) mass: f64,
    /// The rotations of the body after [`PARTS`] of the time, if contacts do not turn it.
    pub(super) rotations: [DQuat; PARTS.len()],
}

/// The data of a turning body that contacts move.
pub(super) struct Turns {
    pub(super) slot: usize,
    /// The acceleration and the torque of forces other than contacts, m/s² and N m.
    pub(super) pull: DVec3,
    pub(super) torque: DVec3,
    pub(super) moments: DVec3,
    pub(super) axes: DQuat,
    pub(super) turned: Turned,
}

/// The contacts of an island and the motion of its bodies, without the forces that are sought.
pub(super) struct Pressing<'a> {
    /// The duration for which forces are constant, s.
    pub(super) length: f64,
    pub(super) movers: Vec<Mover>,
    /// How impulses change mean velocities.
    pub(super) yielding: Vec<Yielding>,
    pub(super) touching: &'a [Touching],
    pub(super) anchored: Vec<Anchored>,
    /// The gap that each contact keeps, m.
    pub(super) room: Vec<f64>,
    pub(super) contacts: &'a [Arms],
}

/// The contact forces, with the lever arms and normals along which they push.
pub(super) struct Forces {
    /// The impulse over the whole duration, N s.
    pub(super) impulse: Vec<f64>,
    pub(super) contacts: Vec<Arms>,
}

/// A contact at a later time.
pub(super) struct Later {
    pub(super) gap: f64,
    pub(super) normal: DVec3,
    /// From the centres of mass, m.
    pub(super) arms: (DVec3, DVec3),
}

/// A pose.
#[derive(Clone, Copy)]
pub(super) struct At {
    pub(super) position: DVec3,
    pub(super) rotation: DQuat,
}

impl Anchored {
    /// A contact in the frames of its shapes; `inverse` rotates from the world into these frames.
    pub(super) fn of(touching: &Touching, inverse: [DQuat; 2]) -> Anchored {
        Anchored {
            bodies: touching.bodies,
            points: [inverse[0] * touching.arms.0, inverse[1] * touching.arms.1],
            normal: inverse[touching.owner] * touching.normal,
            owner: touching.owner,
            edges: touching
                .edges
                .map(|[e, f]| [inverse[0] * e, inverse[1] * f]),
            room: touching.room,
        }
    }

    /// The contact in given poses: a vertex over the plane of a face, or the nearest points of two lines.
    pub(super) fn later(&self, at: [At; 2]) -> Later {
        let [first, second] = at;
        let mut arms = (
            first.rotation * self.points[0],
            second.rotation * self.points[1],
        );
        let between = second.position - first.position;
        let apart = between + arms.1 - arms.0;
        let owned = at[self.owner].rotation * self.normal;
        let edges = self
            .edges
            .map(|[e, f]| [first.rotation * e, second.rotation * f]);
        let across = edges.and_then(|[e, f]| e.cross(f).try_normalize());
        let normal = across.map_or(owned, |across| across.dot(owned).signum() * across);
        let gap = apart.dot(normal);
        let slid = apart - gap * normal;
        match edges.filter(|_| across.is_some()) {
            None if self.owner == 0 => arms.0 += slid,
            None => arms.1 -= slid,
            Some([e, f]) => {
                // Along each line by the distance that the other line has slid across it.
                let sine = e.cross(f).dot(normal);
                arms.0 += slid.cross(f).dot(normal) / sine * e;
                arms.1 += slid.cross(e).dot(normal) / sine * f;
            }
        }
        Later { gap, normal, arms }
    }
}

/// The motion of a body at the start.
#[derive(Clone, Copy, Default)]
pub(super) struct Rates {
    pub(super) velocity: DVec3,
    pub(super) acceleration: DVec3,
    pub(super) spin: DVec3,
    pub(super) turning: DVec3,
}

impl Rates {
    /// The velocity and acceleration of a point at a lever arm.
    pub(super) fn at(&self, arm: DVec3) -> (DVec3, DVec3) {
        let swept = self.spin.cross(arm);
        let bent = self.turning.cross(arm) + self.spin.cross(swept);
        (self.velocity + swept, self.acceleration + bent)
    }
}

/// The motion of the bodies of an island under given forces.
pub(super) struct Course {
    /// By body, the motion at the start.
    pub(super) rates: Vec<Rates>,
    /// By body, the poses after [`PARTS`] of the time.
    pub(super) at: Vec<[At; PARTS.len()]>,
    /// By body, the angle by which it turns, as a vector: the integral of its angular velocity.
    pub(super) turn: Vec<DVec3>,
}

impl Pressing<'_> {
    /// The impulse and torque that the forces give each body.
    pub(super) fn pushes(&self, forces: &Forces) -> Vec<(DVec3, DVec3)> {
        let mut pushes = vec![(DVec3::ZERO, DVec3::ZERO); self.movers.len()];
        for (contact, &impulse) in forces.contacts.iter().zip(&forces.impulse) {
            let push = impulse * contact.normal;
            let (i, j) = contact.bodies;
            pushes[i].0 -= push;
            pushes[j].0 += push;
            pushes[i].1 -= contact.arms.0.cross(push) / self.length;
            pushes[j].1 += contact.arms.1.cross(push) / self.length;
        }
        pushes
    }

    /// The motion of the bodies under given forces; `None` if a body turns so far that nothing can be said of its
    /// contacts.
    fn course(&self, forces: &Forces) -> Option<Course> {
        let pushes = self.pushes(forces);
        let mut course = Course {
            rates: Vec::with_capacity(self.movers.len()),
            at: Vec::with_capacity(self.movers.len()),
            turn: Vec::with_capacity(self.movers.len()),
        };
        for (mover, (impulse, torque)) in self.movers.iter().zip(pushes) {
            let mut at = mover.rotations.map(|rotation| At {
                position: mover.position,
                rotation,
            });
            let times = PARTS.map(|part| part * self.length);
            let mut turn = DVec3::ZERO;
            let mut rates = Rates::default();
            match &mover.turns {
                None => {
                    let velocity = mover.velocity + mover.mass * impulse;
                    rates.velocity = velocity;
                    for (at, t) in at.iter_mut().zip(times) {
                        at.position += t * velocity;
                    }
                }
                Some(turns) => {
                    let acceleration = turns.pull + mover.mass / self.length * impulse;
                    let Turned { rotation, momentum } = turns.turned;
                    let torque = turns.torque + torque;
                    let most = momentum.length() + self.length * torque.length();
                    if self.length * most > MOST_TURN * turns.moments.min_element() {
                        return None;
                    }
                    let flight =
                        Flight::new(turns.moments, rotation, momentum, torque, self.length);
                    let flight = flight.ok()?;
                    let poses = times.map(|t| flight.at(t));
                    for ((at, t), pose) in at.iter_mut().zip(times).zip(&poses) {
                        at.position += t * (mover.velocity + 0.5 * t * acceleration);
                        at.rotation = (pose.rotation * turns.axes.inverse()).normalize();
                    }
                    let [start, end, middle, _] = poses;
                    rates = Rates {
                        velocity: mover.velocity,
                        acceleration,
                        spin: start.spin,
                        turning: start.acceleration,
                    };
                    // Simpson's rule.
                    turn = self.length / 6.0 * (start.spin + 4.0 * middle.spin + end.spin);
                }
            }
            course.rates.push(rates);
            course.at.push(at);
            course.turn.push(turn);
        }
        Some(course)
    }

    /// A contact after the given entry of [`PARTS`].
    pub(super) fn later(&self, k: usize, course: &Course, part: usize) -> Later {
        let (i, j) = self.contacts[k].bodies;
        self.anchored[k].later([course.at[i][part], course.at[j][part]])
    }

    /// Twice the growth of a gap until the earliest time at which gaps are examined, divided by the square of that
    /// time: the second derivative of the gap, plus the part of the opening speed.
    pub(super) fn growth(&self, k: usize, course: &Course) -> f64 {
        let contact = &self.contacts[k];
        let n = contact.normal;
        let of = [
            &course.rates[contact.bodies.0],
            &course.rates[contact.bodies.1],
        ];
        let (first, second) = (of[0].at(contact.arms.0), of[1].at(contact.arms.1));
        let turned = match self.touching[k].edges {
            None => of[self.touching[k].owner].spin.cross(n),
            Some([e, f]) => {
                let across = e.cross(f);
                let rate = of[0].spin.cross(e).cross(f) + e.cross(of[1].spin.cross(f));
                let along = (across.dot(n)).recip() * rate;
                along - along.dot(n) * n
            }
        };
        let opening = second.0 - first.0;
        let bend = n.dot(second.1 - first.1) + 2.0 * turned.dot(opening);
        bend + 2.0 * n.dot(opening) / (PARTS[PARTS.len() - 1] * self.length)
    }

    /// Whether neither body of a contact turns. Then impulses change their velocities at once, and their gap from
    /// then on.
    fn is_straight(&self, k: usize) -> bool {
        let turns = |place: usize| {
            let mover = &self.movers[place];
            mover.turns.is_some() || mover.rotations.iter().any(|r| *r != mover.rotations[0])
        };
        let (i, j) = self.contacts[k].bodies;
        !turns(i) && !turns(j)
    }

    /// The opening speed of such a contact, m/s.
    fn parting(&self, k: usize, course: &Course) -> f64 {
        let contact = &self.contacts[k];
        let (i, j) = contact.bodies;
        let relative = course.rates[j].velocity - course.rates[i].velocity;
        contact.normal.dot(relative)
    }

    /// The distance that the point of a contact moves along a constant direction with constant lever arms, m.
    pub(super) fn gets(&self, contact: &Arms, course: &Course) -> f64 {
        let of = |body: usize, arm: DVec3| {
            let at = &course.at[body];
            at[1].position - at[0].position + course.turn[body].cross(arm)
        };
        let (i, j) = contact.bodies;
        contact
            .normal
            .dot(of(j, contact.arms.1) - of(i, contact.arms.0))
    }

    /// Chooses for each contact the lever arms and normal of the start or of the end, whichever do less work, unless
    /// the contact does no work. Returns whether any has changed.
    pub(super) fn choose(&self, forces: &mut Forces, course: &Course) -> bool {
        let mut is_changed = false;
        for k in 0..self.contacts.len() {
            let is_active = forces.impulse[k] > 0.0;
            if !is_active || self.gets(&forces.contacts[k], course) <= self.allowed(k) {
                continue;
            }
            let Later { normal, arms, .. } = self.later(k, course, 1);
            let start = self.contacts[k];
            let end = Arms {
                normal,
                arms,
                ..start
            };
            let (by_start, by_end) = (self.gets(&start, course), self.gets(&end, course));
            let chosen = if by_end < by_start { end } else { start };
            is_changed |= chosen != forces.contacts[k];
            forces.contacts[k] = chosen;
        }
        is_changed
    }

    /// The energy that contacts give to bodies, J, without the work that restores the room that they lack.
    fn gain(&self, forces: &Forces, course: &Course) -> f64 {
        let pairs = forces.contacts.iter().zip(&forces.impulse).enumerate();
        let given = pairs.map(|(k, (contact, impulse))| {
            impulse / self.length * (self.gets(contact, course) - self.allowed(k))
        });
        given.sum()
    }

    /// The distance that a contact may move along its force, m: the room that it lacks, and a slack of rounding size.
    fn allowed(&self, k: usize) -> f64 {
        let touching = &self.touching[k];
        (self.room[k] - touching.gap).max(0.0) + 0.25 * touching.room
    }

    /// Zero forces.
    pub(super) fn no_forces(&self) -> Forces {
        Forces {
            impulse: vec![0.0; self.touching.len()],
            contacts: self.contacts.to_vec(),
        }
    }

    /// The forces after which no gap is less than it must be, and whether they are exact or only near; `None` if the
    /// forces would give energy or a body would turn too far.
    pub(super) fn find(&self) -> Option<(Forces, bool)> {
        let mut forces = self.no_forces();
        for round in 0..ROUNDS {
            let course = self.course(&forces)?;
            if round == 1 {
                self.choose(&mut forces, &course);
                continue;
            }
            let (wanted, is_found) = self.wanted(&forces, &course);
            if is_found {
                let gain = self.gain(&forces, &course);
                if gain <= 0.0 || !self.choose(&mut forces, &course) {
                    return (gain <= 0.0).then_some((forces, true));
                }
            }
            forces.impulse = arms::multipliers(&forces.contacts, &self.yielding, &wanted);
        }
        let course = self.course(&forces)?;
        (self.gain(&forces, &course) <= 0.0).then_some((forces, false))
    }

    /// The mean speed at which each contact must open by forces, m/s, if contacts influence each other as in the
    /// present poses; and whether the present forces are the solution.
    fn wanted(&self, forces: &Forces, course: &Course) -> (Vec<f64>, bool) {
        let widest = self.touching.iter().map(|touching| touching.room);
        let widest = widest.fold(0.0, f64::max);
        let mut pushed = vec![Twist::default(); self.movers.len()];
        arms::push(
            &forces.contacts,
            &self.yielding,
            &mut pushed,
            &forces.impulse,
        );
        let mut is_found = true;
        let wanted = (0..self.touching.len())
            .map(|k| {
                let (missing, room) = match self.is_straight(k) {
                    true => (-self.length * self.parting(k, course), widest),
                    false => (self.missing(k, course), self.touching[k].room),
                };
                let slack = 0.25 * room;
                is_found &= missing <= slack && (forces.impulse[k] == 0.0 || missing >= -slack);
                forces.contacts[k].opening(&pushed) + missing / self.length
            })
            .collect();
        (wanted, is_found)
    }

    /// The greatest distance that a gap lacks at the examined times, m, scaled to the end of the duration; negative
    /// if the gap is never too small.
    fn missing(&self, k: usize, course: &Course) -> f64 {
        let (from, room) = (self.touching[k].gap.min(self.room[k]), self.room[k]);
        let at_first = -0.5 * self.length * self.length * self.growth(k, course);
        let later = PARTS.iter().enumerate().skip(1);
        let later = later.map(|(place, part)| {
            let share = part * part;
            let least = from + share * (room - from);
            (least - self.later(k, course, place).gap) / share
        });
        later.fold(at_first, f64::max)
    }
}
