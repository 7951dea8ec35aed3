//! Backward (implicit) Euler.

use super::Method;

pub(super) static METHOD: Method = Method {
    name: "backward-euler",
    title: "Backward Euler",
    order: 1,
    stability: "stable at every step (A- and L-stable): an oscillator loses energy",
    source: "Hairer, Wanner 1996, Solving Ordinary Differential Equations II, sec. IV.1; Baraff, Witkin 1998, eq. 5",
    // Solves x1 = x + dt v1, v1 = v + dt a(x1, v1). A constant force makes the system triangular:
    // v1 first, then x1, with nothing left to iterate.
    step: |before, after, forces, dt| {
        after.fill(before, forces, |x, v, a| {
            let v1 = v + dt * a;
            (x + dt * v1, v1)
        });
    },
};
