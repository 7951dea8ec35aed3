//! A run of bodies and the forces on them, as equations of motion.

use core::ops::Range;
use glam::DVec3;

use super::plan::{Group, Plan};
use crate::{
    Jacobians, System,
    force::{BodyMotion, Force, PairMotion},
};

/// Bodies of a world that can be stepped without the others.
pub(super) struct Part<'a> {
    pub(super) forces: &'a [Force],
    pub(super) plan: &'a Plan,
    /// The bodies, as indices of the world, if they are not a group.
    pub(super) bodies: Range<usize>,
    /// The group that the bodies are, in its order and with its forces.
    pub(super) group: Option<&'a Group>,
    pub(super) is_coupled: bool,
    /// Their masses, kg.
    pub(super) mass: &'a [f64],
    /// Their accelerations by constant forces and weight, m/s².
    pub(super) acceleration: &'a [DVec3],
}

/// The motion of the bodies of a part, at which a method evaluates forces.
#[derive(Clone, Copy)]
struct Motion<'a> {
    time: f64,
    x: &'a [DVec3],
    v: &'a [DVec3],
}

impl Part<'_> {
    fn body(&self, at: Motion<'_>, i: usize) -> BodyMotion {
        BodyMotion {
            time: at.time,
            mass: self.mass[i],
            position: at.x[i],
            velocity: at.v[i],
        }
    }

    fn pair(&self, at: Motion<'_>, i: usize, j: usize) -> PairMotion {
        PairMotion {
            time: at.time,
            mass: [self.mass[i], self.mass[j]],
            position: at.x[j] - at.x[i],
            velocity: at.v[j] - at.v[i],
        }
    }

    /// Calls `act` for each force on a single movable body and that body's index in the part.
    pub(super) fn on_bodies(&self, mut act: impl FnMut(&Force, usize)) {
        for &force in &self.plan.each {
            for i in (0..self.mass.len()).filter(|&i| self.is_movable(i)) {
                act(&self.forces[force], i);
            }
        }
        let (single, start) = match self.group {
            Some(group) => (&group.single[..], 0),
            None => (self.plan.single_in(&self.bodies), self.bodies.start),
        };
        for &(body, force) in single {
            let i = body - start;
            if self.is_movable(i) {
                act(&self.forces[force], i);
            }
        }
    }

    fn is_movable(&self, i: usize) -> bool {
        self.mass[i].is_finite()
    }

    /// Calls `act` for each force between two bodies and their indices in the part. Forces between every two bodies
    /// leave out immovable ones: their attraction would be infinite.
    pub(super) fn on_pairs(&self, mut act: impl FnMut(&Force, usize, usize)) {
        if !self.is_coupled {
            return;
        }
        let (pairs, start) = match self.group {
            Some(group) => (&group.pairs[..], 0),
            None => (self.plan.pairs_in(&self.bodies), self.bodies.start),
        };
        for &([i, j], force) in pairs {
            act(&self.forces[force], i - start, j - start);
        }
        for &force in &self.plan.each_pair {
            for j in (1..self.mass.len()).filter(|&j| self.is_movable(j)) {
                for i in (0..j).filter(|&i| self.is_movable(i)) {
                    act(&self.forces[force], i, j);
                }
            }
        }
    }
}

impl System for Part<'_> {
    fn len(&self) -> usize {
        self.mass.len()
    }

    fn is_coupled(&self) -> bool {
        self.is_coupled
    }

    fn depends_on_velocity(&self) -> bool {
        self.plan.depends_on_velocity
    }

    fn accelerations(&self, time: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        let at = Motion { time, x, v };
        a.copy_from_slice(self.acceleration);
        self.on_bodies(|force, i| a[i] += force.on_body(&self.body(at, i)) / self.mass[i]);
        self.on_pairs(|force, i, j| {
            let on_first = force.on_pair(&self.pair(at, i, j));
            a[i] += on_first / self.mass[i];
            a[j] -= on_first / self.mass[j];
        });
    }

    fn apply_jacobian(
        &self,
        time: f64,
        (x, v): (&[DVec3], &[DVec3]),
        (dx, dv): (&[DVec3], &[DVec3]),
        da: &mut [DVec3],
    ) {
        let at = Motion { time, x, v };
        da.fill(DVec3::ZERO);
        self.on_bodies(|force, i| {
            let slopes = force.body_jacobians(&self.body(at, i));
            da[i] += (slopes.position * dx[i] + slopes.velocity * dv[i]) / self.mass[i];
        });
        self.on_pairs(|force, i, j| {
            let (dx, dv) = (dx[j] - dx[i], dv[j] - dv[i]);
            let change = force.pair_change(&self.pair(at, i, j), dx, dv);
            da[i] += change / self.mass[i];
            da[j] -= change / self.mass[j];
        });
    }

    fn jacobians(&self, time: f64, x: &[DVec3], v: &[DVec3], out: &mut [Jacobians]) {
        let at = Motion { time, x, v };
        out.fill(Jacobians::ZERO);
        let mut add = |i: usize, slopes: &Jacobians, sign: f64| {
            let share = sign / self.mass[i];
            out[i].position += share * slopes.position;
            out[i].velocity += share * slopes.velocity;
        };
        self.on_bodies(|force, i| add(i, &force.body_jacobians(&self.body(at, i)), 1.0));
        // The Jacobian is that of the force on the first body with respect to the relative position, from the first to
        // the second. For the first body the position has the opposite sign, for the second body the force has.
        self.on_pairs(|force, i, j| {
            let slopes = force.pair_jacobians(&self.pair(at, i, j));
            add(i, &slopes, -1.0);
            add(j, &slopes, -1.0);
        });
    }
}
