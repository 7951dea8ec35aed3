//! Turning bodies at the end of a step of a discrete mode.
//!
//! A pair that meets has touched during the step: both centres of mass move on straight lines, and the rotations
//! follow the flight of the step. Impulses act at all features of the first contact at once, with lever arms:
//! restitution along each normal, no friction. Both bodies go back to the start of the step, with their rotation
//! there.
//!
//! The energy of rotation depends on the rotation of a body. So a body that goes back with an angular momentum `L` gets
//! an angular momentum parallel to `L` there, of the length that has the energy after the impact. For a cube or a ball,
//! whose moments are equal, this is `L` itself.
//!
//! If no feature closes, which only rounding explains, the relative motion itself is reversed, as for bodies that do
//! not turn: the relative velocity of the two, and their spins. Otherwise the next step would be the same.

use alloc::{collections::BTreeMap, vec::Vec};
use glam::{DMat3, DQuat, DVec3};

use super::{DiscreteStep, Touching};
use crate::{
    collide::{
        Contact,
        turning::{Moving, NEAR, Turning, features_within, first_contact},
    },
    impulse::{
        self,
        arms::{self, Arms, Twist, Yielding},
    },
    rotation::{Flight, spin},
};

/// Features touch if their distance is at most this times that of a contact. An impact is found earlier than the first
/// contact by less than this distance.
const REACH: f64 = 64.0;

/// A body at an impact.
struct Placed {
    body: usize,
    /// The rotation of a turning body there: from principal axes into the world.
    axes: DQuat,
    was_back: bool,
}

