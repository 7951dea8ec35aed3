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
    // Kick, then drift: the position advances by the new velocity. A force that depends on the
    // velocity is taken at the old one, which keeps the method explicit.
    step: |system, s| {
        let (x, v) = (s.position, s.velocity);
        system.accelerations(s.time, x, v, s.new_velocity);
        let end = s.new_position.iter_mut().zip(s.new_velocity);
        for ((x1, v1), (x, v)) in end.zip(x.iter().zip(v)) {
            *v1 = *v + s.dt * *v1;
            *x1 = *x + s.dt * *v1;
        }
        Ok(())
    },
};
