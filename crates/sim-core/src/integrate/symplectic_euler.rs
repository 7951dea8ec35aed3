//! Symplectic (semi-implicit) Euler.

use super::Method;

pub(super) static METHOD: Method = Method {
    name: "symplectic-euler",
    title: "Symplectic Euler",
    order: 1,
    stability: "stable while ω dt < 2: energy swings about its start and does not drift",
    source: "de Vogelaere 1956; Hairer, Lubich, Wanner 2006, Geometric Numerical Integration, sec. I.1.2",
    symplectic: true,
    reversible: false,
    adaptive: false,
    fall: Some(1.0),
    // Kick, then drift: the position advances by the new velocity. A force that depends on the velocity is evaluated at
    // the old one, which keeps the method explicit.
    step: |system, s| {
        let kicks = system.kicks().unwrap_or(system);
        kicks.accelerations(s.time, s.position, s.velocity, s.new_velocity);
        for (v1, v) in s.new_velocity.iter_mut().zip(s.velocity) {
            *v1 = *v + s.dt * *v1;
        }
        s.new_position.copy_from_slice(s.position);
        system.drift(s.dt, s.new_position, s.new_velocity);
        Ok(())
    },
};
