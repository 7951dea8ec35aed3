//! Forward (explicit) Euler.

use super::Method;

pub(super) static METHOD: Method = Method {
    name: "forward-euler",
    title: "Forward Euler",
    order: 1,
    stability: "unstable at every step: an oscillator gains energy",
    source: "Euler 1768; Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I, sec. I.7",
    // Position and velocity both advance by their slopes at the start.
    step: |before, after, forces, dt| {
        after.fill(before, forces, |x, v, a| (x + dt * v, v + dt * a));
    },
};
