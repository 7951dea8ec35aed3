//! Symplectic (semi-implicit) Euler.

use super::Method;

pub(super) static METHOD: Method = Method {
    name: "symplectic-euler",
    title: "Symplectic Euler",
    order: 1,
    stability: "stable while ω dt < 2: energy swings about its start and does not drift",
    source: "de Vogelaere 1956; Hairer, Lubich, Wanner 2006, Geometric Numerical Integration, sec. I.1.2",
    // Kick, then drift: the position advances by the new velocity.
    step: |before, after, forces, dt| {
        after.fill(before, forces, |x, v, a| {
            let v = v + dt * a;
            (x + dt * v, v)
        });
    },
};
