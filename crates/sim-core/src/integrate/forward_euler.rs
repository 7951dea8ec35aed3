//! Forward (explicit) Euler.

use super::Method;

pub(super) static METHOD: Method = Method {
    name: "forward-euler",
    title: "Forward Euler",
    order: 1,
    stability: "unstable at every step without damping: an oscillator gains energy",
    source: "Euler 1768; Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I, sec. I.7",
    symplectic: false,
    reversible: false,
    adaptive: false,
    fall: Some(0.0),
    // Position and velocity both advance by their slopes at the start.
    step: |system, s| {
        let (x, v) = (s.position, s.velocity);
        system.accelerations(s.time, x, v, s.new_velocity);
        let end = s.new_position.iter_mut().zip(s.new_velocity);
        for ((x1, v1), (x, v)) in end.zip(x.iter().zip(v)) {
            *x1 = *x + s.dt * *v;
            *v1 = *v + s.dt * *v1;
        }
        Ok(())
    },
};
