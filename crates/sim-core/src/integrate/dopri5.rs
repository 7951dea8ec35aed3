//! Dormand and Prince's method of order five, with error control.

use super::{Method, adaptive};
use crate::ode::DormandPrince5;

pub(super) static METHOD: Method = Method {
    name: "dopri5",
    title: "Dormand-Prince 5(4)",
    order: 5,
    stability: "as many steps within dt as stability and the tolerance ask for",
    source: "Dormand, Prince 1980, J. Comput. Appl. Math. 6, p. 19; Hairer, Nørsett, Wanner 1993, sec. II.5",
    symplectic: false,
    reversible: false,
    adaptive: true,
    fall: Some(0.5),
    step: adaptive::step::<DormandPrince5>,
};
