//! Velocity Verlet, also called leapfrog or Störmer-Verlet.

use super::{Method, splitting::Kick};

pub(super) static METHOD: Method = Method {
    name: "velocity-verlet",
    title: "Velocity Verlet",
    order: 2,
    stability: "stable while ω dt < 2: energy swings about its start and does not drift",
    source: "Störmer 1907; Verlet 1967; Hairer, Lubich, Wanner 2003, Acta Numerica 12, p. 399, eq. 1.5",
    symplectic: true,
    reversible: true,
    adaptive: false,
    fall: Some(0.5),
    // Half a kick, a drift, half a kick. A force that depends on the velocity is evaluated at the start in the first
    // half kick and at the end, implicitly, in the second.
    step: |system, s| {
        let half = 0.5 * s.dt;
        s.new_position.copy_from_slice(s.position);
        s.new_velocity.copy_from_slice(s.velocity);
        let first = Kick {
            time: s.time,
            explicit: half,
            implicit: 0.0,
        };
        first.act(system, s.new_position, s.new_velocity, s.scratch)?;
        system.drift(s.dt, s.new_position, s.new_velocity);
        let second = Kick {
            time: s.time + s.dt,
            explicit: 0.0,
            implicit: half,
        };
        second.act(system, s.new_position, s.new_velocity, s.scratch)
    },
};
