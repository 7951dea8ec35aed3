//! The rotation within a step of bodies on which forces act at points.
//!
//! Methods of second and higher order compute it like positions: the state at any time is the state after a step of
//! exactly that length.
//!
//! A first-order method does not, because two partial steps differ from one whole step. It turns a body from the
//! start of the step to the end, and the trajectory is the torque-free flight between these rotations. The difference
//! of its angular momentum from that of the method is added at the end, as a *kick*. This is the counterpart of the
//! velocity stagger of positions.

use alloc::vec::Vec;
use glam::DVec3;

use super::super::{scene::Scene, state::Turned, stepping::Cause};
use super::{
    ContactSolver,
    trajectory::{Motion, Probe, Trajectories},
};
use crate::rotation::{Flight, FlightError, chart};

/// The greatest number of corrections of a flight until it leads to the given rotation. Each multiplies the error by
/// about the angle of the step, rad.
const CORRECTIONS: u32 = 60;

/// The constant torque that changes one angular momentum into another in a time, N m.
pub(super) fn mean_torque(from: Turned, to: Turned, length: f64) -> DVec3 {
    match length > 0.0 {
        true => (to.momentum - from.momentum) / length,
        false => DVec3::ZERO,
    }
}

/// The position, m, and velocity, m/s, of a body, and its rotation if the method computes it.
#[derive(Clone, Copy)]
pub(super) struct Pose {
    pub(super) position: DVec3,
    pub(super) velocity: DVec3,
    pub(super) turned: Option<Turned>,
}

impl Scene<'_> {
    /// Whether forces at points of a body turn it.
    pub(super) fn is_turned_by_levers(&self, body: usize) -> bool {
        self.forces.plan.is_levered(body)
            && self.bodies.is_movable(body)
            && self.bodies.turners.slot(body).is_some()
    }
}

impl Trajectories {
    /// Begins the rotation of a body that levers turn.
    pub(super) fn begin_levered(
        &mut self,
        scene: &Scene<'_>,
        slot: usize,
        body: usize,
    ) -> Result<(), FlightError> {
        let (start, end) = (scene.before.turned[slot], self.end.turned[slot]);
        let length = self.motion(scene).horizon(body);
        self.applied_torque[slot] = mean_torque(start, end, length);
        if self.is_free {
            let moments = scene.bodies.turners.inertia[slot].moments();
            let momentum = momentum_between(moments, start, end, length)?;
            self.start.turned[slot].momentum = momentum;
            self.kicks[slot] = Some(end.momentum - momentum);
        }
        Ok(())
    }
}

/// The flight from one rotation to a third, through a second one in the middle of the time.
pub(super) fn flight_over(
    moments: DVec3,
    [start, half, end]: [Turned; 3],
    length: f64,
) -> Result<Flight, FlightError> {
    let mut momentum = start.momentum;
    let mut torque = mean_torque(start, end, length);
    let mut best = Flight::new(moments, start.rotation, momentum, torque, length)?;
    let mut least = f64::INFINITY;
    let step = 0.5 * length;
    for _ in 0..CORRECTIONS {
        let Ok(flight) = Flight::new(moments, start.rotation, momentum, torque, length) else {
            break;
        };
        let there = flight.rotation_at(step);
        let near = chart::vector(there.inverse() * half.rotation);
        let far = chart::vector(flight.rotation_at(length).inverse() * end.rotation);
        let size = near.length().max(far.length());
        if size >= least {
            break;
        }
        (least, best) = (size, flight);
        if size <= f64::EPSILON {
            break;
        }
        momentum += there * (moments * (2.0 * near - 0.5 * far)) / step;
        torque += there * (moments * (far - 2.0 * near)) / (step * step);
    }
    Ok(best)
}

/// The angular momentum with which a free body gets from one rotation to another in a time. It is searched near the
/// one that the body has at the end.
fn momentum_between(
    moments: DVec3,
    start: Turned,
    end: Turned,
    length: f64,
) -> Result<DVec3, FlightError> {
    let mut momentum = end.momentum;
    let mut least = f64::INFINITY;
    let mut best = momentum;
    for _ in 0..CORRECTIONS {
        let flight = Flight::new(moments, start.rotation, momentum, DVec3::ZERO, length)?;
        let there = flight.rotation_at(length);
        let off = chart::vector(there.inverse() * end.rotation);
        let size = off.length();
        if size >= least {
            break;
        }
        (least, best) = (size, momentum);
        if size <= f64::EPSILON {
            break;
        }
        momentum += there * (moments * off) / length;
    }
    Ok(best)
}

