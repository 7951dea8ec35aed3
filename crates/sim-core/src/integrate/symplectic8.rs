//! A symplectic method of order eight.

use super::{Method, splitting};

pub(super) static METHOD: Method = Method {
    name: "symplectic-8",
    title: "Kahan-Li 8",
    order: 8,
    stability: "stable while ω dt < 3.09: energy swings by very little and does not drift",
    source: "Kahan, Li 1997, Math. Comput. 66, p. 1089; Hairer, Lubich, Wanner 2006, eq. V.3.13",
    symplectic: true,
    reversible: true,
    adaptive: false,
    fall: Some(0.5),
    step: |system, s| splitting::step(system, s, &DRIFTS, &KICKS),
};

/// Lengths of the first nine of seventeen steps of position Verlet; the others mirror them.
const GAMMA: [f64; 9] = [
    0.130_202_483_088_890_08,
    0.561_162_981_775_108_4,
    -0.389_474_962_644_847_3,
    0.158_841_906_555_155_6,
    -0.395_903_894_133_237_6,
    0.184_539_640_978_315_7,
    0.258_374_387_686_322_04,
    0.295_011_723_609_310_3,
    -0.605_508_533_830_034_5,
];

pub(super) const KICKS: [f64; 17] = {
    let mut kicks = [0.0; 17];
    let mut i = 0;
    while i < 9 {
        kicks[i] = GAMMA[i];
        kicks[16 - i] = GAMMA[i];
        i += 1;
    }
    kicks
};

/// Each drift joins the second half of one step and the first half of the next.
pub(super) const DRIFTS: [f64; 18] = {
    let mut drifts = [0.5 * GAMMA[0]; 18];
    let mut i = 1;
    while i < 17 {
        drifts[i] = 0.5 * (KICKS[i - 1] + KICKS[i]);
        i += 1;
    }
    drifts
};
