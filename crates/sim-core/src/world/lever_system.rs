//! Equations of motion of bodies with forces at points, including their rotations.
//!
//! The turning bodies of a [`Part`] appear in the system a second time, as *rotors*. The position of a rotor is the
//! rotation vector from the rotation at the start of the step ([`crate::rotation::chart`]); its velocity is the rate
//! of this vector. So every method that steps positions steps rotations too, at its own order.
//!
//! Methods made of drifts and kicks are split in another way: the drift is the free flight of a body, exact
//! for any time, and only torques kick. This splits the energy into the same two parts, so such a
//! method conserves for rotations what it conserves for positions.

use alloc::vec::Vec;
use glam::{DQuat, DVec3};

use super::{bodies::Bodies, scene::Scene, state::Turned, system::Part};
use crate::{
    System,
    force::{BodyMotion, PairMotion},
    rotation::{Coordinates, Flight, Rotor, chart, into_body},
};

/// The accelerations of bodies by forces, and of rotors by torques.
pub(super) struct Kicks<'a> {
    pub(super) part: Part<'a>,
    /// In the order of their places in the part.
    pub(super) rotors: &'a [Rotor],
}

/// The same, together with the free rotation of the rotors.
pub(super) struct LeverSystem<'a>(pub(super) Kicks<'a>);

/// A point on which a force acts, relative to its body.
#[derive(Clone, Copy, Default)]
struct Lever {
    arm: DVec3,
    velocity: DVec3,
    /// The rotor of the body.
    rotor: Option<usize>,
}

impl Kicks<'_> {
    /// The number of bodies; rotors come after them.
    fn bodies(&self) -> usize {
        self.part.mass.len()
    }

    /// A point of a body, given the body's place in the part, and the motion of the point about the body's position.
    fn lever(&self, place: usize, point: DVec3, x: &[DVec3], v: &[DVec3]) -> Lever {
        let Ok(k) = self
            .rotors
            .binary_search_by_key(&place, |rotor| rotor.place)
        else {
            return Lever {
                arm: point,
                ..Lever::default()
            };
        };
        let rotor = &self.rotors[k];
        let row = self.bodies() + k;
        let (axes, spin) = rotor.pose(x[row], v[row]);
        let arm = rotor.axes.inverse() * (point - rotor.centre);
        Lever {
            arm: axes * arm,
            velocity: axes * spin.cross(arm),
            rotor: Some(k),
        }
    }

    /// Writes the accelerations of bodies, and the torques on rotors, N m in the world.
    fn loads(&self, time: f64, x: &[DVec3], v: &[DVec3], loads: &mut [DVec3]) {
        let (part, bodies) = (&self.part, self.bodies());
        loads[..bodies].copy_from_slice(part.acceleration);
        for (load, rotor) in loads[bodies..].iter_mut().zip(self.rotors) {
            *load = rotor.torque;
        }
        let mut act = |i: usize, lever: Lever, force: DVec3| {
            loads[i] += force / part.mass[i];
            if let Some(k) = lever.rotor {
                loads[bodies + k] += lever.arm.cross(force);
            }
        };
        part.on_bodies(|force, i| {
            let lever = force.point().map(|point| self.lever(i, point, x, v));
            let lever = lever.unwrap_or_default();
            let motion = BodyMotion {
                time,
                mass: part.mass[i],
                position: x[i] + lever.arm,
                velocity: v[i] + lever.velocity,
            };
            act(i, lever, force.on_body(&motion));
        });
        part.on_pairs(|force, i, j| {
            let levers = force
                .points()
                .map(|[p, q]| [self.lever(i, p, x, v), self.lever(j, q, x, v)]);
            let [first, second] = levers.unwrap_or_default();
            let motion = PairMotion {
                time,
                mass: [part.mass[i], part.mass[j]],
                position: (x[j] - x[i]) + (second.arm - first.arm),
                velocity: (v[j] - v[i]) + (second.velocity - first.velocity),
            };
            let on_first = force.on_pair(&motion);
            act(i, first, on_first);
            act(j, second, -on_first);
        });
    }

    /// Converts torques to second derivatives of rotation vectors; with the free rotation if `is_whole`.
    fn turn(&self, x: &[DVec3], v: &[DVec3], loads: &mut [DVec3], is_whole: bool) {
        let bodies = self.bodies();
        for (k, rotor) in self.rotors.iter().enumerate() {
            let row = bodies + k;
            let (theta, rate) = (x[row], v[row]);
            let (axes, spin) = rotor.pose(theta, rate);
            let torque = match rotor.is_movable {
                true => axes.inverse() * loads[row],
                false => DVec3::ZERO,
            };
            loads[row] = rotor.acceleration((theta, rate), spin, torque, is_whole);
        }
    }
}