impl ContactSolver<'_> {
    /// Makes the forces constant for the rest of the step on a body that contacts begin to press, and on all bodies
    /// coupled to it by forces. They are those at the starts of the trajectories. The forces on bodies in contact are
    /// constant, and what one body gains the other one must lose.
    pub(super) fn freeze(&mut self, body: usize) {
        let Some((bodies, true)) = self.view().motion().coupled_group(body) else {
            return;
        };
        let motion = self.view().motion();
        let loads = |body: usize| {
            let slot = self.scene.bodies.turners.slot(body);
            let torque = slot.map(|slot| (slot, motion.torque_there(slot, body)));
            (motion.acceleration_there(body), torque)
        };
        let loads: Vec<_> = bodies.clone().map(loads).collect();
        let paths = &mut *self.paths;
        paths.frozen.resize(self.scene.bodies.len(), false);
        for (body, (acceleration, torque)) in bodies.zip(loads) {
            paths.frozen[body] = true;
            let by_contacts = paths.acceleration[body] - paths.applied_acceleration[body];
            paths.applied_acceleration[body] = acceleration - by_contacts;
            paths.acceleration[body] = acceleration;
            if let Some((slot, torque)) = torque {
                paths.applied_torque[slot] = torque;
            }
        }
    }

    /// How much the angular momentum of a body at the start of its trajectory is more than that of its flight, kg m²/s.
    /// It is zero unless a first-order method turns the body by levers. The flight keeps its momentum until the end of
    /// the step, where the kick is added; the momentum of the body itself changes evenly over the step.
    pub(super) fn kick_left(&self, slot: usize, body: usize) -> DVec3 {
        let left = self.scene.settings.dt - self.paths.since[body];
        let kick = self.paths.kicks[slot];
        kick.map_or(DVec3::ZERO, |kick| {
            kick - left * self.paths.applied_torque[slot]
        })
    }
}

impl Motion<'_> {
    /// Whether forces that depend on the motion turn a body, so that its method computes the rotation.
    pub(super) fn is_turning_bent(&self, body: usize) -> bool {
        self.scene.is_turned_by_levers(body) && self.coupled_group(body).is_some()
    }

    /// The position and velocity of a body at a time between its trajectory's start and its horizon, s from the
    /// step's start; and its rotation, if the method computes it.
    pub(super) fn pose_at(
        &self,
        body: usize,
        time: f64,
        probe: &mut Probe,
    ) -> Result<Pose, (usize, Cause)> {
        let (position, velocity) = self.motion_at(body, time, probe)?;
        let slot = self.scene.bodies.turners.slot(body);
        let bent = slot.filter(|_| self.is_turning_bent(body));
        let turned = bent.map(|slot| match time {
            _ if time == self.paths.since[body] => self.paths.start.turned[slot],
            _ if time == self.horizon(body) => self.paths.end.turned[slot],
            // `motion_at` has just stepped the method to this time.
            _ => probe.state.turned[slot],
        });
        Ok(Pose {
            position,
            velocity,
            turned,
        })
    }

    /// The same after the body `asked` was evaluated at that time: bodies coupled to it by forces were stepped with
    /// it.
    pub(super) fn pose_after(
        &self,
        asked: usize,
        body: usize,
        time: f64,
        probe: &mut Probe,
    ) -> Result<Pose, (usize, Cause)> {
        let is_known = time == self.paths.since[body] || time == self.horizon(body);
        let group = self.coupled_group(body).filter(|_| !is_known);
        if group.is_none_or(|(bodies, _)| !bodies.contains(&asked)) {
            return self.pose_at(body, time, probe);
        }
        let slot = self.scene.bodies.turners.slot(body);
        let bent = slot.filter(|_| self.is_turning_bent(body));
        Ok(Pose {
            position: probe.state.position[body],
            velocity: probe.state.velocity[body],
            turned: bent.map(|slot| probe.state.turned[slot]),
        })
    }

    /// The torque on a turning body of all forces other than contacts, N m: at the start of its trajectory if a method
    /// of second or higher order computes its rotation, else the constant one, which under a first-order method is
    /// the mean over the step.
    pub(super) fn torque_there(&self, slot: usize, body: usize) -> DVec3 {
        let applied = self.paths.applied_torque[slot];
        let known = match self.is_turning_bent(body) {
            true => self.loads_beside(body, &[]).1,
            false => None,
        };
        known.unwrap_or(applied)
    }
}
