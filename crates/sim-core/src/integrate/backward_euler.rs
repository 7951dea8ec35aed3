//! Backward (implicit) Euler.

use super::{Method, implicit::Equation};

pub(super) static METHOD: Method = Method {
    name: "backward-euler",
    title: "Backward Euler",
    order: 1,
    stability: "stable at every step (A- and L-stable): an oscillator loses energy",
    source: "Hairer, Wanner 1996, Solving Ordinary Differential Equations II, sec. IV.1; Baraff, Witkin 1998, eq. 5",
    symplectic: false,
    reversible: false,
    adaptive: false,
    fall: Some(1.0),
    // Solves v1 = v + dt a(x + dt v1, v1); then x1 = x + dt v1.
    step: |system, s| {
        let (_, room) = s.scratch.with_newton::<0>(0);
        let equation = Equation {
            time: s.time + s.dt,
            position: s.position,
            velocity: s.velocity,
            h: s.dt,
            drift: s.dt,
        };
        s.new_velocity.copy_from_slice(s.velocity);
        equation.solve(system, s.new_velocity, room)?;
        let end = s.new_position.iter_mut().zip(s.new_velocity);
        for ((x1, v1), x) in end.zip(s.position) {
            *x1 = *x + s.dt * *v1;
        }
        Ok(())
    },
};
