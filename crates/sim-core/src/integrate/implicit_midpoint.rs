//! The implicit midpoint rule.

use super::{Method, implicit::Equation};

pub(super) static METHOD: Method = Method {
    name: "implicit-midpoint",
    title: "Implicit midpoint",
    order: 2,
    stability: "stable at every step (A-stable): energy swings about its start and does not drift",
    source: "Hairer, Lubich, Wanner 2006, Geometric Numerical Integration, eq. II.1.7 and sec. VI.4",
    symplectic: true,
    reversible: true,
    adaptive: false,
    fall: Some(0.5),
    // Backward Euler to the middle, w = v + dt/2 a(x + dt/2 w, w); then the same distance again.
    step: |system, s| {
        let half = 0.5 * s.dt;
        let (_, room) = s.scratch.with_newton::<0>(0);
        let equation = Equation {
            time: s.time + half,
            position: s.position,
            velocity: s.velocity,
            h: half,
            drift: half,
        };
        s.new_velocity.copy_from_slice(s.velocity);
        equation.solve(system, s.new_velocity, room)?;
        let end = s.new_position.iter_mut().zip(s.new_velocity);
        for ((x1, w), (x, v)) in end.zip(s.position.iter().zip(s.velocity)) {
            *x1 = *x + s.dt * *w;
            *w = 2.0 * *w - *v;
        }
        Ok(())
    },
};