impl DiscreteStep<'_> {
    /// The straight motion of a body during the step; a body that was put back stays at its start.
    fn way<'a>(&'a self, body: usize, flight: Option<&'a Flight>) -> Option<Moving<'a>> {
        let from = self.scene.before.position[body];
        let velocity = (self.end.position[body] - from) / self.scene.settings.dt;
        let turners = &self.scene.bodies.turners;
        let turning = match flight.zip(turners.slot(body)) {
            Some((flight, slot)) => Turning::Flight(flight, turners.inertia[slot].axes()),
            None => Turning::Still(self.shape_rotation(body)),
        };
        self.scene.bodies.need_bvh(body);
        let motion = (from, velocity, DVec3::ZERO);
        self.scene.bodies.moving(body, motion, turning)
    }

    /// The rotation of a body that does not turn during the step: from its shape into the world.
    fn shape_rotation(&self, body: usize) -> DQuat {
        match self.scene.bodies.tumbles(body) {
            true => self.scene.bodies.rotation_in(self.scene.before, body),
            false => DQuat::IDENTITY,
        }
    }

    /// The flight of a body's rotation during the step; `None` if the body does not tumble or was put back.
    fn flight(&self, body: usize, was_back: bool) -> Option<Flight> {
        let bodies = self.scene.bodies;
        if was_back || !bodies.tumbles(body) {
            return None;
        }
        let slot = bodies.turners.slot(body)?;
        let before = self.scene.before.turned[slot];
        let (moments, torque) = (
            bodies.turners.inertia[slot].moments(),
            bodies.turners.torque[slot],
        );
        let dt = self.scene.settings.dt;
        // The step has computed this flight before without an error.
        Flight::new(moments, before.rotation, before.momentum, torque, dt).ok()
    }

    /// The first contact of two bodies of which one turns, in the world, and the distance up to which features touch,
    /// m.
    pub(super) fn turning_contact_on_way(
        &self,
        (i, j): (usize, usize),
        were_back: (bool, bool),
    ) -> (Option<Contact>, f64) {
        let flights = (self.flight(i, were_back.0), self.flight(j, were_back.1));
        let ways = (
            self.way(i, flights.0.as_ref()),
            self.way(j, flights.1.as_ref()),
        );
        let Some((a, b)) = ways.0.zip(ways.1) else {
            return (None, 0.0);
        };
        let dt = self.scene.settings.dt;
        let (at, motion) = (&self.end.position, b.velocity - a.velocity);
        if let Some(touch) = first_contact(&a, &b, dt) {
            let contact = Contact {
                time: (touch.time / dt).min(1.0),
                point: a.position + touch.time * a.velocity + touch.points[0],
                normal: touch.normal,
                feature: None,
                face: None,
            };
            return (Some(contact), touch.near);
        }
        // If rounding hides the place of the contact, use the end of the step.
        let line = self.scene.bodies.line_apart(at, (i, j));
        let normal = (-motion).try_normalize().or(line).unwrap_or(DVec3::X);
        let contact = Contact {
            time: 1.0,
            point: 0.5 * (at[i] + at[j]),
            normal,
            feature: None,
            face: None,
        };
        let size = |body: usize| self.scene.bodies.extent_however_turned(body).farthest;
        let finite = |size: f64| if size.is_finite() { size } else { 0.0 };
        let size = finite(size(i)) + finite(size(j)) + (at[j] - at[i]).length();
        (Some(contact), NEAR * f64::EPSILON * size)
    }

    /// Resolves the collisions of a connected set of bodies, of which some turn, with the least restitution of all
    /// its pairs.
    pub(super) fn reflect_turning(&mut self, piece: &[(usize, Touching)]) {
        let piece: Vec<&Touching> = piece.iter().map(|(_, touching)| touching).collect();
        let (placed, places) = self.placed(&piece);
        let mut contacts: Vec<Arms> = Vec::new();
        let mut ends: Vec<usize> = Vec::new();
        for touching in &piece {
            let bodies = (places[&touching.bodies[0]], places[&touching.bodies[1]]);
            let arms = self.arms(touching, bodies);
            contacts.extend(arms);
            ends.push(contacts.len());
        }
        let restitution = piece
            .iter()
            .map(|touching| {
                let [i, j] = touching.bodies;
                self.scene.bodies.pair_restitution(i, j)
            })
            .fold(1.0, f64::min);
        let yielding: Vec<Yielding> = placed.iter().map(|placed| self.yielding(placed)).collect();
        let before: Vec<Twist> = placed.iter().map(|placed| self.twist(placed)).collect();
        let mut after = before.clone();
        let given = arms::reflect(&contacts, &yielding, &mut after, restitution);
        let is_given = given.iter().any(|&given| given > 0.0);
        if !is_given && !placed.iter().any(|placed| placed.was_back) {
            piece.iter().for_each(|touching| self.turn_back(touching));
            return;
        }
        for (placed, after) in placed.iter().zip(&after) {
            if self.scene.bodies.is_movable(placed.body) {
                self.end.velocity[placed.body] = after.velocity;
            }
        }
        self.give_momentum(&placed, &contacts, &given);
        let mut first = 0;
        for (touching, end) in piece.iter().zip(ends) {
            let parts = || (first..end).map(|k| (&contacts[k], given[k]));
            let impulse: f64 = parts().map(|(_, given)| given).sum();
            if impulse > 0.0 {
                let mean = |of: &dyn Fn(&Arms) -> f64| {
                    let weighed = parts().map(|(arms, given)| given * of(arms));
                    weighed.sum::<f64>() / impulse
                };
                let speeds = (
                    mean(&|arms| -arms.opening(&before)),
                    mean(&|arms| arms.opening(&after)),
                );
                self.note_turning(touching, (impulse, speeds));
            }
            first = end;
        }
    }

    fn note_turning(&mut self, touching: &Touching, exchanged: (f64, (f64, f64))) {
        let (pair, contact) = (touching.pair(), &touching.contact);
        let at = self.scene.on_way(pair, contact, self.end);
        let impact = self.scene.impact(pair, contact, exchanged, at);
        self.record.note(impact);
    }

    /// The bodies of some contacts, each once, with their rotations at the first contact, and the index of each body
    /// in this list.
    fn placed(&self, piece: &[&Touching]) -> (Vec<Placed>, BTreeMap<usize, usize>) {
        let mut placed: Vec<Placed> = Vec::new();
        let mut places: BTreeMap<usize, usize> = BTreeMap::new();
        for touching in piece {
            for (&body, was_back) in touching.bodies.iter().zip(touching.were_back) {
                places.entry(body).or_insert_with(|| {
                    placed.push(Placed {
                        body,
                        axes: self.axes_at(body, was_back, touching.contact.time),
                        was_back,
                    });
                    placed.len() - 1
                });
            }
        }
        (placed, places)
    }

    /// The rotation of a body at a part of the step: from principal axes into the world.
    fn axes_at(&self, body: usize, was_back: bool, part: f64) -> DQuat {
        let Some(slot) = self.scene.bodies.turners.slot(body) else {
            return DQuat::IDENTITY;
        };
        match self.flight(body, was_back) {
            Some(flight) => flight.rotation_at(part * self.scene.settings.dt),
            None => self.scene.before.turned[slot].rotation,
        }
    }

    /// The contacts of a pair at all features that touch.
    fn arms(&self, touching: &Touching, bodies: (usize, usize)) -> Vec<Arms> {
        let (i, j) = touching.pair();
        let contact = &touching.contact;
        let at = self.scene.on_way((i, j), contact, self.end).positions;
        let point = ([contact.point - at.0; 2], contact.normal);
        let mut found: Vec<([DVec3; 2], DVec3)> = Vec::new();
        if self.scene.bodies.pair_tumbles(i, j) {
            let back = match touching.is_turned {
                true => [touching.were_back[1], touching.were_back[0]],
                false => touching.were_back,
            };
            let still = |body: usize, place: DVec3, was_back: bool| {
                let rotation = match self.scene.bodies.turners.slot(body) {
                    Some(slot) if self.scene.bodies.tumbles(body) => {
                        let axes = self.axes_at(body, was_back, contact.time);
                        axes * self.scene.bodies.turners.inertia[slot].axes().inverse()
                    }
                    _ => DQuat::IDENTITY,
                };
                let motion = (place, DVec3::ZERO, DVec3::ZERO);
                let turning = Turning::Still(rotation.normalize());
                self.scene.bodies.moving(body, motion, turning)
            };
            let pair = still(i, at.0, back[0]).zip(still(j, at.1, back[1]));
            if let Some((a, b)) = pair {
                let near = touching.near;
                let all = features_within(&a, &b, (0.5 * near, REACH * near));
                found.extend(all.into_iter().map(|point| (point.points, point.normal)));
            }
        }
        if !found.iter().any(|(_, normal)| normal.dot(point.1) > 0.5) {
            found.push(point);
        }
        let between = at.1 - at.0;
        let arms = found.into_iter().map(|(points, normal)| {
            let arms = [points[0], points[1] - between];
            match touching.is_turned {
                true => (-normal, (arms[1], arms[0])),
                false => (normal, (arms[0], arms[1])),
            }
        });
        arms.map(|(normal, arms)| Arms {
            bodies,
            normal,
            arms,
        })
        .collect()
    }

    fn yielding(&self, placed: &Placed) -> Yielding {
        let bodies = self.scene.bodies;
        if !bodies.is_movable(placed.body) {
            return Yielding {
                mass: 0.0,
                inertia: DMat3::ZERO,
            };
        }
        let inertia = match bodies.turners.slot(placed.body) {
            Some(slot) if bodies.tumbles(placed.body) => {
                bodies.turners.inverse_inertia(slot, placed.axes)
            }
            _ => DMat3::ZERO,
        };
        Yielding {
            mass: 1.0 / bodies.mass[placed.body],
            inertia,
        }
    }

    fn twist(&self, placed: &Placed) -> Twist {
        let bodies = self.scene.bodies;
        let slot = bodies.turners.slot(placed.body);
        let slot = slot.filter(|_| bodies.tumbles(placed.body));
        Twist {
            velocity: self.end.velocity[placed.body],
            spin: slot.map_or(DVec3::ZERO, |slot| {
                let moments = bodies.turners.inertia[slot].moments();
                spin(moments, placed.axes, self.end.turned[slot].momentum)
            }),
        }
    }

    /// Adds the angular momenta of impulses to the bodies, and converts them for the rotations to which the bodies go
    /// back.
    fn give_momentum(&mut self, placed: &[Placed], contacts: &[Arms], given: &[f64]) {
        let bodies = self.scene.bodies;
        for (contact, &given) in contacts.iter().zip(given) {
            let push = given * contact.normal;
            for (place, arm, push) in [
                (contact.bodies.0, contact.arms.0, -push),
                (contact.bodies.1, contact.arms.1, push),
            ] {
                let body = placed[place].body;
                if let Some(slot) = bodies.turners.slot(body)
                    && bodies.tumbles(body)
                    && bodies.is_movable(body)
                {
                    self.end.turned[slot].momentum += arm.cross(push);
                }
            }
        }
        for &Placed {
            body,
            axes,
            was_back,
        } in placed
        {
            let Some(slot) = bodies.turners.slot(body) else {
                continue;
            };
            if was_back || !bodies.tumbles(body) || !bodies.is_movable(body) {
                continue;
            }
            let moments = bodies.turners.inertia[slot].moments();
            let momentum = self.end.turned[slot].momentum;
            let energy = |axes: DQuat| momentum.dot(spin(moments, axes, momentum));
            let there = energy(self.scene.before.turned[slot].rotation);
            if there > 0.0 {
                self.end.turned[slot].momentum *= libm::sqrt(energy(axes) / there);
            }
        }
    }

    /// Reverses the relative motion of two bodies.
    fn turn_back(&mut self, touching: &Touching) {
        let bodies = self.scene.bodies;
        let [i, j] = touching.bodies;
        let restitution = bodies.pair_restitution(i, j);
        let velocity = |body: usize| self.end.velocity[body];
        let closing = velocity(i) - velocity(j);
        let exchange = closing.try_normalize().and_then(|normal| {
            let masses = (bodies.mass[i], bodies.mass[j]);
            impulse::between(
                (masses.0, velocity(i)),
                (masses.1, velocity(j)),
                normal,
                restitution,
            )
        });
        for body in [i, j].into_iter().filter(|&body| bodies.is_movable(body)) {
            if let Some(slot) = bodies.turners.slot(body) {
                self.end.turned[slot].momentum *= -restitution;
            }
        }
        let Some(exchange) = exchange else { return };
        for (body, after) in [(i, exchange.after.0), (j, exchange.after.1)] {
            if bodies.is_movable(body) {
                self.end.velocity[body] = after;
            }
        }
        let speed = closing.length();
        self.note_turning(touching, (exchange.impulse, (speed, restitution * speed)));
    }
}
