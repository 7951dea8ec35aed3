//! A symplectic method of order four.

use super::{Method, splitting};

pub(super) static METHOD: Method = Method {
    name: "symplectic-4",
    title: "Blanes-Moan 4",
    order: 4,
    stability: "stable while ω dt < 3.13: energy swings by little and does not drift",
    source: "Blanes, Moan 2002, J. Comput. Appl. Math. 142, p. 313, table 2, S6",
    symplectic: true,
    reversible: true,
    adaptive: false,
    fall: Some(0.5),
    step: |system, s| splitting::step(system, s, &DRIFTS, &KICKS),
};

const A: [f64; 3] = [0.0792036964311957, 0.353172906049774, -0.0420650803577195];
const MIDDLE: f64 = 1.0 - 2.0 * (A[0] + A[1] + A[2]);
pub(super) const DRIFTS: [f64; 7] = [A[0], A[1], A[2], MIDDLE, A[2], A[1], A[0]];

const B: [f64; 2] = [0.209515106613362, -0.143851773179818];
const INNER: f64 = 0.5 - (B[0] + B[1]);
pub(super) const KICKS: [f64; 6] = [B[0], B[1], INNER, INNER, B[1], B[0]];