impl System for Kicks<'_> {
    fn len(&self) -> usize {
        self.bodies() + self.rotors.len()
    }

    fn depends_on_velocity(&self) -> bool {
        self.part.depends_on_velocity()
    }

    fn accelerations(&self, time: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        self.loads(time, x, v, a);
        self.turn(x, v, a, false);
    }
}

impl System for LeverSystem<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn accelerations(&self, time: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        self.0.loads(time, x, v, a);
        self.0.turn(x, v, a, true);
    }

    fn kicks(&self) -> Option<&dyn System> {
        Some(&self.0)
    }

    fn drift(&self, h: f64, x: &mut [DVec3], v: &mut [DVec3]) {
        let bodies = self.0.bodies();
        for (x, v) in x[..bodies].iter_mut().zip(&v[..bodies]) {
            *x += h * *v;
        }
        for (k, rotor) in self.0.rotors.iter().enumerate() {
            let (theta, rate) = (&mut x[bodies + k], &mut v[bodies + k]);
            // In the frame of the axes at the start of the drift.
            let momentum = rotor.moments * chart::spin(*theta, *rate);
            let flight = Flight::new(rotor.moments, DQuat::IDENTITY, momentum, DVec3::ZERO, h);
            let Ok(flight) = flight else {
                // The end of the step reports this.
                *theta = DVec3::NAN;
                continue;
            };
            let turned = flight.rotation_at(h);
            *theta = chart::vector(chart::rotation(*theta) * turned);
            *rate = chart::rate(*theta, into_body(turned, momentum) / rotor.moments);
        }
    }
}

impl Scene<'_> {
    /// The acceleration of one body of a part, m/s², and the torque on it if it turns, N m, for given positions and
    /// velocities of all bodies of the part.
    pub(super) fn loads(
        &self,
        part: Part<'_>,
        time: f64,
        (x, v): (&[DVec3], &[DVec3]),
        turned: &[Turned],
        body: usize,
    ) -> (DVec3, Option<DVec3>) {
        let (bodies, start) = (part.bodies.clone(), part.bodies.start);
        let levered = bodies.filter(|&body| self.forces.plan.is_levered(body));
        let rotors = levered.filter_map(|body| {
            self.bodies
                .rotor((body, body - start), turned, Coordinates::Vector)
        });
        let rotors: Vec<Rotor> = rotors.collect();
        let still = rotors.iter().map(|_| DVec3::ZERO);
        let x: Vec<DVec3> = x.iter().copied().chain(still).collect();
        let rates = rotors.iter().map(Rotor::first_rate);
        let v: Vec<DVec3> = v.iter().copied().chain(rates).collect();
        let mut loads = x.clone();
        let (place, count) = (body - start, part.mass.len());
        let kicks = Kicks {
            part,
            rotors: &rotors,
        };
        kicks.loads(time, &x, &v, &mut loads);
        let rotor = rotors.binary_search_by_key(&place, |rotor| rotor.place);
        (loads[place], rotor.ok().map(|k| loads[count + k]))
    }
}

impl Bodies {
    /// The rotor of a turning body, given the body's place in the part and the rotations at the start of the step.
    pub(super) fn rotor(
        &self,
        (body, place): (usize, usize),
        turned: &[Turned],
        coordinates: Coordinates,
    ) -> Option<Rotor> {
        let slot = self.turners.slot(body)?;
        let inertia = &self.turners.inertia[slot];
        Some(Rotor {
            place,
            slot,
            moments: inertia.moments(),
            base: turned[slot].rotation,
            momentum: turned[slot].momentum,
            axes: inertia.axes(),
            centre: inertia.centre(),
            torque: self.turners.torque[slot],
            is_movable: self.is_movable(body),
            coordinates,
        })
    }

    /// Stores the rotation of a body at the end of a step. Returns false if it cannot be computed or is not finite.
    #[must_use]
    pub(super) fn note_turned(
        &self,
        rotor: &Rotor,
        (theta, rate): (DVec3, DVec3),
        turned: &mut [Turned],
    ) -> bool {
        let Some((rotation, spin)) = rotor.end(theta, rate) else {
            return false;
        };
        let momentum = rotation * (rotor.moments * spin);
        // An immovable body keeps its free rotation.
        if rotor.is_movable {
            turned[rotor.slot] = Turned { rotation, momentum };
        }
        momentum.is_finite()
    }

    /// A point of a body (m, in the frame of its shape) relative to the body's position, and its velocity about that
    /// position, in the world, m and m/s.
    pub(super) fn lever_in(&self, turned: &[Turned], body: usize, point: DVec3) -> (DVec3, DVec3) {
        let Some(slot) = self.turners.slot(body) else {
            return (point, DVec3::ZERO);
        };
        let arm =
            self.rotation_of(slot, &turned[slot]) * (point - self.turners.inertia[slot].centre());
        let Turned { rotation, momentum } = turned[slot];
        let spin = crate::rotation::spin(self.turners.inertia[slot].moments(), rotation, momentum);
        (arm, spin.cross(arm))
    }
}
