//! A system that counts its evaluations.

use std::cell::Cell;

use sim_core::{DVec3, Jacobians, System};

pub(super) struct Counted<'a, S> {
    system: &'a S,
    evaluations: Cell<u64>,
    jacobians: Cell<u64>,
}

impl<'a, S> Counted<'a, S> {
    pub(super) fn new(system: &'a S) -> Self {
        Counted {
            system,
            evaluations: Cell::new(0),
            jacobians: Cell::new(0),
        }
    }

    pub(super) fn evaluations(&self) -> u64 {
        self.evaluations.get()
    }

    pub(super) fn jacobians(&self) -> u64 {
        self.jacobians.get()
    }
}

impl<S: System> System for Counted<'_, S> {
    fn len(&self) -> usize {
        self.system.len()
    }

    fn accelerations(&self, t: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        self.evaluations.set(self.evaluations.get() + 1);
        self.system.accelerations(t, x, v, a);
    }

    fn is_coupled(&self) -> bool {
        self.system.is_coupled()
    }

    fn depends_on_velocity(&self) -> bool {
        self.system.depends_on_velocity()
    }

    fn apply_jacobian(
        &self,
        t: f64,
        at: (&[DVec3], &[DVec3]),
        along: (&[DVec3], &[DVec3]),
        da: &mut [DVec3],
    ) {
        self.jacobians.set(self.jacobians.get() + 1);
        self.system.apply_jacobian(t, at, along, da);
    }

    fn jacobians(&self, t: f64, x: &[DVec3], v: &[DVec3], out: &mut [Jacobians]) {
        self.jacobians.set(self.jacobians.get() + 1);
        self.system.jacobians(t, x, v, out);
    }
}
